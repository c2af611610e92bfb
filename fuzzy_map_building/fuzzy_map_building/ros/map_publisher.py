# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper's three grids: latched topics, and services for who wants one now."""

from __future__ import annotations

from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from rclpy.node import Node

from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.occupancy import belief_to_int8, risk_to_int8
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
        self.publish(mapper)
        node.create_service(
            GetMap, names.GET_MOTION_MAP, self._get_motion_map, qos_profile=qos.REQUESTS
        )
        node.create_service(
            GetMap, names.GET_PLANNING_MAP, self._get_planning_map, qos_profile=qos.REQUESTS
        )

    def publish(self, mapper: FuzzyMapper, newest: float = 0.0) -> None:
        """Publish all three grids, with one stamp.

        Parameters
        ----------
        mapper : FuzzyMapper
            Whose maps they are.
        newest : float
            Stamp of the newest reading in them [s]. The maps' stamp is the present time, but
            never before this one: readings can arrive before the /clock of their time.
        """
        now = now_seconds(self._node)
        self.undated = now == 0.0 and mapper.perceptions > 0
        stamp = stamp_from_seconds(max(now, newest))
        geometry = mapper.geometry
        self._motion_map = grid_to_msg(risk_to_int8(mapper.motion_risk), geometry, stamp)
        self._planning_map = grid_to_msg(risk_to_int8(mapper.planning_risk), geometry, stamp)
        occupancy = belief_to_int8(mapper.empty, mapper.occupied)
        self._motion.publish(self._motion_map)
        self._planning.publish(self._planning_map)
        self._occupancy.publish(grid_to_msg(occupancy, geometry, stamp))

    def _get_motion_map(self, _: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
        response.map = self._motion_map
        return response

    def _get_planning_map(self, _: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
        response.map = self._planning_map
        return response
