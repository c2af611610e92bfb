# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper's three grids: latched topics, and services for who wants one now."""

from __future__ import annotations

import numpy as np
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from numpy.typing import NDArray
from rclpy.node import Node

from fuzzy_map_building.grid import Window
from fuzzy_map_building.map_grids import MapGrids
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import now_seconds, stamp_from_seconds
from fuzzy_map_building.ros.conversions import grid_to_msg

__all__ = ["MapPublisher"]


class MapPublisher:
    """Publishes the motion map, the planning map and the occupancy of a mapper.

    Parameters
    ----------
    node : Node
        Whose topics and services they are.
    mapper : FuzzyMapper
        The map published at once, explored or not, so that nobody waits in vain.
    """

    def __init__(self, node: Node, mapper: FuzzyMapper) -> None:
        self._node = node
        self._motion = node.create_publisher(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
        self._planning = node.create_publisher(OccupancyGrid, names.PLANNING_MAP, qos.LATCHED)
        self._occupancy = node.create_publisher(OccupancyGrid, names.MAP, qos.LATCHED)
        #: Whether a map that tells something was published before simulated time had begun.
        self.undated = False
        self._grids = MapGrids(mapper)
        self.publish(mapper, window=Window(0, 0, 0, 0))
        node.create_service(
            GetMap, names.GET_MOTION_MAP, self._get_motion_map, qos_profile=qos.REQUESTS
        )
        node.create_service(
            GetMap, names.GET_PLANNING_MAP, self._get_planning_map, qos_profile=qos.REQUESTS
        )

    def publish(
        self, mapper: FuzzyMapper, newest: float = 0.0, window: Window | None = None
    ) -> None:
        """Publish all three grids, with one stamp.

        Parameters
        ----------
        mapper : FuzzyMapper
            Whose maps they are.
        newest : float
            Stamp of the newest reading in them [s]. The maps' stamp is the present time, but
            never before this one: readings can arrive before the /clock of their time.
        window : Window, optional
            The cells that may have changed since the last time; all if not given.
        """
        now = now_seconds(self._node)
        self.undated = now == 0.0 and mapper.perceptions > 0
        self._stamp = stamp_from_seconds(max(now, newest))
        self._geometry = mapper.geometry
        self._grids.refresh(mapper, window)
        self._motion.publish(self._message(self._grids.motion))
        self._planning.publish(self._message(self._grids.planning))
        self._occupancy.publish(self._message(self._grids.occupancy))

    def _message(self, grid: NDArray[np.int8]) -> OccupancyGrid:
        return grid_to_msg(grid, self._geometry, self._stamp)

    def _get_motion_map(self, _: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
        response.map = self._message(self._grids.motion)
        return response

    def _get_planning_map(self, _: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
        response.map = self._message(self._grids.planning)
        return response
