# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The shortest echo in a sonar's beam, exactly: compiled loops.

Between two neighbouring directions in which something ends (an end of a segment, a
crossing, the border of a circle) the nearest surface is one and the same. So the beam is
cut at these directions, one ray through the middle of each piece finds its surface, and
the shortest echo of that surface within the piece follows in closed form. Unlike a fan
of sample rays this misses no thin surface and has no error of its own.

A segment reflects what falls in beyond its critical angle like a mirror: the reflected
piece is a beam again, from the sonar's mirror image, that sees only what lies behind the
mirror. The way from the image is the whole way of the sound. Circles send sound that falls
in beyond their critical angle apart in all directions: it is lost.
"""

from __future__ import annotations

import math

import numpy as np
from fuzzy_map_building.jit import njit
from numpy.typing import NDArray

from nomad_sim.ray_casting import nearest

__all__ = ["crosstalk_range", "echo_range"]

FloatArray = NDArray[np.float64]

# Pieces of a beam narrower than this [rad] are lines between two others.
_NARROW = 1e-9
# What ends at a point [m] does not hide the point.
_TOUCH = 1e-7
# Columns of a beam: its source, its axis, first and last angle from it, mirror, depth.
_COLUMNS = 8


@njit
def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@njit
def _foot(x: float, y: float, s: FloatArray) -> tuple[float, float]:
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
    """Return the way [m] from a mirror image to its mirror, 0 for the sonar itself."""
    if mirror < 0:
        return 0.0
    d, normal = _foot(x, y, segments[mirror])
    return d / max(math.cos(angle - normal), 1e-12)


@njit
def _first(
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
def _visible(
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
    if distance <= _behind(x, y, angle, mirror, segments) + _TOUCH and mirror >= 0:
        return False
    t, _ = _first(x, y, angle, mirror, body, segments, circles)
    return t >= distance - _TOUCH


@njit
def _cuts(
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
def _image(
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
    if high - low < _NARROW:
        return count
    d, normal = _foot(x, y, segments[mirror])
    middle = axis + 0.5 * (low + high)
    beams[count, 0] = x + 2.0 * d * math.cos(normal)
    beams[count, 1] = y + 2.0 * d * math.sin(normal)
    # Reflection about the line: a direction a becomes 2 (normal + 90 deg) - a.
    beams[count, 2] = 2.0 * normal + math.pi - middle
    beams[count, 3] = -0.5 * (high - low)
    beams[count, 4] = 0.5 * (high - low)
    beams[count, 5] = mirror
    beams[count, 6] = depth
    return count + 1


@njit
def _stack(
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
    return beams


@njit
def echo_range(
    x: float,
    y: float,
    axis: float,
    half_angle: float,
    max_range: float,
    edge_echo: bool,
    reflections: int,
    body: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
    critical_angles: FloatArray,
    edges: FloatArray,
    marks: FloatArray,
) -> float:
    """Return the way [m] to what sends the first echo back, ``inf`` when none comes.

    An echo comes from every visible surface point inside the beam whose angle of
    incidence is at most the surface's critical angle, and from every visible edge.

    Parameters
    ----------
    x, y : float
        The sonar's face [m].
    axis, half_angle : float
        Direction of the beam and its half width [rad].
    max_range : float
        No echo from farther than this [m].
    edge_echo : bool
        Whether edges echo.
    reflections : int
        Most specular reflections on the way.
    body : ndarray of float64, shape (3,)
        Centre and radius of the robot itself [m], which reflected sound does not pass.
    segments, circles : ndarray of float64, shapes (N, 4) and (M, 3)
        Surfaces, as for `ray_casting.nearest`.
    critical_angles : ndarray of float64, shape (N + M,)
        [rad].
    edges, marks : ndarray of float64, shapes (K, 2) and (P, 2)
        What echoes in every direction and where the nearest surface can change [m].
    """
    n = segments.shape[0]
    room = marks.shape[0] + 2 * circles.shape[0] + 4
    cuts = np.empty(room)
    beams = _stack(x, y, axis, half_angle, reflections, room)
    count = 1
    best = max_range
    found = False
    while count > 0:
        count -= 1
        sx = beams[count, 0]
        sy = beams[count, 1]
        axis = beams[count, 2]
        low = beams[count, 3]
        high = beams[count, 4]
        mirror = int(beams[count, 5])
        depth = int(beams[count, 6])
        if edge_echo:
            ux = math.cos(axis)
            uy = math.sin(axis)
            for k in range(edges.shape[0]):
                dx = edges[k, 0] - sx
                dy = edges[k, 1] - sy
                along = dx * ux + dy * uy
                if along <= 0.0 or dx * dx + dy * dy >= best * best:
                    continue
                if not low <= math.atan2(ux * dy - uy * dx, along) <= high:
                    continue
                if _visible(sx, sy, edges[k, 0], edges[k, 1], mirror, body, segments, circles):
                    best = math.hypot(dx, dy)
                    found = True
        pieces = _cuts(sx, sy, axis, low, high, body, circles, marks, cuts)
        for p in range(pieces - 1):
            first = cuts[p]
            last = cuts[p + 1]
            if last - first < _NARROW:
                continue
            middle = 0.5 * (first + last)
            t, surface = _first(sx, sy, axis + middle, mirror, body, segments, circles)
            if surface < 0:
                continue
            critical = critical_angles[surface]
            if surface >= n:
                c = surface - n
                dx = circles[c, 0] - sx
                dy = circles[c, 1] - sy
                radius = circles[c, 2]
                distance = math.hypot(dx, dy)
                centre = middle + _wrapped(math.atan2(dy, dx) - axis - middle)
                beta = min(max(centre, first), last) - centre
                across = distance * abs(math.sin(beta))
                # Incidence i on a circle: radius sin(i) = distance sin(beta).
                if across <= radius * math.sin(critical):
                    way = distance * math.cos(beta) - math.sqrt(
                        max(0.0, radius * radius - across * across)
                    )
                    if way < best:
                        best = way
                        found = True
                continue
            d, normal = _foot(sx, sy, segments[surface])
            # Incidence on a segment: the angle from its normal.
            centre = middle + _wrapped(normal - axis - middle)
            nearest_angle = min(max(centre, first), last) - centre
            if abs(nearest_angle) <= critical:
                way = d / math.cos(nearest_angle)
                if way < best:
                    best = way
                    found = True
            if depth < reflections and d < best:
                count = _image(
                    beams,
                    count,
                    sx,
                    sy,
                    axis,
                    first,
                    min(last, centre - critical),
                    surface,
                    depth + 1,
                    segments,
                )
                count = _image(
                    beams,
                    count,
                    sx,
                    sy,
                    axis,
                    max(first, centre + critical),
                    last,
                    surface,
                    depth + 1,
                    segments,
                )
    return best if found else math.inf


@njit
def crosstalk_range(
    x: float,
    y: float,
    axis: float,
    half_angle: float,
    max_range: float,
    reflections: int,
    hx: float,
    hy: float,
    hearing_axis: float,
    body: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
    marks: FloatArray,
) -> float:
    """Return half the way [m] of one sonar's pulse to another sonar, ``inf`` when it misses.

    The pulse is reflected like light at segments, at any angle of incidence, and is heard
    when it falls into the other's beam. The other takes it for its own: half its way is
    the range that it reads.

    Parameters
    ----------
    x, y, axis : float
        Face [m] and direction [rad] of the sonar that sends.
    half_angle : float
        Half width of the beams [rad].
    max_range : float
        Half of the longest way [m].
    reflections : int
        Most reflections on the way.
    hx, hy, hearing_axis : float
        Face [m] and direction [rad] of the sonar that hears.
    body, segments, circles, marks : ndarray
        As for `echo_range`.
    """
    room = marks.shape[0] + 2 * circles.shape[0] + 4
    cuts = np.empty(room)
    beams = _stack(x, y, axis, half_angle, reflections, room)
    count = 1
    best = 2.0 * max_range
    found = False
    while count > 0:
        count -= 1
        sx = beams[count, 0]
        sy = beams[count, 1]
        axis = beams[count, 2]
        low = beams[count, 3]
        high = beams[count, 4]
        mirror = int(beams[count, 5])
        depth = int(beams[count, 6])
        if depth > 0:
            angle = math.atan2(hy - sy, hx - sx)
            way = math.hypot(hx - sx, hy - sy)
            arrives = abs(_wrapped(angle + math.pi - hearing_axis)) <= half_angle
            if (
                way < best
                and arrives
                and low <= _wrapped(angle - axis) <= high
                and _visible(sx, sy, hx, hy, mirror, body, segments, circles)
            ):
                best = way
                found = True
        if depth == reflections:
            continue
        pieces = _cuts(sx, sy, axis, low, high, body, circles, marks, cuts)
        for p in range(pieces - 1):
            if cuts[p + 1] - cuts[p] < _NARROW:
                continue
            middle = 0.5 * (cuts[p] + cuts[p + 1])
            t, surface = _first(sx, sy, axis + middle, mirror, body, segments, circles)
            if 0 <= surface < segments.shape[0] and t < best:
                count = _image(
                    beams,
                    count,
                    sx,
                    sy,
                    axis,
                    cuts[p],
                    cuts[p + 1],
                    surface,
                    depth + 1,
                    segments,
                )
    return 0.5 * best if found else math.inf
