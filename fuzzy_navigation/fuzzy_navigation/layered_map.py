# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""An augmented map of any risks, with what one request lays over it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import Window
from fuzzy_navigation.plan_types import RiskLayer
from fuzzy_navigation.risk import path_risks
from fuzzy_navigation.rungs import Cells, Query
from fuzzy_navigation.search import SearchResult, admissible_cells, find_path, first_reachable
from fuzzy_navigation.workspace import Workspace

__all__ = ["LayeredMap"]


class LayeredMap:
    """An augmented map as it is, with what one request lays over it.

    Parameters
    ----------
    risk : ndarray of float64, shape (H, W)
        The augmented map.
    layer : RiskLayer, optional
        Risks that come on top.
    barred : ndarray of bool, shape (H, W), optional
        Cells that no path may enter, beside those of the query.
    workspace : Workspace
        Arrays to search in.
    """

    def __init__(
        self,
        risk: NDArray[np.float64],
        layer: RiskLayer | None,
        barred: NDArray[np.bool_] | None,
        workspace: Workspace,
    ) -> None:
        self._risk = self._cut = self._paid = risk
        if layer is not None:
            rows, columns = layer.cells.T
            self._cut, self._paid = risk.copy(), risk.copy()
            self._cut[rows, columns] = np.maximum(risk[rows, columns], layer.cut)
            self._paid[rows, columns] = np.maximum(risk[rows, columns], layer.cost)
        self._barred = barred
        self._workspace = workspace

    def search(self, query: Query, rung: float) -> SearchResult | None:
        """See `Rungs`."""
        admissible = self._admissible(query, rung)
        end = first_reachable(
            admissible, query.start, query.ends, query.adjacency, query.corner_cutting
        )
        if end is None:
            return None
        return find_path(
            self._paid if query.least_risk == 0.0 else np.maximum(self._paid, query.least_risk),
            query.start,
            end,
            query.cost,
            rung,
            query.adjacency,
            epsilon=query.epsilon,
            diagonal=query.diagonal,
            corner_cutting=query.corner_cutting,
            cut=self._cut,
            barred=self._bars(query),
            workspace=self._workspace,
        )

    def blocked(self, query: Query, rung: float) -> bool:
        """See `Rungs`."""
        return not self._admissible(query, rung)[query.ends[:, 0], query.ends[:, 1]].any()

    def risks(self, query: Query, path: Cells) -> tuple[float, float, float]:
        """See `Rungs`."""
        return path_risks(self._risk, path, query.diagonal, query.epsilon)

    def weights(self, query: Query, rung: float, window: Window) -> NDArray[np.float64]:
        """See `Rungs`."""
        mu = np.maximum(self._paid[window.slices], query.least_risk) + query.epsilon
        weights = mu * mu if query.cost == "g2" else mu
        bars = self._bars(query)
        closed = self._cut[window.slices] > rung
        if bars is not None:
            closed |= bars[window.slices]
        closed[query.start[0] - window.row0, query.start[1] - window.col0] = False
        weights[closed] = math.inf
        return weights

    def _bars(self, query: Query) -> NDArray[np.bool_] | None:
        if len(query.barred) == 0:
            return self._barred
        none = np.zeros(self._risk.shape, dtype=np.bool_)
        bars = none if self._barred is None else self._barred.copy()
        bars[query.barred[:, 0], query.barred[:, 1]] = True
        return bars

    def _admissible(self, query: Query, rung: float) -> NDArray[np.bool_]:
        admissible = admissible_cells(self._cut, rung, self._bars(query))
        admissible[query.start] = True
        return admissible
