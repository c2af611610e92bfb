# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A path of cells bent as little as its cells allow, for a robot that drives without a stop.

A path from cell to cell takes a direction between two of its eight by steps of both, and the
places in its cells that leave most room lie now on this side, now on that. Each bend costs speed.
As in the elastic bands of Quinlan and Khatib (1993) the path is made smooth under constraints:
of all points that stay within a tolerance of those given, those with the least sum of squared
second differences (the bending energy of a thin rod) are approached by Nesterov's accelerated
gradient method with projection.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2

__all__ = ["band", "bent_least"]

#: Steps of the method: 100 lower the energy by 2 % more.
STEPS = 50
#: Largest eigenvalue of the fourth difference.
STIFFNESS = 16.0


def band(
    way: NDArray[np.float64],
    pose: Pose2 | None,
    tolerance: NDArray[np.float64],
    spacing: float,
) -> NDArray[np.float64]:
    """Return a way that is bent less and keeps its ends.

    Parameters
    ----------
    way : ndarray of float64, shape (n, 2)
        Points (x, y) [m].
    pose : Pose2, optional
        Where a robot that moves is, at the first point: the way begins in the direction that it
        drives in. None: it turns on the spot first.
    tolerance : ndarray of float64, shape (n,)
        How far each point between the ends may be moved [m].
    spacing : float
        About the distance of two points [m].

    Returns
    -------
    ndarray of float64, shape (n, 2)
    """
    within = tolerance.copy()
    within[[0, -1]] = 0.0
    if pose is None:
        return bent_least(way, within)
    behind = pose.x - spacing * math.cos(pose.theta), pose.y - spacing * math.sin(pose.theta)
    return bent_least(np.vstack([behind, way]), np.concatenate(([0.0], within)))[1:]


def bent_least(points: NDArray[np.float64], tolerance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points that are bent less.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Points (x, y) [m] at about equal distances.
    tolerance : ndarray of float64, shape (n,)
        How far each may be moved [m]; 0: not at all.

    Returns
    -------
    ndarray of float64, shape (n, 2)
    """
    bent = points.copy()
    if len(points) < 3:
        return bent
    ahead, momentum = bent, 1.0
    for _ in range(STEPS):
        second = ahead[:-2] - 2.0 * ahead[1:-1] + ahead[2:]
        gradient = np.zeros_like(ahead)
        gradient[:-2] += second
        gradient[1:-1] -= 2.0 * second
        gradient[2:] += second
        moved = ahead - gradient / STIFFNESS - points
        off = np.hypot(moved[:, 0], moved[:, 1])
        share = np.minimum(1.0, tolerance / np.maximum(off, 1e-12))
        before, bent = bent, points + moved * share[:, None]
        last, momentum = momentum, 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * momentum * momentum))
        ahead = bent + (last - 1.0) / momentum * (bent - before)
    return bent
