# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A grid path rounded, within a bound, so that a robot can drive it without stopping.

Paths from cell to cell are zigzags of steps in eight directions. Each corner is first cut by a
chord between two points on its legs: the chords of a staircase are collinear, so that it becomes
a straight line. A moving average along the path then turns what corners are left into curves.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["SmoothPath", "smooth_path"]

Floats = NDArray[np.float64]

#: A corner sharper than this [rad] is not rounded: the robot stops there and turns.
SHARPEST = math.radians(100.0)
#: Largest distance between samples [m].
SPACING = 0.005
#: Parts of the largest deviation that the chords and the moving average use; what is left, the
#: robot's own error does.
CHORD_PART = 0.55
AVERAGE_PART = 1.2
#: How much farther than elsewhere a chord may reach at the ends of a leg.
END_REACH = 1.5


@dataclass(frozen=True)
class Leg:
    """A curve that is driven without a stop, sampled in order.

    Parameters
    ----------
    s : ndarray of float64, shape (n,)
        Distance along the whole path [m].
    xy : ndarray of float64, shape (n, 2)
        Positions [m].
    heading : ndarray of float64, shape (n,)
        Direction of the tangent [rad], without jumps of a full turn.
    curvature : ndarray of float64, shape (n,)
        Change of the heading by distance [rad/m].
    """

    s: Floats
    xy: Floats
    heading: Floats
    curvature: Floats


@dataclass(frozen=True)
class SmoothPath:
    """Legs that follow each other, and where along them each given point is passed.

    Parameters
    ----------
    legs : tuple of Leg
        None for a path of no length.
    vertex_s : ndarray of float64, shape (n,)
        Distance [m] along the path at which each given point is passed.
    """

    legs: tuple[Leg, ...]
    vertex_s: Floats

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.legs[-1].s[-1]) if self.legs else 0.0


def smooth_path(points: ArrayLike, max_deviation: float) -> SmoothPath:
    """Round the corners of a polyline.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Positions (x, y) [m].
    max_deviation : float
        Largest distance between the curve and the polyline [m].

    Returns
    -------
    SmoothPath
        Ends exactly at the last point and starts at the first.

    Raises
    ------
    ValueError
        If there is no point, or one is not finite.
    """
    given = np.asarray(points, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] != 2 or len(given) == 0:
        raise ValueError(f"a path is an array of shape (n, 2) with n > 0, got shape {given.shape}")
    if not np.isfinite(given).all():
        raise ValueError("a path's points must be finite")
    steps = np.hypot(*np.diff(given, axis=0).T)
    keep = np.concatenate(([True], steps > 1e-9))
    corners = given[keep]
    vertex_t = np.concatenate(([0.0], np.cumsum(steps)))
    if len(corners) == 1:
        return SmoothPath((), np.zeros(len(given)))
    knots = vertex_t[keep]
    deflection = _deflections(corners)
    stops = [0, *(np.flatnonzero(deflection > SHARPEST) + 1), len(corners) - 1]
    legs: list[Leg] = []
    vertex_s = np.zeros(len(given))
    s0 = 0.0
    for first, last in itertools.pairwise(stops):
        leg, t = _smooth_leg(
            corners[first : last + 1],
            knots[first : last + 1],
            deflection[first : last - 1],
            max_deviation,
            s0,
        )
        inside = (vertex_t >= knots[first]) & (vertex_t <= knots[last])
        vertex_s[inside] = np.interp(vertex_t[inside], t, leg.s)
        legs.append(leg)
        s0 = float(leg.s[-1])
    return SmoothPath(tuple(legs), vertex_s)


def _deflections(corners: Floats) -> Floats:
    """Return by how much [rad] the direction changes at each inner corner."""
    d = np.diff(corners, axis=0)
    cross = d[:-1, 0] * d[1:, 1] - d[:-1, 1] * d[1:, 0]
    dot = (d[:-1] * d[1:]).sum(axis=1)
    angle: Floats = np.abs(np.arctan2(cross, dot))
    return angle


def _smooth_leg(
    corners: Floats, knots: Floats, deflection: Floats, max_deviation: float, s0: float
) -> tuple[Leg, Floats]:
    """Round one leg; return it and the polyline's own parameter of its samples."""
    t_cut, cut = _cut_corners(corners, knots, deflection, CHORD_PART * max_deviation)
    count = max(3, math.ceil((knots[-1] - knots[0]) / SPACING) + 1)
    t = np.linspace(knots[0], knots[-1], count)
    xy = np.column_stack([np.interp(t, t_cut, cut[:, k]) for k in (0, 1)])
    half_width = round(AVERAGE_PART * max_deviation / float(t[1] - t[0]))
    # Twice: the first average leaves a curvature that jumps, the second one that changes evenly.
    xy = _moving_average(_moving_average(xy, half_width), half_width)
    d = np.diff(xy, axis=0)
    step = np.hypot(d[:, 0], d[:, 1])
    s = s0 + np.concatenate(([0.0], np.cumsum(step)))
    chord = np.unwrap(np.arctan2(d[:, 1], d[:, 0]))
    middle = 0.5 * (s[:-1] + s[1:])
    heading = np.interp(s, middle, chord)
    curvature = np.gradient(heading, s)
    return Leg(s, xy, heading, curvature), t


def _cut_corners(
    corners: Floats, knots: Floats, deflection: Floats, depth: float
) -> tuple[Floats, Floats]:
    """Replace each inner corner by the chord between two points on its legs.

    The chord leaves the corner at most `depth` [m] aside, half as much more next to the ends, and
    takes at most half of each leg between two corners.
    """
    if len(corners) == 2:
        return knots, corners
    lengths = np.diff(knots)
    # The corner is reach * sin(deflection / 2) off the chord of an isosceles triangle.
    reach = depth / np.maximum(np.sin(0.5 * deflection), 1e-3)
    before = np.minimum(reach, 0.5 * lengths[:-1])
    after = np.minimum(reach, 0.5 * lengths[1:])
    # At its ends a leg has no other corner and any direction: no short piece is left there.
    if lengths[0] <= END_REACH * reach[0]:
        before[0] = lengths[0]
    if lengths[-1] <= END_REACH * reach[-1]:
        after[-1] = lengths[-1]
    unit = np.diff(corners, axis=0) / lengths[:, None]
    inner = corners[1:-1]
    points = np.empty((2 * len(inner) + 2, 2))
    t = np.empty(len(points))
    points[0], points[-1] = corners[0], corners[-1]
    t[0], t[-1] = knots[0], knots[-1]
    points[1:-1:2] = inner - before[:, None] * unit[:-1]
    points[2:-1:2] = inner + after[:, None] * unit[1:]
    t[1:-1:2] = knots[1:-1] - before
    t[2:-1:2] = knots[1:-1] + after
    return t, points


def _moving_average(xy: Floats, half_width: int) -> Floats:
    """Average evenly spaced samples over a window that shrinks towards both ends."""
    i = np.arange(len(xy))
    width = np.minimum(half_width, np.minimum(i, len(xy) - 1 - i))
    total = np.concatenate((np.zeros((1, 2)), np.cumsum(xy - xy[0], axis=0)))
    mean: Floats = (total[i + width + 1] - total[i - width]) / (2 * width + 1)[:, None] + xy[0]
    mean[0], mean[-1] = xy[0], xy[-1]
    return mean
