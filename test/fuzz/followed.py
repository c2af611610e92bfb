# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Somebody who follows one of the mapper's maps and must always have its newest state."""

from __future__ import annotations

from typing import Any

import numpy as np
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid

from fuzzy_map_building.map_follower import MapFollower
from fuzzy_map_building.ros.clock import nanoseconds_from_stamp
from fuzzy_map_building.ros.map_conversions import grid_from_msg, window_from_msg

__all__ = ["Followed"]


class Followed:
    """Hears what is published of a map.

    Parameters
    ----------
    published : object
        The map, as the mapper's `MapPublisher` keeps it.
    """

    def __init__(self, published: Any) -> None:
        self._grid = published.grid
        self._follower = MapFollower()
        self._cells = np.empty((0, 0), np.int8)
        self.windows = self._sent = 0
        self._whole = published.whole.publish
        published.whole.publish = self._on_map
        published.windows.publish = self._on_window

    def check(self) -> None:
        """Hold what was heard against the mapper's own cells."""
        assert np.array_equal(self._cells, self._grid())
        assert self._follower.waiting == self._follower.missed == 0

    def _on_map(self, message: OccupancyGrid) -> None:
        stamp = nanoseconds_from_stamp(message.header.stamp)
        geometry, values = grid_from_msg(message)
        if self._follower.outdated(stamp):
            assert np.array_equal(self._cells, values)
            return
        self._cells = values.copy()
        assert self._follower.take_map(stamp, geometry) == []
        self._whole(message)

    def _on_window(self, message: OccupancyGridUpdate) -> None:
        self._sent += 1
        new = window_from_msg(message, self._sent)
        ready = self._follower.take_window(new)
        assert ready == ([] if new.window.empty else [new])
        if new.window.empty:
            return
        self._cells[new.window.slices] = new.cells
        self.windows += 1
