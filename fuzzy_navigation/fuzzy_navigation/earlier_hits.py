# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What was measured near the robot before it looked anew, until an echo confirms it.

A robot that looks again from beside the end of a thin wall sees the end no more, for its
infrareds miss it from there. The echo from there is too close to measure: without what was
measured on the way there it would have to be taken for something that touches the body by now.
As it may also have gone since, it is no hit before such an echo tells that something is as close.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.sensor_params import SonarParameters
from fuzzy_map_building.sonar_guard import TOUCH_SLACK
from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.hit_memory import RASTER

__all__ = ["EarlierHits"]

Points = NDArray[np.float64]


class EarlierHits:
    """Points that were hits at the looks before, and are near."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Forget all of them."""
        self._points: Points = np.empty((0, 2))

    def keep(self, points: Points, place: Pose2, recall: float) -> None:
        """Add what a robot that looks anew from a place had measured before.

        Parameters
        ----------
        points : ndarray of float64, shape (n, 2)
            Points (x, y) [m].
        place : Pose2
            Where the robot is.
        recall : float
            Points farther from there are forgotten [m], those of before as well.
        """
        all_points = np.vstack([self._points, points])
        near = np.hypot(all_points[:, 0] - place.x, all_points[:, 1] - place.y) < recall
        # Points of one cell of the raster are one, which bounds the memory.
        cells = np.round(all_points[near] / RASTER).astype(np.int64)
        self._points = all_points[near][np.unique(cells, axis=0, return_index=True)[1]]

    def confirmed(
        self, echoes: Sequence[SonarReading], sonar: SonarParameters, angle: float
    ) -> Points:
        """Return the points from which echoes too close to measure may come.

        Parameters
        ----------
        echoes : sequence of SonarReading
            Readings, each placed at its own pose; those of -inf count.
        sonar : SonarParameters
            Their ring.
        angle : float
            How far off an echo's axis such a point may lie [rad].

        Returns
        -------
        ndarray of float64, shape (n, 2)
            Points (x, y) [m] no farther from the sonar than its least range and `TOUCH_SLACK`.
        """
        reach = sonar.mount_radius + sonar.min_range + TOUCH_SLACK
        there = np.zeros(len(self._points), dtype=np.bool_)
        for echo in echoes:
            if echo.range == -math.inf:
                away = self._points - (echo.pose.x, echo.pose.y)
                axis = echo.pose.theta + echo.bearing
                along = away[:, 0] * math.cos(axis) + away[:, 1] * math.sin(axis)
                distance = np.hypot(away[:, 0], away[:, 1])
                there |= (along >= math.cos(angle) * distance) & (distance <= reach)
        return self._points[there]
