# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper's three grids: latched topics, windows of what is new, and services.

A small map is published whole with every packet. Of a large one each packet's window is
published, and the whole, which takes a hundred times as long, at a bounded rate; so whoever
comes late, or follows no windows, sees the newest map within a known time as well. A large map
that is another one from now on comes whole at once, and a window without cells says so to those
who follow the windows.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.publisher import Publisher

from fuzzy_map_building.grid import Window
from fuzzy_map_building.map_follower import MapWindow
from fuzzy_map_building.map_grids import MapGrids
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import PublishingParameters
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import (
    nanoseconds_from_stamp,
    now_seconds,
    stamp_from_nanoseconds,
    stamp_from_seconds,
)
from fuzzy_map_building.ros.map_conversions import grid_to_msg, window_to_msg

__all__ = ["MapPublisher"]

#: A whole map waits so long for the answers that windows bring about, which are short [s].
PAUSE: Final = 0.2


@dataclass
class _Map:
    """One of the maps: where it is published, and what of it has yet to be.

    Attributes
    ----------
    grid : callable
        Returns its cells.
    published : float
        When the whole was published last [s of wall time].
    changed : float or None
        When it changed first after that [s of wall time].
    """

    whole: Publisher
    windows: Publisher
    grid: Callable[[], NDArray[np.int8]]
    published: float = 0.0
    changed: float | None = None


class MapPublisher:
    """Publishes the motion map, the planning map and the occupancy of a mapper.

    Parameters
    ----------
    node : Node
        Whose topics and services they are.
    mapper : FuzzyMapper
        The map published at once, explored or not, so that nobody waits in vain.
    parameters : PublishingParameters
        How often the whole maps are published.

    Attributes
    ----------
    parameters : PublishingParameters
        Those in force; may be replaced.
    """

    def __init__(self, node: Node, mapper: FuzzyMapper, parameters: PublishingParameters) -> None:
        self._node = node
        self.parameters = parameters
        self._grids = MapGrids(mapper)
        # The planner needs its map before the motion asks it for a path on it.
        self._maps = (
            self._map(names.PLANNING_MAP, lambda: self._grids.planning),
            self._map(names.MOTION_MAP, lambda: self._grids.motion),
            self._map(names.MAP, lambda: self._grids.occupancy),
        )
        #: Whether a map that tells something was published before simulated time had begun.
        self.undated = False
        self._stamp = 0
        self._anew = True
        self.publish(mapper, window=Window(0, 0, 0, 0))
        for service, grid in (
            (names.GET_MOTION_MAP, lambda: self._grids.motion),
            (names.GET_PLANNING_MAP, lambda: self._grids.planning),
        ):
            node.create_service(GetMap, service, self._getter(grid), qos_profile=qos.REQUESTS)

    def begin(self) -> None:
        """Publish the next map as another one, for time has stepped back."""
        self._anew = True

    def publish(
        self,
        mapper: FuzzyMapper,
        newest: float = 0.0,
        window: Window | None = None,
        grids: MapGrids | None = None,
    ) -> None:
        """Publish what is new, with one stamp: all three grids, or their windows.

        Parameters
        ----------
        mapper : FuzzyMapper
            Whose maps they are.
        newest : float
            Stamp of the newest reading in them [s]. The maps' stamp is the present time, but
            never before this one: readings can arrive before the /clock of their time.
        window : Window, optional
            The cells that may have changed since the last time; all if not given.
        grids : MapGrids, optional
            Those of the mapper, where somebody has made them already.
        """
        self._geometry = mapper.geometry
        if grids is None:
            self._grids.refresh(mapper, window)
        else:
            self._grids = grids
        previous = self._stamp
        now = now_seconds(self._node)
        self.undated = now == 0.0 and mapper.perceptions > 0
        stamp = nanoseconds_from_stamp(stamp_from_seconds(max(now, newest)))
        anew = self._anew or previous == 0
        if anew:
            self._stamp, self._anew = stamp, False
        else:
            # No two states have one stamp.
            self._stamp = max(stamp, previous + 1)
        small = mapper.geometry.width * mapper.geometry.height <= self.parameters.small_map
        another = anew or window is None
        for each in self._maps:
            if not small and another:
                self._publish_window(each, Window(0, 0, 0, 0))
            if small or another or window is None or window.empty:
                self._publish_whole(each)
            else:
                self._publish_window(each, window)
            if not small and anew:
                # Whoever heard the map before the window took it for an old one if it is stamped
                # earlier: once more when it is due.
                each.changed = each.published

    def advance(self) -> None:
        """Publish a whole map that is due, one at a time; to be called several times a second."""
        now = time.monotonic()
        for each in self._maps:
            if each.changed is None:
                continue
            due = max(each.published + self.parameters.period, each.changed + PAUSE)
            if now >= due:
                self._publish_whole(each)
                return

    def _map(self, topic: str, grid: Callable[[], NDArray[np.int8]]) -> _Map:
        create = self._node.create_publisher
        return _Map(
            create(OccupancyGrid, topic, qos.LATCHED),
            create(OccupancyGridUpdate, names.updates_of(topic), qos.WINDOWS),
            grid,
        )

    def _publish_whole(self, each: _Map) -> None:
        each.whole.publish(self._message(each.grid()))
        each.published, each.changed = time.monotonic(), None

    def _publish_window(self, each: _Map, window: Window) -> None:
        cells = each.grid()[window.slices]
        message = window_to_msg(MapWindow(None, self._stamp, window, cells))
        each.windows.publish(message)
        if each.changed is None:
            each.changed = time.monotonic()

    def _message(self, grid: NDArray[np.int8]) -> OccupancyGrid:
        return grid_to_msg(grid, self._geometry, stamp_from_nanoseconds(self._stamp))

    def _getter(
        self, grid: Callable[[], NDArray[np.int8]]
    ) -> Callable[[GetMap.Request, GetMap.Response], GetMap.Response]:
        def get(_: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
            response.map = self._message(grid())
            return response

        return get
