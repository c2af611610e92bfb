# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a user would search a grid with instead.

Each is given the costs in the form that it likes best, made beforehand; ours is given the
map as it is and makes its costs itself.
"""

from __future__ import annotations

import functools
import heapq
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pyastar2d
import tcod.path
from maps import Case
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from skimage.graph import MCP

from fuzzy_navigation.search import find_path
from fuzzy_navigation.workspace import Workspace

__all__ = ["ALPHA", "CONTENDERS", "PEER", "Contender", "entering_costs"]

ALPHA = 0.6
EPSILON = 0.2
#: The one that ours is held against.
PEER = "pyastar2d"
# tcod counts in whole numbers.
_TCOD_UNIT = 1000

Path = NDArray[np.int64]
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Contender:
    """One way to search.

    Parameters
    ----------
    prepare : callable
        Takes a case and returns the search, which takes nothing and returns a path.
    exact : float
        Largest relative excess of its cost over the least one.
    cells : int
        Largest map that it is tried on.
    """

    prepare: Callable[[Case], Callable[[], Path]]
    exact: float = 1e-12
    cells: int = 1 << 62


def entering_costs(case: Case) -> FloatArray:
    """Return what it costs A2 to enter each cell, in units of the least; infinite for walls."""
    mu = case.risk + EPSILON
    free = case.risk <= ALPHA
    return np.where(free, (mu / mu[free].min()) ** 2, np.inf)


def ours(case: Case, cost: str = "g2", workspace: Workspace | None = None) -> Callable[[], Path]:
    """A2, or another, of this project."""

    def search() -> Path:
        found = find_path(
            case.risk,
            case.start,
            case.goal,
            cost,
            ALPHA,
            4 if cost == "g3" else 8,
            workspace=workspace,
        )
        return found.path

    return search


def _pyastar2d(case: Case) -> Callable[[], Path]:
    weights = entering_costs(case).astype(np.float32)
    return lambda: pyastar2d.astar_path(weights, case.start, case.goal, allow_diagonal=True)


def _skimage(case: Case) -> Callable[[], Path]:
    weights = entering_costs(case)

    def search() -> Path:
        paths = MCP(weights, fully_connected=True)
        paths.find_costs([case.start], [case.goal])
        return np.array(paths.traceback(case.goal))

    return search


def _tcod(case: Case) -> Callable[[], Path]:
    costs = entering_costs(case)
    whole = np.where(np.isfinite(costs), np.rint(costs * _TCOD_UNIT), 0).astype(np.int32)

    def search() -> Path:
        graph = tcod.path.SimpleGraph(cost=whole, cardinal=1, diagonal=1)
        finder = tcod.path.Pathfinder(graph)
        finder.add_root(case.start)
        return np.asarray(finder.path_to(case.goal), dtype=np.int64)

    return search


def _scipy(case: Case) -> Callable[[], Path]:
    costs = entering_costs(case)
    height, width = costs.shape
    index = np.arange(costs.size).reshape(costs.shape)
    tails, heads = [], []
    for i, j in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = index[: height - i, max(0, -j) : width - max(0, j)].ravel()
        there = index[i:, max(0, j) : width + min(0, j)].ravel()
        tails += [here, there]
        heads += [there, here]
    tail, head = np.concatenate(tails), np.concatenate(heads)
    free = np.isfinite(costs).ravel()
    legal = free[tail] & free[head]
    tail, head = tail[legal], head[legal]
    graph = csr_matrix((costs.ravel()[head], (tail, head)), (costs.size, costs.size))
    first, last = index[case.start], index[case.goal]

    def search() -> Path:
        _, before = dijkstra(graph, indices=first, return_predecessors=True)
        path = [last]
        while path[-1] != first:
            path.append(before[path[-1]])
        return np.stack(np.divmod(path[::-1], width), axis=1)

    return search


def _heapq(case: Case) -> Callable[[], Path]:
    costs = entering_costs(case)
    width = costs.shape[1] + 2
    flat = np.pad(costs, 1, constant_values=np.inf).ravel().tolist()
    row, column = case.goal
    first, last = ((r + 1) * width + c + 1 for r, c in (case.start, case.goal))
    steps = (-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1)

    def search() -> Path:
        before, cost, done = {first: first}, {first: 0.0}, set()
        queue = [(0.0, first)]
        while queue:
            _, cell = heapq.heappop(queue)
            if cell == last:
                break
            if cell in done:
                continue
            done.add(cell)
            for step in steps:
                to = cell + step
                reached = cost[cell] + flat[to]
                if reached < cost.get(to, np.inf):
                    cost[to], before[to] = reached, cell
                    y, x = divmod(to, width)
                    left = max(abs(y - 1 - row), abs(x - 1 - column))
                    heapq.heappush(queue, (reached + left, to))
        path = [last]
        while path[-1] != first:
            path.append(before[path[-1]])
        return np.stack(np.divmod(path[::-1], width), axis=1) - 1

    return search


#: Everyone, by name.
CONTENDERS = {
    "A2": Contender(functools.partial(ours, workspace=Workspace())),
    "A3": Contender(functools.partial(ours, cost="g3", workspace=Workspace()), exact=np.inf),
    PEER: Contender(_pyastar2d, exact=1e-5),  # float32
    "tcod": Contender(_tcod, exact=2e-3),
    "scikit-image": Contender(_skimage),
    "scipy": Contender(_scipy, cells=1_100_000),
    "heapq": Contender(_heapq, cells=1_100_000),
}
