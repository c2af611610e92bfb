# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages as the network brings them, byte by byte: read and converted, or refused."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from fuzzy_msgs.msg import OccupancyGridUpdate
from fuzzy_msgs.srv import MapFile, PlanPath
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState, Range

from fuzz import messages
from fuzz.draw import Draw
from fuzz.surface import Surface, check_words, of_function
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_folder import MapFolder
from fuzzy_map_building.map_follower import MapFollower
from fuzzy_map_building.ros import conversions, map_conversions
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_map_building.ros.conversions import Refused
from fuzzy_map_building.ros.names import sonar_frame
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.ros.partners import plan_result
from fuzzy_navigation.ros.requests import requested_pose

__all__ = ["SURFACES"]

FRAMES = [sonar_frame(k) for k in range(16)]
FOLDER = MapFolder("/nowhere/maps")


def _range(message: Range) -> None:
    sample = conversions.range_from_msg(message, FRAMES, 0.4363)
    assert math.isfinite(sample.stamp)
    assert 0 <= sample.sensor < 16


def _joint(message: JointState) -> None:
    sample = conversions.joint_position(message, "turret_joint")
    assert sample is None or all(map(math.isfinite, sample))


def _grid(message: OccupancyGrid) -> None:
    geometry, risk = map_conversions.risk_from_msg(message)
    assert risk.codes.shape == geometry.shape
    assert ((risk.risks >= 0.0) & (risk.risks <= 1.0)).all()
    assert np.isfinite(geometry.bounds).all()


def _window(message: OccupancyGridUpdate) -> None:
    window = map_conversions.window_from_msg(message)
    assert window.cells.shape == window.window.shape
    assert window.stamp >= 0
    follower = MapFollower()
    assert follower.take_window(window) == []
    geometry = GridGeometry(8, 6, 0.1)
    taken = follower.take_map(window.stamp - 1, geometry)
    inside = not window.window.empty
    inside &= window.window.row1 <= geometry.height and window.window.col1 <= geometry.width
    assert taken == ([window] if inside else [])


def _twist(message: Twist) -> None:
    assert all(map(math.isfinite, conversions.twist_from_msg(message)))


def _pose(message: PoseStamped) -> None:
    stamp, _ = conversions.stamped_pose_from_msg(message)
    assert stamp > 0.0
    requested_pose(message, "the goal")


def _path(message: Path) -> None:
    conversions.path_from_msg(message)


def _plan(message: PlanPath.Response) -> None:
    assert 0.0 <= plan_result(message).alpha <= 1.0


def _name(message: MapFile.Request) -> None:
    path = FOLDER.file_to_read(message.path)
    raise AssertionError(f"{path} was found")


#: Types, and what takes their messages.
TAKERS: Mapping[type, Callable[[Any], None]] = {
    Range: _range,
    JointState: _joint,
    OccupancyGrid: _grid,
    OccupancyGridUpdate: _window,
    Twist: _twist,
    PoseStamped: _pose,
    Path: _path,
    PlanPath.Response: _plan,
    MapFile.Request: _name,
}
_COUNTS: Counter[str] = Counter()


def target(data: bytes) -> None:
    """The first byte chooses the type, the others are its message."""
    kinds = list(TAKERS)
    kind = kinds[data[0] % len(kinds) if data else 0]
    try:
        message = deserialize_message(data[1:], kind)
    except Exception:  # of several unrelated types; the middleware drops such a sample
        _COUNTS["unreadable"] += 1
        return
    _COUNTS[kind.__name__] += 1
    try:
        TAKERS[kind](message)
    except (Refused, ValueError) as error:
        check_words(error)


def _seeds() -> Sequence[bytes]:
    none = Draw(b"")
    good = [
        messages.range_of(none, 10.0, FRAMES[3], 0.4363),
        messages.joint_state(none, 10.0, "turret_joint", 0.1),
        messages.grid(none, 10.0, 5, 4, 0.1, (0, 20, 100)),
        messages.window(none, 10.0, 5, 4),
        messages.twist(none),
        messages.stamped_pose(none, 10.0, 1.0, 2.0),
        conversions.path_to_msg([Pose2(1.0, 2.0)], stamp_from_seconds(10.0)),
        PlanPath.Response(message="found", alpha=0.6),
        MapFile.Request(path="lab.map"),
    ]
    return [bytes([k]) + serialize_message(message) for k, message in enumerate(good)]


SURFACES = (
    Surface(
        "wire",
        of_function(target),
        _seeds,
        (
            b"map\0",
            b"\xff\xff\xff\xff",
            b"\xff\xff\xff\x7f",
            b"\xff\xfe",
            b"\0\0\xc0\x7f",
            b"\0\1",
        ),
        longest=512,
        counts=_COUNTS,
    ),
)
