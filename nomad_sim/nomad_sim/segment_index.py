# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""An index of segments by place, with which a ray looks only at those along its way.

The area is parted into squares, and each knows the segments that touch it. A ray goes from
square to square until what it has met is nearer than the next. It meets what it would meet
if it looked at all segments, at the same distance to the last bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import for_kernel, njit
from nomad_sim.ray_casting import NO_SURFACE, TOUCHING, hits, nearest

__all__ = ["SegmentIndex", "put_member"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A segment counts as touching squares this near [m]: more than a ray starts behind its start,
# and more than rounding.
_SLACK = 1e-5


@njit
def put_member(square: int, number: int, places: IntArray, members: IntArray) -> None:
    """Put a number among those of a square, if there is room, and move its place on by one.

    Parameters
    ----------
    square, number : int
        The square, and what touches it.
    places : ndarray of int64, shape (squares,)
        Where each square's next number goes.
    members : ndarray of int64
        Receives the numbers, as far as there is room: none to count only.
    """
    if places[square] < members.shape[0]:
        members[places[square]] = number
    places[square] += 1


@njit
def _file(
    segments: FloatArray,
    frame: FloatArray,
    shape: IntArray,
    places: IntArray,
    members: IntArray,
) -> None:
    """Put the number of each segment at the place of each square that it touches.

    Parameters
    ----------
    segments : ndarray of float64, shape (N, 4)
        End points [m].
    frame : ndarray of float64, shape (3,)
        Lower left corner of the squares and their side [m].
    shape : ndarray of int64, shape (2,)
        Rows and columns.
    places : ndarray of int64, shape (squares,)
        Where each square's next number goes; moves on by one with each.
    members : ndarray of int64
        Receives the numbers, as far as there is room: none to count only.
    """
    side = frame[2]
    for i in range(segments.shape[0]):
        x0, y0 = segments[i, 0] - frame[0], segments[i, 1] - frame[1]
        x1, y1 = segments[i, 2] - frame[0], segments[i, 3] - frame[1]
        left, right = min(x0, x1), max(x0, x1)
        first = max(0, int((left - _SLACK) / side))
        last = min(shape[1] - 1, int((right + _SLACK) / side))
        for column in range(first, last + 1):
            low, high = min(y0, y1), max(y0, y1)
            if right - left > _SLACK:
                # The part of the segment above this column of squares.
                a = max(left, column * side - _SLACK)
                b = min(right, (column + 1) * side + _SLACK)
                ya = y0 + (a - x0) / (x1 - x0) * (y1 - y0)
                yb = y0 + (b - x0) / (x1 - x0) * (y1 - y0)
                low, high = max(low, min(ya, yb)), min(high, max(ya, yb))
            bottom = max(0, int((low - _SLACK) / side))
            top = min(shape[0] - 1, int((high + _SLACK) / side))
            for row in range(bottom, top + 1):
                put_member(row * shape[1] + column, i, places, members)


@njit
def _cast(
    starts: FloatArray,
    directions: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
    frame: FloatArray,
    shape: IntArray,
    begins: IntArray,
    members: IntArray,
    ranges: FloatArray,
) -> None:
    """Write the way along each ray to the first surface into `ranges`."""
    none = segments[:0]
    left, bottom, side = frame[0], frame[1], frame[2]
    rows, columns = shape[0], shape[1]
    width, height = columns * side, rows * side
    for r in range(starts.shape[0]):
        x, y = starts[r, 0], starts[r, 1]
        ux, uy = directions[r, 0], directions[r, 1]
        best = math.inf
        if circles.shape[0] > 0:
            best, _ = nearest(x, y, ux, uy, TOUCHING, NO_SURFACE, none, circles)
        # Where the ray is above the squares: from `enter` to `leave`.
        enter, leave = TOUCHING, best
        for along, u, extent in ((x - left, ux, width), (y - bottom, uy, height)):
            if u == 0.0:
                if not -_SLACK <= along <= extent + _SLACK:
                    leave = -math.inf
            else:
                near, far = -along / u, (extent - along) / u
                if near > far:
                    near, far = far, near
                if near > enter:
                    enter = near
                if far < leave:
                    leave = far
        if enter <= leave:
            column = int((x + enter * ux - left) / side)
            row = int((y + enter * uy - bottom) / side)
            column = min(columns - 1, max(0, column))
            row = min(rows - 1, max(0, row))
            # From a square to the next: which of its sides the ray leaves by.
            next_column, far_column = (1, 1) if ux > 0.0 else (-1, 0)
            next_row, far_row = (1, 1) if uy > 0.0 else (-1, 0)
            while 0 <= column < columns and 0 <= row < rows:
                square = row * columns + column
                for k in range(begins[square], begins[square + 1]):
                    t = hits(x, y, ux, uy, TOUCHING, best, segments, members[k])
                    if t < best:
                        best = t
                across = up = math.inf
                if ux != 0.0:
                    across = (left + (column + far_column) * side - x) / ux
                if uy != 0.0:
                    up = (bottom + (row + far_row) * side - y) / uy
                if across <= up:
                    if best <= across:
                        break
                    column += next_column
                else:
                    if best <= up:
                        break
                    row += next_row
        ranges[r] = max(best, 0.0)


@dataclass(frozen=True, eq=False)
class SegmentIndex:
    """Segments, and where to find them.

    Parameters
    ----------
    segments : ndarray of float64, shape (N, 4)
        End points x0, y0, x1, y1 [m], N at least 1.
    frame : ndarray of float64, shape (3,)
        Lower left corner of the squares and their side [m].
    shape : ndarray of int64, shape (2,)
        Rows and columns of squares.
    begins : ndarray of int64, shape (squares + 1,)
        Where the members of each square begin.
    members : ndarray of int64
        Numbers of the segments that touch each square.

    Examples
    --------
    >>> wall = SegmentIndex.of(np.array([[2.0, -1.0, 2.0, 1.0]]))
    >>> wall.cast_rays(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.empty((0, 3)))
    array([2.])
    """

    segments: FloatArray
    frame: FloatArray
    shape: IntArray
    begins: IntArray
    members: IntArray

    @classmethod
    def of(cls, segments: FloatArray) -> SegmentIndex:
        """Return the index of some segments.

        Parameters
        ----------
        segments : ndarray of float64, shape (N, 4)
            End points x0, y0, x1, y1 [m], finite, N at least 1.

        Raises
        ------
        ValueError
            If there is no segment, or an end is not finite.
        """
        segments = np.ascontiguousarray(segments, dtype=np.float64)
        if segments.ndim != 2 or segments.shape[1] != 4 or len(segments) == 0:
            raise ValueError(f"segments have the shape (1 or more, 4), got {segments.shape}")
        if not np.isfinite(segments).all():
            raise ValueError("the ends of segments must be finite [m]")
        ends = segments.reshape(-1, 2)
        low = ends.min(axis=0) - 2.0 * _SLACK
        size = ends.max(axis=0) + 2.0 * _SLACK - low
        lengths = np.hypot(*(segments[:, 2:] - segments[:, :2]).T)
        # About one square a segment, and not more than a few squares for each.
        side = max(math.sqrt(size[0] * size[1] / len(segments)), float(lengths.mean()) / 4.0)
        side = max(side, float(size.max()) / 10_000.0)
        frame = np.array([low[0], low[1], side])
        shape = np.maximum(np.ceil(size[::-1] / side), 1.0).astype(np.int64)
        counts = np.zeros(int(shape.prod()), np.int64)
        _file(segments, frame, shape, counts, np.empty(0, np.int64))
        begins = np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)])
        members = np.empty(int(begins[-1]), np.int64)
        _file(segments, frame, shape, begins[:-1].copy(), members)
        return cls(segments, frame, shape, begins, members)

    def cast_rays(
        self, starts: FloatArray, directions: FloatArray, circles: FloatArray
    ) -> FloatArray:
        """Return the way along each ray to the first surface.

        Parameters
        ----------
        starts, directions : ndarray of float64, shape (R, 2)
            Starts [m] and unit vectors.
        circles : ndarray of float64, shape (M, 3)
            Circles beside the segments: centre and radius [m].

        Returns
        -------
        ndarray of float64, shape (R,)
            Ways [m], ``inf`` where a ray meets nothing; those of `ray_casting.cast_rays`.
        """
        ranges = np.empty(len(starts))
        squares = (self.frame, self.shape, self.begins, self.members)
        arrays = (starts, directions, self.segments, circles, *squares, ranges)
        _cast(*(for_kernel(a) for a in arrays))
        return ranges
