# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import math
from collections.abc import Iterable

import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.control_tick import ControlTicks, Tick, Untimely

BEARINGS = (0.0, math.pi / 2.0, math.pi)


def pose_at(stamp: float) -> Pose2:
    """A robot that drives along x with 1 m/s."""
    return Pose2(stamp, 0.0, 0.0)


def feed(ticks: ControlTicks, stamp: float, sensors: Iterable[int]) -> list[Tick | None]:
    """Let sensors measure at a stamp; return what each of their readings brought."""
    return [ticks.on_range(stamp, sensor, stamp, 0.1 * (sensor + 1)) for sensor in sensors]


def due(tick: Tick | None) -> tuple[float, bool]:
    assert tick is not None
    return tick.stamp, tick.complete


def test_a_tick_is_due_with_the_last_reading_of_the_poses_stamp() -> None:
    ticks = ControlTicks(BEARINGS)
    assert ticks.on_pose(1.0, 1.0, pose_at(1.0)) is None
    assert feed(ticks, 1.0, (0, 2)) == [None, None]
    (tick,) = feed(ticks, 1.0, (1,))
    assert tick is not None
    assert (tick.stamp, tick.pose, tick.complete) == (1.0, pose_at(1.0), True)
    assert [(r.sensor, r.bearing, r.range, r.stamp) for r in tick.readings] == [
        (0, 0.0, pytest.approx(0.1), 1.0),
        (1, math.pi / 2.0, pytest.approx(0.2), 1.0),
        (2, math.pi, pytest.approx(0.3), 1.0),
    ]
    assert all(r.pose == pose_at(1.0) for r in tick.readings)


def test_ranges_may_come_before_their_pose() -> None:
    ticks = ControlTicks(BEARINGS)
    assert feed(ticks, 1.0, range(3)) == [None] * 3
    assert due(ticks.on_pose(1.0, 1.0, pose_at(1.0))) == (1.0, True)
    # One tick per pose: more ranges make no other.
    assert feed(ticks, 1.01, range(3)) == [None] * 3


def test_without_sensors_each_pose_is_a_tick() -> None:
    ticks = ControlTicks(())
    assert due(ticks.on_pose(1.0, 1.0, pose_at(1.0))) == (1.0, True)


def test_a_pose_waits_for_no_ranges_once_it_is_overdue() -> None:
    ticks = ControlTicks(BEARINGS)
    assert ticks.overdue() is None
    assert ticks.on_pose(1.0, 1.0, pose_at(1.0)) is None
    feed(ticks, 1.0, (0, 2))
    tick = ticks.overdue()
    assert due(tick) == (1.0, False)
    assert tick is not None
    assert [r.sensor for r in tick.readings] == [0, 2]
    assert ticks.overdue() is None
    # What comes too late belongs to the next tick.
    assert feed(ticks, 1.0, (1,)) == [None]
    assert ticks.on_pose(1.1, 1.1, pose_at(1.1)) is None
    last = feed(ticks, 1.1, range(3))[-1]
    assert due(last) == (1.1, True)


def test_a_silent_sensor_delays_the_tick_to_the_next_pose_at_the_latest() -> None:
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(1.0, 1.0, pose_at(1.0))
    feed(ticks, 1.0, (0, 1))
    tick = ticks.on_pose(1.05, 1.05, pose_at(1.05))
    assert due(tick) == (1.0, False)
    assert tick is not None
    assert [r.sensor for r in tick.readings] == [0, 1]


def test_each_reading_is_placed_where_the_robot_was_when_it_was_taken() -> None:
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(1.0, 1.0, pose_at(1.0))
    ticks.on_range(1.0, 0, 0.9, 0.1)  # before every pose: nobody knows where
    ticks.on_range(1.1, 1, 1.04, 0.2)
    ticks.on_range(1.1, 2, 1.08, 0.3)
    late = ticks.on_pose(1.1, 1.1, pose_at(1.1))
    assert late is not None
    assert {r.sensor: r.pose.x for r in late.readings} == {
        1: pytest.approx(1.04),
        2: pytest.approx(1.08),
    }
    # A reading newer than the newest pose is placed there.
    ticks.on_range(1.12, 0, 1.12, 0.1)
    ticks.on_range(1.12, 1, 1.1, 0.1)
    tick = ticks.on_range(1.12, 2, 1.11, 0.1)
    assert tick is not None
    assert {r.sensor: r.pose.x for r in tick.readings} == dict.fromkeys(range(3), 1.1)


def test_a_reading_is_brought_once() -> None:
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(1.0, 1.0, pose_at(1.0))
    first = feed(ticks, 1.04, range(3))[-1]
    assert first is not None
    assert len(first.readings) == 3
    second = ticks.on_pose(1.02, 1.02, pose_at(1.02))
    assert second is not None
    assert (second.complete, second.readings) == (True, ())


@pytest.mark.parametrize(
    ("stamp", "reason"), [(1.6, "future"), (1.0, "duplicate"), (0.9, "out_of_order")]
)
def test_untimely_poses_and_ranges_are_refused(stamp: float, reason: str) -> None:
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(1.0, 1.0, pose_at(1.0))
    feed(ticks, 1.0, (0,))
    with pytest.raises(Untimely) as refusal:
        ticks.on_pose(1.0, stamp, pose_at(stamp))
    assert refusal.value.reason == reason
    with pytest.raises(Untimely) as refusal:
        ticks.on_range(1.0, 0, stamp, 0.1)
    assert refusal.value.reason == reason
    # Nothing was changed by it.
    assert due(feed(ticks, 1.0, (1, 2))[-1]) == (1.0, True)


def test_a_pose_that_is_too_old_is_refused_with_its_likely_cause() -> None:
    ticks = ControlTicks(BEARINGS, max_age=0.5)
    with pytest.raises(Untimely, match=r"0\.600 s behind the clock.*use_sim_time") as refusal:
        ticks.on_pose(1.6, 1.0, pose_at(1.0))
    assert refusal.value.reason == "late"
    ticks.on_pose(1.5, 1.0, pose_at(1.0))  # not older than that


def test_an_unknown_clock_refuses_no_stamp() -> None:
    ticks = ControlTicks(())
    assert due(ticks.on_pose(math.inf, 9e8, pose_at(0.0))) == (9e8, True)


@pytest.mark.parametrize("sensor", [-1, 3])
def test_an_unknown_sensor_is_refused(sensor: int) -> None:
    with pytest.raises(ValueError, match=f"sensors 0 to 2, got {sensor}"):
        ControlTicks(BEARINGS).on_range(1.0, sensor, 1.0, 0.1)


def test_a_clock_set_back_starts_afresh() -> None:
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(100.0, 100.0, pose_at(100.0))
    feed(ticks, 100.0, range(3))
    ticks.on_pose(100.05, 100.05, pose_at(100.05))
    # The first range of the new time must not pass for out of order ...
    ticks.on_range(0.05, 0, 0.05, 0.1)
    # ... and ranges of the old time must not pass for newer ones.
    assert ticks.on_pose(0.05, 0.05, pose_at(0.05)) is None
    assert due(feed(ticks, 0.06, range(3))[-1]) == (0.05, True)


def test_a_stamp_far_behind_is_refused_too_while_newer_ones_come() -> None:
    """One stray message must not pass for a clock that was set back."""
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(100.0, 100.0, pose_at(100.0))
    feed(ticks, 100.0, (0,))
    with pytest.raises(Untimely, match="came after"):
        ticks.on_pose(100.05, 90.0, pose_at(90.0))
    with pytest.raises(Untimely, match="came after"):
        ticks.on_range(100.05, 0, 90.0, 0.1)
    assert due(feed(ticks, 100.0, (1, 2))[-1]) == (100.0, True)


def test_after_a_silence_a_source_may_begin_anew() -> None:
    """A robot that was started again, its clock not being the node's."""
    ticks = ControlTicks(BEARINGS)
    ticks.on_pose(1000.0, 100.0, pose_at(100.0))
    for sensor in range(3):
        ticks.on_range(1000.0, sensor, 100.0, 0.1)
    assert ticks.on_pose(1005.0, 1.0, pose_at(1.0)) is None
    last = [ticks.on_range(1005.0, sensor, 1.0, 0.1) for sensor in range(3)][-1]
    assert due(last) == (1.0, True)
