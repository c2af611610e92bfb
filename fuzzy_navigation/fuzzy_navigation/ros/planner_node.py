# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The node ``fuzzy_planner``: paths of least risk on the newest planning map.

The header of every answer's path carries the stamp of the planning map that the answer
rests on, also when there is no path: whoever has just had a map built can tell whether the
planner knew it.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Final

from builtin_interfaces.msg import Time
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
from rclpy.node import Node

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp
from fuzzy_map_building.ros.conversions import Refused, path_to_msg
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.rivals import Rivals
from fuzzy_map_building.ros.run import spin_node
from fuzzy_navigation import any_angle, clearance_layer, search
from fuzzy_navigation.agreement import shared_parameters
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.planner import Planner, PlanResult, PlanStatus
from fuzzy_navigation.risk import check_effort
from fuzzy_navigation.ros.declarations import declare_planner
from fuzzy_navigation.ros.followed_map import FollowedMap, NewMap, NewWindow
from fuzzy_navigation.ros.requests import requested_pose

__all__ = ["PlannerNode", "main"]

#: Names of the costs that a request can ask for; None is the planner's own.
_COSTS: Final[Mapping[int, str | None]] = {
    PlanPath.Request.DEFAULT: None,
    PlanPath.Request.G1: "g1",
    PlanPath.Request.G2: "g2",
    PlanPath.Request.G3: "g3",
}
#: Where the planner lies until the first map: it then answers that it has none.
_NOWHERE: Final = GridGeometry(1, 1, 1.0)


class PlannerNode(Node):
    """Keeps the newest planning map and answers ``plan_path`` and ``get_plan`` on it."""

    def __init__(self) -> None:
        super().__init__(names.PLANNER_NODE)
        self._settings = declare_planner(self, on_change=self._use_parameters)
        self._planner = Planner(_NOWHERE, self._settings.values)
        self._map_stamp: Time | None = None
        self._answers: Counter[str] = Counter()
        self._last_time = 0.0
        # Before the first request, which would otherwise wait for the compiler.
        for kernels in (search, any_angle, clearance_layer):
            kernels.warm_up()
        alone = Rivals(self, services=(names.PLAN_PATH,))
        self._diagnostics = Diagnostics(self, self._values, self._problem, alone)
        self._settings.on_refusal = self._diagnostics.reject
        self._plan_publisher = self.create_publisher(Path, names.PLAN, qos.LATCHED)
        self._followed = FollowedMap(
            self,
            names.PLANNING_MAP,
            "the planning map",
            self._diagnostics,
            self._admit,
            self._on_map,
            self._on_window,
        )
        self.create_service(
            PlanPath, names.PLAN_PATH, self._on_plan_path, qos_profile=qos.REQUESTS
        )
        self.create_service(GetPlan, names.GET_PLAN, self._on_get_plan, qos_profile=qos.REQUESTS)
        p = self._settings.values
        self.get_logger().info(
            f"planning by {p.cost} for a robot of radius {p.robot_radius:g} m, on the maps that "
            f"come by '{names.PLANNING_MAP}'"
        )

    def _admit(self, geometry: GridGeometry) -> None:
        p = self._settings.values
        check_effort(geometry, p.robot_radius, p.augmentation)

    def _on_map(self, new: NewMap) -> None:
        if new.geometry != self._planner.geometry:
            self._planner = Planner(new.geometry, self._settings.values)
        self._planner.set_map(new.risk)
        self._map_stamp = new.stamp

    def _on_window(self, new: NewWindow) -> None:
        self._planner.update_map(new.risk, new.window)
        self._map_stamp = new.stamp

    def _use_parameters(self, parameters: PlannerParameters) -> None:
        self._planner.parameters = parameters

    def _on_plan_path(
        self, request: PlanPath.Request, response: PlanPath.Response
    ) -> PlanPath.Response:
        began = time.perf_counter()
        if request.cost in _COSTS:
            result = self._plan(
                request.start,
                request.goal,
                _COSTS[request.cost],
                request.alpha,
                request.adjacency,
                request.tolerance,
                [(point.x, point.y) for point in request.barred],
                [(point.x, point.y) for point in request.hits],
                request.slim_radius,
                request.slim_above,
                request.any_angle,
            )
        else:
            known = ", ".join(map(str, sorted(_COSTS)))
            result = _bad_request(f"cost must be one of {known}, got {request.cost}")
        response.path = self._answer(names.PLAN_PATH, result)
        response.status = int(result.status)
        response.message = result.message
        response.g1, response.g2, response.g3 = result.g1, result.g2, result.g3
        response.alpha = result.alpha
        response.expanded_cells = result.expanded
        response.planning_time = self._last_time = time.perf_counter() - began
        response.parameters = shared_parameters(self._settings.values)
        return response

    def _on_get_plan(
        self, request: GetPlan.Request, response: GetPlan.Response
    ) -> GetPlan.Response:
        result = self._plan(request.start, request.goal, tolerance=request.tolerance)
        response.plan = self._answer(names.GET_PLAN, result)
        if result.status is not PlanStatus.FOUND:
            # The response has no field for the reason.
            self.get_logger().warning(f"{names.GET_PLAN}: {result.message}")
        return response

    def _plan(
        self,
        start: PoseStamped,
        goal: PoseStamped,
        cost: str | None = None,
        alpha: float = 0.0,
        adjacency: int = 0,
        tolerance: float = 0.0,
        barred: Sequence[tuple[float, float]] = (),
        hits: Sequence[tuple[float, float]] = (),
        slim_radius: float = 0.0,
        slim_above: float = 0.0,
        any_angle: bool = False,
    ) -> PlanResult:
        try:
            poses = requested_pose(start, "the start"), requested_pose(goal, "the goal")
        except Refused as refusal:
            return _bad_request(str(refusal))
        return self._planner.plan(
            *poses,
            cost,
            alpha,
            adjacency,
            tolerance,
            barred,
            hits,
            slim_radius,
            slim_above,
            any_angle,
        )

    def _answer(self, service: str, result: PlanResult) -> Path:
        """Count and publish a result, and return its path."""
        self._answers[result.status.name.lower()] += 1
        if result.status is PlanStatus.BAD_REQUEST:
            self._diagnostics.reject(service, "bad_request", result.message)
        path = path_to_msg(result.poses, self._map_stamp or Time())
        if result.status is PlanStatus.FOUND:
            self._plan_publisher.publish(path)
        return path

    def _values(self) -> Mapping[str, object]:
        values: dict[str, object] = {
            f"plans.{status.name.lower()}": self._answers[status.name.lower()]
            for status in PlanStatus
        }
        values["last_planning_time"] = f"{self._last_time:.6f}"
        if self._map_stamp is not None:
            values["map_stamp"] = f"{seconds_from_stamp(self._map_stamp):.3f}"
        values.update(self._followed.values())
        return values

    def _problem(self) -> str:
        behind = self._followed.problem()
        if self._map_stamp is not None or behind:
            return behind
        return f"no map has come by '{names.PLANNING_MAP}' yet: is the mapper running?"


def _bad_request(reason: str) -> PlanResult:
    return PlanResult(PlanStatus.BAD_REQUEST, f"request refused: {reason}")


def main() -> int:
    """Run the node until SIGINT or SIGTERM."""
    return spin_node(PlannerNode, name=names.PLANNER_NODE)


if __name__ == "__main__":
    sys.exit(main())
