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

__all__ = ["DIAGONAL", "STEPS", "STRAIGHT", "best_first", "trace"]

#: Steps (rows, columns) to the adjacent cells: the straight ones first, so that the first four
#: are 4-adjacency.
STEPS = ((-1, 0), (0, -1), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1))
#: Lengths of steps that order paths of equal cost: whole numbers with 99 / 70 = sqrt(2) to
#: 5e-5, because ties between sums of whole numbers are exact.
STRAIGHT = 70
DIAGONAL = 99

#: State of a cell: 0 not seen, 1 to 8 entered by step 0 to 7 and open, `CLOSED` added once it
#: has been expanded, `BLOCKED` if it must not be entered.
CLOSED = 16
BLOCKED = 64
_ARRIVAL = 15

#: What the loop keeps between two calls, by index.
FREE, ROOM, HOT, WAITING, BUCKET, EXPANDED, LOWEST, HIGHEST = range(8)

# Room in a tie for the length left, below the estimated length.
_LEFT = 1 << 28
# Whoever sees this knows that the index is not negative: no check for indices from the end.
_INDEX = 0x7FFFFFFF

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Int32Array = NDArray[np.int32]


@njit
def _sift_up(
    estimates: FloatArray,
    ties: IntArray,
    cells: Int32Array,
    place: int,
    estimate: float,
    tie: int,
    cell: int,
) -> None:
    """Put an entry into a binary heap whose last place is free."""
    while place > 0:
        parent = ((place - 1) >> 1) & _INDEX
        other = estimates[parent]
        if other < estimate or (
            other == estimate
            and (ties[parent] < tie or (ties[parent] == tie and cells[parent] < cell))
        ):
            break
        estimates[place] = other
        ties[place] = ties[parent]
        cells[place] = cells[parent]
        place = parent
    estimates[place] = estimate
    ties[place] = tie
    cells[place] = cell


@njit
def _drop_first(estimates: FloatArray, ties: IntArray, cells: Int32Array, last: int) -> None:
    """Take the least entry out of a binary heap whose last entry is at `last`."""
    estimate = estimates[last]
    tie = ties[last]
    cell = cells[last]
    place = 0
    while True:
        child = (2 * place + 1) & _INDEX
        if child >= last:
            break
        if child + 1 < last:
            left = estimates[child]
            right = estimates[child + 1]
            if right < left or (
                right == left
                and (
                    ties[child + 1] < ties[child]
                    or (ties[child + 1] == ties[child] and cells[child + 1] < cells[child])
                )
            ):
                child += 1
        other = estimates[child]
        if estimate < other or (
            estimate == other
            and (tie < ties[child] or (tie == ties[child] and cell < cells[child]))
        ):
            break
        estimates[place] = other
        ties[place] = ties[child]
        cells[place] = cells[child]
        place = child
    estimates[place] = estimate
    ties[place] = tie
    cells[place] = cell


@njit
def best_first(
    field: NDArray[np.int8] | FloatArray,
    table: FloatArray,
    coded: bool,
    width: int,
    goal: int,
    limit: int,
    adjacency: int,
    diagonal: float,
    corner_cutting: bool,
    bottleneck: bool,
    heuristic: float,
    fineness: float,
    begin: IntArray,
    steps: IntArray,
    moves: IntArray,
    state: NDArray[np.int8],
    cost: FloatArray,
    length: Int32Array | IntArray,
    buckets: Int32Array,
    links: Int32Array,
    queued_estimates: FloatArray,
    queued_ties: IntArray,
    queued_cells: Int32Array,
    hot_estimates: FloatArray,
    hot_ties: IntArray,
    hot_cells: Int32Array,
    control: IntArray,
) -> bool:
    """Search a cheapest path to `goal` with A*.

    Cells leave the open list in the order of estimated cost, then estimated length, then
    distance to the goal, then index. With a consistent heuristic each leaves it once. The
    open list is an array of buckets of estimated cost, each a chain without order; only the
    one in turn is in order, as a heap: the hot entries.

    Parameters
    ----------
    field : ndarray of int8 or float64, shape (cells,)
        Cost of entering each cell, as an index into `table` or itself; infinite for cells
        that must not be entered, the border among them.
    table : ndarray of float64
        Costs that the field points to.
    coded : bool
        Whether the field points to the table.
    width : int
        Cells in a row, border included.
    goal : int
        Index of a cell. That of the start is among the hot entries.
    limit : int
        Most cells to expand; the search is over before the next.
    adjacency : int
        4 or 8.
    diagonal : float
        Factor on the cost of a diagonal step.
    corner_cutting : bool
        Whether a diagonal step may pass a cell that must not be entered.
    bottleneck : bool
        Whether a path costs its largest weight (A3) rather than the sum (A1, A2).
    heuristic : float
        Estimated cost of a straight step [0: not informed].
    fineness : float
        Buckets to a unit of cost.
    begin, steps : ndarray of int64, shapes (10,) and (any,)
        Steps worth trying from a cell, by the state of the cell: those of state s are
        ``steps[begin[s]:begin[s + 1]]``.
    moves : ndarray of int64, shape (24,)
        What each step adds to an index, then its rows, then its columns.
    state, cost, length : ndarray, shape (cells,)
        State, cost and length of the best path known to each cell; cost and length count
        where the state is neither 0 nor `BLOCKED`.
    buckets : ndarray of int32, shape (a power of two,)
        First entry of each chain, -1 for none.
    links, queued_estimates, queued_ties, queued_cells : ndarray, shape (entries,)
        Next of the chain, and what an entry holds.
    hot_estimates, hot_ties, hot_cells : ndarray, shape (entries,)
        The heap.
    control : ndarray of int64, shape (8,)
        What is kept between two calls.

    Returns
    -------
    bool
        Whether the search is over; else the entries need more room.
    """
    goal_row = goal // width
    goal_column = goal % width
    # Distance of the cells (a, b) apart, a >= b: Manhattan, Chebyshev or octile.
    sideways = 1.0 if adjacency == 4 else diagonal - 1.0
    sideways_length = STRAIGHT if adjacency == 4 else DIAGONAL - STRAIGHT
    mask = (len(buckets) - 1) & _INDEX
    free = control[FREE]
    room = control[ROOM]
    hot = control[HOT]
    waiting = control[WAITING]
    bucket = control[BUCKET]
    expanded = control[EXPANDED]
    lowest = control[LOWEST]
    highest = control[HIGHEST]
    # The least of the entries that the last expansion made, where that is hot: often the next
    # in turn, and then it need not pass through the heap.
    held = -1
    held_estimate = 0.0
    held_tie = 0
    over = False
    while True:
        slot = bucket & mask
        if held >= 0:
            cell = held & _INDEX
            held = -1
        elif hot > 0 and buckets[slot] < 0:
            cell = hot_cells[0] & _INDEX
            hot -= 1
            if hot > 0:
                _drop_first(hot_estimates, hot_ties, hot_cells, hot)
        else:
            if hot == 0 and waiting == 0:
                over = True
                break
            while buckets[slot] < 0:
                bucket += 1
                slot = bucket & mask
            entry = buckets[slot]
            while entry >= 0 and hot < len(hot_cells):
                entry = entry & _INDEX
                cell = queued_cells[entry] & _INDEX
                if state[cell] < CLOSED:
                    _sift_up(
                        hot_estimates,
                        hot_ties,
                        hot_cells,
                        hot,
                        queued_estimates[entry],
                        queued_ties[entry],
                        cell,
                    )
                    hot += 1
                following = links[entry]
                links[entry] = free
                free = entry
                room += 1
                waiting -= 1
                entry = following
            buckets[slot] = entry
            if entry >= 0:
                break
            continue
        arrival = state[cell] & _INDEX
        if arrival >= CLOSED:
            continue  # a dearer entry of a cell that was queued again
        if room < 8 or hot + 8 > len(hot_cells):
            _sift_up(hot_estimates, hot_ties, hot_cells, hot, 0.0, 0, cell)
            hot += 1
            break
        state[cell] = arrival + CLOSED
        if cell == goal or expanded == limit:
            over = True
            break
        expanded += 1
        lowest = min(lowest, cell)
        highest = max(highest, cell)
        so_far = cost[cell]
        so_long = length[cell]
        row = cell // width
        column = cell - row * width
        for i in range(begin[arrival], begin[arrival + 1]):
            step = steps[i] & 7
            neighbour = (cell + moves[step]) & _INDEX
            known = state[neighbour]
            if known >= CLOSED:
                continue
            weight = table[int(field[neighbour])] if coded else field[neighbour]
            if weight == np.inf:
                state[neighbour] = BLOCKED
                continue
            row_step = moves[8 + step]
            column_step = moves[16 + step]
            if step >= 4 and not corner_cutting:
                above = (cell + row_step * width) & _INDEX
                beside = (cell + column_step) & _INDEX
                weight_above = table[int(field[above])] if coded else field[above]
                weight_beside = table[int(field[beside])] if coded else field[beside]
                if weight_above == np.inf or weight_beside == np.inf:
                    continue
            if bottleneck:
                # g3 of the longer path: arc costs as in the paper, section IV-A2.
                reached = max(so_far, weight)
            elif step >= 4:
                reached = so_far + diagonal * weight
            else:
                reached = so_far + weight
            reached_length = so_long + (DIAGONAL if step >= 4 else STRAIGHT)
            if known > 0:
                before = cost[neighbour]
                if reached > before or (
                    reached == before and (bottleneck or reached_length >= length[neighbour])
                ):
                    continue
            cost[neighbour] = reached
            length[neighbour] = reached_length
            state[neighbour] = step + 1
            rows_left = abs(goal_row - row - row_step)
            columns_left = abs(goal_column - column - column_step)
            high = max(rows_left, columns_left)
            low = min(rows_left, columns_left)
            # Equations (15) and below: h = d times the least weight.
            estimate = reached + heuristic * (high + sideways * low)
            left = STRAIGHT * high + sideways_length * low
            tie = left if bottleneck else (reached_length + left) * _LEFT + left
            turn = int(estimate * fineness)
            if turn <= bucket:
                if (
                    held < 0
                    or estimate < held_estimate
                    or (
                        estimate == held_estimate
                        and (tie < held_tie or (tie == held_tie and neighbour < held))
                    )
                ):
                    other, other_estimate, other_tie = held, held_estimate, held_tie
                    held, held_estimate, held_tie = neighbour, estimate, tie
                else:
                    other, other_estimate, other_tie = neighbour, estimate, tie
                if other >= 0:
                    _sift_up(
                        hot_estimates, hot_ties, hot_cells, hot, other_estimate, other_tie, other
                    )
                    hot += 1
            else:
                entry = free & _INDEX
                free = links[entry]
                room -= 1
                waiting += 1
                slot = turn & mask
                queued_estimates[entry] = estimate
                queued_ties[entry] = tie
                queued_cells[entry] = neighbour
                links[entry] = buckets[slot]
                buckets[slot] = entry
        if held >= 0 and hot > 0:
            first = hot_estimates[0]
            if first < held_estimate or (
                first == held_estimate
                and (hot_ties[0] < held_tie or (hot_ties[0] == held_tie and hot_cells[0] < held))
            ):
                _sift_up(hot_estimates, hot_ties, hot_cells, hot, held_estimate, held_tie, held)
                hot += 1
                held = -1
    control[FREE] = free
    control[ROOM] = room
    control[HOT] = hot
    control[WAITING] = waiting
    control[BUCKET] = bucket
    control[EXPANDED] = expanded
    control[LOWEST] = lowest
    control[HIGHEST] = highest
    return over


@njit
def trace(state: NDArray[np.int8], width: int, start: int, goal: int) -> IntArray:
    """Return the cells (row, column) of the path that `best_first` found, shape (n, 2)."""
    count = 1
    cell = goal
    while cell != start:
        row_step, column_step = STEPS[(state[cell] & _ARRIVAL) - 1]
        cell -= row_step * width + column_step
        count += 1
    path = np.empty((count, 2), np.int64)
    cell = goal
    for k in range(count - 1, -1, -1):
        path[k, 0] = cell // width - 1
        path[k, 1] = cell % width - 1
        if cell != start:
            row_step, column_step = STEPS[(state[cell] & _ARRIVAL) - 1]
            cell -= row_step * width + column_step
    return path
