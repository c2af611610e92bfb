# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Packets without end: when one is full, and where the turret is sent meanwhile."""

import math
from collections.abc import Iterator

from fuzzy_map_building.continuous import ContinuousGathering
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.types import Pose2, SonarReading


def rounds(count: int, silent: frozenset[int] = frozenset()) -> Iterator[SonarReading]:
    """Some rounds of a ring of 16 sonars, one reading each 10 ms."""
    for k in range(16 * count):
        if k % 16 not in silent:
            yield SonarReading(Pose2(0.0, 0.0), 0.0, 1.0, 0.01 * (k + 1), k % 16)


def commands(gathering: ContinuousGathering, readings: Iterator[SonarReading]) -> list[float]:
    """What the turret is told, in degrees, when it is asked after every reading."""
    told = [gathering.turret_command(0.0)]
    for reading in readings:
        gathering.on_reading(reading)
        told.append(gathering.turret_command(reading.stamp))
    return [round(math.degrees(angle), 6) for angle in told if angle is not None]


def test_a_packet_is_full_at_its_size_and_the_next_begins() -> None:
    gathering = ContinuousGathering(mapper_parameters(overrides={"packet_size": 20}))
    readings = list(rounds(3))
    packets = [packet for r in readings if (packet := gathering.on_reading(r)) is not None]
    assert packets == [readings[:20], readings[20:40]]
    assert gathering.waiting == 8
    gathering.forget()
    assert gathering.waiting == 0


def test_the_turret_goes_to_and_fro_a_step_a_round() -> None:
    gathering = ContinuousGathering(mapper_parameters())
    told = commands(gathering, rounds(7))
    assert told == [0.0, 7.5, 15.0, 15.0, 7.5, 0.0, 0.0, 7.5]


def test_any_packet_of_three_rounds_has_all_three_angles() -> None:
    told = commands(ContinuousGathering(mapper_parameters()), rounds(12))
    # From the first command on a round is measured at, or on the way to, each angle told.
    for first in range(0, len(told) - 2, 3):
        assert set(told[first : first + 3]) == {0.0, 7.5, 15.0}


def test_a_silent_sonar_does_not_hold_the_turret() -> None:
    gathering = ContinuousGathering(mapper_parameters())
    told = commands(gathering, rounds(4, silent=frozenset({0, 5, 15})))
    # The round is over when the first one speaks again: the last has no such end.
    assert told == [0.0, 7.5, 15.0, 15.0]


def test_without_a_turret_nothing_is_commanded() -> None:
    gathering = ContinuousGathering(mapper_parameters(overrides={"turret.joint": ""}))
    assert commands(gathering, rounds(3)) == []


def test_readings_from_before_a_command_do_not_end_its_round() -> None:
    gathering = ContinuousGathering(mapper_parameters())
    assert gathering.turret_command(1.0) == 0.0
    for reading in rounds(3):
        gathering.on_reading(reading)
    assert gathering.turret_command(1.1) is None


def test_after_the_clock_was_set_back_it_begins_anew() -> None:
    gathering = ContinuousGathering(mapper_parameters())
    gathering.turret_command(1000.0)
    gathering.forget()
    assert len(commands(gathering, rounds(2))) == 3
