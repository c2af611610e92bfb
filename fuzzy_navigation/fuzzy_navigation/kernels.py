# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Loops of the graph search. The same source runs compiled and as plain Python."""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit

__all__ = ["best_first", "trace"]

# Steps to the adjacent cells: the straight ones first, so that the first four are 4-adjacency.
ROW_STEPS = (-1, 0, 0, 1, -1, -1, 1, 1)
COLUMN_STEPS = (0, -1, 1, 0, -1, 1, -1, 1)
# Lengths of steps that order paths of equal cost: whole numbers with 99 / 70 = sqrt(2) to
# 5e-5, because ties between sums of whole numbers are exact.
STRAIGHT = 70
DIAGONAL = 99
# Cost of a cell that has been expanded: nothing is cheaper, so that nothing replaces it.
CLOSED = -np.inf


@njit
def best_first(
    weight: NDArray[np.float64],
    start: int,
    goal: int,
    adjacency: int,
    diagonal: float,
    corner_cutting: bool,
    bottleneck: bool,
    heuristic: float,
) -> tuple[NDArray[np.int8], int]:
    """Search a cheapest path from `start` to `goal` with A*.

    Cells leave the open list in the order of estimated cost, then estimated length, then
    distance to the goal, then index. With a consistent heuristic each leaves it once.

    Parameters
    ----------
    weight : ndarray of float64, shape (H, W)
        Cost of entering each cell; infinite for cells that must not be entered.
    start, goal : int
        Flat indices of two different cells.
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

    Returns
    -------
    arrival : ndarray of int8, shape (H * W,)
        Step by which the best path known enters each cell, -1 if there is none.
    expanded : int
        Number of cells expanded.
    """
    height, width = weight.shape
    cost = np.full(height * width, np.inf)
    length = np.zeros(height * width, np.int64)
    arrival = np.full(height * width, -1, np.int8)
    goal_row = goal // width
    goal_column = goal % width
    # Distance of the cells (a, b) apart, a >= b: Manhattan, Chebyshev or octile.
    sideways = 1.0 if adjacency == 4 else diagonal - 1.0
    sideways_length = STRAIGHT if adjacency == 4 else DIAGONAL - STRAIGHT

    cost[start] = weight[start // width, start % width] if bottleneck else 0.0
    expanded = 0
    # (estimated cost, estimated length, length left, cell); the start's own estimate is idle.
    frontier = [(0.0, 0, 0, start)]
    while len(frontier) > 0:
        _, _, _, cell = heapq.heappop(frontier)
        if cost[cell] == CLOSED:
            continue  # a dearer entry of a cell that was queued again
        if cell == goal:
            break
        so_far = cost[cell]
        cost[cell] = CLOSED
        expanded += 1
        row = cell // width
        column = cell % width
        for step in range(adjacency):
            next_row = row + ROW_STEPS[step]
            next_column = column + COLUMN_STEPS[step]
            if not (0 <= next_row < height and 0 <= next_column < width):
                continue
            entry = weight[next_row, next_column]
            if entry == np.inf:
                continue
            neighbour = next_row * width + next_column
            if (
                step >= 4
                and not corner_cutting
                and (weight[row, next_column] == np.inf or weight[next_row, column] == np.inf)
            ):
                continue
            if bottleneck:
                # g3 of the longer path: arc costs as in the paper, section IV-A2.
                reached = max(so_far, entry)
            elif step >= 4:
                reached = so_far + diagonal * entry
            else:
                reached = so_far + entry
            reached_length = length[cell] + (DIAGONAL if step >= 4 else STRAIGHT)
            if reached > cost[neighbour] or (
                reached == cost[neighbour] and (bottleneck or reached_length >= length[neighbour])
            ):
                continue
            cost[neighbour] = reached
            length[neighbour] = reached_length
            arrival[neighbour] = step
            rows_left = abs(goal_row - next_row)
            columns_left = abs(goal_column - next_column)
            high = max(rows_left, columns_left)
            low = min(rows_left, columns_left)
            # Equations (15) and below: h = d times the least weight.
            estimate = reached + heuristic * (high + sideways * low)
            left = STRAIGHT * high + sideways_length * low
            order = left if bottleneck else reached_length + left
            heapq.heappush(frontier, (estimate, order, left, neighbour))
    return arrival, expanded


@njit
def trace(arrival: NDArray[np.int8], width: int, start: int, goal: int) -> NDArray[np.int64]:
    """Return the cells (row, column) of the path that `best_first` found, shape (n, 2)."""
    count = 1
    cell = goal
    while cell != start:
        step = arrival[cell]
        cell -= ROW_STEPS[step] * width + COLUMN_STEPS[step]
        count += 1
    path = np.empty((count, 2), np.int64)
    cell = goal
    for k in range(count - 1, -1, -1):
        path[k, 0] = cell // width
        path[k, 1] = cell % width
        if cell != start:
            step = arrival[cell]
            cell -= ROW_STEPS[step] * width + COLUMN_STEPS[step]
    return path
