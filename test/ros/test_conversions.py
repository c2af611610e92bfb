# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages are checked at the rim: what is refused, under which word, and what comes through."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from fuzzy_msgs.msg import OccupancyGridUpdate
from fuzzy_msgs.srv import MapFile
from geometry_msgs.msg import PoseStamped, Quaternion, Twist
from nav_msgs.msg import OccupancyGrid
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState, Range

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_follower import MapWindow
from fuzzy_map_building.ros import conversions, map_conversions, names
from fuzzy_map_building.ros.clock import seconds_from_stamp, stamp_from_seconds
from fuzzy_map_building.ros.conversions import RangeSample, Refused
from fuzzy_map_building.types import Pose2

FRAMES = tuple(f"sonar_{i}" for i in range(16))
NAN, INF = math.nan, math.inf
SOMEWHERE = Window(4, 6, 7, 10)


def pose_message(x: float = 1.0, y: float = 2.0, theta: float = 0.5) -> PoseStamped:
    return conversions.pose_to_msg(Pose2(x, y, theta), Time(sec=12, nanosec=500_000_000))


def range_message(value: float = 1.0, frame: str = "sonar_3") -> Range:
    message = Range(range=value, field_of_view=math.radians(25.0))
    message.header.frame_id = frame
    message.header.stamp = Time(sec=3, nanosec=250_000_000)
    return message


def refusal(call: Callable[[], object]) -> Refused:
    with pytest.raises(Refused) as caught:
        call()
    return caught.value


@pytest.mark.parametrize("theta", [-3.1, -math.pi / 2, 0.0, 1.0, 3.0])
def test_pose_there_and_back(theta: float) -> None:
    stamp, pose = conversions.stamped_pose_from_msg(pose_message(-4.0, 2.5, theta))
    assert stamp == 12.5
    assert (pose.x, pose.y) == (-4.0, 2.5)
    assert pose.theta == pytest.approx(theta, abs=1e-12)


def test_heading_of_a_tilted_quaternion_is_that_of_its_rotation_matrix() -> None:
    # Rz(0.7) Ry(0.1) Rx(-0.05): yaw is 0.7 by construction, whatever the tilt.
    def product(a: Quaternion, b: Quaternion) -> Quaternion:
        return Quaternion(
            w=a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            x=a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            y=a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            z=a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        )

    def about(axis: str, angle: float) -> Quaternion:
        return Quaternion(w=math.cos(angle / 2), **{axis: math.sin(angle / 2)})

    message = pose_message()
    message.pose.orientation = product(
        about("z", 0.7), product(about("y", 0.1), about("x", -0.05))
    )
    assert conversions.pose_from_msg(message.pose).theta == pytest.approx(0.7, abs=1e-12)


@pytest.mark.parametrize(
    ("reason", "spoil"),
    [
        ("not_finite", lambda m: setattr(m.pose.position, "x", NAN)),
        ("not_finite", lambda m: setattr(m.pose.position, "y", INF)),
        ("not_finite", lambda m: setattr(m.pose.position, "z", -INF)),
        ("not_finite", lambda m: setattr(m.pose.orientation, "w", NAN)),
        ("too_far", lambda m: setattr(m.pose.position, "x", 1e300)),
        ("quaternion_norm", lambda m: setattr(m.pose.orientation, "w", 2.0)),
        ("quaternion_norm", lambda m: setattr(m.pose, "orientation", Quaternion(w=0.0))),
        ("tilted", lambda m: setattr(m.pose, "orientation", Quaternion(x=1.0, w=0.0))),
        ("wrong_frame", lambda m: setattr(m.header, "frame_id", "odom")),
        ("wrong_frame", lambda m: setattr(m.header, "frame_id", "")),
        ("wrong_frame", lambda m: setattr(m.header, "frame_id", "x" * 9999)),
        ("no_stamp", lambda m: setattr(m.header, "stamp", Time())),
        ("negative_stamp", lambda m: setattr(m.header, "stamp", Time(sec=-1))),
        ("malformed_stamp", lambda m: setattr(m.header, "stamp", Time(sec=1, nanosec=10**9))),
    ],
)
def test_poses_that_are_refused(reason: str, spoil: Callable[[PoseStamped], None]) -> None:
    message = pose_message()
    spoil(message)
    refused = refusal(lambda: conversions.stamped_pose_from_msg(message))
    assert refused.reason == reason
    assert str(refused).startswith("pose ")
    assert len(str(refused)) < 300


def test_a_goal_needs_neither_stamp_nor_orientation() -> None:
    message = pose_message()
    message.header.stamp = Time()
    message.pose.orientation = Quaternion(w=0.0)
    assert conversions.goal_from_msg(message) == Pose2(1.0, 2.0, 0.0)
    message.header.frame_id = "odom"
    assert refusal(lambda: conversions.goal_from_msg(message)).reason == "wrong_frame"
    message.header.frame_id = "map"
    message.pose.position.y = NAN
    assert refusal(lambda: conversions.goal_from_msg(message)).reason == "not_finite"


@pytest.mark.parametrize("value", [0.12, 0.1, 1.0, 6.5, 3.3333333, INF, -INF, -2.0, 0.0])
def test_range_means_the_decimal_that_was_sent(value: float) -> None:
    # The field is a float32: 0.12 arrives as 0.11999999731779099, below a limit of 0.12.
    message = range_message(struct.unpack("f", struct.pack("f", value))[0])
    sample = conversions.range_from_msg(message, FRAMES, math.radians(25.0))
    assert sample == RangeSample(3, 3.25, value)


def test_a_range_that_is_not_a_number_comes_through_for_the_sensor_model_to_count() -> None:
    sample = conversions.range_from_msg(range_message(NAN), FRAMES, math.radians(25.0))
    assert math.isnan(sample.range)


@pytest.mark.parametrize(
    ("reason", "spoil"),
    [
        ("unknown_frame", lambda m: setattr(m.header, "frame_id", "sonar_16")),
        ("unknown_frame", lambda m: setattr(m.header, "frame_id", "infrared_3")),
        ("unknown_frame", lambda m: setattr(m.header, "frame_id", "")),
        ("no_stamp", lambda m: setattr(m.header, "stamp", Time())),
        ("negative_stamp", lambda m: setattr(m.header, "stamp", Time(sec=-5))),
        ("malformed_stamp", lambda m: setattr(m.header, "stamp", Time(sec=1, nanosec=10**9))),
        ("field_of_view", lambda m: setattr(m, "field_of_view", math.radians(12.5))),
        ("field_of_view", lambda m: setattr(m, "field_of_view", NAN)),
        ("field_of_view", lambda m: setattr(m, "field_of_view", 0.0)),
    ],
)
def test_ranges_that_are_refused(reason: str, spoil: Callable[[Range], None]) -> None:
    message = range_message()
    spoil(message)
    refused = refusal(
        lambda: conversions.range_from_msg(message, FRAMES, math.radians(25.0), "sonar")
    )
    assert refused.reason == reason
    assert str(refused).startswith("sonar")


@pytest.mark.parametrize("topic", [names.SONAR, names.INFRARED])
def test_a_refused_range_names_the_parameter_in_full(topic: str) -> None:
    message = range_message()
    wide = math.radians(12.5)
    seen = refusal(lambda: conversions.range_from_msg(message, FRAMES, wide, topic))
    assert f"'{topic}.field_of_view'" in str(seen)
    message.header.frame_id = "front"
    refused = refusal(lambda: conversions.range_from_msg(message, FRAMES, None, topic))
    assert str(refused).startswith(f"{topic} range from frame 'front', which is none of")
    assert f"name it in the parameter '{topic}.frame_ids'" in str(refused)


def test_joint_position() -> None:
    message = JointState(name=["wheel", "turret_joint"], position=[9.0, 0.25])
    message.header.stamp = Time(sec=2)
    assert conversions.joint_position(message, "turret_joint") == (2.0, 0.25)
    assert conversions.joint_position(message, "arm") is None
    message.position = [9.0]
    refused = refusal(lambda: conversions.joint_position(message, "turret_joint"))
    assert refused.reason == "no_position"
    message.position = [9.0, NAN]
    refused = refusal(lambda: conversions.joint_position(message, "turret_joint"))
    assert refused.reason == "not_finite"
    for angle in (1.1e9, -1.7e308):
        message.position = [9.0, angle]
        refused = refusal(lambda: conversions.joint_position(message, "turret_joint"))
        assert refused.reason == "too_large"
    message.position = [9.0, 0.0]
    message.header.stamp = Time()
    refused = refusal(lambda: conversions.joint_position(message, "turret_joint"))
    assert refused.reason == "no_stamp"


def grid_message() -> tuple[GridGeometry, np.ndarray, OccupancyGrid]:
    geometry = GridGeometry(4, 3, 0.1, (-1.0, 2.0))
    values = np.array([[0, 1, 2, 3], [50, 51, 52, 53], [97, 98, 99, 100]], dtype=np.int8)
    return geometry, values, map_conversions.grid_to_msg(values, geometry, Time(sec=1))


def test_a_map_is_row_major_with_x_fastest_from_its_lower_left_corner() -> None:
    geometry, values, message = grid_message()
    assert (message.info.width, message.info.height) == (4, 3)
    assert (message.info.origin.position.x, message.info.origin.position.y) == (-1.0, 2.0)
    # Cell (row 1, column 2) is the seventh value.
    assert message.data[1 * 4 + 2] == 52
    back, read = map_conversions.grid_from_msg(message)
    assert back == geometry  # the resolution, too: 0.1 and not the nearest float32
    np.testing.assert_array_equal(read, values)


def test_a_map_in_columns_is_sent_row_by_row() -> None:
    geometry, values, message = grid_message()
    fortran = np.asfortranarray(values)
    assert map_conversions.grid_to_msg(fortran, geometry, Time(sec=1)).data == message.data


def test_risk_is_a_hundredth_of_the_value() -> None:
    _, values, message = grid_message()
    _, risk = map_conversions.risk_from_msg(message)
    assert risk.risks[1, 2] == 0.52
    np.testing.assert_array_equal(np.round(100 * risk.risks), values)


@pytest.mark.parametrize(
    ("reason", "spoil"),
    [
        ("wrong_frame", lambda m: setattr(m.header, "frame_id", "odom")),
        ("rotated", lambda m: setattr(m.info.origin, "orientation", Quaternion(z=0.6, w=0.8))),
        ("quaternion_norm", lambda m: setattr(m.info.origin, "orientation", Quaternion(w=0.0))),
        ("not_finite", lambda m: setattr(m.info.origin.position, "x", NAN)),
        ("geometry", lambda m: setattr(m.info, "resolution", 0.0)),
        ("geometry", lambda m: setattr(m.info, "resolution", NAN)),
        ("geometry", lambda m: setattr(m.info, "width", 0)),
        ("geometry", lambda m: setattr(m.info, "width", 2**32 - 1)),
        ("size", lambda m: setattr(m.info, "height", 4)),
        ("size", lambda m: m.data.pop()),
        ("value", lambda m: m.data.__setitem__(3, 101)),
        ("value", lambda m: m.data.__setitem__(3, -2)),
        ("unknown", lambda m: m.data.__setitem__(3, -1)),
    ],
)
def test_risk_maps_that_are_refused(reason: str, spoil: Callable[[OccupancyGrid], None]) -> None:
    *_, message = grid_message()
    spoil(message)
    assert refusal(lambda: map_conversions.risk_from_msg(message)).reason == reason


def test_a_map_of_another_shape_is_a_fault_of_the_program() -> None:
    geometry, values, _ = grid_message()
    with pytest.raises(ValueError, match=r"shape \(3, 4\) takes int8"):
        map_conversions.grid_to_msg(values[:2], geometry, Time(sec=1))
    with pytest.raises(ValueError, match="float64"):
        map_conversions.grid_to_msg(values.astype(float), geometry, Time(sec=1))


def window_message(where: Window = SOMEWHERE) -> OccupancyGridUpdate:
    cells = np.arange(where.shape[0] * where.shape[1], dtype=np.int8).reshape(where.shape)
    return map_conversions.window_to_msg(MapWindow(None, 3_000_000_005, where, cells))


def test_a_window_there_and_back() -> None:
    message = window_message()
    assert message.header.stamp == Time(sec=3, nanosec=5)
    assert (message.x, message.y, message.width, message.height) == (7, 4, 3, 2)
    assert list(message.data) == [0, 1, 2, 3, 4, 5]
    back = map_conversions.window_from_msg(message, 12)
    assert (back.number, back.stamp, back.window) == (12, 3_000_000_005, SOMEWHERE)
    np.testing.assert_array_equal(back.cells, [[0, 1, 2], [3, 4, 5]])
    nothing = map_conversions.window_from_msg(window_message(Window(0, 0, 0, 0)))
    assert (nothing.number, nothing.window.empty, nothing.cells.size) == (None, True, 0)


@pytest.mark.parametrize(
    ("reason", "spoil"),
    [
        ("wrong_frame", lambda m: setattr(m.header, "frame_id", "odom")),
        ("window", lambda m: setattr(m, "x", -1)),
        ("window", lambda m: setattr(m, "width", 0)),
        ("window", lambda m: setattr(m, "height", 0)),
        ("window", lambda m: setattr(m, "width", 2**32 - 1)),
        ("window", lambda m: setattr(m, "y", 2**31 - 2)),
        ("size", lambda m: setattr(m, "width", 2)),
        ("size", lambda m: (setattr(m, "width", 0), setattr(m, "height", 0))),
        ("value", lambda m: setattr(m, "data", [0, 0, 0, 0, 0, -1])),
        ("value", lambda m: setattr(m, "data", [0, 0, 0, 0, 0, 101])),
        ("stamps", lambda m: setattr(m.header.stamp, "sec", -1)),
    ],
)
def test_windows_that_are_refused(
    reason: str, spoil: Callable[[OccupancyGridUpdate], None]
) -> None:
    message = window_message()
    spoil(message)
    assert refusal(lambda: map_conversions.window_from_msg(message)).reason == reason


def test_path_there_and_back() -> None:
    poses = [Pose2(0.05, 0.05, 0.0), Pose2(0.15, 0.05, math.pi / 4), Pose2(0.25, 0.15, 0.0)]
    message = conversions.path_to_msg(poses, Time(sec=7))
    back = conversions.path_from_msg(message)
    assert [(p.x, p.y) for p in back] == [(p.x, p.y) for p in poses]
    assert [p.theta for p in back] == pytest.approx([p.theta for p in poses])
    message.poses[1].pose.position.x = NAN
    refused = refusal(lambda: conversions.path_from_msg(message))
    assert refused.reason == "not_finite"
    assert "pose 1" in str(refused)


def test_twist_there_and_back() -> None:
    message = conversions.twist_to_msg(0.3, -1.0)
    assert conversions.twist_from_msg(message) == (0.3, -1.0)
    message.linear.x = NAN
    assert refusal(lambda: conversions.twist_from_msg(message)).reason == "not_finite"
    sideways = Twist()
    sideways.linear.y = 0.1
    assert refusal(lambda: conversions.twist_from_msg(sideways)).reason == "not_planar"


@pytest.mark.parametrize("seconds", [0.0, 0.05, 1.999999999, 1_700_000_000.25])
def test_stamp_there_and_back(seconds: float) -> None:
    assert seconds_from_stamp(stamp_from_seconds(seconds)) == pytest.approx(seconds, abs=1e-9)


def test_stamp_carries_into_the_seconds() -> None:
    assert stamp_from_seconds(0.9999999999) == Time(sec=1, nanosec=0)


@pytest.mark.parametrize("seconds", [-1.0, NAN, INF, 2.0**31])
def test_times_that_no_stamp_can_hold(seconds: float) -> None:
    with pytest.raises(ValueError, match="a stamp lies in"):
        stamp_from_seconds(seconds)


def test_the_middleware_cuts_a_name_at_a_nul() -> None:
    # What the README says of names of map files: no node can see what stood behind.
    assert b"b" not in serialize_message(MapFile.Request(path="a\0b"))
    sent = bytes([0, 1, 0, 0, 4, 0, 0, 0]) + b"a\0b\0"  # as others may send it
    assert deserialize_message(sent, MapFile.Request).path == "a"
