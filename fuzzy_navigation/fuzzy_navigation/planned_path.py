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
    places : ndarray of float64, shape (n, 2)
        Where in the cells the planner has it pass [m].
    alpha : float
        Rung that it was found on.
    resolution : float
        Side of a cell [m].
    """

    points: NDArray[np.float64]
    places: NDArray[np.float64]
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
        places = np.array([(pose.x, pose.y) for pose in poses], dtype=np.float64)
        cells, inside = geometry.cells_of(places)
        if not inside.all():
            x, y = places[int(np.argmin(inside))]
            raise ValueError(f"the path leaves the map at ({x:.2f}, {y:.2f}) m")
        if (np.abs(np.diff(cells, axis=0)) > 1).any():
            raise ValueError("the path jumps over cells")
        if robot.distance_to(*places[0]) > 1.5 * geometry.resolution:
            raise ValueError(
                f"the path starts at ({places[0, 0]:.2f}, {places[0, 1]:.2f}) m, the robot is at "
                f"({robot.x:.2f}, {robot.y:.2f}) m"
            )
        points = np.column_stack(geometry.centre_coordinates(cells[:, 0], cells[:, 1]))
        return cls(points, places, alpha, geometry.resolution)
