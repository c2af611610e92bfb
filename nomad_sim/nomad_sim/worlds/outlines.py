# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The outlines of a raster: closed lines between cells that are free and cells that are not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["MAX_SIDES", "enclosed", "outlines", "simplified"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

#: Most sides between free and solid cells: nine times what the plan of a building of 54 m by 59 m
#: has in cells of 0.1 m. They take about 0.4 kB and 0.03 ms each.
MAX_SIDES = 300_000

#: A corner of cells: column, row.
_Corner = tuple[int, int]


def outlines(solid: BoolArray) -> list[FloatArray]:
    """Return the closed lines around all solid regions, also those of their holes.

    Solid cells that touch by a corner belong together. What lies beyond the raster is solid.

    Parameters
    ----------
    solid : ndarray of bool, shape (H, W)
        The cells that are not free.

    Returns
    -------
    list of ndarray of float64, shape (N, 2)
        The corners (column, row) of each line in order; the last joins the first. Corners on
        straight lines are left out.

    Raises
    ------
    ValueError
        If there are more than `MAX_SIDES` sides between free and solid cells.
    """
    ends = _sides(solid)
    lines = []
    while ends:
        start = next(iter(ends))
        first = ends[start][0]
        line, before, corner = [start], start, first
        # Where two lines touch, one passes through its own start before it is closed.
        while (following := _turn(before, corner, ends[corner])) != first or corner != start:
            line.append(corner)
            _take(ends, corner, following)
            before, corner = corner, following
        _take(ends, start, first)
        lines.append(_without_straight(np.array(line, dtype=np.float64)))
    return lines


def _sides(solid: BoolArray) -> dict[_Corner, list[_Corner]]:
    """Return the sides between free and solid cells, by where they begin: solid on the left."""
    padded = np.pad(solid, 1, constant_values=True)
    sides = sum(int(np.count_nonzero(np.diff(padded, axis=axis))) for axis in (0, 1))
    if sides > MAX_SIDES:
        raise ValueError(
            f"the outlines of the raster have {sides} sides of cells, at most {MAX_SIDES} are "
            "taken: is it a floor plan, and not a photograph?"
        )
    ends: dict[_Corner, list[_Corner]] = {}
    # Below, right of, above and left of a solid cell (r, c): begin and end of the side there.
    for (down, right), begin, end in (
        ((-1, 0), (0, 0), (1, 0)),
        ((0, 1), (1, 0), (1, 1)),
        ((1, 0), (1, 1), (0, 1)),
        ((0, -1), (0, 1), (0, 0)),
    ):
        beside = np.roll(padded, (-down, -right), axis=(0, 1))
        rows, columns = np.nonzero(padded & ~beside)
        for r, c in zip((rows - 1).tolist(), (columns - 1).tolist(), strict=True):
            ends.setdefault((c + begin[0], r + begin[1]), []).append((c + end[0], r + end[1]))
    return ends


def _take(ends: dict[_Corner, list[_Corner]], begin: _Corner, end: _Corner) -> None:
    ends[begin].remove(end)
    if not ends[begin]:
        del ends[begin]


def _turn(before: _Corner, at: _Corner, options: list[_Corner]) -> _Corner:
    """Return where to go on: to the right where two solid cells touch by a corner."""
    along = (at[0] - before[0], at[1] - before[1])

    def left(option: _Corner) -> int:
        return along[0] * (option[1] - at[1]) - along[1] * (option[0] - at[0])

    return min(options, key=left)


def _without_straight(line: FloatArray) -> FloatArray:
    before, after = line - np.roll(line, 1, axis=0), np.roll(line, -1, axis=0) - line
    corners: FloatArray = line[before[:, 0] * after[:, 1] != before[:, 1] * after[:, 0]]
    return corners


def enclosed(line: FloatArray) -> float:
    """Return the area that a closed line encloses, negative where it runs clockwise.

    Parameters
    ----------
    line : ndarray of float64, shape (N, 2)
        Its corners; the last joins the first.
    """
    x, y = (line - line[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def simplified(line: FloatArray, tolerance: float) -> FloatArray:
    """Return a closed line with fewer corners, all of them its own (Douglas, Peucker 1973).

    Parameters
    ----------
    line : ndarray of float64, shape (N, 2)
        Its corners; the last joins the first.
    tolerance : float
        Largest distance of a corner that is left out from the line that remains.

    Returns
    -------
    ndarray of float64, shape (M, 2)
        At least two corners.
    """
    far = int(np.argmax(((line - line[0]) ** 2).sum(axis=1)))
    ring = np.vstack([line, line[:1]])
    keep = np.zeros(len(ring), dtype=bool)
    keep[[0, far]] = True
    pending = [(0, far), (far, len(ring) - 1)]
    while pending:
        first, last = pending.pop()
        if last - first < 2:
            continue
        distance = _from_line(ring[first + 1 : last], ring[first], ring[last])
        worst = int(np.argmax(distance))
        if distance[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            pending += [(first, middle), (middle, last)]
    corners: FloatArray = ring[:-1][keep[:-1]]
    return corners


def _from_line(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the distances of points from the line between two points."""
    along = b - a
    square = float(along @ along)
    if square == 0.0:
        nearest = np.broadcast_to(a, points.shape)
    else:
        share = np.clip((points - a) @ along / square, 0.0, 1.0)
        nearest = a + share[:, None] * along
    distance: FloatArray = np.hypot(*(points - nearest).T)
    return distance
