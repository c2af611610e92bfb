# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Arrays that searches work in, and the search of one path through a field of costs."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import filled, for_kernel, short_for_kernel
from fuzzy_navigation import kernels
from fuzzy_navigation.cost_field import CostField

__all__ = ["Workspace"]

# Entries that a queue has room for at first.
_ENTRIES = 1 << 10
# Most buckets of A1 and A2. While a bucket holds less than the cheapest step, few cells are
# expanded twice: so many do for dearest steps of 500,000 times that, as of A2 with an epsilon of
# 0.001; beyond, the path is as exact and takes up to a hundred times as long.
_BUCKETS = 1 << 20
# Ticks to the least cost of a step: so much longer a path may be before that weighs as much.
_TICKS = 2.0**15
# A bucket has at least 2 ** _BUCKET_BITS ticks; with A3 so many that its cells are as far from
# the goal, but for a step or two.
_BUCKET_BITS = 13
_A3_BUCKET_BITS = 7
# Cells to expand without a limit: not the map's, for on even ground some are expanded several
# times.
_UNLIMITED = int(np.iinfo(np.int64).max)
# Bytes of an entry of a list.
_POINTER = 8
_NO_PATH = np.empty((0, 2), np.int64)


class Workspace:
    """Arrays that are kept from one search to the next.

    A search leaves behind no more than it touched, and that is wiped when it ends: what a
    search costs depends on the cells that it meets, not on the size of the map. One search
    at a time.

    Parameters
    ----------
    wide : bool
        Whether labels are of 64 bits, as they become where a path of a million cells and more
        has no room in 32.
    """

    def __init__(self, wide: bool = False) -> None:
        self._kind: type[Any] = np.int64 if wide else np.int32
        self._forget()

    def _forget(self) -> None:
        """Begin anew."""
        self._shape = (0, 0)
        self._cost = filled(0, kernels.UNSEEN, np.float64)
        self._label = filled(0, 0, self._kind)
        self._buckets = filled(0, -1, np.int32)
        self._queue = filled(_ENTRIES, 0, np.int64)

    @property
    def nbytes(self) -> int:
        """Memory of all arrays [bytes]; without compiled kernels the numbers come on top."""
        arrays = (self._cost, self._label, self._buckets, self._queue)
        return sum(getattr(array, "nbytes", _POINTER * len(array)) for array in arrays)

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
        height, width = field.cells.shape
        origin = (start[0] + 1) * width + start[1] + 1
        target = (goal[0] + 1) * width + goal[1] + 1
        self._fit((height, width))
        form = (field.bottleneck, field.heuristic, field.most, (height, width))
        order = _order(*form, adjacency, diagonal)
        spent = 0.0
        if field.bottleneck:
            spent = order.ticks * float(field.at(*np.array([start]).T)[0])
        self._cost[origin] = spent
        self._label[origin] = 0
        high, low = abs(start[0] - goal[0]), abs(start[1] - goal[1])
        if low > high:
            low, high = high, low
        cost_high, cost_low, tie_high, tie_low, _ = order.ahead
        ticks = int(spent) + (cost_high + tie_high) * high + (cost_low + tie_low) * low
        bucket = ticks >> order.fine_bits
        # Indices by `kernels.FREE` to `kernels.RIGHT`.
        control = filled(11, 0, np.int64)
        control[:] = [-1, 1, 1, bucket, 0, -1, 0, height, 0, width, 0]
        if len(self._buckets) < order.buckets:
            self._buckets = filled(order.buckets, -1, np.int32)
        slots = order.buckets - 1
        self._buckets[bucket & slots] = 0
        self._queue[0] = kernels.first_entry(origin)
        # Beside the cell before, nothing is reached for less through this one: where steps of
        # every kind cost the same, that holds for all cells that both touch.
        everywhere = (field.bottleneck or diagonal == 1.0) and corner_cutting
        steps = _steps(adjacency, everywhere, width)
        # Codes are not negative: no check for indices from the table's end.
        kind = np.float64 if field.table is None else np.uint8
        factors = short_for_kernel(order.factors[steps[1]])
        given = (*steps, factors, self._cost, self._label, self._buckets, slots)
        path = _NO_PATH
        try:
            while not kernels.best_first(
                for_kernel(field.cells.reshape(-1).view(kind)),
                None if field.table is None else short_for_kernel(field.table),
                for_kernel(field.laid.reshape(-1)),
                (*field.corner, field.laid.shape[1]),
                width,
                target,
                _UNLIMITED if limit is None else limit,
                kernels.longest_labelled(int(np.iinfo(self._kind).max)),
                corner_cutting,
                field.bottleneck,
                order.ahead,
                order.fine_bits,
                *(*given, self._queue, control),
            ):
                self._make_room()
            _, _, _, _, expanded, final, _, top, bottom, left, right = map(int, control)
            if final >= 0:
                path = kernels.trace(self._label, width, origin, target)
            self._cost[origin] = kernels.UNSEEN
            window = (max(0, top - 1), bottom + 2, max(0, left - 1), right + 2)
            kernels.wipe(self._cost, width, window, self._buckets, slots)
        except BaseException:  # nobody knows what was touched
            self._forget()
            raise
        if final == kernels.NO_ROOM:
            self._kind = np.int64
            self._forget()
            return self.search(field, start, goal, adjacency, diagonal, corner_cutting, limit)
        return path, expanded

    def _fit(self, shape: tuple[int, int]) -> None:
        """Have room for the cells of a map, or raise ValueError."""
        if self._shape != shape:
            cells = shape[0] * shape[1]
            if cells > kernels.MOST_CELLS:
                raise ValueError(
                    f"a map of {shape[0]} x {shape[1]} cells is too large to search; "
                    f"at most {kernels.MOST_CELLS} cells can be"
                )
            self._cost = filled(cells, kernels.UNSEEN, np.float64)
            self._label = filled(cells, 0, self._kind)
            self._shape = shape

    def _make_room(self) -> None:
        """Double the room for entries in the middle of a search."""
        taken = len(self._queue)
        wider = filled(2 * taken, 0, np.int64)
        wider[:taken] = self._queue
        self._queue = wider


@dataclass(frozen=True)
class _Order:
    """In which order cells leave the open list, as `best_first` takes it.

    Parameters
    ----------
    ticks : float
        Ticks to a unit of cost.
    factors : ndarray of float64, shape (9,)
        The same, by step as a label has it.
    ahead : tuple of int
        What an entry's ticks hold beside its cost.
    fine_bits : int
        A bucket has 2 ** fine_bits ticks.
    buckets : int
        Number of buckets, a power of two. They are used over and over, as the hours of a
        clock: together they cover more than the ticks can grow by one step.
    """

    ticks: float
    factors: NDArray[np.float64]
    ahead: tuple[int, int, int, int, int]
    fine_bits: int
    buckets: int


@functools.lru_cache
def _order(
    bottleneck: bool,
    heuristic: float,
    dearest: float,
    shape: tuple[int, int],
    adjacency: int,
    diagonal: float,
) -> _Order:
    """Return the order for a field with such costs."""
    sideways = 1.0 if adjacency == 4 else diagonal - 1.0
    beside = kernels.STRAIGHT if adjacency == 4 else kernels.DIAGONAL - kernels.STRAIGHT
    farthest = kernels.DIAGONAL * sum(shape)
    if bottleneck:
        # From hundredth to hundredth of cost, and within that the nearest to the goal first.
        ticks = 2.0 ** (100 * farthest).bit_length()
        ahead, factors = (0, 0, kernels.STRAIGHT, beside, 0), [0.0] + [ticks] * 8
        # Risks lie in [0, 1]; the constant on top is the same for all.
        growth = int(ticks) + 1 + farthest
        fine_bits = _A3_BUCKET_BITS
    else:
        ticks = _TICKS
        while dearest * shape[0] * shape[1] * ticks > 2.0**60:
            ticks /= 2.0
        unit = ticks * heuristic
        ahead = (int(unit), int(unit * sideways), kernels.STRAIGHT, beside, 1)
        factors = [0.0] + [ticks] * 4 + [diagonal * ticks] * 4
        growth = int(diagonal * (ticks * dearest + unit)) + 4 * kernels.DIAGONAL
        fine_bits = max(_BUCKET_BITS, (growth // _BUCKETS).bit_length() + 1)
    buckets = 1 << ((growth >> fine_bits) + 2).bit_length()
    return _Order(ticks, np.array(factors), ahead, fine_bits, buckets)


@functools.cache
def _steps(adjacency: int, everywhere: bool, width: int) -> tuple[Any, ...]:
    """Return the steps worth trying from a cell, as `best_first` takes them.

    Parameters
    ----------
    adjacency : {4, 8}
        Neighbours of a cell.
    everywhere : bool
        Whether the cell before reaches all cells that it touches for less; else only those
        beside it, by a straight step.
    width : int
        Cells in a row, border included.
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
    row_steps, column_steps = np.array(kernels.STEPS)[steps].T.copy()
    lengths = np.where(np.array(steps) < 4, kernels.STRAIGHT, kernels.DIAGONAL)
    offsets = row_steps * width + column_steps
    # An index that counts from them is not negative.
    bounds = np.array(begin, np.uint64)
    moves = (np.array(steps) + 1, offsets, row_steps, column_steps, lengths)
    return tuple(short_for_kernel(array) for array in (bounds, *moves))
