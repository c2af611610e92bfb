# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Clocks that go fast, slow, or not at all."""

from __future__ import annotations

import pytest

from fuzzy_map_building.ros.clock import PatientTime, StallWatch


class Wall:
    """Wall time that a test turns [s]."""

    def __init__(self) -> None:
        self.now = 50.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> Wall:
    wall = Wall()
    monkeypatch.setattr("fuzzy_map_building.ros.clock.time", wall)
    return wall


def test_a_clock_stalls_when_it_stands_and_not_when_it_goes(wall: Wall) -> None:
    watch = StallWatch(limit=5.0)
    assert not watch.stalled(1.0)
    wall.now = 54.0
    assert not watch.stalled(1.0)
    wall.now = 55.5
    assert watch.stalled(1.0)
    assert not watch.stalled(1.05)
    wall.now = 60.0
    assert not watch.stalled(1.05)
    wall.now = 61.0
    assert watch.stalled(1.05)
    watch.restart()
    assert not watch.stalled(1.05)


def pass_time(wall: Wall, patient: PatientTime, seconds: float, rate: float, now: float) -> float:
    """Let wall time pass in looks of 50 ms; return the node's time, `rate` times as fast."""
    for _ in range(round(seconds / 0.05)):
        wall.now += 0.05
        now += 0.05 * rate
        read = patient.read(now)
        assert read <= now
    return now


def test_patience_is_the_nodes_time_where_that_is_slower_than_the_walls(wall: Wall) -> None:
    for rate in (0.2, 1.0):
        patient = PatientTime(7.0)
        now = pass_time(wall, patient, 3.0, rate, 7.0)
        assert patient.read(now) == pytest.approx(7.0 + 3.0 * rate)


def test_fast_simulated_time_exhausts_no_patience_before_wall_time(wall: Wall) -> None:
    patient = PatientTime(7.0)
    now = pass_time(wall, patient, 1.0, 20.0, 7.0)
    assert now == pytest.approx(27.0)
    assert patient.read(now) == pytest.approx(8.0)


def test_a_process_that_is_held_up_does_not_lose_its_patience(wall: Wall) -> None:
    patient = PatientTime(7.0)
    wall.now += 10.0
    assert patient.read(17.0) == pytest.approx(7.1)
