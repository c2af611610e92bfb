# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Straight lines at any angle in place of a path's steps in eight directions.

A path from cell to cell is up to 8 % longer than the way that it stands for. Its cells are
therefore joined by straight lines wherever these cost less: the cheapest chain of lines between
cells of the path, where a line costs its length times the mean cost of the cells that it leads
through. On ground of one risk that is the path pulled tight.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import for_kernel, njit

__all__ = ["MOST_KNOTS", "pulled_straight", "warm_up"]

Floats = NDArray[np.float64]
Cells = NDArray[np.int64]

#: Most cells of a path that lines run between: all at its beginning, which is driven before the
#: next plan is made, and evenly spaced ones of what is left.
MOST_KNOTS = 96
_BEGINNING = 48
#: Lines that cost more by no more than this share cost the same: then the longer one is taken.
_SAME = 1e-9
#: A place is at most so far off its cell's centre, in cells, so that it lies in that cell.
_OFFSET = 0.49


def warm_up() -> None:
    """Compile the kernel, or load it from the cache."""
    pulled_straight(np.zeros((3, 2), dtype=np.int64), np.ones((1, 1)))


def pulled_straight(
    path: Cells, weights: Floats, corner_cutting: bool = True
) -> tuple[Cells, Floats]:
    """Return a path that costs no more, of straight lines at any angle.

    Parameters
    ----------
    path : ndarray of int64, shape (n, 2)
        8-adjacent cells (row, column) of the array of weights.
    weights : ndarray of float64, shape (H, W)
        Cost of each cell for a way of its side's length, infinite where no path may enter.
    corner_cutting : bool
        Whether a diagonal step may pass beside a cell that must not be entered.

    Returns
    -------
    cells : ndarray of int64, shape (m, 2)
        8-adjacent cells from the same start to the same end.
    places : ndarray of float64, shape (m, 2)
        Where the lines pass through them (row, column); a cell's centre is a whole number.
    """
    count = len(path)
    if count < 3:
        return path, path.astype(np.float64)
    knots = np.arange(count)
    if count > MOST_KNOTS:
        rest = np.linspace(_BEGINNING, count - 1, MOST_KNOTS - _BEGINNING).round().astype(np.int64)
        knots = np.append(knots[:_BEGINNING], rest)
    before = for_kernel(np.zeros(len(knots), dtype=np.int64))
    _cheapest_lines(
        for_kernel(path), for_kernel(knots), for_kernel(weights), corner_cutting, before
    )
    corners = [len(knots) - 1]
    while corners[-1] > 0:
        corners.append(int(before[corners[-1]]))
    corners.reverse()
    cells, places = [path[:1]], [path[:1].astype(np.float64)]
    for i, j in itertools.pairwise(corners):
        if j == i + 1:
            # Neighbouring knots are joined by the path itself.
            piece = path[knots[i] + 1 : knots[j] + 1]
            cells.append(piece)
            places.append(piece.astype(np.float64))
            continue
        line, on_line = _line(path[knots[i]], path[knots[j]])
        cells.append(line)
        places.append(on_line)
    return np.vstack(cells), np.vstack(places)


def _line(first: Cells, last: Cells) -> tuple[Cells, Floats]:
    """Return the cells of a line behind its first, and where it passes through them."""
    way = last - first
    count = int(np.abs(way).max())
    exact = first + np.arange(1, count + 1)[:, None] * (way / count)
    cells = np.floor(exact + 0.5).astype(np.int64)
    return cells, np.clip(exact, cells - _OFFSET, cells + _OFFSET)


@njit
def _cheapest_lines(
    path: Cells, knots: Cells, weights: Floats, corner_cutting: bool, before: Cells
) -> None:
    """Find for each knot the one that the last line to it comes from.

    Parameters
    ----------
    path, weights, corner_cutting
        As `pulled_straight` takes them.
    knots : ndarray of int64, shape (k,)
        Indices of cells of the path.
    before : ndarray of int64, shape (k,)
        Where the numbers of the knots go.
    """
    best = np.zeros(len(knots))
    for j in range(1, len(knots)):
        # The path itself, from the knot before.
        cost = best[j - 1]
        for k in range(knots[j - 1] + 1, knots[j] + 1):
            row, column = path[k, 0], path[k, 1]
            diagonal = row != path[k - 1, 0] and column != path[k - 1, 1]
            cost += weights[row, column] * (math.sqrt(2.0) if diagonal else 1.0)
        before[j] = j - 1
        row1, column1 = path[knots[j], 0], path[knots[j], 1]
        for i in range(j - 2, -1, -1):
            row0, column0 = path[knots[i], 0], path[knots[i], 1]
            rows, columns = row1 - row0, column1 - column0
            steps = max(abs(rows), abs(columns))
            if steps == 0:
                continue
            piece = math.sqrt(rows * rows + columns * columns) / steps
            limit = cost * (1.0 + _SAME)
            line = best[i]
            row, column = row0, column0
            for k in range(1, steps + 1):
                above, beside = row, column
                row = math.floor(row0 + k * (rows / steps) + 0.5)
                column = math.floor(column0 + k * (columns / steps) + 0.5)
                line += piece * weights[row, column]
                if not corner_cutting and row != above and column != beside:
                    line += 0.0 * (weights[above, column] + weights[row, beside])
                if not line <= limit:  # a NaN fails
                    break
            if line <= limit:
                cost = min(cost, line)
                before[j] = i
        best[j] = cost
