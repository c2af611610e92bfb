# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which sensors fell silent, and which tell the same whatever they look at."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.ring_watch import RingWatch

FRAMES = ("s0", "s1", "s2")
DEGREE = math.radians(1.0)


def reading(sensor: int, distance: float, stamp: float, turned: float = 0.0) -> SonarReading:
    """A reading of a robot that has turned by an angle [deg]."""
    return SonarReading(Pose2(1.0, 2.0, turned * DEGREE), 0.3 * sensor, distance, stamp, sensor)


def watch() -> RingWatch:
    return RingWatch(FRAMES, 0.1, 6.5)


def test_silent_sensors_are_named() -> None:
    ring = watch()
    assert ring.silent(0.0, 0.5) == list(FRAMES)
    ring.update([reading(0, math.inf, 1.0), reading(2, -math.inf, 1.1)])
    assert ring.silent(1.2, 0.5) == ["s1"]
    ring.update([reading(1, 0.2, 1.2)])
    assert ring.silent(1.2, 0.5) == []
    assert ring.silent(1.55, 0.5) == ["s0"]
    assert ring.silent(1.7, 0.5) == ["s0", "s2"]
    ring.clear()
    assert ring.silent(1.2, 0.5) == list(FRAMES)


def test_what_is_faulty_or_older_than_the_newest_is_no_sign_of_life() -> None:
    ring = watch()
    ring.update([reading(0, 0.5, 1.0), reading(1, 0.5, 1.0), reading(2, 0.5, 1.0)])
    ring.update([reading(0, math.nan, 2.0), reading(1, 0.6, 0.9), reading(2, 0.6, 2.0)])
    assert ring.silent(2.0, 0.5) == ["s0", "s1"]


@pytest.mark.parametrize("stuck_at", [0.11, 0.5, 6.4])
@pytest.mark.parametrize("sign", [1, -1])
def test_one_distance_for_a_turn_is_stuck(stuck_at: float, sign: int) -> None:
    ring = watch()
    for k in range(46):
        assert ring.stuck(44.5 * DEGREE) == [], k
        moving = [reading(0, stuck_at, k, sign * k), reading(1, 0.5 + 0.001 * k, k, sign * k)]
        ring.update(moving)
    assert ring.stuck(44.5 * DEGREE) == ["s0"]
    # It stays so when the robot turns back, until it tells something else.
    ring.update([reading(0, stuck_at, 50.0)])
    assert ring.stuck(44.5 * DEGREE) == ["s0"]
    ring.update([reading(0, stuck_at + 1e-6, 51.0)])
    assert ring.stuck(44.5 * DEGREE) == []


@pytest.mark.parametrize("value", [math.inf, -math.inf, 6.5, 0.1])
def test_what_is_no_distance_may_stay_the_same(value: float) -> None:
    ring = watch()
    for k in range(0, 360, 5):
        ring.update([reading(0, value, k, k)])
    assert ring.stuck(20.0 * DEGREE) == []


def test_the_turret_turns_a_sensor_as_well_and_standing_does_not() -> None:
    ring = watch()
    for k in range(100):
        ring.update([reading(0, 0.5, k)])
    assert ring.stuck(5.0 * DEGREE) == []
    ring.update([replace(reading(0, 0.5, 100.0), bearing=10.0 * DEGREE)])
    assert ring.stuck(5.0 * DEGREE) == ["s0"]


def test_a_sensor_that_measures_a_wall_is_not_stuck() -> None:
    """Exact ranges of a wall, a pole and a corner, from a robot that drives and turns."""
    generator = np.random.default_rng(5)
    ring, heading = watch(), 0.0
    for k in range(2000):
        heading += generator.uniform(-0.05, 0.05)
        x, y = 0.001 * k, 0.3
        direction = math.remainder(heading, 2.0 * math.pi)
        to_wall = y / math.cos(direction) if abs(direction) < 1.4 else math.inf
        to_pole = math.hypot(1.0 - x, 1.0 - y) - 0.1 + 0.2 * (1.0 - math.cos(direction))
        ranges = (to_wall, to_pole, math.hypot(2.0 - x, 2.0 - y))
        pose = Pose2(x, y, heading)
        ring.update([SonarReading(pose, 0.0, r, 0.05 * k, i) for i, r in enumerate(ranges)])
        assert ring.stuck(20.0 * DEGREE) == []
