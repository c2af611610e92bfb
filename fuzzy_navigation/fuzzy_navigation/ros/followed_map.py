# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""One of the mapper's maps as a node follows it: whole, and by the windows of what is new."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from builtin_interfaces.msg import Time
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_follower import MapFollower, MapWindow
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.params import PublishingParameters
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
from fuzzy_map_building.wording import counted
from fuzzy_navigation.control_tick import Untimely
from fuzzy_navigation.map_times import MapTimes

__all__ = ["FollowedMap", "NewMap", "NewWindow"]

#: Time for which a map may lack what was sent of it before that is a problem [s of wall time]:
#: within half of it a mapper of the usual parameters sends the whole map.
PATIENCE: Final = 2.0 * PublishingParameters().period


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
        # Since when the map lacks windows, and since when and why something of it was refused.
        self._behind: float | None = None
        self._refused: tuple[float, str] | None = None

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
        self._refused = None
        self._look()

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
        self._look()

    def values(self) -> Mapping[str, object]:
        """Return what the node's diagnostics tell of the windows."""
        follower = self._follower
        return {
            "windows.taken": follower.taken,
            "windows.waiting": follower.waiting,
            "windows.missed": follower.missed,
            "windows.settled": follower.settled,
        }

    def problem(self) -> str:
        """Return what the map lacks for longer than `PATIENCE`, and what to do; empty: nothing."""
        now, follower = time.monotonic(), self._follower
        if self._refused is not None and now - self._refused[0] > PATIENCE:
            since, why = self._refused
            return (
                f"{self._what} may be behind: {now - since:.0f} s ago something of it was refused "
                f"({why}), and no whole map has come since; see to whoever sent that, or have the "
                "mapper send its map anew, by a perception or 'reset_map'"
            )
        if self._behind is not None and now - self._behind > PATIENCE:
            updates = names.updates_of(self._topic)
            return (
                f"{self._what} has been behind for {now - self._behind:.0f} s: by '{updates}' "
                f"{counted(follower.missed, 'window')} missed so far and {follower.waiting} "
                f"waiting for a whole map by '{self._topic}', which does not come; does the "
                "network lose it, or is the mapper's 'publishing.period' that long?"
            )
        return ""

    def _look(self) -> None:
        """Note since when the map lacks windows."""
        if not self._follower.behind:
            self._behind = None
        elif self._behind is None:
            self._behind = time.monotonic()

    def _take(self, windows: list[MapWindow]) -> None:
        for each in windows:
            stamp = stamp_from_nanoseconds(each.stamp)
            self._take_window(NewWindow(each.window, Hundredths(each.cells), stamp))

    def _refuse(self, topic: str, refusal: ValueError) -> None:
        told = isinstance(refusal, (Refused, Untimely))
        reason = refusal.reason if told else "unfit"  # type: ignore[attr-defined]
        self._diagnostics.reject(topic, reason, str(refusal))
        if self._refused is None:
            self._refused = time.monotonic(), str(refusal)
