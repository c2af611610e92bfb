# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the robot may go because it knows the place: the beta-cut of the motion map.

Paper, section IV-B, stop condition 1: the robot is leaving the explored area.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.cost_field import HUNDREDTHS
from fuzzy_navigation.risk import Footprint, beta_cut, changed_window, checked_risk

__all__ = ["ExploredArea"]

_NOWHERE = Window(0, 0, 0, 0)


class ExploredArea:
    """The cells that the robot's centre may enter, from a motion map.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map's cells lie.
    motion_risk : array_like or Hundredths, shape (H, W)
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
        motion_risk: ArrayLike | Hundredths,
        beta: float,
        robot_radius: float,
        augmentation: str,
        robot: Pose2 | None = None,
    ) -> None:
        self.geometry = geometry
        shape = np.shape(motion_risk.codes if isinstance(motion_risk, Hundredths) else motion_risk)
        self._check_shape(shape)
        self._radius = robot_radius
        self._footprint = Footprint.of(
            robot_radius, geometry.resolution, augmentation, geometry.shape
        )
        self._codes: NDArray[np.int8] | None = None
        self._body = _NOWHERE
        self._cells = np.empty(shape, dtype=np.bool_)
        # The largest code of a cell that may be entered; -1: none may be.
        self._limit = np.count_nonzero(beta_cut(HUNDREDTHS, beta)) - 1
        if isinstance(motion_risk, Hundredths):
            self._codes = motion_risk.codes.copy()
            self._judge([Window(0, geometry.height, 0, geometry.width)], robot)
            return
        risk = checked_risk(motion_risk, "the motion map").copy()
        body, covered = self._under(robot)
        risk[body.slices][covered] = 0.0
        # "To account for the actual robot dimensions": paper, section IV-B.
        self._cells = beta_cut(self._footprint.largest(risk, np.float64(1.0)), beta)

    @property
    def coded(self) -> bool:
        """Whether the motion map came in hundredths."""
        return self._codes is not None

    @property
    def codes(self) -> Hundredths | None:
        """The motion map in hundredths; None if it did not come so."""
        return None if self._codes is None else Hundredths(self._codes)

    @property
    def cells(self) -> NDArray[np.bool_]:
        """The cells that the robot's centre may enter, shape (H, W)."""
        return self._cells

    def renew(self, motion_risk: Hundredths, robot: Pose2 | None) -> None:
        """Take a new map of the same cells; the one before was in hundredths as well.

        Parameters
        ----------
        motion_risk, robot
            As the constructor takes them.

        Raises
        ------
        ValueError
            If the shape is wrong; the map before stays.
        """
        assert self._codes is not None
        self._check_shape(motion_risk.codes.shape)
        window = changed_window(self._codes, motion_risk.codes)
        self._codes[window.slices] = motion_risk.codes[window.slices]
        self._judge([window], robot)

    def update(self, motion_risk: Hundredths, window: Window, robot: Pose2 | None) -> None:
        """Take what is new in a map; what that costs depends on the window, not on the map.

        Parameters
        ----------
        motion_risk : Hundredths, shape (h, w)
            M_m in the window, not augmented.
        window : Window
            The only cells that differ from the map before.
        robot : Pose2, optional
            As the constructor takes it.

        Raises
        ------
        ValueError
            If the map before was not in hundredths, or shape or window are wrong; it stays.
        """
        height, width = self.geometry.shape
        rows, columns = (window.row0, window.row1, height), (window.col0, window.col1, width)
        if not all(0 <= first < last <= end for first, last, end in (rows, columns)):
            raise ValueError(f"{window} is no part of a map of {height} rows, {width} columns")
        if motion_risk.codes.shape != window.shape:
            raise ValueError(
                f"the window of the motion map has {motion_risk.codes.shape} (rows, columns), "
                f"but {window} has {window.shape}"
            )
        if self._codes is None:
            raise ValueError("windows in hundredths take a map in hundredths")
        self._codes[window.slices] = motion_risk.codes
        self._judge([window], robot)

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

    def _check_shape(self, shape: tuple[int, ...]) -> None:
        if shape != self.geometry.shape:
            raise ValueError(
                f"the motion map has {shape} (rows, columns), but its geometry "
                f"has {self.geometry.shape}"
            )

    def _judge(self, changed: Sequence[Window], robot: Pose2 | None) -> None:
        """Find anew which cells may be entered, where the map has changed and under the robot."""
        assert self._codes is not None
        before = self._body
        self._body, covered = self._under(robot)
        under = self._codes[self._body.slices]
        kept = under[covered]
        under[covered] = 0
        for window in (*changed, before, self._body):
            if not window.empty:
                touched = self._footprint.grown(window, self._codes.shape)
                # "To account for the actual robot dimensions": paper, section IV-B.
                worst = self._footprint.largest_in(self._codes, np.int8(100), touched)
                self._cells[touched.slices] = worst <= self._limit
        under[covered] = kept

    def _under(self, robot: Pose2 | None) -> tuple[Window, NDArray[np.bool_]]:
        """Return a window around the body, and which of its cells lie wholly under it."""
        if robot is None:
            return _NOWHERE, np.empty((0, 0), dtype=np.bool_)
        window = self.geometry.window(robot.x, robot.y, self._radius)
        x, y = self.geometry.centres(window)
        half = 0.5 * self.geometry.resolution
        dx, dy = np.abs(x - robot.x) + half, np.abs(y - robot.y) + half
        return window, np.hypot(dx[None, :], dy[:, None]) <= self._radius
