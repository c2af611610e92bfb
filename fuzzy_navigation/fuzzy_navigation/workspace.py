# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Arrays that searches work in, and the search of one path through a field of costs."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import for_kernel
from fuzzy_navigation import kernels
from fuzzy_navigation.cost_field import CostField

__all__ = ["Workspace"]

# Entries that a queue has room for at first.
_ENTRIES = 1 << 10
# Most buckets: their first entries stay in a processor's cache.
_BUCKETS = 1 << 14


class Workspace:
    """Arrays that are kept from one search to the next.

    A search leaves behind no more than it touched, and that is wiped when it ends: what a
    search costs depends on the cells that it meets, not on the size of the map. One search
    at a time.
    """

    def __init__(self) -> None:
        self._state = np.zeros(0, np.int8)
        self._cost = np.empty(0)
        self._length: NDArray[np.int32] | NDArray[np.int64] = np.empty(0, np.int32)
        self._make_entries(_ENTRIES)

    @property
    def nbytes(self) -> int:
        """Memory of all arrays [bytes]."""
        arrays = (self._state, self._cost, self._length, *self._entries())
        return sum(array.nbytes for array in arrays)

    def search(
        self,
        field: CostField,
        start: tuple[int, int],
        goal: tuple[int, int],
        adjacency: int,
        diagonal: float,
        corner_cutting: bool,
        limit: int | None = None,
    ) -> tuple[NDArray[np.int64], int]:
        """Return a cheapest path between two different cells.

        Parameters
        ----------
        field : CostField
            What it costs to enter each cell; start and goal can be entered.
        start, goal : tuple of int
            (row, column).
        adjacency : {4, 8}
            Neighbours of a cell.
        diagonal : float
            Factor on the cost of a diagonal step.
        corner_cutting : bool
            Whether a diagonal step may pass beside a cell that must not be entered.
        limit : int, optional
            Most cells to expand; a path that takes more is not found.

        Returns
        -------
        path : ndarray of int64, shape (n, 2)
            Cells (row, column), both ends included; n = 0 without a path.
        expanded : int
            Number of cells expanded.
        """
        width = field.cells.shape[1]
        origin = (start[0] + 1) * width + start[1] + 1
        target = (goal[0] + 1) * width + goal[1] + 1
        self._fit(field.cells.size)
        flat = field.cells.reshape(-1)
        self._cost[origin] = 0.0
        if field.bottleneck:
            code = flat[origin]
            self._cost[origin] = field.table[code] if field.coded else code
        self._length[origin] = 0

        high, low = sorted((abs(start[0] - goal[0]), abs(start[1] - goal[1])), reverse=True)
        estimate = field.heuristic * (high + (1.0 if adjacency == 4 else diagonal - 1.0) * low)
        fineness, buckets = _buckets(field, diagonal)
        control = np.zeros(8, np.int64)
        control[kernels.FREE], control[kernels.ROOM] = 0, len(self._links)
        control[kernels.BUCKET] = int(estimate * fineness)
        control[kernels.LOWEST] = field.cells.size
        self._links[:] = np.arange(1, len(self._links) + 1)
        self._hot[0][0], self._hot[1][0], self._hot[2][0] = estimate, 0, origin
        control[kernels.HOT] = 1
        # Beside the cell before, nothing is reached for less through this one: where steps of
        # every kind cost the same, that holds for all cells that both touch.
        everywhere = field.bottleneck or diagonal == 1.0
        begin, steps = _steps(adjacency, everywhere and corner_cutting)
        rows, columns = np.array(kernels.STEPS).T
        moves = np.concatenate([rows * width + columns, rows, columns])
        most = field.cells.size if limit is None else limit
        request = (width, target, most, adjacency, diagonal, corner_cutting, field.bottleneck)
        try:
            while True:
                cells = (begin, steps, moves, self._state, self._cost, self._length, buckets)
                arrays: list[Any] = [for_kernel(a) for a in (*cells, *self._entries(), control)]
                if kernels.best_first(
                    for_kernel(flat),
                    for_kernel(field.table),
                    field.coded,
                    *request,
                    field.heuristic,
                    fineness,
                    *arrays,
                ):
                    break
                self._make_room(control)
            path = np.empty((0, 2), np.int64)
            if kernels.CLOSED < self._state[target] < kernels.BLOCKED:
                path = kernels.trace(self._state, width, origin, target)
        except BaseException:  # nobody knows what was touched
            self._state[:] = 0
            raise
        lowest, highest = int(control[kernels.LOWEST]), int(control[kernels.HIGHEST])
        self._state[max(0, lowest - width - 1) : highest + width + 2] = 0
        return path, int(control[kernels.EXPANDED])

    def _fit(self, cells: int) -> None:
        """Have room for a number of cells."""
        if len(self._state) != cells:
            self._state = np.zeros(cells, np.int8)
            self._cost = np.empty(cells)
            # A path enters each cell once.
            wide = cells * kernels.DIAGONAL > np.iinfo(np.int32).max
            self._length = np.empty(cells, np.int64) if wide else np.empty(cells, np.int32)

    def _make_entries(self, number: int) -> None:
        self._links = np.empty(number, np.int32)
        self._queued = (np.empty(number), np.empty(number, np.int64), np.empty(number, np.int32))
        self._hot = (np.empty(number), np.empty(number, np.int64), np.empty(number, np.int32))

    def _make_room(self, control: NDArray[np.int64]) -> None:
        """Double the room for entries in the middle of a search."""
        number = len(self._links)
        entries = self._entries()
        self._make_entries(2 * number)
        for old, new in zip(entries, self._entries(), strict=True):
            new[:number] = old
        self._links[number:] = np.arange(number + 1, 2 * number + 1)
        self._links[-1] = control[kernels.FREE]
        control[kernels.FREE] = number
        control[kernels.ROOM] += number

    def _entries(self) -> tuple[NDArray[Any], ...]:
        return (self._links, *self._queued, *self._hot)


def _buckets(field: CostField, diagonal: float) -> tuple[float, NDArray[np.int32]]:
    """Return how many buckets there are to a unit of cost, and empty ones.

    They are used over and over, as the hours of a clock: together they cover more than the
    estimated cost can grow by one step.
    """
    span = diagonal * (field.most + field.heuristic)
    if field.heuristic > 0.0:
        fine = 2.0 ** round(0.5 * np.log2(field.cells.size) - 3.5)
        fineness = min(max(fine, 16.0), 256.0, (_BUCKETS - 2) / span)
    else:
        fineness = 1022.0 / span if span > 0.0 else 1.0
    number = 1 << int(span * fineness + 1.0).bit_length()
    return fineness, np.full(number, -1, np.int32)


@functools.cache
def _steps(adjacency: int, everywhere: bool) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the steps worth trying from a cell by its state, as `best_first` takes them.

    Parameters
    ----------
    adjacency : {4, 8}
        Neighbours of a cell.
    everywhere : bool
        Whether the cell before reaches all cells that it touches for less; else only those
        beside it, by a straight step.
    """
    begin, steps = [0], list(range(adjacency))
    begin.append(len(steps))
    for row, column in kernels.STEPS:
        for step, (next_row, next_column) in enumerate(kernels.STEPS[:adjacency]):
            rows, columns = abs(row + next_row), abs(column + next_column)
            touched = max(rows, columns) <= 1 and adjacency == 8 and everywhere
            if not (rows + columns == 0 or touched or (rows + columns == 1 and adjacency == 8)):
                steps.append(step)
        begin.append(len(steps))
    return np.array(begin), np.array(steps)
