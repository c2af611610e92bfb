# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The augmented planning map as the planner keeps it: up to date by windows, ready to search.

A map whose risks are hundredths, as all that come in occupancy grids are, is kept as two
bytes a cell, in the layout that the search reads. A search then begins without a look at the
whole map, however large that is. Other maps are kept as they are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import Window
from fuzzy_navigation.cost_field import (
    HUNDREDTHS,
    LAID,
    NO_ENTRY,
    START,
    CostField,
    coded_costs,
    counted,
)
from fuzzy_navigation.plan_types import RiskLayer
from fuzzy_navigation.risk import (
    Footprint,
    changed_window,
    diagonal_factor,
    risks_of_path,
)
from fuzzy_navigation.rungs import Cells, Query, Rungs
from fuzzy_navigation.search import SearchResult, first_reachable
from fuzzy_navigation.workspace import Workspace

__all__ = ["PlanningMap"]

#: After so many expanded cells, or such a share of the map's if that is more, it is worth a
#: look at the whole map, whether the goal can be reached at all.
PATIENCE = 4096
_WORTH_A_LOOK = 1 / 16


@dataclass(frozen=True)
class _Marks:
    """What a request has marked on the map.

    Parameters
    ----------
    start : float
        Risk that a path pays at the start.
    layer : RiskLayer, optional
        Risks that come on top.
    risks : ndarray of float64, shape (n,)
        Risks of the layer's cells without it.
    """

    start: float
    layer: RiskLayer | None
    risks: NDArray[np.float64]


@dataclass(frozen=True)
class _Covered:
    """A planning map in hundredths with a layer of risk over it."""

    ground: PlanningMap
    layer: RiskLayer

    def search(self, query: Query, rung: float) -> SearchResult | None:
        """See `Rungs`."""
        return self.ground.search(query, rung, self.layer)

    def blocked(self, query: Query, rung: float) -> bool:
        """See `Rungs`."""
        return self.ground.blocked(query, rung, self.layer)

    def risks(self, query: Query, path: Cells) -> tuple[float, float, float]:
        """See `Rungs`."""
        return self.ground.risks(query, path)

    def weights(self, query: Query, rung: float, window: Window) -> NDArray[np.float64]:
        """See `Rungs`."""
        return self.ground.weights(query, rung, window, self.layer)


class PlanningMap:
    """A planning map in hundredths and what the robot's footprint makes of it.

    Parameters
    ----------
    codes : ndarray of int8, shape (H, W)
        Risks in hundredths, 0 to 100.
    footprint : Footprint
        The cells under the robot.
    workspace : Workspace
        Arrays to search in.
    """

    def __init__(
        self, codes: NDArray[np.int8], footprint: Footprint, workspace: Workspace
    ) -> None:
        height, width = codes.shape
        self._codes = codes
        self._footprint = footprint
        self._field = np.full((height + 2, width + 2), NO_ENTRY, np.int8)
        self._inner = self._field[1:-1, 1:-1]
        # How many cells have each augmented risk.
        self._count = np.zeros(len(HUNDREDTHS), np.int64)
        self._augment(Window(0, height, 0, width))
        self._workspace = workspace

    @property
    def nbytes(self) -> int:
        """Memory of the map [bytes]."""
        return self._codes.nbytes + self._field.nbytes

    @property
    def codes(self) -> NDArray[np.int8]:
        """The map without augmentation in hundredths, shape (H, W)."""
        return self._codes

    @property
    def planning_risk(self) -> NDArray[np.float64]:
        """The map without augmentation, shape (H, W)."""
        return HUNDREDTHS[self._codes]

    @property
    def augmented_risk(self) -> NDArray[np.float64]:
        """The augmented map, shape (H, W)."""
        return HUNDREDTHS[self._inner]

    def renew(self, codes: NDArray[np.int8]) -> None:
        """Take new risks in hundredths for the whole map, shape (H, W)."""
        window = changed_window(self._codes, codes)
        self.update(codes[window.slices], window)

    def update(self, codes: NDArray[np.int8], window: Window) -> None:
        """Take new risks for a window.

        Parameters
        ----------
        codes : ndarray of int8, shape (h, w)
            Risks in hundredths, 0 to 100.
        window : Window
            Where they are.
        """
        if window.empty:
            return
        self._codes[window.slices] = codes
        touched = self._footprint.grown(window, self._codes.shape)
        self._count -= self._histogram(touched)
        self._augment(touched)

    def under(self, layer: RiskLayer) -> Rungs:
        """Return the map with a layer of risk over it."""
        return _Covered(self, layer)

    def search(
        self, query: Query, rung: float, layer: RiskLayer | None = None
    ) -> SearchResult | None:
        """See `Rungs`."""
        with self._marked(query, layer) as marks:
            risks, field = self._costs(query, rung, marks)
            ends = query.ends[np.isfinite(field.at(*query.ends.T))]
            if len(ends) == 0:
                return None
            size = self._codes.size
            limit = max(PATIENCE, int(size * _WORTH_A_LOOK))
            found = self._path(risks, field, query, ends[0], limit)
            if found is None:
                end = first_reachable(
                    field.admissible(), query.start, ends, query.adjacency, query.corner_cutting
                )
                if end is None:
                    return None
                found = self._path(risks, field, query, end, None)
        return found

    def blocked(self, query: Query, rung: float, layer: RiskLayer | None = None) -> bool:
        """See `Rungs`."""
        with self._marked(query, layer) as marks:
            _, field = self._costs(query, rung, marks)
            return not np.isfinite(field.at(*query.ends.T)).any()

    def risks(self, query: Query, path: Cells) -> tuple[float, float, float]:
        """See `Rungs`."""
        mu = HUNDREDTHS[self._inner[path[:, 0], path[:, 1]]] + query.epsilon
        return risks_of_path(mu, path, query.diagonal)

    def weights(
        self, query: Query, rung: float, window: Window, layer: RiskLayer | None = None
    ) -> NDArray[np.float64]:
        """See `Rungs`."""
        rows, columns = np.mgrid[window.slices]
        with self._marked(query, layer) as marks:
            _, field = self._costs(query, rung, marks)
            return field.at(rows.reshape(-1), columns.reshape(-1)).reshape(window.shape)

    def _path(
        self,
        risks: CostField,
        field: CostField,
        query: Query,
        end: Sequence[int] | Cells,
        limit: int | None,
    ) -> SearchResult | None:
        goal = (int(end[0]), int(end[1]))
        path, expanded = np.array([query.start], dtype=np.int64), 0
        if goal != query.start:
            path, expanded = self._workspace.search(
                field,
                query.start,
                goal,
                query.adjacency,
                diagonal_factor(query.diagonal),
                query.corner_cutting,
                limit,
            )
        if len(path) == 0:
            return None
        costs = risks_of_path(risks.at(*path.T), path, query.diagonal)
        return SearchResult(True, path, *costs, expanded)

    def _costs(self, query: Query, rung: float, marks: _Marks) -> tuple[CostField, CostField]:
        """Return the risks of the cells with epsilon, and what it costs to enter each."""
        paid = np.maximum(HUNDREDTHS, query.least_risk)
        table = np.full(NO_ENTRY + 1, math.inf)
        table[: len(HUNDREDTHS)] = np.where(rung >= HUNDREDTHS, paid, math.inf)
        table[START] = max(marks.start, query.least_risk)
        present = np.append(self._count > 0, [True])
        least = float(np.append(table[: len(HUNDREDTHS)], table[START])[present].min())
        laid, corner = np.empty((0, 0)), (0, 0)
        if marks.layer is not None:
            cells = marks.layer.cells
            dear = np.maximum(np.maximum(marks.risks, marks.layer.cost), query.least_risk)
            dear[np.maximum(marks.risks, marks.layer.cut) > rung] = math.inf
            least = min(least, float(dear.min()))
            first = cells.min(axis=0)
            laid = np.full(cells.max(axis=0) - first + 1, math.inf)
            laid[tuple((cells - first).T)] = dear
            corner = (int(first[0]) + 1, int(first[1]) + 1)
        table += query.epsilon
        laid += query.epsilon
        risks = CostField(self._field, table, 0.0, 0.0, False, laid, corner)
        least += query.epsilon
        kind = (query.epsilon, query.cost)
        return risks, coded_costs(self._field, table.copy(), least, *kind, laid.copy(), corner)

    @contextmanager
    def _marked(self, query: Query, layer: RiskLayer | None) -> Iterator[_Marks]:
        """Have what is special marked, and its risks not counted, meanwhile."""
        if layer is not None and len(layer.cells) == 0:
            layer = None
        cells = np.concatenate([query.barred, [query.start]])
        if layer is not None:
            cells = np.concatenate([layer.cells, cells])
        rows, columns = cells.T
        before = self._inner[rows, columns]
        places = np.unique(rows * self._codes.shape[1] + columns)
        taken = np.bincount(
            self._inner[np.divmod(places, self._codes.shape[1])], minlength=len(HUNDREDTHS)
        )
        start = float(HUNDREDTHS[before[-1]])
        risks = HUNDREDTHS[before[: 0 if layer is None else len(layer.cells)]]
        if layer is not None:
            self._inner[tuple(layer.cells.T)] = LAID
            here = (layer.cells == query.start).all(axis=1)
            start = max(start, float(layer.cost[here].max(initial=0.0)))
        self._count -= taken
        self._inner[query.barred[:, 0], query.barred[:, 1]] = NO_ENTRY
        self._inner[query.start] = START
        try:
            yield _Marks(start, layer, risks)
        finally:
            self._count += taken
            self._inner[rows, columns] = before

    def _histogram(self, window: Window) -> NDArray[np.int64]:
        return counted(self._inner[window.slices])

    def _augment(self, window: Window) -> None:
        """Make the augmented map of a window anew."""
        self._inner[window.slices] = self._footprint.largest_in(self._codes, np.int8(100), window)
        self._count += self._histogram(window)
