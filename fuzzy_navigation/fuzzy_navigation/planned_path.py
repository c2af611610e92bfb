# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A planner's answer as the motion drives it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2

__all__ = ["PlannedPath"]


@dataclass(frozen=True)
class PlannedPath:
    """A path from cell to cell.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Centres (x, y) of the cells [m].
    alpha : float
        Rung that it was found on.
    resolution : float
        Side of a cell [m].
    """

    points: NDArray[np.float64]
    alpha: float
    resolution: float

    @classmethod
    def of(
        cls, poses: Sequence[Pose2], alpha: float, geometry: GridGeometry, robot: Pose2
    ) -> PlannedPath:
        """Take a planner's answer.

        Raises
        ------
        ValueError
            If there is no pose, one lies outside the map, two in a row are not of neighbouring
            cells, or the first is not where the robot is.
        """
        if not poses:
            raise ValueError("the path has no pose")
        points = np.array([(pose.x, pose.y) for pose in poses], dtype=np.float64)
        cells, inside = geometry.cells_of(points)
        if not inside.all():
            x, y = points[int(np.argmin(inside))]
            raise ValueError(f"the path leaves the map at ({x:.2f}, {y:.2f}) m")
        if (np.abs(np.diff(cells, axis=0)) > 1).any():
            raise ValueError("the path jumps over cells")
        if robot.distance_to(*points[0]) > 1.5 * geometry.resolution:
            raise ValueError(
                f"the path starts at ({points[0, 0]:.2f}, {points[0, 1]:.2f}) m, the robot is at "
                f"({robot.x:.2f}, {robot.y:.2f}) m"
            )
        return cls(points, alpha, geometry.resolution)
