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
from fuzzy_navigation.clearance import clearance_at

__all__ = ["band", "bent_least", "roomy_band"]

#: Steps of the method: 100 lower the energy by 2 % more.
STEPS = 50
#: Largest eigenvalue of the fourth difference.
STIFFNESS = 16.0


#: How often a point that lost room is tried with a smaller tolerance, smaller by what factor,
#: and which loss is none [m].
TRIALS, SMALLER, LOSS = 5, 0.4, 0.002


def roomy_band(
    way: NDArray[np.float64],
    pose: Pose2 | None,
    hits: NDArray[np.float64],
    robot_radius: float,
    enough: float,
    spacing: float,
) -> NDArray[np.float64]:
    """Return a way that is bent less and leaves no less room, up to where there is enough.

    Parameters
    ----------
    way, pose, spacing
        As `band` takes them; a point is moved by half the spacing at most.
    hits : ndarray of float64, shape (m, 2)
        Hit points (x, y) [m].
    robot_radius : float
        Radius of the body [m].
    enough : float
        Clearance beyond which more is no better [m].

    Returns
    -------
    ndarray of float64, shape (n, 2)
    """
    clearances = clearance_at(way, hits, robot_radius)
    kept = np.minimum(clearances, enough) - LOSS
    safe = np.clip(clearances - enough, 0.0, 0.5 * spacing)
    tolerance = np.full(len(way), 0.5 * spacing)
    for _ in range(TRIALS):
        bent = band(way, pose, tolerance, spacing)
        lost = clearance_at(bent, hits, robot_radius) < kept
        if not lost.any():
            return bent
        tolerance = np.where(lost, np.maximum(SMALLER * tolerance, safe), tolerance)
    return band(way, pose, safe, spacing)


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
