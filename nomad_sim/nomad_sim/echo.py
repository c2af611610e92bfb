# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The echoes that come back to a sonar, exactly: compiled loops.

The beam is cut into pieces with one nearest surface each (see `beam`); the shortest echo
of that surface within its piece follows in closed form. Unlike a fan of sample rays this
misses no thin surface and has no error of its own.

A segment reflects what falls in beyond its critical angle like a mirror: the reflected
piece is a beam again, from the sonar's mirror image, that sees only what lies behind the
mirror. The way from the image is the whole way of the sound. Circles send sound that falls
in beyond their critical angle apart in all directions: it is lost.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from nomad_sim.beam import (
    NARROW,
    beside,
    cut,
    first_surface,
    foot,
    push_image,
    sees,
    stack_of,
    within,
    wrapped,
)

__all__ = ["crosstalk_range", "echo_range"]

FloatArray = NDArray[np.float64]


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
    near = np.empty(segments.shape[0], dtype=np.int64)
    beams = stack_of(x, y, axis, half_angle, reflections, room)
    count = 1
    best = max_range
    found = False
    while count > 0:
        count -= 1
        if beams[count, 7] >= best:
            continue
        sx = beams[count, 0]
        sy = beams[count, 1]
        axis = beams[count, 2]
        low = beams[count, 3]
        high = beams[count, 4]
        mirror = int(beams[count, 5])
        depth = int(beams[count, 6])
        number = within(sx, sy, axis, low, high, segments, near)
        if edge_echo:
            ux = math.cos(axis)
            uy = math.sin(axis)
            widest = math.tan(max(-low, high))
            for k in range(edges.shape[0]):
                dx = edges[k, 0] - sx
                dy = edges[k, 1] - sy
                along = dx * ux + dy * uy
                across = ux * dy - uy * dx
                if beside(along, across, widest) or dx * dx + dy * dy >= best * best:
                    continue
                if not low <= math.atan2(across, along) <= high:
                    continue
                ex, ey = edges[k, 0], edges[k, 1]
                if sees(sx, sy, ex, ey, mirror, body, segments, circles, near, number):
                    best = math.hypot(dx, dy)
                    found = True
        pieces = cut(sx, sy, axis, low, high, body, circles, marks, cuts)
        for p in range(pieces - 1):
            first = cuts[p]
            last = cuts[p + 1]
            if last - first < NARROW:
                continue
            middle = 0.5 * (first + last)
            angle = axis + middle
            t, surface = first_surface(
                sx, sy, angle, mirror, body, segments, circles, near, number
            )
            if surface < 0:
                continue
            if t <= 0.0:
                return 0.0  # the sonar touches the surface
            critical = critical_angles[surface]
            if surface >= n:
                c = surface - n
                dx = circles[c, 0] - sx
                dy = circles[c, 1] - sy
                radius = circles[c, 2]
                distance = math.hypot(dx, dy)
                centre = middle + wrapped(math.atan2(dy, dx) - axis - middle)
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
            d, normal = foot(sx, sy, segments[surface])
            # Incidence on a segment: the angle from its normal.
            centre = middle + wrapped(normal - axis - middle)
            nearest_angle = min(max(centre, first), last) - centre
            if abs(nearest_angle) <= critical:
                way = d / math.cos(nearest_angle)
                if way < best:
                    best = way
                    found = True
            # Whatever comes by a mirror has come farther than to it.
            if depth < reflections and d < best:
                count = push_image(
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
                count = push_image(
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
    near = np.empty(segments.shape[0], dtype=np.int64)
    beams = stack_of(x, y, axis, half_angle, reflections, room)
    count = 1
    best = 2.0 * max_range
    found = False
    while count > 0:
        count -= 1
        if beams[count, 7] >= best:
            continue
        sx = beams[count, 0]
        sy = beams[count, 1]
        axis = beams[count, 2]
        low = beams[count, 3]
        high = beams[count, 4]
        mirror = int(beams[count, 5])
        depth = int(beams[count, 6])
        number = within(sx, sy, axis, low, high, segments, near)
        if depth > 0:
            angle = math.atan2(hy - sy, hx - sx)
            way = math.hypot(hx - sx, hy - sy)
            arrives = abs(wrapped(angle + math.pi - hearing_axis)) <= half_angle
            if (
                way < best
                and arrives
                and low <= wrapped(angle - axis) <= high
                and sees(sx, sy, hx, hy, mirror, body, segments, circles, near, number)
            ):
                best = way
                found = True
        if depth == reflections:
            continue
        pieces = cut(sx, sy, axis, low, high, body, circles, marks, cuts)
        for p in range(pieces - 1):
            if cuts[p + 1] - cuts[p] < NARROW:
                continue
            middle = 0.5 * (cuts[p] + cuts[p + 1])
            angle = axis + middle
            t, surface = first_surface(
                sx, sy, angle, mirror, body, segments, circles, near, number
            )
            if 0 <= surface < segments.shape[0] and t < best:
                count = push_image(
                    beams, count, sx, sy, axis, cuts[p], cuts[p + 1], surface, depth + 1, segments
                )
    return 0.5 * best if found else math.inf
