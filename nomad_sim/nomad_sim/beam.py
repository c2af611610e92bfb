# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A sonar's beam among surfaces, cut where the nearest surface can change: compiled loops.

Between two neighbouring directions in which something ends (an end of a segment, a
crossing, the border of a circle) the nearest surface is one and the same: a ray through
the middle of the piece finds it for all of the piece.

A beam starts at a source, the sonar's face or its mirror image in a segment, and sees only
what lies behind that mirror.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from nomad_sim.ray_casting import TOUCHING, nearest

__all__ = ["NARROW", "cut", "first_surface", "foot", "push_image", "sees", "stack_of", "wrapped"]

FloatArray = NDArray[np.float64]

# Pieces of a beam narrower than this [rad] are lines between two others.
NARROW = 1e-9
# What ends at a point [m] does not hide the point.
_TOUCH = 1e-7
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
def first_surface(
    x: float,
    y: float,
    angle: float,
    mirror: int,
    body: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
) -> tuple[float, int]:
    """Return way and number of the first surface in a beam; the robot's own body is -2."""
    ux = math.cos(angle)
    uy = math.sin(angle)
    start = _behind(x, y, angle, mirror, segments)
    t, surface = nearest(x, y, ux, uy, start, mirror, segments, circles)
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
) -> bool:
    """Whether nothing but the mirror stands between the source of a beam and a point."""
    angle = math.atan2(py - y, px - x)
    distance = math.hypot(px - x, py - y)
    if mirror >= 0 and distance <= _behind(x, y, angle, mirror, segments) + _TOUCH:
        return False
    t, _ = first_surface(x, y, angle, mirror, body, segments, circles)
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
    for k in range(marks.shape[0]):
        dx = marks[k, 0] - x
        dy = marks[k, 1] - y
        along = dx * ux + dy * uy
        if along <= 0.0:
            continue
        angle = math.atan2(ux * dy - uy * dx, along)
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
