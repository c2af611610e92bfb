# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages out of bytes: what the types can hold, and so what the network can bring."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from fuzzy_msgs.msg import OccupancyGridUpdate
from geometry_msgs.msg import Point, Pose, PoseStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid
from rcl_interfaces.msg import Parameter, ParameterValue
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import Header

from fuzz.draw import Draw
from fuzzy_map_building.ros.clock import stamp_from_seconds

__all__ = [
    "float32",
    "grid",
    "joint_state",
    "parameter",
    "point",
    "range_of",
    "stamped_pose",
    "stamped_twist",
    "twist",
    "window",
    "window_info",
]

_INT32, _UINT32 = 2**31 - 1, 2**32 - 1


def float32(value: float) -> float:
    """Return a number as a field of 32 bits has it."""
    with np.errstate(all="ignore"):
        return float(np.float32(value))


def _stamp(draw: Draw, now: float) -> Time:
    """Return a time not far from now, or any that a message can hold."""
    if not draw.one_in(8):
        return stamp_from_seconds(max(0.001, now))
    kind = draw.byte() % 4
    if kind == 0:
        return Time()
    if kind == 1:
        return Time(sec=draw.choice((-1, -_INT32 - 1, _INT32, 1)), nanosec=draw.byte())
    if kind == 2:
        return Time(sec=round(now), nanosec=draw.choice((_UINT32, 10**9, 10**9 - 1)))
    return stamp_from_seconds(max(0.0, now + draw.choice((-100.0, -1.0, -0.3, 0.3, 1.0, 59.0))))


def _header(draw: Draw, frame: str, now: float) -> Header:
    return Header(stamp=_stamp(draw, now), frame_id=draw.text() if draw.one_in(12) else frame)


def _pose(draw: Draw, x: float, y: float, theta: float) -> Pose:
    message = Pose()
    message.position.x = draw.number(lambda: x)
    message.position.y = draw.number(lambda: y)
    message.position.z = draw.float64() if draw.one_in(12) else 0.0
    message.orientation.z = math.sin(0.5 * theta)
    message.orientation.w = math.cos(0.5 * theta)
    if draw.one_in(8):
        name = draw.choice(("x", "y", "z", "w"))
        setattr(message.orientation, name, draw.float64())
    return message


def stamped_pose(draw: Draw, now: float, x: float, y: float, theta: float = 0.0) -> PoseStamped:
    """Return a pose, mostly the one given."""
    return PoseStamped(header=_header(draw, "map", now), pose=_pose(draw, x, y, theta))


def range_of(draw: Draw, now: float, frame: str, field_of_view: float) -> Range:
    """Return a range of a sensor, mostly a good one."""
    message = Range(header=_header(draw, frame, now))
    message.field_of_view = float32(draw.float64() if draw.one_in(24) else field_of_view)
    message.range = float32(draw.number(lambda: draw.between(0.1, 3.0)))
    return message


def joint_state(draw: Draw, now: float, joint: str, angle: float) -> JointState:
    """Return the angle of a joint, mostly well."""
    message = JointState(header=_header(draw, "", now))
    message.name = [joint]
    message.position = [draw.number(lambda: angle)]
    if draw.one_in(8):
        message.name = [draw.text() for _ in range(draw.below(4))] + [joint] * draw.below(3)
        message.position = [draw.float64() for _ in range(draw.below(4))]
    return message


def grid(
    draw: Draw, now: float, width: int, height: int, resolution: float, values: Sequence[int]
) -> OccupancyGrid:
    """Return a map, mostly one of the size given."""
    message = OccupancyGrid(header=_header(draw, "map", now))
    info = message.info
    info.width, info.height, info.resolution = width, height, float32(resolution)
    info.origin = _pose(draw, 0.0, 0.0, 0.0)
    if draw.one_in(6):
        info.width = draw.choice((0, 1, 2, width, 8000, 65536, _UINT32))
        info.height = draw.choice((0, 1, 2, height, 8000, 65536, _UINT32))
    if draw.one_in(6):
        info.resolution = float32(draw.float64())
    count = width * height
    if draw.one_in(3):
        count = min(info.width * info.height, 4096)
    seen = [draw.choice(values) for _ in range(min(count, 12))] or [0]
    data = array("b", (seen * (1 + count // len(seen)))[:count])
    if draw.one_in(6) and data:
        data[draw.below(len(data))] = draw.choice((-128, -2, -1, 101, 127, 100))
    message.data = data
    return message


def window(draw: Draw, now: float, width: int, height: int) -> OccupancyGridUpdate:
    """Return a window of a map, mostly one that lies in it; now and then the empty one."""
    message = OccupancyGridUpdate(header=_header(draw, "map", now))
    if draw.one_in(12):
        return message
    message.width, message.height = 1 + draw.below(width), 1 + draw.below(height)
    message.x = draw.below(width - message.width + 1)
    message.y = draw.below(height - message.height + 1)
    count = message.width * message.height
    if draw.one_in(6):
        name = draw.choice(("x", "y"))
        setattr(message, name, draw.choice((-1, 5, width, _INT32, -_INT32)))
    if draw.one_in(6):
        name = draw.choice(("width", "height"))
        setattr(message, name, draw.choice((0, 1, width, 8000, _UINT32)))
        if draw.one_in(2):
            count = min(message.width * message.height, 4096)
    values = (0, 20, 60, 100)
    message.data = array("b", [draw.choice(values) for _ in range(min(count, 12))] or [0])
    message.data = array("b", (list(message.data) * (1 + count // 12))[:count])
    if draw.one_in(6) and message.data:
        message.data[draw.below(len(message.data))] = draw.choice((-128, -1, 101, 127))
    return message


def window_info(draw: Draw, number: int | None) -> dict[str, Any]:
    """Return what the middleware tells of a window, mostly that it follows window `number`."""
    follows = (number or 0) + 1
    if draw.one_in(8):
        return {"publication_sequence_number": draw.choice((None, 1, follows + 1, 2**64 - 1))}
    return {"publication_sequence_number": follows}


def point(draw: Draw, x: float, y: float) -> Point:
    """Return a point, mostly near the one given."""
    return Point(
        x=draw.number(lambda: x + draw.between(-1.0, 1.0)),
        y=draw.number(lambda: y + draw.between(-1.0, 1.0)),
    )


def twist(draw: Draw) -> Twist:
    """Return a velocity command, mostly one of a unicycle."""
    message = Twist()
    message.linear.x = draw.number(lambda: draw.between(-1.0, 1.0))
    message.angular.z = draw.number(lambda: draw.between(-2.0, 2.0))
    if draw.one_in(8):
        draw.choice((message.linear, message.angular)).y = draw.float64()
    return message


def stamped_twist(draw: Draw) -> TwistStamped:
    """Return a velocity command with a stamp, mostly one of the base."""
    return TwistStamped(
        header=_header(draw, "base_link", draw.between(0.0, 2.0)), twist=twist(draw)
    )


def parameter(draw: Draw, names: Sequence[str]) -> Parameter:
    """Return a parameter to set, of any type."""
    value = ParameterValue(type=draw.byte() if draw.one_in(12) else draw.below(10))
    value.bool_value = bool(draw.byte() % 2)
    value.integer_value = max(-(2**63), min(2**63 - 1, draw.whole()))
    value.double_value = draw.number(lambda: draw.between(0.0, 1.0))
    value.string_value = draw.text()
    count = draw.below(5)
    value.byte_array_value = [bytes([draw.byte()]) for _ in range(count)]
    value.bool_array_value = [bool(draw.byte() % 2) for _ in range(count)]
    value.integer_array_value = [draw.byte() for _ in range(count)]
    value.double_array_value = [draw.float64() for _ in range(count)]
    value.string_array_value = [draw.text() for _ in range(count)]
    name = draw.text() if draw.one_in(8) else draw.choice(names)
    return Parameter(name=name, value=value)
