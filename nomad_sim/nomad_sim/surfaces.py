# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The surfaces of a world at one moment, as arrays for the loops over rays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import for_kernel
from nomad_sim import ray_casting
from nomad_sim.corners import SAME, segment_crossings, which_echo
from nomad_sim.segment_index import SegmentIndex

__all__ = ["MAX_CROSSINGS", "Outline", "Surfaces"]

FloatArray = NDArray[np.float64]
S = TypeVar("S", bound=np.generic)
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Most crossings of surfaces that are accepted.
MAX_CROSSINGS = 20_000

# From so many segments on, rays find them by an index.
_MANY = 50
# Rows and columns of the parts of a grid that are compared with the same few segments.
_TILE = 32


@dataclass(frozen=True, eq=False)
class Outline:
    """One wall, polygon or circle with its material.

    Parameters
    ----------
    segments : ndarray of float64, shape (N, 4)
        End points x0, y0, x1, y1 [m].
    circles : ndarray of float64, shape (M, 3)
        Centre and radius [m].
    critical_angle : float
        Incidence from which on sound is reflected like light [rad].
    opaque : bool
        Whether infrared light is sent back.
    solid : bool
        Whether the segments enclose an obstacle.
    """

    segments: FloatArray
    circles: FloatArray
    critical_angle: float
    opaque: bool
    solid: bool


def _counts(outlines: Sequence[Outline]) -> list[int]:
    return [len(o.segments) for o in outlines] + [len(o.circles) for o in outlines]


def _solids(outlines: Sequence[Outline]) -> IntArray:
    stops = np.cumsum([0] + [len(o.segments) for o in outlines])
    ranges = [
        (start, stop)
        for o, start, stop in zip(outlines, stops[:-1], stops[1:], strict=True)
        if o.solid
    ]
    return np.array(ranges, dtype=np.int64).reshape(-1, 2)


def _crossings(
    segments: FloatArray, circles: FloatArray, first_segment: int, first_circle: int
) -> FloatArray:
    points = np.empty((32, 2))
    count = ray_casting.crossings(segments, circles, first_segment, first_circle, points)
    _check_number(count)
    if count > len(points):
        points = np.empty((count, 2))
        ray_casting.crossings(segments, circles, first_segment, first_circle, points)
    return points[:count]


def _check_number(count: int) -> None:
    if count > MAX_CROSSINGS:
        raise ValueError(
            f"the surfaces of the world cross each other {count} times, more than "
            f"{MAX_CROSSINGS}; use fewer or simpler shapes"
        )


@dataclass(frozen=True, eq=False)
class Surfaces:
    """All surfaces that are there at one moment.

    Surfaces are numbered: first the segments, then the circles.

    Parameters
    ----------
    segments : ndarray of float64, shape (N, 4)
        End points x0, y0, x1, y1 [m].
    circles : ndarray of float64, shape (M, 3)
        Centre and radius [m].
    critical_angles : ndarray of float64, shape (N + M,)
        Incidence from which on sound is reflected like light [rad].
    opaque : ndarray of bool, shape (N + M,)
        Whether infrared light is sent back.
    solids : ndarray of int64, shape (S, 2)
        First and past-the-last segment of each polygon that encloses an obstacle.
    edges : ndarray of float64, shape (K, 2)
        Edges, corners and free ends, which echo in every direction [m].
    marks : ndarray of float64, shape (P, 2)
        Every point where the nearest surface can change: all ends and crossings [m].
    parts : tuple of Surfaces
        What these surfaces were joined from; none: they are no others joined.
    """

    segments: FloatArray
    circles: FloatArray
    critical_angles: FloatArray
    opaque: BoolArray
    solids: IntArray
    edges: FloatArray
    marks: FloatArray
    parts: tuple[Surfaces, ...] = ()

    @classmethod
    def of(cls, outlines: Sequence[Outline]) -> Surfaces:
        """Put outlines together and find the edges and corners that echo.

        A corner is one where two outlines meet or cross as well; faces that continue each
        other straight on have none, nor has a point with obstacle on all sides.

        Raises
        ------
        ValueError
            If the surfaces cross more than `MAX_CROSSINGS` times.
        """
        segments = np.concatenate([np.empty((0, 4))] + [o.segments for o in outlines])
        circles = np.concatenate([np.empty((0, 3))] + [o.circles for o in outlines])
        solids = _solids(outlines)
        # The segments among themselves are looked at by place.
        index = SegmentIndex.of(segments) if len(segments) > 0 else None
        met = _crossings(segments, circles, len(segments), 0)
        if index is not None:
            crossed, count = segment_crossings(index, MAX_CROSSINGS)
            _check_number(count + len(met))
            met = np.concatenate([met, crossed])
        marks = np.concatenate([segments[:, :2], segments[:, 2:], met])
        marks = marks[np.unique(np.round(marks / SAME), axis=0, return_index=True)[1]]
        # Where a circle crosses, its face has no direction of its own: no corner is claimed.
        edges = marks[:0] if index is None else marks[which_echo(marks, index, solids)]
        return cls(
            segments=segments,
            circles=circles,
            critical_angles=np.repeat([o.critical_angle for o in outlines] * 2, _counts(outlines)),
            opaque=np.repeat([o.opaque for o in outlines] * 2, _counts(outlines)).astype(bool),
            solids=solids,
            edges=edges,
            marks=marks,
        )

    def shifted(self, x: float, y: float) -> Surfaces:
        """Return the surfaces moved by (x, y) [m]."""
        return replace(
            self,
            segments=self.segments + np.array([x, y, x, y]),
            circles=self.circles + np.array([x, y, 0.0]),
            edges=self.edges + np.array([x, y]),
            marks=self.marks + np.array([x, y]),
            parts=tuple(part.shifted(x, y) for part in self.parts),
        )

    def joined(self, others: Sequence[Surfaces]) -> Surfaces:
        """Return these surfaces and others that may cross them, all in one.

        Every part keeps its own edges: where parts touch, no new corner is claimed.
        """
        if not others:
            return self
        parts = (self, *others)
        segments = np.concatenate([p.segments for p in parts])
        circles = np.concatenate([p.circles for p in parts])
        starts = np.cumsum([0] + [len(p.segments) for p in parts])
        met = _crossings(segments, circles, len(self.segments), len(self.circles))
        return Surfaces(
            segments=segments,
            circles=circles,
            critical_angles=_in_order(parts, [p.critical_angles for p in parts]),
            opaque=_in_order(parts, [p.opaque for p in parts]),
            solids=np.concatenate(
                [p.solids + start for p, start in zip(parts, starts[:-1], strict=True)]
            ),
            edges=np.concatenate([p.edges for p in parts]),
            marks=np.concatenate([p.marks for p in parts] + [met]),
            parts=parts,
        )

    @cached_property
    def seen_by_infrared(self) -> tuple[FloatArray, FloatArray]:
        """Segments and circles that send infrared light back, shapes (N', 4) and (M', 3)."""
        count = len(self.segments)
        return self.segments[self.opaque[:count]], self.circles[self.opaque[count:]]

    @cached_property
    def _index(self) -> SegmentIndex:
        return SegmentIndex.of(self.segments)

    @cached_property
    def _infrared_index(self) -> SegmentIndex:
        return SegmentIndex.of(self.seen_by_infrared[0])

    def cast_rays(
        self, starts: FloatArray, directions: FloatArray, *, sees_glass: bool
    ) -> FloatArray:
        """Return the way along each ray to the first surface.

        Parameters
        ----------
        starts, directions : ndarray of float64, shape (R, 2)
            Starts [m] and unit vectors.
        sees_glass : bool
            Whether surfaces that let infrared light through count.

        Returns
        -------
        ndarray of float64, shape (R,)
            Ways [m], ``inf`` where a ray meets nothing.
        """
        segments, circles = self.seen_by_infrared
        if sees_glass:
            segments, circles = self.segments, self.circles
        if len(segments) < _MANY:
            arrays = (starts, directions, segments, circles)
            ways: FloatArray = ray_casting.cast_rays(*(for_kernel(a) for a in arrays))
            return ways
        if self.parts:
            # The index of what stands still outlives this moment.
            each = [p.cast_rays(starts, directions, sees_glass=sees_glass) for p in self.parts]
            nearest: FloatArray = np.minimum.reduce(each)
            return nearest
        index = self._index if sees_glass else self._infrared_index
        return index.cast_rays(starts, directions, circles)

    def distance(self, x: float, y: float) -> float:
        """Return the distance [m] of (x, y) [m] to the nearest surface, negative inside."""
        return ray_casting.nearest_distance(x, y, self.segments, self.circles, self.solids)

    def distances(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the `distance` [m] of all points of a grid.

        Parameters
        ----------
        x : ndarray of float64, shape (W,)
        y : ndarray of float64, shape (H,)
            Coordinates of its columns and rows [m].

        Returns
        -------
        ndarray of float64, shape (H, W)
        """
        column, row = x[None, :], y[:, None]
        square = np.full((len(y), len(x)), np.inf)
        for rows in _tiles(len(y)):
            for columns in _tiles(len(x)):
                part = square[rows, columns]
                for segment in self._nearest_to(x[columns], y[rows]):
                    np.minimum(part, _squares(column[:, columns], row[rows], segment), out=part)
        distance: FloatArray = np.sqrt(square)
        distance[self._inside(column, row)] *= -1.0
        for cx, cy, radius in self.circles:
            np.minimum(distance, np.hypot(column - cx, row - cy) - radius, out=distance)
        return distance

    def _nearest_to(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the segments of which one is nearest to each point of a part of a grid."""
        if len(self.segments) == 0:
            return self.segments
        middle_x, middle_y = 0.5 * (x[0] + x[-1]), 0.5 * (y[0] + y[-1])
        reach = math.hypot(x[-1] - middle_x, y[-1] - middle_y)
        away = np.sqrt(_squares(middle_x, middle_y, self.segments.T))
        # None of the points is farther from the middle than the reach.
        near: FloatArray = self.segments[away <= away.min() + 2.0 * reach + SAME]
        return near

    def _inside(self, column: FloatArray, row: FloatArray) -> BoolArray:
        """Whether the points of a grid lie in a solid polygon, shape (H, W)."""
        covered = np.zeros((row.size, column.size), dtype=bool)
        for start, stop in self.solids:
            odd = np.zeros_like(covered)
            for x0, y0, x1, y1 in self.segments[start:stop]:
                if y0 != y1:
                    spans = (y0 > row) != (y1 > row)
                    odd ^= spans & (column < x0 + (row - y0) / (y1 - y0) * (x1 - x0))
            covered |= odd
        return covered


def _tiles(count: int) -> list[slice]:
    """Return slices that part the rows or columns of a grid."""
    return [slice(first, first + _TILE) for first in range(0, count, _TILE)]


def _squares(x: FloatArray | float, y: FloatArray | float, segment: FloatArray) -> FloatArray:
    """Return the squared distances [m^2] of points from a segment, or of a point from many."""
    x0, y0, x1, y1 = segment
    ex, ey = x1 - x0, y1 - y0
    along = np.clip(((x - x0) * ex + (y - y0) * ey) / (ex * ex + ey * ey), 0.0, 1.0)
    dx, dy = x - x0 - along * ex, y - y0 - along * ey
    square: FloatArray = dx * dx + dy * dy
    return square


def _in_order(parts: Sequence[Surfaces], values: Sequence[NDArray[S]]) -> NDArray[S]:
    """Concatenate values of surfaces, those of all segments before those of all circles."""
    counts = [len(p.segments) for p in parts]
    return np.concatenate(
        [v[:n] for v, n in zip(values, counts, strict=True)]
        + [v[n:] for v, n in zip(values, counts, strict=True)]
    )
