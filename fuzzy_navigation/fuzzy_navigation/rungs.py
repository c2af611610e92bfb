# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the planner asks of a map, and climbs: admissible cells, rung by rung."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import Window
from fuzzy_navigation.search import SearchResult

__all__ = ["Cells", "Query", "Rungs"]

#: Cells (row, column), shape (n, 2).
Cells: TypeAlias = NDArray[np.int64]


@dataclass(frozen=True)
class Query:
    """What a path is asked to be, on every rung.

    Parameters
    ----------
    start : tuple of int
        (row, column), admissible whatever its risk.
    ends : ndarray of int64, shape (n, 2)
        Cells where the path may end, in the order of preference.
    barred : ndarray of int64, shape (m, 2)
        Cells that the path must not enter.
    cost, adjacency, epsilon, diagonal, corner_cutting
        As `search.find_path` takes them.
    least_risk : float
        Risk that every cell costs at least.
    """

    start: tuple[int, int]
    ends: Cells
    barred: Cells
    cost: str
    adjacency: int
    epsilon: float
    diagonal: str
    corner_cutting: bool
    least_risk: float = 0.0


class Rungs(Protocol):
    """What the planner climbs: admissible cells, rung by rung."""

    def search(self, query: Query, rung: float) -> SearchResult | None:
        """Return a path of least cost to the first end that can be reached, None if none can.

        Parameters
        ----------
        query : Query
            What is asked.
        rung : float
            Largest risk of an admissible cell.
        """

    def blocked(self, query: Query, rung: float) -> bool:
        """Whether no end is admissible, be it reachable or not."""

    def risks(self, query: Query, path: Cells) -> tuple[float, float, float]:
        """Return the costs g1, g2, g3 of a path on the augmented map."""

    def weights(self, query: Query, rung: float, window: Window) -> NDArray[np.float64]:
        """Return what it costs to enter each cell of a window that holds the start.

        Infinite where no path may; a constant factor apart, which is the same for all cells.
        """
