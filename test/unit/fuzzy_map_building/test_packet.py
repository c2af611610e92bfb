# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Ranges wait for the pose and the turret angle of their own stamp."""

import math

import pytest

from fuzzy_map_building import packet
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.types import InfraredReading, Pose2

PARAMETERS = mapper_parameters()
ON_BASE = mapper_parameters(overrides={"turret.joint": ""})


def test_a_range_is_placed_at_its_own_stamp() -> None:
    assembler = ReadingAssembler(PARAMETERS)
    assembler.add_pose(1.0, Pose2(0.0, 0.0, 0.0), 1.0)
    assembler.add_turret(1.0, 0.0, 1.0)
    assert assembler.add_range(2, 1.05, 2.5, 1.05)
    assert assembler.release(1.05) == []
    assembler.add_pose(1.1, Pose2(0.2, 0.4, 0.6), 1.1)
    assert assembler.release(1.1) == []  # the turret is still missing
    assert assembler.waiting == 1
    assembler.add_turret(1.2, 0.8, 1.2)
    (reading,) = assembler.release(1.2)
    assert (reading.pose.x, reading.pose.y) == pytest.approx((0.1, 0.2))
    assert reading.pose.theta == pytest.approx(0.3)
    assert reading.bearing == pytest.approx(math.radians(45.0) + 0.2)
    assert (reading.range, reading.stamp, reading.sensor) == (2.5, 1.05, 2)
    assert assembler.waiting == 0
    assert assembler.rejected == {}


def test_without_a_turret_the_pose_is_enough() -> None:
    assembler = ReadingAssembler(ON_BASE)
    assembler.add_range(1, 1.0, math.inf, 1.0)
    assembler.add_pose(1.0, Pose2(1.0, 2.0, 3.0), 1.0)
    (reading,) = assembler.release(1.0)
    assert reading.bearing == pytest.approx(math.radians(22.5))


def test_readings_come_in_the_order_of_their_stamps() -> None:
    assembler = ReadingAssembler(ON_BASE)
    for sensor, stamp in ((3, 1.3), (0, 1.1), (5, 1.2), (6, 1.6)):
        assembler.add_range(sensor, stamp, 1.0, 1.6)
    assembler.add_pose(1.0, Pose2(0, 0), 1.6)
    assembler.add_pose(1.4, Pose2(0, 0), 1.6)
    assert [r.sensor for r in assembler.release(1.6)] == [0, 5, 3]
    assert assembler.waiting == 1


def test_what_cannot_be_placed_is_given_up_after_the_limit() -> None:
    assembler = ReadingAssembler(PARAMETERS)
    assembler.add_range(0, 10.0, 1.0, 10.0)
    assert assembler.release(10.5) == []
    assert (assembler.waiting, assembler.rejected) == (1, {})
    assembler.release(10.51)
    assert (assembler.waiting, assembler.rejected) == (0, {"no_pose": 1})
    # With poses but no turret the other reason is named.
    assembler.add_range(0, 11.0, 1.0, 11.0)
    assembler.add_pose(11.0, Pose2(0, 0), 11.0)
    assembler.release(12.0)
    assert assembler.rejected == {"no_pose": 1, "no_turret": 1}


def test_what_no_later_pose_can_place_is_given_up_at_once() -> None:
    assembler = ReadingAssembler(ON_BASE)
    assembler.add_pose(10.0, Pose2(0, 0), 10.0)
    assembler.add_range(0, 7.0, 1.0, 10.0)  # long before the first pose
    assembler.add_range(1, 10.3, 1.0, 10.3)  # in a gap of poses
    assembler.add_pose(10.9, Pose2(0, 0), 10.9)
    assembler.add_range(2, 10.9, 1.0, 10.9)
    assert [r.sensor for r in assembler.release(10.75)] == [2]
    assert assembler.rejected == {"no_pose": 2}


def test_what_is_from_right_before_the_first_pose_or_angle_is_no_fault() -> None:
    assembler = ReadingAssembler(PARAMETERS)
    assembler.add_range(0, 9.9, 1.0, 10.0)
    assembler.add_range(1, 10.02, 1.0, 10.02)
    assembler.add_range(2, 10.06, 1.0, 10.06)
    assembler.add_pose(10.0, Pose2(0, 0), 10.0)
    assembler.add_pose(10.1, Pose2(0, 0), 10.1)
    assembler.add_turret(10.05, 0.0, 10.1)
    assembler.add_turret(10.1, 0.0, 10.1)
    assert [r.sensor for r in assembler.release(10.1)] == [2]
    assert assembler.rejected == {"before_pose": 1, "before_turret": 1}
    # Where samples have come for long, the same is told.
    for k in range(100):
        assembler.add_pose(11.0 + 0.1 * k, Pose2(0, 0), 11.0 + 0.1 * k)
    assembler.add_range(3, 9.95, 1.0, 21.0)
    assembler.add_range(4, 5.0, 1.0, 21.0)
    assembler.release(21.0)
    assert assembler.rejected["no_pose"] == 1


def test_a_late_pose_stream_still_places_what_waited() -> None:
    assembler = ReadingAssembler(ON_BASE)
    assembler.add_range(0, 1.02, 1.0, 1.02)
    for k in range(5):
        assembler.add_pose(1.0 + 0.05 * k, Pose2(0.05 * k, 0), 1.4)
    (reading,) = assembler.release(1.4)
    assert reading.pose.x == pytest.approx(0.02)


def test_duplicates_old_and_future_stamps_are_counted() -> None:
    assembler = ReadingAssembler(PARAMETERS)
    assert assembler.add_range(0, 5.0, 1.0, 5.0)
    assert not assembler.add_range(0, 5.0, 1.0, 5.0)
    assert not assembler.add_range(0, 4.9, 1.0, 5.0)
    assert assembler.add_range(1, 4.9, 1.0, 5.0)  # another sonar's stamps are its own
    assert not assembler.add_range(2, 5.6, 1.0, 5.0)
    assert assembler.rejected == {"duplicate": 1, "out_of_order": 1, "future": 1}
    assert assembler.waiting == 2
    # A refused stamp from the future must not make all later ones out of order.
    assert assembler.add_range(2, 5.1, 1.0, 5.1)


def test_poses_and_angles_from_the_future_do_not_poison_the_buffers() -> None:
    assembler = ReadingAssembler(PARAMETERS)
    assert not assembler.add_pose(1e9, Pose2(0, 0), 5.0)
    assert not assembler.add_turret(1e9, 0.0, 5.0)
    assert assembler.add_pose(5.0, Pose2(0, 0), 5.0)
    assert assembler.add_turret(5.0, 0.0, 5.0)
    assert assembler.poses.rejected == {"future": 1}
    assert assembler.turret.rejected == {"future": 1}


@pytest.mark.parametrize("sensor", [-1, 16])
def test_an_unknown_sonar_is_an_error(sensor: int) -> None:
    with pytest.raises(ValueError, match=f"no sonar {sensor}: the ring has sonars 0 to 15"):
        ReadingAssembler(PARAMETERS).add_range(sensor, 1.0, 1.0, 1.0)


def test_a_stamp_is_finite() -> None:
    with pytest.raises(ValueError, match="stamp"):
        ReadingAssembler(PARAMETERS).add_range(0, math.nan, 1.0, 1.0)


def test_a_flood_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packet, "_MAX_WAITING", 3)
    assembler = ReadingAssembler(PARAMETERS)
    for k in range(5):
        assembler.add_range(k, 1.0, 1.0, 1.0)
    assert (assembler.waiting, assembler.rejected) == (3, {"overflow": 2})


def test_clear_forgets_a_clock_that_was_set_back() -> None:
    assembler = ReadingAssembler(ON_BASE)
    assembler.add_pose(100.0, Pose2(9, 9), 100.0)
    assembler.add_range(0, 100.0, 1.0, 100.0)
    assembler.clear()
    assert assembler.waiting == 0
    assert assembler.add_pose(1.0, Pose2(1, 0), 1.0)
    assert assembler.add_range(0, 1.0, 2.0, 1.0)
    (reading,) = assembler.release(1.0)
    assert reading.pose == Pose2(1, 0)


def test_faulty_ranges_pass_on_to_the_sensor_model() -> None:
    assembler = ReadingAssembler(ON_BASE)
    assembler.add_pose(1.0, Pose2(0, 0), 1.0)
    for sensor, value in enumerate((math.nan, -math.inf, -3.0)):
        assert assembler.add_range(sensor, 1.0, value, 1.0)
    assert len(assembler.release(1.0)) == 3


def test_infrareds_sit_on_the_base_and_need_no_turret_angle() -> None:
    assembler = ReadingAssembler(PARAMETERS)
    assembler.add_pose(1.0, Pose2(0.0, 0.0, 0.0), 1.0)
    assert assembler.add_infrared(2, 1.05, 0.3, 1.05)
    assert assembler.add_range(2, 1.05, 0.3, 1.05)
    assert assembler.release_infrared(1.05) == []
    assert assembler.waiting == 2
    assembler.add_pose(1.1, Pose2(0.2, 0.0, 0.4), 1.1)
    assembler.add_turret(1.0, 1.0, 1.1)
    (reading,) = assembler.release_infrared(1.1)
    assert type(reading) is InfraredReading
    assert (reading.pose.x, reading.pose.theta) == pytest.approx((0.1, 0.2))
    assert reading.bearing == pytest.approx(math.radians(45.0))
    assert (reading.range, reading.stamp, reading.sensor) == (0.3, 1.05, 2)
    # The sonar goes on waiting for the turret; what is refused is counted apart.
    assert assembler.release(1.1) == []
    assert assembler.waiting == 1
    assert not assembler.add_infrared(2, 1.05, 0.3, 1.1)
    assert not assembler.add_infrared(3, 2.0, 0.3, 1.1)
    assert assembler.add_infrared(4, 1.15, 0.3, 1.2)
    assert assembler.release_infrared(1.7) == []
    assert assembler.infrared_rejected == {"duplicate": 1, "future": 1, "no_pose": 1}
    assert assembler.rejected == {}
    with pytest.raises(ValueError, match="no infrared sensor 16: the ring has infrared sensors 0"):
        assembler.add_infrared(16, 1.0, 1.0, 1.0)
