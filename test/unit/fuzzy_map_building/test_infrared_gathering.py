# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which infrared readings a packet gets: one sweep a step of the way, guarded by the sonars."""

import math

import numpy as np
import pytest

from fuzzy_map_building import infrared_gathering
from fuzzy_map_building.infrared_gathering import InfraredGatherer
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading

PARAMETERS = mapper_parameters("consistent")


def sweep(x: float, stamp: float, value: float = math.inf) -> list[InfraredReading]:
    pose = Pose2(x, 1.0)
    return [InfraredReading(pose, math.radians(22.5 * i), value, stamp, i) for i in range(16)]


def drive(gatherer: InfraredGatherer, start: float, end: float, step: float = 0.03) -> None:
    """A sweep every few centimetres, as a robot at 0.6 m/s has them."""
    for k, x in enumerate(np.arange(start, end, step)):
        for reading in sweep(float(x), start + k):
            gatherer.on_infrared(reading)


def places(gatherer: InfraredGatherer) -> list[float]:
    readings = gatherer.readings()
    assert len(readings) % 16 == 0
    for k in range(0, len(readings), 16):
        assert [r.sensor for r in readings[k : k + 16]] == list(range(16))
        assert len({r.pose for r in readings[k : k + 16]}) == 1
    return [round(r.pose.x, 6) for r in readings[::16]]


def test_one_sweep_for_each_step_of_the_way() -> None:
    gatherer = InfraredGatherer(PARAMETERS)
    assert gatherer.readings() == []
    drive(gatherer, 0.0, 0.61)
    # Steps of 3 cm: the first at least 10 cm on is 12 cm on.
    assert places(gatherer) == [0.0, 0.12, 0.24, 0.36, 0.48, 0.6]
    gatherer.readings()  # taking a look changes nothing
    assert len(places(gatherer)) == 6


def test_a_way_of_whole_cells_gives_a_sweep_a_cell() -> None:
    gatherer = InfraredGatherer(PARAMETERS)
    drive(gatherer, 2.05, 2.56, 0.1)
    assert places(gatherer) == [2.05, 2.15, 2.25, 2.35, 2.45, 2.55]


def test_what_was_fused_is_forgotten() -> None:
    gatherer = InfraredGatherer(PARAMETERS)
    drive(gatherer, 0.0, 0.3)
    # A perception took the sweeps where the robot stands.
    gatherer.restart(Pose2(0.27, 1.0))
    assert gatherer.readings() == []
    drive(gatherer, 0.27, 0.365)
    assert gatherer.readings() == []
    drive(gatherer, 0.365, 0.5)
    assert places(gatherer) == [0.395]
    # In continuous mode each packet gets a sweep, also that of a robot that stands.
    gatherer.restart()
    drive(gatherer, 0.485, 0.5)
    assert places(gatherer) == [0.485]


def test_each_sensor_is_taken_once_a_place() -> None:
    gatherer = InfraredGatherer(PARAMETERS)
    first = sweep(1.0, 0.0)[3]
    assert gatherer.wants(first.pose)
    gatherer.on_infrared(first)
    gatherer.on_infrared(InfraredReading(first.pose, first.bearing, 0.1, 0.1, 3))
    assert gatherer.readings() == [first]
    assert gatherer.wants(first.pose)
    for reading in sweep(1.05, 0.2):
        gatherer.on_infrared(reading)
    assert len(gatherer.readings()) == 16
    assert not gatherer.wants(Pose2(1.0, 1.09))
    assert gatherer.wants(Pose2(1.0, 1.1))


def test_nothing_is_kept_of_what_is_no_evidence() -> None:
    gatherer = InfraredGatherer(mapper_parameters(overrides={"infrared_evidence.enabled": False}))
    drive(gatherer, 0.0, 1.0)
    assert gatherer.readings() == []
    assert not gatherer.wants(Pose2(0.0, 0.0))


def test_the_newest_sweeps_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(infrared_gathering, "_MAX_SWEEPS", 3)
    gatherer = InfraredGatherer(PARAMETERS)
    drive(gatherer, 0.0, 1.0, 0.1)
    assert places(gatherer) == [0.7, 0.8, 0.9]


def test_a_sonar_guards_the_sweep_it_was_heard_in_and_the_one_after() -> None:
    gatherer = InfraredGatherer(PARAMETERS)
    for k in range(4):
        for reading in sweep(0.1 * k, float(k)):
            gatherer.on_infrared(reading)
    # Glass 0.15 m to the left of the body, heard at the second place, late.
    gatherer.on_sonar(SonarReading(Pose2(0.1, 1.0), math.pi / 2.0, 0.15, 1.5, 4))
    # Too far away to count while moving, or before anything was seen.
    gatherer.on_sonar(SonarReading(Pose2(0.1, 1.0), 0.0, 0.26, 1.5, 0))
    gatherer.on_sonar(SonarReading(Pose2(0.0, 1.0), math.pi, 0.1, -1.0, 8))
    limited = [
        (round(r.pose.x, 6), r.sensor, r.limit) for r in gatherer.readings() if r.limit < math.inf
    ]
    # The glass stands at (0.1, 1.38); seen from (0.2, 1) it lies 14.7 deg off the left ray.
    at_once, next_place, beside = limited
    assert at_once == (0.1, 4, pytest.approx(0.15 - 0.05))
    assert next_place == (0.2, 4, pytest.approx(math.hypot(0.1, 0.38) - 0.05 - 0.23))
    assert beside[:2] == (0.2, 5)


def test_a_hit_explains_and_without_the_guard_nothing_is_cut() -> None:
    echo = SonarReading(Pose2(0.0, 1.0), math.pi / 2.0, 0.15, 0.5, 4)
    for values, parameters in (
        (0.17, PARAMETERS),
        (math.inf, mapper_parameters("consistent", {"sonar_guard.enabled": False})),
    ):
        gatherer = InfraredGatherer(parameters)
        for reading in sweep(0.0, 0.0, values):
            gatherer.on_infrared(reading)
        gatherer.on_sonar(echo)
        assert all(r.limit == math.inf for r in gatherer.readings())
