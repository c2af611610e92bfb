# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A sonar's beam among surfaces, cut where the nearest surface can change: compiled loops.

Between two neighbouring directions in which something ends (an end of a segment, a
crossing, the border of a circle) the nearest surface is one and the same: a ray through
the middle of the piece finds it for all of the piece.

A beam starts at a source, the sonar's face or its mirror image in a segment, and sees only
what lies behind that mirror. Most segments, ends and edges lie beside it: they are left out
by a few products before anything is computed of them.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from nomad_sim.ray_casting import NO_SURFACE, TOUCHING, hits, nearest

__all__ = [
    "NARROW",
    "beside",
    "cut",
    "first_surface",
    "foot",
    "push_image",
    "sees",
    "stack_of",
    "within",
    "wrapped",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Pieces of a beam narrower than this [rad] are lines between two others.
NARROW = 1e-9
# What ends at a point [m] does not hide the point.
_TOUCH = 1e-7
# What lies this far beside a beam [m] is not left out: more than a ray starts behind its
# source, and more than rounding.
_SLACK = 1e-5
# Columns of a beam: its source, its axis, first and last angle from it, mirror, depth, and
# the way to the nearest point of its mirror.
_COLUMNS = 8


@njit
def wrapped(angle: float) -> float:
    """Return an angle [rad] brought into [-pi, pi)."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@njit
def foot(x: float, y: float, s: FloatArray) -> tuple[float, float]:
    """Return distance [m] and direction [rad] of the perpendicular from a point to a line."""
    ex = s[2] - s[0]
    ey = s[3] - s[1]
    length = math.hypot(ex, ey)
    nx = ey / length
    ny = -ex / length
    d = (s[0] - x) * nx + (s[1] - y) * ny
    if d < 0.0:
        return -d, math.atan2(-ny, -nx)
    return d, math.atan2(ny, nx)


@njit
def _behind(x: float, y: float, angle: float, mirror: int, segments: FloatArray) -> float:
    """Return the way [m] from a source on which it sees nothing yet: up to its mirror."""
    if mirror < 0:
        return TOUCHING
    d, normal = foot(x, y, segments[mirror])
    return d / max(math.cos(angle - normal), 1e-12)


@njit
def beside(along: float, across: float, widest: float) -> bool:
    """Whether a point lies beside a beam, for certain, so that its angle need not be known.

    Parameters
    ----------
    along, across : float
        Where the point lies from the source, along the axis and to its left [m].
    widest : float
        Tangent of the larger of the angles between the axis and the borders.
    """
    return along <= 0.0 or abs(across) > widest * along + _SLACK


@njit
def within(
    x: float,
    y: float,
    axis: float,
    low: float,
    high: float,
    segments: FloatArray,
    numbers: IntArray,
) -> int:
    """Find the segments that rays of a beam narrower than a half plane can meet.

    Parameters
    ----------
    x, y : float
        Source of the beam [m].
    axis, low, high : float
        Direction of the beam, and its borders from there [rad].
    segments : ndarray of float64, shape (N, 4)
        As for `ray_casting.nearest`.
    numbers : ndarray of int64, shape (N,)
        Receives their numbers, in order; there may be some that no ray meets.

    Returns
    -------
    int
        How many there are.
    """
    ux, uy = math.cos(axis), math.sin(axis)
    right_x, right_y = math.cos(axis + low), math.sin(axis + low)
    left_x, left_y = math.cos(axis + high), math.sin(axis + high)
    count = 0
    for i in range(segments.shape[0]):
        ax, ay = segments[i, 0] - x, segments[i, 1] - y
        bx, by = segments[i, 2] - x, segments[i, 3] - y
        # Both ends behind the source, or both beyond the same border.
        if ux * ax + uy * ay < -_SLACK and ux * bx + uy * by < -_SLACK:
            continue
        if right_x * ay - right_y * ax < -_SLACK and right_x * by - right_y * bx < -_SLACK:
            continue
        if left_x * ay - left_y * ax > _SLACK and left_x * by - left_y * bx > _SLACK:
            continue
        numbers[count] = i
        count += 1
    return count


@njit
def first_surface(
    x: float,
    y: float,
    angle: float,
    mirror: int,
    body: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
    numbers: IntArray,
    count: int,
) -> tuple[float, int]:
    """Return way and number of the first surface on a ray; the robot's own body is -2.

    Parameters
    ----------
    x, y, angle : float
        Start [m] and direction [rad] of the ray.
    mirror : int
        The segment that the beam comes from, -1 without.
    body, segments, circles : ndarray
        As for `echo.echo_range`.
    numbers, count : ndarray of int64 and int
        The segments `within` the beam, and how many.
    """
    ux = math.cos(angle)
    uy = math.sin(angle)
    start = _behind(x, y, angle, mirror, segments)
    t = math.inf
    surface = NO_SURFACE
    for k in range(count):
        i = numbers[k]
        if i == mirror:
            continue
        way = hits(x, y, ux, uy, start, t, segments, i)
        if way < t:
            t = way
            surface = i
    if circles.shape[0] > 0:
        way, circle = nearest(x, y, ux, uy, start, NO_SURFACE, segments[:0], circles)
        if way < t:
            t = way
            surface = segments.shape[0] + circle
    if mirror >= 0 and body[2] > 0.0:
        qx = body[0] - x
        qy = body[1] - y
        across = qx * uy - qy * ux
        if abs(across) < body[2]:
            entry = qx * ux + qy * uy - math.sqrt(body[2] * body[2] - across * across)
            if start < entry < t:
                return entry, -2
    return t, surface


@njit
def sees(
    x: float,
    y: float,
    px: float,
    py: float,
    mirror: int,
    body: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
    numbers: IntArray,
    count: int,
) -> bool:
    """Whether nothing but the mirror stands between the source of a beam and a point in it."""
    angle = math.atan2(py - y, px - x)
    distance = math.hypot(px - x, py - y)
    if mirror >= 0 and distance <= _behind(x, y, angle, mirror, segments) + _TOUCH:
        return False
    t, _ = first_surface(x, y, angle, mirror, body, segments, circles, numbers, count)
    return t >= distance - _TOUCH


@njit
def cut(
    x: float,
    y: float,
    axis: float,
    low: float,
    high: float,
    body: FloatArray,
    circles: FloatArray,
    marks: FloatArray,
    cuts: FloatArray,
) -> int:
    """Fill in the sorted angles from the axis at which the nearest surface can change."""
    cuts[0] = low
    cuts[1] = high
    count = 2
    ux = math.cos(axis)
    uy = math.sin(axis)
    widest = math.tan(max(-low, high))
    for k in range(marks.shape[0]):
        dx = marks[k, 0] - x
        dy = marks[k, 1] - y
        along = dx * ux + dy * uy
        across = ux * dy - uy * dx
        if beside(along, across, widest):
            continue
        angle = math.atan2(across, along)
        if low < angle < high:
            cuts[count] = angle
            count += 1
    for j in range(circles.shape[0] + 1):
        if j < circles.shape[0]:
            dx = circles[j, 0] - x
            dy = circles[j, 1] - y
            radius = circles[j, 2]
        else:
            dx = body[0] - x
            dy = body[1] - y
            radius = body[2]
        distance = math.hypot(dx, dy)
        if distance <= radius or radius <= 0.0:
            continue
        centre = math.atan2(ux * dy - uy * dx, dx * ux + dy * uy)
        half = math.asin(radius / distance)
        for angle in (centre - half, centre + half):
            if low < angle < high:
                cuts[count] = angle
                count += 1
    cuts[:count].sort()
    return count


@njit
def push_image(
    beams: FloatArray,
    count: int,
    x: float,
    y: float,
    axis: float,
    low: float,
    high: float,
    mirror: int,
    depth: int,
    segments: FloatArray,
) -> int:
    """Put the mirror image of a piece of a beam on the stack; return its new height."""
    if high - low < NARROW:
        return count
    d, normal = foot(x, y, segments[mirror])
    middle = axis + 0.5 * (low + high)
    beams[count, 0] = x + 2.0 * d * math.cos(normal)
    beams[count, 1] = y + 2.0 * d * math.sin(normal)
    # Reflection about the line: a direction a becomes 2 (normal + 90 deg) - a.
    beams[count, 2] = 2.0 * normal + math.pi - middle
    beams[count, 3] = -0.5 * (high - low)
    beams[count, 4] = 0.5 * (high - low)
    beams[count, 5] = mirror
    beams[count, 6] = depth
    first = abs(wrapped(axis + low - normal))
    last = abs(wrapped(axis + high - normal))
    nearest_angle = min(first, last) if first + last > high - low + NARROW else 0.0
    beams[count, 7] = d / max(math.cos(nearest_angle), 1e-12)
    return count + 1


@njit
def stack_of(
    x: float, y: float, axis: float, half_angle: float, depth: int, pieces: int
) -> FloatArray:
    """Return a stack of beams, with room for two reflections a piece at each depth."""
    beams = np.empty((1 + depth * 2 * pieces, _COLUMNS))
    beams[0, 0] = x
    beams[0, 1] = y
    beams[0, 2] = axis
    beams[0, 3] = -half_angle
    beams[0, 4] = half_angle
    beams[0, 5] = -1.0
    beams[0, 6] = 0.0
    beams[0, 7] = 0.0
    return beams
