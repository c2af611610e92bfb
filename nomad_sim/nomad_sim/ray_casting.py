# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Rays, distances and crossings on arrays of segments and circles: compiled loops.

Circles are exact, not polygons of many sides: a surface that curves has no corners that
could echo, its angle of incidence changes without steps, and one circle costs less than
the sides that would replace it.

Surfaces are numbered: first the segments, then the circles.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit

__all__ = [
    "NO_SURFACE",
    "TOUCHING",
    "cast_rays",
    "crossings",
    "hits",
    "in_polygon",
    "inside",
    "meet_segments",
    "nearest",
    "nearest_distance",
]

FloatArray = NDArray[np.float64]

#: Number of the surface where a ray meets none.
NO_SURFACE = -1
#: A sensor that touches a surface, or is behind it by rounding, still sees it [m].
TOUCHING = -1e-6

# Share of a segment by which it counts as longer, so that no ray slips through a joint.
_JOINT = 1e-12


@njit
def hits(
    x: float,
    y: float,
    ux: float,
    uy: float,
    t_min: float,
    t_max: float,
    segments: FloatArray,
    i: int,
) -> float:
    """Return where a ray meets a segment, ``inf`` where that is not between two ways.

    Parameters
    ----------
    x, y, ux, uy : float
        Start [m] and direction of the ray, of length 1.
    t_min, t_max : float
        Ways [m] between which it counts, themselves excluded.
    segments : ndarray of float64, shape (N, 4)
        End points x0, y0, x1, y1 [m].
    i : int
        Number of the segment.
    """
    x0 = segments[i, 0]
    y0 = segments[i, 1]
    ex = segments[i, 2] - x0
    ey = segments[i, 3] - y0
    denominator = ux * ey - uy * ex
    if denominator == 0.0:
        return math.inf
    qx = x0 - x
    qy = y0 - y
    t = (qx * ey - qy * ex) / denominator
    if t <= t_min or t >= t_max:
        return math.inf
    w = (qx * uy - qy * ux) / denominator
    return t if -_JOINT <= w <= 1.0 + _JOINT else math.inf


@njit
def nearest(
    x: float,
    y: float,
    ux: float,
    uy: float,
    t_min: float,
    skip: int,
    segments: FloatArray,
    circles: FloatArray,
) -> tuple[float, int]:
    """Return where a ray first meets a surface.

    Parameters
    ----------
    x, y : float
        Start of the ray [m].
    ux, uy : float
        Its direction, of length 1.
    t_min : float
        Surfaces nearer than this are not seen [m].
    skip : int
        Number of a surface that is not seen, or `NO_SURFACE`.
    segments : ndarray of float64, shape (N, 4)
        End points x0, y0, x1, y1 [m].
    circles : ndarray of float64, shape (M, 3)
        Centre and radius [m]. They are seen from outside only.

    Returns
    -------
    distance : float
        Way to the surface [m], ``inf`` when there is none.
    surface : int
        Its number.
    """
    best = math.inf
    surface = NO_SURFACE
    for i in range(segments.shape[0]):
        if i == skip:
            continue
        t = hits(x, y, ux, uy, t_min, best, segments, i)
        if t < best:
            best = t
            surface = i
    for j in range(circles.shape[0]):
        if segments.shape[0] + j == skip:
            continue
        qx = circles[j, 0] - x
        qy = circles[j, 1] - y
        radius = circles[j, 2]
        along = qx * ux + qy * uy
        across = qx * uy - qy * ux
        square = radius * radius - across * across
        if square < 0.0:
            continue
        t = along - math.sqrt(square)
        if t_min < t < best:
            best = t
            surface = segments.shape[0] + j
    return best, surface


@njit
def cast_rays(
    starts: FloatArray, directions: FloatArray, segments: FloatArray, circles: FloatArray
) -> FloatArray:
    """Return the way along each ray to the first surface.

    Parameters
    ----------
    starts, directions : ndarray of float64, shape (R, 2)
        Starts [m] and unit vectors.
    segments, circles : ndarray of float64, shapes (N, 4) and (M, 3)
        As for `nearest`.

    Returns
    -------
    ndarray of float64, shape (R,)
        Ways [m], ``inf`` where a ray meets nothing.
    """
    ranges = np.empty(starts.shape[0])
    for r in range(starts.shape[0]):
        ranges[r], _ = nearest(
            starts[r, 0],
            starts[r, 1],
            directions[r, 0],
            directions[r, 1],
            TOUCHING,
            NO_SURFACE,
            segments,
            circles,
        )
        ranges[r] = max(ranges[r], 0.0)
    return ranges


@njit
def in_polygon(x: float, y: float, segments: FloatArray, first: int, last: int) -> bool:
    """Whether a point lies in the polygon of the segments from `first` to the one before `last`.

    Parameters
    ----------
    x, y : float
        The point [m].
    segments : ndarray of float64, shape (N, 4)
        End points [m].
    first, last : int
        Half open [first, last).
    """
    odd = False
    for i in range(first, last):
        y0 = segments[i, 1]
        y1 = segments[i, 3]
        if (y0 > y) != (y1 > y):
            x0 = segments[i, 0]
            if x < x0 + (y - y0) / (y1 - y0) * (segments[i, 2] - x0):
                odd = not odd
    return odd


@njit
def inside(x: float, y: float, segments: FloatArray, solids: NDArray[np.int64]) -> bool:
    """Whether a point lies in a solid polygon.

    Parameters
    ----------
    x, y : float
        The point [m].
    segments : ndarray of float64, shape (N, 4)
        End points [m].
    solids : ndarray of int64, shape (S, 2)
        First and past-the-last segment of each polygon.
    """
    for s in range(solids.shape[0]):
        if in_polygon(x, y, segments, solids[s, 0], solids[s, 1]):
            return True
    return False


@njit
def nearest_distance(
    x: float, y: float, segments: FloatArray, circles: FloatArray, solids: NDArray[np.int64]
) -> float:
    """Return the distance [m] from a point to the nearest surface, negative inside an obstacle.

    Parameters
    ----------
    x, y : float
        The point [m].
    segments, circles, solids : ndarray
        As for `nearest` and `inside`.
    """
    square = math.inf
    for i in range(segments.shape[0]):
        x0 = segments[i, 0]
        y0 = segments[i, 1]
        ex = segments[i, 2] - x0
        ey = segments[i, 3] - y0
        qx = x - x0
        qy = y - y0
        w = (qx * ex + qy * ey) / (ex * ex + ey * ey)
        w = min(1.0, max(0.0, w))
        dx = qx - w * ex
        dy = qy - w * ey
        square = min(square, dx * dx + dy * dy)
    distance = math.sqrt(square)
    if inside(x, y, segments, solids):
        distance = -distance
    for j in range(circles.shape[0]):
        gap = math.hypot(x - circles[j, 0], y - circles[j, 1]) - circles[j, 2]
        distance = min(distance, gap)
    return distance


@njit
def meet_segments(p: FloatArray, q: FloatArray, found: FloatArray) -> int:
    """Find where two segments cross in their interior; return how often: 0 or 1."""
    ex, ey = p[2] - p[0], p[3] - p[1]
    fx, fy = q[2] - q[0], q[3] - q[1]
    denominator = ex * fy - ey * fx
    if denominator == 0.0:
        return 0
    dx, dy = q[0] - p[0], q[1] - p[1]
    t = (dx * fy - dy * fx) / denominator
    w = (dx * ey - dy * ex) / denominator
    # Strictly inside both: an end that touches is an end and known already.
    if not (1e-9 < t < 1.0 - 1e-9 and 1e-9 < w < 1.0 - 1e-9):
        return 0
    found[0, 0] = p[0] + t * ex
    found[0, 1] = p[1] + t * ey
    return 1


@njit
def _meet_circle(p: FloatArray, c: FloatArray, found: FloatArray) -> int:
    ex, ey = p[2] - p[0], p[3] - p[1]
    length = math.hypot(ex, ey)
    dx, dy = c[0] - p[0], c[1] - p[1]
    foot = (dx * ex + dy * ey) / length
    across = (dx * ey - dy * ex) / length
    square = c[2] * c[2] - across * across
    if square <= 0.0:
        return 0
    half = math.sqrt(square)
    number = 0
    for t in ((foot - half) / length, (foot + half) / length):
        if 0.0 <= t <= 1.0:
            found[number, 0] = p[0] + t * ex
            found[number, 1] = p[1] + t * ey
            number += 1
    return number


@njit
def _meet_circles(b: FloatArray, c: FloatArray, found: FloatArray) -> int:
    dx, dy = c[0] - b[0], c[1] - b[1]
    d = math.hypot(dx, dy)
    if not abs(b[2] - c[2]) < d < b[2] + c[2]:
        return 0
    along = (d * d + b[2] * b[2] - c[2] * c[2]) / (2.0 * d)
    across = math.sqrt(max(0.0, b[2] * b[2] - along * along))
    for k in range(2):
        sign = 2.0 * k - 1.0
        found[k, 0] = b[0] + (along * dx - sign * across * dy) / d
        found[k, 1] = b[1] + (along * dy + sign * across * dx) / d
    return 2


@njit
def crossings(
    segments: FloatArray,
    circles: FloatArray,
    first_segment: int,
    first_circle: int,
    points: FloatArray,
) -> int:
    """Find where surfaces cross each other in their interior.

    Parameters
    ----------
    segments, circles : ndarray of float64, shapes (N, 4) and (M, 3)
        As for `nearest`.
    first_segment, first_circle : int
        Pairs of a segment and a circle both before these are left out: they are known.
    points : ndarray of float64, shape (P, 2)
        Receives the crossings [m] in its first rows, as far as there is room.

    Returns
    -------
    int
        Number of crossings; more than P when the room did not suffice.
    """
    found = np.empty((2, 2))
    count = 0
    n = segments.shape[0]
    m = n + circles.shape[0]
    for i in range(m):
        known = i < first_segment or n <= i < n + first_circle
        for j in range(max(i + 1, first_segment if known else 0), m):
            if known and n <= j < n + first_circle:
                continue
            if j < n:
                number = meet_segments(segments[i], segments[j], found)
            elif i < n:
                number = _meet_circle(segments[i], circles[j - n], found)
            else:
                number = _meet_circles(circles[i - n], circles[j - n], found)
            for k in range(number):
                if count < points.shape[0]:
                    points[count, 0] = found[k, 0]
                    points[count, 1] = found[k, 1]
                count += 1
    return count
