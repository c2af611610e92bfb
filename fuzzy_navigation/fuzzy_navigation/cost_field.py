# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What it costs to enter each cell, in the layout that the search reads.

A map whose risks are hundredths, as all that come in occupancy grids are, is kept as one
byte a cell and a table of costs: the search then reads an eighth of the memory. Costs are
the same float64 numbers either way.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import elementwise
from fuzzy_navigation.risk import alpha_cut

__all__ = [
    "HUNDREDTHS",
    "LAID",
    "NOTHING_LAID",
    "NO_ENTRY",
    "START",
    "CostField",
    "coded_costs",
    "cost_field",
    "hundredths",
]

#: Risks that have a code: their number is the code.
HUNDREDTHS = np.arange(101) / 100.0
#: Code of a cell that must not be entered.
NO_ENTRY = 127
#: Code of the start's cell, which may be entered whatever its risk.
START = 126
#: Code of a cell whose cost lies beside the table.
LAID = 125
#: Costs of the cells with the code `LAID`, if there are none.
NOTHING_LAID = np.empty((0, 0))

# Below this least risk the heuristic says nothing and weights are not normalised.
_LEAST_RISK = 1e-9
# Cells that are worked on at a time: their intermediate values stay in a processor's cache.
_BLOCK = 1 << 15

Mu = TypeVar("Mu", float, NDArray[np.float64])


@dataclass(frozen=True)
class CostField:
    """Cost of entering each cell.

    Parameters
    ----------
    cells : ndarray of int8 or float64, shape (H + 2, W + 2)
        The cost, or its index in `table`; the border must not be entered.
    table : ndarray of float64, shape (128,), or None
        Costs by code, infinite for `NO_ENTRY`, 0 for `LAID`; None where `cells` holds costs.
    heuristic : float
        No less than this a straight step costs; 0 where that is not known.
    most : float
        No more than this a straight step costs.
    bottleneck : bool
        Whether a path costs the largest of its cells' costs (A3) rather than their sum.
    laid : ndarray of float64, shape (h, w)
        Costs of the cells of a window whose code is `LAID`.
    corner : tuple of int
        Row and column in `cells` of the first of them.
    """

    cells: NDArray[np.int8] | NDArray[np.float64]
    table: NDArray[np.float64] | None
    heuristic: float
    most: float
    bottleneck: bool
    laid: NDArray[np.float64]
    corner: tuple[int, int]

    def at(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return what it costs to enter some cells of the map, all shape (n,)."""
        values = self.cells[rows + 1, columns + 1]
        if self.table is None:
            return values.astype(np.float64)
        costs = self.table[values]
        laid = values == LAID
        row, column = self.corner
        costs[laid] = self.laid[rows[laid] + 1 - row, columns[laid] + 1 - column]
        return costs

    def admissible(self) -> NDArray[np.bool_]:
        """Return which cells of the map may be entered, shape (H, W)."""
        inner = self.cells[1:-1, 1:-1]
        if self.table is None:
            return np.isfinite(inner)
        free = np.isfinite(self.table)[inner]
        rows, columns = np.nonzero(inner == LAID)
        free[rows, columns] = np.isfinite(self.at(rows, columns))
        return free


def cost_field(
    risk: NDArray[np.float64],
    start: tuple[int, int],
    alpha: float,
    closed: NDArray[np.bool_] | None,
    epsilon: float,
    cost: str,
) -> CostField:
    """Return what it costs to enter each cell.

    Parameters
    ----------
    risk : ndarray of float64, shape (H, W)
        Risks in [0, 1].
    start : tuple of int
        Cell (row, column) that may be entered whatever its risk.
    alpha : float
        Largest risk of a cell that may be entered; there is one beside the start.
    closed : ndarray of bool, shape (H, W), optional
        Cells that must not be entered whatever their risk, the start excepted.
    epsilon : float
        Added to every risk.
    cost : {"g1", "g2", "g3"}
        What a path costs.

    Notes
    -----
    A1 and A2 work on mu / mu_min and its square: a constant factor changes no path, and
    uniform risks become exactly 1, so that sums, ties and paths are the same for both.
    """
    codes = hundredths(risk, closed)
    if codes is not None:
        here = float(risk[start])
        codes[start[0] + 1, start[1] + 1] = START
        table = _table(alpha, epsilon).copy()
        table[START] = here + epsilon
        # The least risk of all cells is that of one that may be entered, for there is one.
        least = min(float(HUNDREDTHS[np.minimum.reduce(codes, axis=None)]), here) + epsilon
        return coded_costs(codes, table, least, epsilon, cost)
    cells, least = _exact(risk, start, alpha, closed, epsilon)
    for rows in _blocks(cells):
        _weighed(cells[rows], least, cost)
    return _field(cells, None, least, epsilon, cost)


@functools.lru_cache
def _table(alpha: float, epsilon: float) -> NDArray[np.float64]:
    """Return the risk of each code with epsilon, infinite for what must not be entered."""
    table = np.full(NO_ENTRY + 1, math.inf)
    table[: len(HUNDREDTHS)] = np.where(alpha_cut(HUNDREDTHS, alpha), HUNDREDTHS, math.inf)
    table += epsilon
    table.flags.writeable = False
    return table


def coded_costs(
    cells: NDArray[np.int8],
    table: NDArray[np.float64],
    least: float,
    epsilon: float,
    cost: str,
    laid: NDArray[np.float64] | None = None,
    corner: tuple[int, int] = (0, 0),
) -> CostField:
    """Return what it costs to enter each cell of a map in codes.

    Parameters
    ----------
    cells : ndarray of int8, shape (H + 2, W + 2)
        Codes, `NO_ENTRY` at the border.
    table : ndarray of float64, shape (128,)
        Risk of each code with epsilon, infinite for what must not be entered; becomes the
        table of costs.
    least : float
        Least risk with epsilon of a cell that may be entered.
    epsilon, cost
        As `cost_field` takes them.
    laid : ndarray of float64, shape (h, w), optional
        Risks with epsilon of the cells of a window that have the code `LAID`, infinite for
        what must not be entered; become costs.
    corner : tuple of int
        Row and column in `cells` of the first of them.
    """
    _weighed(table, least, cost)
    if laid is None:
        return _field(cells, table, least, epsilon, cost)
    _weighed(laid, least, cost)
    table[LAID] = 0.0
    return _field(cells, table, least, epsilon, cost, laid, corner)


def _field(
    cells: NDArray[np.int8] | NDArray[np.float64],
    table: NDArray[np.float64] | None,
    least: float,
    epsilon: float,
    cost: str,
    laid: NDArray[np.float64] = NOTHING_LAID,
    corner: tuple[int, int] = (0, 0),
) -> CostField:
    most = _weighed(1.0 + epsilon, least, cost)
    informed = cost != "g3" and least >= _LEAST_RISK
    return CostField(cells, table, float(informed), most, cost == "g3", laid, corner)


def _weighed(mu: Mu, least: float, cost: str) -> Mu:
    """Turn risks with epsilon into costs, arrays in place; for A3 they are the same."""
    if cost != "g3" and least >= _LEAST_RISK:
        mu /= least
    if cost == "g2":
        mu *= mu
    return mu


def _rows(values: NDArray[np.int8] | NDArray[np.float64]) -> int:
    """Return the number of rows of a block."""
    return max(1, _BLOCK // int(values.shape[1]))


def _blocks(values: NDArray[np.int8] | NDArray[np.float64]) -> list[slice]:
    """Return slices that part the rows."""
    step = _rows(values)
    return [slice(row, row + step) for row in range(0, len(values), step)]


@elementwise
def _whole(risk: Any) -> Any:
    """Return risks as hundredths of type int8, below 0 where they are no whole number of them."""
    whole = np.rint(risk * 100.0)
    return np.int8(whole - 128.0 * (whole / 100.0 != risk))


def hundredths(
    risk: NDArray[np.float64], closed: NDArray[np.bool_] | None = None
) -> NDArray[np.int8] | None:
    """Return the codes of a map with a border.

    Parameters
    ----------
    risk : ndarray of float64, shape (H, W)
        Risks in [0, 1].
    closed : ndarray of bool, shape (H, W), optional
        Cells that must not be entered.

    Returns
    -------
    ndarray of int8 or None
        Risks in hundredths, `NO_ENTRY` where a cell must not be entered and at the border,
        shape (H + 2, W + 2); None if some risk is no hundredth.
    """
    codes = np.full((risk.shape[0] + 2, risk.shape[1] + 2), NO_ENTRY, np.int8)
    inner = codes[1:-1, 1:-1]
    for rows in _blocks(risk):
        inner[rows] = _whole(risk[rows])
        # With the border, which is not negative: whole rows are read fastest.
        if np.minimum.reduce(codes[1:-1][rows], axis=None) < 0:
            return None
    if closed is not None:
        # All bits of NO_ENTRY are set.
        inner |= closed.view(np.int8) * np.int8(NO_ENTRY)
    return codes


def counted(codes: NDArray[np.int8]) -> NDArray[np.int64]:
    """Return how many cells have each of the hundredths, shape (101,).

    Parameters
    ----------
    codes : ndarray of int8, shape (rows, columns)
        0 to 100. Counting takes nine times the memory of the cells that are counted at a time.
    """
    out = np.zeros(len(HUNDREDTHS), np.int64)
    for rows in _blocks(codes):
        out += np.bincount(codes[rows].reshape(-1), minlength=len(out))
    return out


def _exact(
    risk: NDArray[np.float64],
    start: tuple[int, int],
    alpha: float,
    closed: NDArray[np.bool_] | None,
    epsilon: float,
) -> tuple[NDArray[np.float64], float]:
    """Return risks with epsilon and border, and the least of them."""
    out = np.empty((risk.shape[0] + 2, risk.shape[1] + 2))
    out[0] = out[-1] = math.inf
    out[:, 0] = out[:, -1] = math.inf
    here = float(risk[start]) + epsilon
    least = here
    for rows in _blocks(risk):
        admissible = alpha_cut(risk[rows], alpha)
        if closed is not None:
            admissible &= ~closed[rows]
        mu = np.where(admissible, risk[rows] + epsilon, math.inf)
        least = min(least, float(mu.min()))
        out[1:-1, 1:-1][rows] = mu
    out[start[0] + 1, start[1] + 1] = here
    return out, least
