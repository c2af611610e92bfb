# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where segments cross, and which of their ends and crossings are edges and corners that echo.

Both look only at what touches the same square of a `SegmentIndex`: what they cost grows with
the number of segments, not with that of their pairs.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from nomad_sim.ray_casting import in_polygon, meet_segments
from nomad_sim.segment_index import SegmentIndex, put_member

__all__ = ["SAME", "segment_crossings", "which_echo"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Distance within which ends count as one point [m].
SAME = 1e-6
# Two faces that meet at less than this from straight on give no echo at their joint.
_STRAIGHT = math.radians(5.0)
# How far from a vertex it is looked whether a sector is free [m].
_PROBE = 1e-4


@njit
def _square(x: float, y: float, frame: FloatArray, shape: IntArray) -> int:
    """Return the number of the square that a point lies in, -1 if in none."""
    column = math.floor((x - frame[0]) / frame[2])
    row = math.floor((y - frame[1]) / frame[2])
    if not (0 <= column < shape[1] and 0 <= row < shape[0]):
        return -1
    return int(row * shape[1] + column)


@njit
def _cross(
    segments: FloatArray,
    frame: FloatArray,
    shape: IntArray,
    begins: IntArray,
    members: IntArray,
    points: FloatArray,
) -> int:
    """Put crossings into the first rows of `points`, as far as there is room; return how many."""
    found = np.empty((2, 2))
    count = 0
    for square in range(begins.shape[0] - 1):
        for a in range(begins[square], begins[square + 1]):
            for b in range(a + 1, begins[square + 1]):
                number = meet_segments(segments[members[a]], segments[members[b]], found)
                # Each crossing counts in the one square that it lies in.
                if number > 0 and _square(found[0, 0], found[0, 1], frame, shape) == square:
                    if count < points.shape[0]:
                        points[count, 0] = found[0, 0]
                        points[count, 1] = found[0, 1]
                    count += 1
    return count


def segment_crossings(index: SegmentIndex, most: int) -> tuple[FloatArray, int]:
    """Return where segments cross each other in their interior.

    Parameters
    ----------
    index : SegmentIndex
        The segments.
    most : int
        Crossings that are returned at most.

    Returns
    -------
    points : ndarray of float64, shape (n, 2)
        Crossings [m].
    count : int
        Number of all crossings.
    """
    points = np.empty((most, 2))
    squares = (index.frame, index.shape, index.begins, index.members)
    count = _cross(index.segments, *squares, points)
    return points[:count].copy(), count


@njit
def _file_solids(
    segments: FloatArray,
    solids: IntArray,
    frame: FloatArray,
    shape: IntArray,
    places: IntArray,
    members: IntArray,
) -> None:
    """Put the number of each solid at the place of each square that its bounds touch.

    `places` and `members` are as for the segments of a `SegmentIndex`.
    """
    for s in range(solids.shape[0]):
        left = bottom = math.inf
        right = top = -math.inf
        for i in range(solids[s, 0], solids[s, 1]):
            left = min(left, segments[i, 0], segments[i, 2])
            right = max(right, segments[i, 0], segments[i, 2])
            bottom = min(bottom, segments[i, 1], segments[i, 3])
            top = max(top, segments[i, 1], segments[i, 3])
        if left > right:
            continue
        for row in range(
            max(0, int((bottom - frame[1]) / frame[2])),
            min(shape[0] - 1, int((top - frame[1]) / frame[2])) + 1,
        ):
            for column in range(
                max(0, int((left - frame[0]) / frame[2])),
                min(shape[1] - 1, int((right - frame[0]) / frame[2])) + 1,
            ):
                put_member(row * shape[1] + column, s, places, members)


@njit
def _covered(
    x: float,
    y: float,
    segments: FloatArray,
    solids: IntArray,
    near: IntArray,
) -> bool:
    """Whether a point lies in one of the solids whose numbers are given."""
    for k in range(near.shape[0]):
        if in_polygon(x, y, segments, solids[near[k], 0], solids[near[k], 1]):
            return True
    return False


@njit
def _directions(x: float, y: float, segments: FloatArray, near: IntArray) -> FloatArray:
    """Return the directions [rad], sorted, in which faces leave a point that they touch."""
    angles = np.empty(2 * near.shape[0])
    count = 0
    for k in range(near.shape[0]):
        x0 = segments[near[k], 0]
        y0 = segments[near[k], 1]
        ex = segments[near[k], 2] - x0
        ey = segments[near[k], 3] - y0
        length = math.sqrt(ex * ex + ey * ey)
        if length == 0.0:
            continue
        foot = ((x - x0) * ex + (y - y0) * ey) / length
        across = abs((x - x0) * ey - (y - y0) * ex) / length
        if across < SAME and -SAME < foot < length + SAME:
            if foot < length - SAME:
                angles[count] = math.atan2(ey, ex)
                count += 1
            if foot > SAME:
                angles[count] = math.atan2(-ey, -ex)
                count += 1
    return np.sort(angles[:count])


@njit
def _echo(
    points: FloatArray,
    segments: FloatArray,
    solids: IntArray,
    frame: FloatArray,
    shape: IntArray,
    begins: IntArray,
    members: IntArray,
    solid_begins: IntArray,
    solid_members: IntArray,
    echo: BoolArray,
) -> None:
    """Fill in what `which_echo` returns."""
    for p in range(points.shape[0]):
        echo[p] = False
        square = _square(points[p, 0], points[p, 1], frame, shape)
        if square < 0:
            continue
        near = members[begins[square] : begins[square + 1]]
        angles = _directions(points[p, 0], points[p, 1], segments, near)
        for k in range(angles.shape[0]):
            following = angles[k + 1] if k + 1 < angles.shape[0] else angles[0] + 2.0 * math.pi
            gap = following - angles[k]
            if gap < 1e-6 or abs(gap - math.pi) < _STRAIGHT:
                continue
            middle = angles[k] + 0.5 * gap
            x = points[p, 0] + _PROBE * math.cos(middle)
            y = points[p, 1] + _PROBE * math.sin(middle)
            around = _square(x, y, frame, shape)
            if around < 0:
                echo[p] = True
                break
            solid = solid_members[solid_begins[around] : solid_begins[around + 1]]
            if not _covered(x, y, segments, solids, solid):
                echo[p] = True
                break


def which_echo(points: FloatArray, index: SegmentIndex, solids: IntArray) -> BoolArray:
    """Tell at which points an edge or corner is, seen from some free side.

    Faces that continue each other straight on have none, nor has a point with obstacle on all
    sides, or on no face.

    Parameters
    ----------
    points : ndarray of float64, shape (P, 2)
        Ends and crossings of segments [m].
    index : SegmentIndex
        The segments.
    solids : ndarray of int64, shape (S, 2)
        First and past-the-last segment of each polygon that encloses an obstacle.

    Returns
    -------
    ndarray of bool, shape (P,)
    """
    filed = (index.segments, solids, index.frame, index.shape)
    counts = np.zeros(len(index.begins) - 1, np.int64)
    _file_solids(*filed, counts, np.empty(0, np.int64))
    begins = np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)])
    members = np.empty(int(begins[-1]), np.int64)
    _file_solids(*filed, begins[:-1].copy(), members)
    echo = np.empty(len(points), np.bool_)
    _echo(points, *filed, index.begins, index.members, begins, members, echo)
    return echo
