# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Maps and windows of maps as messages and back; see `conversions` for all others."""

from __future__ import annotations

import math
from array import array
from typing import Final

import numpy as np
from builtin_interfaces.msg import Time
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from std_msgs.msg import Header

from fuzzy_map_building.grid import MAX_CELLS, GridGeometry, Window
from fuzzy_map_building.map_follower import MapWindow
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.clock import nanoseconds_from_stamp, stamp_from_nanoseconds
from fuzzy_map_building.ros.conversions import (
    Refused,
    check_frame,
    float32,
    pose_from_msg,
)
from fuzzy_map_building.wording import counted

__all__ = [
    "geometry_from_msg",
    "grid_from_msg",
    "grid_to_msg",
    "risk_from_msg",
    "window_from_msg",
    "window_to_msg",
]

#: Farthest row or column of a window's end.
_FARTHEST: Final = 2**31 - 1


def geometry_from_msg(message: OccupancyGrid, what: str = "map") -> GridGeometry:
    """Return where a map's cells lie.

    Raises
    ------
    Refused
        ``wrong_frame``, ``rotated``, ``not_finite``, ``quaternion_norm``, ``too_far`` or
        ``geometry``.
    """
    check_frame(message.header, names.MAP_FRAME, what)
    origin = pose_from_msg(message.info.origin, f"{what} origin")
    if abs(origin.theta) > 1e-6:
        raise Refused(
            "rotated",
            f"{what} is rotated by {math.degrees(origin.theta):.3g} deg; "
            "its axes must be those of the frame",
        )
    info = message.info
    try:
        return GridGeometry(
            info.width, info.height, float32(info.resolution), (origin.x, origin.y)
        )
    except ValueError as error:
        raise Refused("geometry", f"{what}: {error}") from error


def grid_from_msg(
    message: OccupancyGrid, what: str = "map"
) -> tuple[GridGeometry, NDArray[np.int8]]:
    """Return a map's geometry and its values, -1 or 0..100, shape (height, width).

    The values are a read-only view of the message's data.

    Raises
    ------
    Refused
        As `geometry_from_msg`, ``size`` or ``value``.
    """
    geometry = geometry_from_msg(message, what)
    cells = geometry.width * geometry.height
    if len(message.data) != cells:
        raise Refused(
            "size",
            f"{what} has {counted(len(message.data), 'value')} for {geometry.width} x "
            f"{geometry.height} cells",
        )
    values = np.frombuffer(message.data, dtype=np.int8).reshape(geometry.shape)
    if values.min() < -1 or values.max() > 100:
        raise Refused(
            "value", f"{what} has values from {values.min()} to {values.max()}, allowed: -1..100"
        )
    values.flags.writeable = False
    return geometry, values


def risk_from_msg(message: OccupancyGrid, what: str = "map") -> tuple[GridGeometry, Hundredths]:
    """Return a risk map's geometry and its risks, shape (height, width).

    Raises
    ------
    Refused
        As `grid_from_msg`; ``unknown`` where a value is -1, which no risk map has.
    """
    geometry, values = grid_from_msg(message, what)
    if values.min() < 0:
        raise Refused("unknown", f"{what} has cells of -1: a risk map knows each cell, 0..100")
    return geometry, Hundredths(values)


def grid_to_msg(
    values: NDArray[np.int8],
    geometry: GridGeometry,
    stamp: Time,
    frame: str = names.MAP_FRAME,
) -> OccupancyGrid:
    """Return the message of a map.

    Parameters
    ----------
    values : ndarray of int8, shape (height, width)
        -1 or 0..100.
    geometry : GridGeometry
        Where the cells lie.
    stamp : Time
        Of the map.
    frame : str
        That of its positions.
    """
    if values.dtype != np.int8 or values.shape != geometry.shape:
        raise ValueError(
            f"a map of shape {geometry.shape} takes int8, got {values.dtype} of {values.shape}"
        )
    message = OccupancyGrid(header=Header(stamp=stamp, frame_id=frame))
    message.info.map_load_time = stamp
    message.info.resolution = geometry.resolution
    message.info.width = geometry.width
    message.info.height = geometry.height
    message.info.origin.position.x, message.info.origin.position.y = geometry.origin
    message.info.origin.orientation.w = 1.0
    message.data = _bytes_of(values)
    return message


def _bytes_of(values: NDArray[np.int8]) -> array[int]:
    """Return cells, row by row, as a message's setter takes them over as they are.

    Anything else it copies value by value, a hundred times slower.
    """
    data = array("b")
    data.frombytes(np.ascontiguousarray(values).data)
    return data


def window_to_msg(window: MapWindow) -> OccupancyGridUpdate:
    """Return the message of new cells of a map; the middleware numbers it."""
    message = OccupancyGridUpdate(
        header=Header(stamp=stamp_from_nanoseconds(window.stamp), frame_id=names.MAP_FRAME)
    )
    message.x, message.y = window.window.col0, window.window.row0
    message.height, message.width = window.cells.shape
    message.data = _bytes_of(window.cells)
    return message


def window_from_msg(
    message: OccupancyGridUpdate, number: int | None = None, what: str = "window"
) -> MapWindow:
    """Return new cells of a risk map; whether they fit it is for the `MapFollower` to say.

    Parameters
    ----------
    message : OccupancyGridUpdate
        Of 0 x 0 cells if the map is another one from its stamp on.
    number : int, optional
        What the middleware tells as its ``publication_sequence_number``.
    what : str
        What to call it in the refusal.

    Raises
    ------
    Refused
        ``wrong_frame``, ``window`` (no part of any map), ``size``, ``value`` or ``stamps``.
    """
    check_frame(message.header, names.MAP_FRAME, what)
    x, y, width, height = message.x, message.y, message.width, message.height
    none = width == height == 0
    if x < 0 or y < 0 or (width * height < 1 and not none) or width * height > MAX_CELLS:
        raise Refused(
            "window",
            f"{what} of {width} x {height} cells at column {x}, row {y} is no part of a map of up "
            f"to {MAX_CELLS} cells",
        )
    if max(x + width, y + height) > _FARTHEST:
        raise Refused("window", f"{what} at column {x}, row {y} ends beyond {_FARTHEST}")
    if len(message.data) != width * height:
        raise Refused(
            "size",
            f"{what} has {counted(len(message.data), 'value')} for {width} x {height} cells",
        )
    cells = np.frombuffer(message.data, dtype=np.int8).reshape(height, width)
    if not none and (cells.min() < 0 or cells.max() > 100):
        raise Refused(
            "value", f"{what} has values from {cells.min()} to {cells.max()}, allowed: 0..100"
        )
    if message.header.stamp.sec < 0:
        raise Refused("stamps", f"{what} has a negative stamp ({message.header.stamp.sec} s)")
    stamp = nanoseconds_from_stamp(message.header.stamp)
    return MapWindow(number, stamp, Window(y, y + height, x, x + width), cells)
