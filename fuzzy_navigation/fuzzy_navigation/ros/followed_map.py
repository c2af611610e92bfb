# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""One of the mapper's maps as a node follows it: whole, and by the windows of what is new."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from builtin_interfaces.msg import Time
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_follower import MapFollower, MapWindow
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import (
    known_seconds,
    nanoseconds_from_stamp,
    seconds_from_stamp,
    stamp_from_nanoseconds,
)
from fuzzy_map_building.ros.conversions import Refused
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.map_conversions import risk_from_msg, window_from_msg
from fuzzy_navigation.control_tick import Untimely
from fuzzy_navigation.map_times import MapTimes

__all__ = ["FollowedMap", "NewMap", "NewWindow"]


@dataclass(frozen=True)
class NewMap:
    """A whole map that has come.

    Parameters
    ----------
    geometry : GridGeometry
        Where its cells lie.
    risk : Hundredths
        Of all cells.
    stamp : Time
        Of the map.
    """

    geometry: GridGeometry
    risk: Hundredths
    stamp: Time


@dataclass(frozen=True)
class NewWindow:
    """Cells that are new in the map.

    Parameters
    ----------
    window : Window
        Where they are.
    risk : Hundredths
        Of the window's cells.
    stamp : Time
        Of the map that they make.
    """

    window: Window
    risk: Hundredths
    stamp: Time


class FollowedMap:
    """Hears a map and its windows, and hands on what makes up the newest map, in order.

    Parameters
    ----------
    node : Node
        Who follows the map.
    topic : str
        Where the whole map comes by; its windows come by ``<topic>_updates``.
    what : str
        What to call it in messages.
    diagnostics : Diagnostics
        Counts what is refused.
    admit : callable
        Raises ValueError for the geometry of a map that the node cannot work with.
    on_map, on_window : callable
        Take what is new.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        what: str,
        diagnostics: Diagnostics,
        admit: Callable[[GridGeometry], None],
        on_map: Callable[[NewMap], None],
        on_window: Callable[[NewWindow], None],
    ) -> None:
        self._node = node
        self._topic = topic
        self._what = what
        self._diagnostics = diagnostics
        self._admit = admit
        self._take_map = on_map
        self._take_window = on_window
        self.forget()
        node.create_subscription(OccupancyGrid, topic, self.on_map, qos.LATCHED)
        node.create_subscription(
            OccupancyGridUpdate, names.updates_of(topic), self.on_window, qos.WINDOWS
        )

    def forget(self) -> None:
        """Forget all that has come."""
        self._times = MapTimes(self._what)
        self._follower = MapFollower()

    def on_map(self, message: OccupancyGrid) -> None:
        """Take a whole map, unless windows have made a newer one of it already."""
        stamp = message.header.stamp
        at = nanoseconds_from_stamp(stamp)
        if self._follower.outdated(at):
            return
        try:
            geometry, risk = risk_from_msg(message, self._what)
            self._times.check(known_seconds(self._node), seconds_from_stamp(stamp))
            self._admit(geometry)
        except ValueError as refusal:
            self._refuse(self._topic, refusal)
            return
        self._take_map(NewMap(geometry, risk, stamp))
        self._take(self._follower.take_map(at, geometry))

    def on_window(self, message: OccupancyGridUpdate, info: Mapping[str, Any]) -> None:
        """Take a window if it goes on from the map that is known, else have it wait.

        Parameters
        ----------
        message : OccupancyGridUpdate
            What has come.
        info : mapping
            What the middleware tells of it: its ``publication_sequence_number``, or None.
        """
        number, what = info.get("publication_sequence_number"), f"a window of {self._what}"
        try:
            window = window_from_msg(message, number, what)
            self._times.check(known_seconds(self._node), seconds_from_stamp(message.header.stamp))
            ready = self._follower.take_window(window)
        except ValueError as refusal:
            self._refuse(names.updates_of(self._topic), refusal)
            return
        self._take(ready)

    def values(self) -> Mapping[str, object]:
        """Return what the node's diagnostics tell of the windows."""
        follower = self._follower
        return {
            "windows.taken": follower.taken,
            "windows.waiting": follower.waiting,
            "windows.missed": follower.missed,
            "windows.settled": follower.settled,
        }

    def _take(self, windows: list[MapWindow]) -> None:
        for each in windows:
            stamp = stamp_from_nanoseconds(each.stamp)
            self._take_window(NewWindow(each.window, Hundredths(each.cells), stamp))

    def _refuse(self, topic: str, refusal: ValueError) -> None:
        told = isinstance(refusal, (Refused, Untimely))
        reason = refusal.reason if told else "unfit"  # type: ignore[attr-defined]
        self._diagnostics.reject(topic, reason, str(refusal))
