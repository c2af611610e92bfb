# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Loops of the graph search. The same source runs compiled and as plain Python.

Grids are flat and have a border of one cell around them that must not be entered, so that
no step needs to be checked against the grid's edge: a cell (row, column) has the index
``(row + 1) * width + column + 1`` with `width` two more than the map's.

Arrays come in from outside and are never replaced here. Where one is too small the loop
returns; it goes on where it was when it is called again with larger ones.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from fuzzy_navigation.cost_field import LAID

__all__ = ["DIAGONAL", "MOST_CELLS", "STEPS", "STRAIGHT", "UNSEEN", "best_first", "trace", "wipe"]

#: Steps (rows, columns) to the adjacent cells: the straight ones first, so that the first four
#: are 4-adjacency.
STEPS = ((-1, 0), (0, -1), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1))
#: Lengths of steps that order paths of equal cost: whole numbers with 99 / 70 = sqrt(2) to
#: 5e-5, because ties between sums of whole numbers are exact.
STRAIGHT = 70
DIAGONAL = 99

#: Cost of a cell that no path is known to: less than infinity, which a cell costs that must not
#: be entered, so that one comparison tells whether a step is worth taking.
UNSEEN = float(np.finfo(np.float64).max)

# The label of a cell to which a path is known is the path's length times 16, and 1 to 8, that
# its last step was step 0 to 7 [0: the start]; all bits of it turned once it was expanded.
_STEP_BITS = 4
_STEP = 15

#: What the loop keeps between two calls, by index.
FREE, FRESH, WAITING, BUCKET, EXPANDED, FINAL, LONGEST = range(7)
TOP, BOTTOM, LEFT, RIGHT = range(7, 11)
#: What it keeps as `FINAL` when a path became too long for the labels.
NO_ROOM = -2

# Whoever sees this knows that the index is not negative: no check for indices from the end.
_INDEX = 0x7FFFFFFF
# Bits of an entry below the next of its chain.
_LINK = 32
_VISIT = 0xFFFFFFFF
#: Most cells of a map, its border included: more have no room in an entry.
MOST_CELLS = 1 << (_LINK - _STEP_BITS)

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Int32Array = NDArray[np.int32]


def longest_labelled(most: int) -> int:
    """Return the length of paths from which on a step more may need a label above `most`."""
    return ((most - _STEP) >> _STEP_BITS) - DIAGONAL


@njit
def _weight(
    cell: int,
    field: NDArray[np.uint8] | FloatArray,
    table: FloatArray | None,
    laid: FloatArray,
    frame: tuple[int, int, int],
    width: int,
) -> float:
    """Return what it costs to enter a cell, as `best_first` does."""
    if table is None:
        weight: float = field[cell]
    else:
        code = field[cell]
        weight = table[code]
        if code == LAID:
            row = cell // width - frame[0]
            weight = laid[row * frame[2] + cell % width - frame[1]]
    return weight


def first_entry(start: int) -> int:
    """Return the entry of the start, alone in its chain."""
    return (-1 << _LINK) + (start << _STEP_BITS)


@njit
def best_first(
    field: NDArray[np.uint8] | FloatArray,
    table: FloatArray | None,
    laid: FloatArray,
    frame: tuple[int, int, int],
    width: int,
    goal: int,
    limit: int,
    longest_labelled: int,
    corner_cutting: bool,
    bottleneck: bool,
    ahead: tuple[int, int, int, int, int],
    fine_bits: int,
    begin: IntArray,
    arrivals: IntArray,
    offsets: IntArray,
    rows: IntArray,
    columns: IntArray,
    lengths: IntArray,
    factors: FloatArray,
    cost: FloatArray,
    label: Int32Array | IntArray,
    buckets: Int32Array,
    slots: int,
    queue: IntArray,
    control: IntArray,
) -> bool:
    """Search a cheapest path to `goal` with A*.

    Parameters
    ----------
    field : ndarray of uint8 or float64, shape (cells,)
        Cost of entering each cell, as an index into `table` or itself; infinite for cells
        that must not be entered, the border among them.
    table : ndarray of float64, shape (128,), or None
        Costs that the field points to, if it does.
    laid : ndarray of float64, shape (any,)
        Costs of the cells of a window to which the field points as `LAID`.
    frame : tuple of int
        First row and column of the window, and cells in a row of it.
    width : int
        Cells in a row, border included.
    goal : int
        Index of a cell. That of the start is waiting.
    limit, longest_labelled : int
        Most cells to expand, and longest path to one; the search is over before it expands more
        or one farther away.
    corner_cutting : bool
        Whether a diagonal step may pass a cell that must not be entered.
    bottleneck : bool
        Whether a path costs its largest weight (A3) rather than the sum (A1, A2).
    ahead : tuple of int
        What an entry's ticks hold beside the cost of the path to its cell, which is (a, b)
        rows and columns or columns and rows from the goal, a >= b: a and b times the first
        two, which is the estimated cost; a and b times the next two, and the path's length
        times the last, which decide between equal costs.
    fine_bits : int
        A bucket has 2 ** fine_bits ticks.
    begin : ndarray of uint64, shape (10,)
        Which steps are worth trying from a cell, by the last step to it: after step s - 1
        those from number begin[s] to begin[s + 1] - 1.
    arrivals, offsets, rows, columns, lengths : ndarray of int64, shape (any,)
        Of each of them: as in a label, what it adds to an index, its rows, columns, length.
    factors : ndarray of float64, shape (any,)
        Of each of them the factor on its cost: ticks to a unit of cost among others.
    cost, label : ndarray, shape (cells,)
        Cost and label of the best path known to each cell; `cost` is `UNSEEN` where none is.
    buckets : ndarray of int32, shape (more than slots,)
        First entry of each chain, -1 for none.
    slots : int
        Number of buckets less one, a power of two less one.
    queue : ndarray of int64, shape (entries,)
        Entries: the next of the chain in the upper half, the cell and the last step to it,
        as in its label, in the lower.
    control : ndarray of int64, shape (11,)
        What is kept between two calls.

    Returns
    -------
    bool
        Whether the search is over; else the entries need more room.

    Notes
    -----
    Open cells wait in buckets, each a chain that the last to come leaves first. The bucket of
    an entry is told by its ticks: the estimated cost of a path through the cell, plus what
    decides between equal costs.

    That is not quite the order of least cost, then least length. So a cell may leave before
    the best path to it is known; then it waits once more. The search is over when no entry
    is left whose estimated cost and length are less than the goal's: the path found has the
    least cost, and the least length of those.
    """
    goal_row = goal // width
    goal_column = goal % width
    cost_high, cost_low, tie_high, tie_low, tie_length = ahead
    some_laid = table is not None and len(laid) > 0
    slots &= _INDEX
    most = len(queue) - 9
    free = control[FREE]
    fresh = control[FRESH]
    waiting = control[WAITING]
    bucket = control[BUCKET]
    expanded = control[EXPANDED]
    # Ticks of the path found, -1 without one.
    final = control[FINAL]
    longest = control[LONGEST]
    top = control[TOP]
    bottom = control[BOTTOM]
    leftmost = control[LEFT]
    rightmost = control[RIGHT]
    # The best cell that the last expansion opened, where it is in turn: it need not wait.
    held = -1
    over = False
    while True:
        if waiting > most:
            if held >= 0:
                slot = bucket & slots
                queue[fresh] = (buckets[slot] << _LINK) + held
                buckets[slot] = fresh
                fresh += 1
                waiting += 1
            break
        if held >= 0:
            visit = held
            held = -1
        else:
            if waiting == 0:
                over = True
                break
            slot = bucket & slots
            while buckets[slot] < 0:
                bucket += 1
                slot = bucket & slots
            # No entry of a better path has more: what decides ties may yet grow, `longest` too.
            if final >= 0 and bucket > (final + longest) >> fine_bits:
                over = True
                break
            entry = buckets[slot] & _INDEX
            visit = queue[entry] & _VISIT
            buckets[slot] = queue[entry] >> _LINK
            queue[entry] = free
            free = entry
            waiting -= 1
        cell = visit >> _STEP_BITS
        arrival = visit & _STEP
        known = label[cell]
        if known < 0:
            continue  # expanded since it came here
        so_far = cost[cell]
        so_long = known >> _STEP_BITS
        row = cell // width
        column = cell - row * width
        if cell == goal:
            final = int(so_far)
            continue
        if final >= 0:
            high = max(abs(goal_row - row), abs(goal_column - column))
            low = min(abs(goal_row - row), abs(goal_column - column))
            best = cost[goal]
            estimate = so_far + cost_high * high + cost_low * low
            if estimate > best or (
                estimate == best
                and (
                    tie_length == 0
                    or so_long + tie_high * high + tie_low * low >= label[goal] >> _STEP_BITS
                )
            ):
                continue
        if expanded == limit or so_long > longest_labelled:
            final = -1 if expanded == limit else NO_ROOM
            over = True
            break
        label[cell] = ~known
        expanded += 1
        if row < top:
            top = row
        if row > bottom:
            bottom = row
        if column < leftmost:
            leftmost = column
        if column > rightmost:
            rightmost = column
        held_ticks = 0
        down = goal_row - row
        across = goal_column - column
        for i in range(begin[arrival], begin[arrival + 1]):
            neighbour = (cell + offsets[i]) & _INDEX
            weight = field[neighbour] if table is None else table[field[neighbour]]
            # g3 of the longer path: arc costs as in the paper, section IV-A2.
            reached = factors[i] * weight
            if not bottleneck:
                reached += so_far
            elif reached < so_far:
                reached = so_far
            before = cost[neighbour]
            if reached > before:
                continue
            if some_laid and field[neighbour] == LAID:
                # The table says 0, which is too little: few cells are laid and many looked at.
                reached = factors[i] * _weight(neighbour, field, table, laid, frame, width)
                if not bottleneck:
                    reached += so_far
                elif reached < so_far:
                    reached = so_far
                if reached > before:
                    continue
            reached_length = so_long + lengths[i]
            if reached == before:
                if tie_length == 0:
                    continue
                other = label[neighbour]
                if reached_length >= max(other, ~other) >> _STEP_BITS:
                    continue
            row_step = rows[i]
            column_step = columns[i]
            if not corner_cutting and row_step != 0 and column_step != 0:
                above = _weight(cell + row_step * width, field, table, laid, frame, width)
                beside = _weight(cell + column_step, field, table, laid, frame, width)
                if above == np.inf or beside == np.inf:
                    continue
            cost[neighbour] = reached
            arrival = arrivals[i]
            label[neighbour] = (reached_length << _STEP_BITS) + arrival
            visit = (neighbour << _STEP_BITS) + arrival
            high = abs(down - row_step)
            low = abs(across - column_step)
            if low > high:
                low, high = high, low
            tie = tie_high * high + tie_low * low + tie_length * reached_length
            if tie > longest:
                longest = tie
            # Equations (15) and below: h = d times the least weight.
            ticks = int(reached) + cost_high * high + cost_low * low + tie
            turn = ticks >> fine_bits
            if turn <= bucket:
                if held < 0:
                    held = visit
                    held_ticks = ticks
                    continue
                if ticks < held_ticks:
                    visit, held = held, visit
                    ticks, held_ticks = held_ticks, ticks
                    turn = ticks >> fine_bits
                # Asked here, not of each entry: few belong into this bucket or one before.
                if turn < bucket:
                    bucket = turn
            if free >= 0:
                entry = free & _INDEX
                free = queue[entry]
            else:
                entry = fresh & _INDEX
                fresh += 1
            waiting += 1
            slot = turn & slots
            queue[entry] = (buckets[slot] << _LINK) + visit
            buckets[slot] = entry
        if held >= 0:
            bucket = min(bucket, held_ticks >> fine_bits)
    control[FREE] = free
    control[FRESH] = fresh
    control[WAITING] = waiting
    control[BUCKET] = bucket
    control[EXPANDED] = expanded
    control[FINAL] = final
    control[LONGEST] = longest
    control[TOP] = top
    control[BOTTOM] = bottom
    control[LEFT] = leftmost
    control[RIGHT] = rightmost
    return over


@njit
def trace(label: Int32Array | IntArray, width: int, start: int, goal: int) -> IntArray:
    """Return the cells (row, column) of the path that `best_first` found, shape (n, 2)."""
    count = 1
    cell = goal
    while cell != start:
        known = label[cell]
        row_step, column_step = STEPS[(max(known, ~known) & _STEP) - 1]
        cell -= row_step * width + column_step
        count += 1
    path = np.empty((count, 2), np.int64)
    cell = goal
    for k in range(count - 1, -1, -1):
        path[k, 0] = cell // width - 1
        path[k, 1] = cell % width - 1
        if cell != start:
            known = label[cell]
            row_step, column_step = STEPS[(max(known, ~known) & _STEP) - 1]
            cell -= row_step * width + column_step
    return path


@njit
def wipe(
    cost: FloatArray,
    width: int,
    window: tuple[int, int, int, int],
    buckets: Int32Array,
    slots: int,
) -> None:
    """Forget a search: costs in a window, (row0, row1, column0, column1), and the open cells."""
    row0, row1, column0, column1 = window
    for row in range(row0, row1):
        for cell in range(row * width + column0, row * width + column1):
            cost[cell] = UNSEEN
    for slot in range(slots + 1):
        buckets[slot] = -1
