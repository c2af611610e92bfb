# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the robot may go because it knows the place: the beta-cut of the motion map.

Paper, section IV-B, stop condition 1: the robot is leaving the explored area.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.risk import augment, beta_cut

__all__ = ["ExploredArea"]


class ExploredArea:
    """The cells that the robot's centre may enter, from one motion map.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map's cells lie.
    motion_risk : array_like, shape (H, W)
        M_m, not augmented.
    beta : float
        Largest augmented motion risk of a cell that may be entered.
    robot_radius : float
        Radius of the body [m].
    augmentation : {"square", "disc"}
        Footprint of the body.
    robot : Pose2, optional
        Where the robot is. What its body covers is free, whatever the map says: obstacles
        closer than the sonars can measure let the belief of empty fade even there, and the
        robot would be trapped by a cell that it stands on.

    Raises
    ------
    ValueError
        If shape or values of the map are wrong.
    """

    def __init__(
        self,
        geometry: GridGeometry,
        motion_risk: ArrayLike,
        beta: float,
        robot_radius: float,
        augmentation: str,
        robot: Pose2 | None = None,
    ) -> None:
        if np.shape(motion_risk) != geometry.shape:
            raise ValueError(
                f"the motion map has {np.shape(motion_risk)} (rows, columns), but its geometry "
                f"has {geometry.shape}"
            )
        self.geometry = geometry
        if robot is not None:
            motion_risk = _without_body(geometry, motion_risk, robot, robot_radius)
        # "To account for the actual robot dimensions": paper, section IV-B.
        risk = augment(motion_risk, robot_radius, geometry.resolution, augmentation)
        self._cells = beta_cut(risk, beta)

    @property
    def cells(self) -> NDArray[np.bool_]:
        """The cells that the robot's centre may enter, shape (H, W)."""
        return self._cells

    def holds(self, x: float, y: float) -> bool:
        """Tell whether the robot's centre may enter the cell that holds a point (x, y) [m]."""
        return self.geometry.contains(x, y) and bool(self._cells[self.geometry.cell_of(x, y)])

    def reach(self, path: NDArray[np.float64], at: int = 0) -> int:
        """Return the index of the last point of a path that the robot may drive to.

        Parameters
        ----------
        path : ndarray of float64, shape (n, 2)
            Centres (x, y) of the path's cells [m].
        at : int
            Index of the cell where the robot is; it and those before are exempt.
        """
        cells, inside = self.geometry.cells_of(path[at + 1 :])
        # Indices of points outside the map are -1: whatever they find does not count.
        allowed = inside & self._cells[cells[:, 0], cells[:, 1]]
        return len(path) - 1 if allowed.all() else at + int(np.argmin(allowed))


def _without_body(
    geometry: GridGeometry, motion_risk: ArrayLike, robot: Pose2, radius: float
) -> NDArray[np.float64]:
    """Return the map with no risk in the cells that lie wholly under the body."""
    risk = np.array(motion_risk, dtype=np.float64)
    window = geometry.window(robot.x, robot.y, radius)
    x, y = geometry.centres(window)
    half = 0.5 * geometry.resolution
    farthest = np.hypot(np.abs(x - robot.x)[None, :] + half, np.abs(y - robot.y)[:, None] + half)
    risk[window.slices][farthest <= radius] = 0.0
    return risk
