# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages to values and back. Everything that comes in is checked here, once.

A message that cannot be used raises `Refused`, a ValueError that says what was wrong,
where, and what to do, and whose ``reason`` is the word it is counted under.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Pose, PoseStamped, Quaternion, Twist, TwistStamped
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import Header

from fuzzy_map_building.plain_yaml import shown
from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.clock import seconds_from_stamp, stamp_from_seconds
from fuzzy_map_building.types import Pose2

__all__ = [
    "RangeSample",
    "Refused",
    "check_frame",
    "float32",
    "goal_from_msg",
    "joint_position",
    "path_from_msg",
    "path_to_msg",
    "pose_from_msg",
    "pose_to_msg",
    "range_from_msg",
    "stamped_pose_from_msg",
    "stamped_twist_from_msg",
    "stamped_twist_to_msg",
    "twist_from_msg",
    "twist_to_msg",
]

#: Deviation of a quaternion's norm from 1 that still passes for rounding.
NORM_TOLERANCE: Final = 1e-3
#: Largest tilt of a pose against the plane that is taken for planar [rad].
MAX_TILT: Final = math.radians(15.0)
#: Deviation of a field of view from the parameter that still passes for rounding [rad].
FIELD_OF_VIEW_TOLERANCE: Final = 1e-3
#: Largest coordinate that a position may have [m], that of a UTM grid: farther positions are
#: taken for faults. A map may have its origin as far away; whether it holds robot and goal is
#: for who uses it to say.
MAX_COORDINATE: Final = 1e7
#: Largest angle that a joint may have [rad], which one that turns without end has after years:
#: beyond it is a fault, and between two of the largest numbers lies none.
MAX_ANGLE: Final = 1e9


class Refused(ValueError):
    """A message that cannot be used.

    Attributes
    ----------
    reason : str
        The word it is counted under in the diagnostics.
    """

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(message)
        self.reason = reason


@dataclass(frozen=True)
class RangeSample:
    """A range as it came: which sensor, when [s], how far [m] (REP 117)."""

    sensor: int
    stamp: float
    range: float


def float32(value: float) -> float:
    """Return the shortest decimal that a float32 field can have meant: 0.1, not 0.10000000149."""
    return float(str(np.float32(value)))


def _stamp(header: Header, what: str) -> float:
    stamp = header.stamp
    if stamp.sec == 0 and stamp.nanosec == 0:
        raise Refused("no_stamp", f"{what} has no stamp; set header.stamp to when it was measured")
    if stamp.sec < 0:
        raise Refused("negative_stamp", f"{what} has a negative stamp ({stamp.sec} s)")
    if stamp.nanosec >= 1_000_000_000:
        raise Refused("malformed_stamp", f"{what} has a stamp of {stamp.nanosec} ns and seconds")
    return seconds_from_stamp(stamp)


def check_frame(header: Header, frame: str, what: str) -> None:
    """Refuse what is in another frame, as ``wrong_frame``."""
    if header.frame_id != frame:
        raise Refused(
            "wrong_frame",
            f"{what} is in frame {shown(header.frame_id)}, expected '{frame}': transform it first",
        )


def _yaw(q: Quaternion, what: str) -> float:
    norm = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
    if not math.isfinite(norm):
        raise Refused("not_finite", f"{what} has an orientation that is not finite")
    if abs(norm - 1.0) > NORM_TOLERANCE:
        raise Refused(
            "quaternion_norm",
            f"{what} has an orientation of norm {norm:.6g}, expected 1: normalise the quaternion",
        )
    # Cosine of the angle between the body's z axis and the world's.
    upright = 1.0 - 2.0 * (q.x * q.x + q.y * q.y) / (norm * norm)
    if upright < math.cos(MAX_TILT):
        raise Refused(
            "tilted",
            f"{what} is tilted by {math.degrees(math.acos(max(-1.0, upright))):.0f} deg; "
            "the method works in the plane: is it the pose of base_link?",
        )
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def pose_from_msg(pose: Pose, what: str = "pose") -> Pose2:
    """Return a pose in the plane.

    Raises
    ------
    Refused
        ``not_finite``, ``too_far``, ``quaternion_norm`` or ``tilted``.
    """
    position = (pose.position.x, pose.position.y, pose.position.z)
    if not all(math.isfinite(v) for v in position):
        raise Refused("not_finite", f"{what} has a position that is not finite: {position}")
    if max(abs(v) for v in position) > MAX_COORDINATE:
        raise Refused("too_far", f"{what} lies beyond {MAX_COORDINATE:g} m: {position}")
    return Pose2(pose.position.x, pose.position.y, _yaw(pose.orientation, what))


def stamped_pose_from_msg(
    message: PoseStamped, frame: str = names.MAP_FRAME, what: str = "pose"
) -> tuple[float, Pose2]:
    """Return (stamp [s], pose) of a message that must be in `frame` and stamped.

    Raises
    ------
    Refused
        ``wrong_frame``, ``no_stamp``, ``negative_stamp`` or as `pose_from_msg`.
    """
    check_frame(message.header, frame, what)
    return _stamp(message.header, what), pose_from_msg(message.pose, what)


def goal_from_msg(message: PoseStamped, frame: str = names.MAP_FRAME, what: str = "goal") -> Pose2:
    """Return a position asked for: the stamp and the orientation are not looked at.

    The heading of the result is 0.

    Raises
    ------
    Refused
        ``wrong_frame``, ``not_finite`` or ``too_far``.
    """
    check_frame(message.header, frame, what)
    upright = Pose(position=message.pose.position)
    upright.orientation.w = 1.0
    return pose_from_msg(upright, what)


def pose_to_msg(pose: Pose2, stamp: Time, frame: str = names.MAP_FRAME) -> PoseStamped:
    """Return the message of a pose in the plane."""
    message = PoseStamped(header=Header(stamp=stamp, frame_id=frame))
    message.pose.position.x = pose.x
    message.pose.position.y = pose.y
    message.pose.orientation.z = math.sin(0.5 * pose.theta)
    message.pose.orientation.w = math.cos(0.5 * pose.theta)
    return message


def range_from_msg(
    message: Range,
    frame_ids: Sequence[str],
    field_of_view: float | None = None,
    topic: str = names.SONAR,
) -> RangeSample:
    """Return a sensor's range.

    The range itself may be anything REP 117 allows, NaN included: whether it lies within
    the sensor's limits is for the sensor model to say.

    Parameters
    ----------
    message : Range
    frame_ids : sequence of str
        Frames of the sensors; the position in it is the sensor's number.
    field_of_view : float, optional
        Full angle that the message must have [rad]; not checked when None.
    topic : str
        Where it came by, ``sonar`` or ``infrared``; the ring's parameters are named alike.

    Raises
    ------
    Refused
        ``unknown_frame``, ``no_stamp``, ``negative_stamp`` or ``field_of_view``.
    """
    frame = message.header.frame_id
    try:
        sensor = frame_ids.index(frame)
    except ValueError:
        first = f" {', '.join(frame_ids[:3])}..." if frame_ids else ""
        raise Refused(
            "unknown_frame",
            f"{topic} range from frame {shown(frame)}, which is none of the {len(frame_ids)} "
            f"sensors{first}; name it in the parameter '{topic}.frame_ids', or let the driver say "
            "what stands there",
        ) from None
    stamp = _stamp(message.header, f"{topic} range")
    if field_of_view is not None and not (
        abs(message.field_of_view - field_of_view) <= FIELD_OF_VIEW_TOLERANCE
    ):
        raise Refused(
            "field_of_view",
            f"{topic} range of '{frame}' has a field of view of {message.field_of_view:.4g} rad, "
            f"expected {field_of_view:.4g} rad (the full angle): mend the driver or the parameter "
            f"'{topic}.field_of_view'",
        )
    return RangeSample(sensor, stamp, float32(message.range))


def joint_position(
    message: JointState, joint: str, what: str = "joint state"
) -> tuple[float, float] | None:
    """Return (stamp [s], position [rad]) of a joint, or None when the message has no such joint.

    Raises
    ------
    Refused
        ``no_position``, ``not_finite``, ``too_large``, ``no_stamp`` or ``negative_stamp``.
    """
    if joint not in message.name:
        return None
    index = list(message.name).index(joint)
    if index >= len(message.position):
        raise Refused("no_position", f"{what} names '{joint}' but has no position for it")
    position = float(message.position[index])
    if not math.isfinite(position):
        raise Refused("not_finite", f"{what} has a position of '{joint}' of {position}")
    if abs(position) > MAX_ANGLE:
        raise Refused(
            "too_large",
            f"{what} has a position of '{joint}' of {position:g} rad, beyond {MAX_ANGLE:g} rad: "
            "where in a turn that is is not known; does the driver tell radians?",
        )
    return _stamp(message.header, what), position


def path_to_msg(poses: Iterable[Pose2], stamp: Time, frame: str = names.MAP_FRAME) -> Path:
    """Return the message of a path."""
    return Path(
        header=Header(stamp=stamp, frame_id=frame),
        poses=[pose_to_msg(pose, stamp, frame) for pose in poses],
    )


def path_from_msg(message: Path, frame: str = names.MAP_FRAME, what: str = "path") -> list[Pose2]:
    """Return the poses of a path; none is a path of no pose.

    Raises
    ------
    Refused
        ``wrong_frame`` or as `pose_from_msg`.
    """
    if not message.poses:
        return []
    check_frame(message.header, frame, what)
    return [pose_from_msg(p.pose, f"{what}, pose {i}") for i, p in enumerate(message.poses)]


def twist_to_msg(linear: float, angular: float) -> Twist:
    """Return the message of a forward speed [m/s] and a turning rate [rad/s]."""
    message = Twist()
    message.linear.x = float(linear)
    message.angular.z = float(angular)
    return message


def twist_from_msg(message: Twist, what: str = "velocity command") -> tuple[float, float]:
    """Return (forward speed [m/s], turning rate [rad/s]).

    Raises
    ------
    Refused
        ``not_finite``, or ``not_planar`` for a motion that a unicycle cannot make.
    """
    used = (message.linear.x, message.angular.z)
    other = (message.linear.y, message.linear.z, message.angular.x, message.angular.y)
    if not all(math.isfinite(v) for v in used + other):
        raise Refused("not_finite", f"{what} is not finite: {used + other}")
    if any(other):
        raise Refused(
            "not_planar", f"{what} moves along or about other axes than x and z: {other}"
        )
    return used


def stamped_twist_to_msg(stamp: float, linear: float, angular: float) -> TwistStamped:
    """Return the message of a velocity of the base that answers the pose of a stamp [s]."""
    message = TwistStamped(twist=twist_to_msg(linear, angular))
    message.header.frame_id = names.BASE_FRAME
    message.header.stamp = stamp_from_seconds(stamp)
    return message


def stamped_twist_from_msg(
    message: TwistStamped, what: str = "velocity command"
) -> tuple[float, tuple[float, float]]:
    """Return (stamp [s], (forward speed [m/s], turning rate [rad/s])).

    Raises
    ------
    Refused
        ``wrong_frame``, ``no_stamp``, ``negative_stamp`` or as `twist_from_msg`.
    """
    check_frame(message.header, names.BASE_FRAME, what)
    return _stamp(message.header, what), twist_from_msg(message.twist, what)
