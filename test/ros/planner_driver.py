# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A planner process, a map, and requests."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from numpy.typing import NDArray
from rclpy.publisher import Publisher

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.map_conversions import grid_to_msg
from ros.harness import NodeProcess, Probe, Received, wait_until

GEOMETRY = GridGeometry(40, 30, 0.1, (-1.0, 0.5))
START, GOAL = (-0.55, 1.05), (2.45, 2.95)


def world() -> NDArray[np.int8]:
    """A map in grey levels: hills of risk, and a wall with one opening."""
    rows, columns = np.mgrid[0:30, 0:40]
    values = (25.0 + 25.0 * np.sin(rows / 3.0) * np.cos(columns / 5.0)).astype(np.int8)
    values[:, 20] = 100
    values[8:16, 20] = 10
    return values


def map_message(values: NDArray[np.int8], stamp: int = 1) -> OccupancyGrid:
    return grid_to_msg(
        values, GridGeometry(*values.shape[::-1], 0.1, (-1.0, 0.5)), Time(sec=stamp)
    )


def at(position: tuple[float, float], frame: str = "map") -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y = position
    return message


def request(**fields: Any) -> PlanPath.Request:
    return PlanPath.Request(**{"start": at(START), "goal": at(GOAL), **fields})


class Driver:
    """A planner process and what the tests say to it and hear from it."""

    def __init__(self, probe: Probe, process: NodeProcess) -> None:
        self.probe = probe
        self.process = process
        self.plans: Received[Path] = probe.subscribe(Path, names.PLAN, qos.LATCHED)
        self.diagnostics: Received[DiagnosticArray] = probe.subscribe(
            DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE
        )
        self._maps: Publisher = probe.publisher(OccupancyGrid, names.PLANNING_MAP, qos.LATCHED)

    def plan(self, **fields: Any) -> PlanPath.Response:
        return self.probe.call(PlanPath, names.PLAN_PATH, request(**fields))

    def give(self, message: OccupancyGrid) -> None:
        self._maps.publish(message)

    def give_and_wait(self, message: OccupancyGrid) -> None:
        """Give a map and return when the planner has it."""
        self.give(message)
        wait_until(
            lambda: self.plan().path.header.stamp == message.header.stamp, "the planner's new map"
        )

    def counts(self) -> dict[str, int]:
        """Return what the node's next diagnostics count."""
        self.diagnostics.clear()
        return counted(self.diagnostics.wait_for())

    def wait_for_counts(self, before: Mapping[str, int], more: Mapping[str, int]) -> None:
        """Wait until the diagnostics count so much more than before."""
        expected = {key: before.get(key, 0) + n for key, n in more.items()}
        self.diagnostics.wait_for(
            lambda array: expected.items() <= counted(array).items(), what=f"{expected}"
        )


def counted(array: DiagnosticArray) -> dict[str, int]:
    return {v.key: int(v.value) for v in array.status[0].values if v.value.isdigit()}
