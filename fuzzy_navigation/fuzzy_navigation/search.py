# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Paths of least risk on an array of risks: the algorithms A1, A2 and A3.

Cells are (row, column); nothing here knows metres. Equations and sections are those of
Oriolo, Ulivi, Vendittelli, IEEE Trans. SMC-B 28(3), 1998.

Ties are broken the same way on every machine. Among paths of equal cost, A1 and A2
return a shortest one (diagonal steps longer than straight ones, whatever they cost).
A3 prefers cells nearer to the goal, as the paper has it.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from fuzzy_navigation.cost_field import cost_field
from fuzzy_navigation.risk import (
    alpha_cut,
    checked_risk,
    diagonal_factor,
    path_risks,
    real_numbers,
)
from fuzzy_navigation.workspace import Workspace

__all__ = ["COSTS", "SearchResult", "admissible_cells", "find_path", "first_reachable", "warm_up"]

#: Path costs, and the algorithms that minimise them: A1, A2, A3.
COSTS = ("g1", "g2", "g3")

# With a larger constant all risks together weigh less than a step, on paths of 1000 cells.
_MOST_EPSILON = 1000.0


@dataclass(frozen=True)
class SearchResult:
    """Outcome of a search.

    Parameters
    ----------
    found : bool
        Whether a path exists.
    path : ndarray of int64, shape (n, 2)
        Cells (row, column) from start to goal, both included; n = 0 without a path.
    g1, g2, g3 : float
        Sum of the risks along the path, of their squares, and the largest, epsilon
        included; infinite without a path.
    expanded : int
        Number of cells expanded.
    """

    found: bool
    path: NDArray[np.int64]
    g1: float
    g2: float
    g3: float
    expanded: int


def find_path(
    risk: ArrayLike,
    start: tuple[int, int],
    goal: tuple[int, int],
    cost: str = "g2",
    alpha: float = 0.6,
    adjacency: int = 8,
    *,
    epsilon: float = 0.2,
    diagonal: str = "unit",
    corner_cutting: bool = True,
    cut: ArrayLike | None = None,
    barred: ArrayLike | None = None,
    workspace: Workspace | None = None,
) -> SearchResult:
    """Return a path of least cost among the admissible cells.

    Parameters
    ----------
    risk : array_like, shape (H, W)
        Risk of each cell in [0, 1]: the planning map, augmented by the robot's size.
        The search works on mu = risk + epsilon.
    start, goal : tuple of int
        (row, column). The start counts as admissible whatever its risk.
    cost : {"g1", "g2", "g3"}
        What to minimise: the sum of mu, the sum of its squares, or its maximum.
    alpha : float
        Largest risk, without epsilon, of an admissible cell [0 to 1].
    adjacency : {4, 8}
        Neighbours of a cell.
    epsilon : float
        Constant added to every risk [0 to 1000].
    diagonal : {"unit", "sqrt2"}
        Cost of a diagonal step: that of a straight one, or sqrt(2) times it. The paper's
        is "unit". Without effect on g3.
    corner_cutting : bool
        Whether a diagonal step may pass beside a cell that is not admissible.
    cut : array_like, shape (H, W), optional
        What is compared with alpha instead of `risk`; may exceed 1.
    barred : array_like of bool, shape (H, W), optional
        Cells that are not admissible whatever their risk.
    workspace : Workspace, optional
        Arrays to work in, for who searches often; without it they are made anew.

    Returns
    -------
    SearchResult
        The cost is the least there is, up to rounding.

    Raises
    ------
    ValueError
        Naming the argument, its value, and what is allowed.

    Examples
    --------
    >>> risk = np.zeros((3, 4))
    >>> risk[:2, 2] = 0.9
    >>> find_path(risk, (0, 0), (0, 3)).path.tolist()
    [[0, 0], [1, 1], [2, 2], [1, 3], [0, 3]]
    """
    values = checked_risk(risk)
    first, last = _cell(start, values.shape, "start"), _cell(goal, values.shape, "goal")
    _check_choice("cost", cost, COSTS)
    _check_choice("adjacency", adjacency, (4, 8))
    if not (isinstance(epsilon, Real) and 0.0 <= epsilon <= _MOST_EPSILON):
        raise ValueError(f"epsilon must lie in [0, {_MOST_EPSILON:g}], got {epsilon!r}")
    factor, added = diagonal_factor(diagonal), float(epsilon)
    limit, closed = alpha, None
    if cut is not None:
        # What the cut closes is closed; the risk closes nothing more.
        limit, closed = math.inf, ~admissible_cells(cut, alpha, barred, values.shape)
    else:
        _check_alpha(alpha)
        if barred is not None:
            closed = _bars(barred, values.shape)

    if first == last:
        path, expanded = np.array([first], dtype=np.int64), 0
    else:
        if not values[last] <= limit or (closed is not None and closed[last]):
            return _no_path(0)
        field = cost_field(values, first, limit, closed, added, cost)
        room = workspace if workspace is not None else Workspace()
        path, expanded = room.search(
            field, first, last, int(adjacency), factor, bool(corner_cutting)
        )
        if len(path) == 0:
            return _no_path(expanded)
    return SearchResult(True, path, *path_risks(values, path, diagonal, added), expanded)


def admissible_cells(
    cut: ArrayLike,
    alpha: float,
    barred: ArrayLike | None = None,
    shape: tuple[int, int] | None = None,
) -> NDArray[np.bool_]:
    """Return which cells a path may enter.

    Parameters
    ----------
    cut : array_like, shape (H, W)
        Risks that are compared with alpha, not negative.
    alpha : float
        Largest admissible value [0 to 1].
    barred : array_like of bool, shape (H, W), optional
        Cells not admissible whatever their risk.
    shape : tuple of int, optional
        Shape that both arrays have to have; that of `cut` if not given.

    Returns
    -------
    ndarray of bool, shape (H, W)

    Raises
    ------
    ValueError
        If alpha is not in [0, 1], or an array has the wrong shape or values.
    """
    _check_alpha(alpha)
    values = real_numbers(cut, "cut")
    expected = values.shape if shape is None else shape
    if values.shape != expected:
        raise ValueError(f"cut must have the shape {expected} of the risks, got {values.shape}")
    if not values.min(initial=math.inf) >= 0.0:  # a NaN fails
        raise ValueError("cut must not hold NaN or negative values")
    admissible = alpha_cut(values, alpha)
    if barred is not None:
        admissible &= ~_bars(barred, expected)
    return admissible


def first_reachable(
    admissible: NDArray[np.bool_],
    start: tuple[int, int],
    candidates: NDArray[np.int64],
    adjacency: int,
    corner_cutting: bool,
) -> tuple[int, int] | None:
    """Return the first of some cells that a path from the start can reach.

    Parameters
    ----------
    admissible : ndarray of bool, shape (H, W)
        Cells that a path may enter, the start among them.
    start : tuple of int
        (row, column).
    candidates : ndarray of int64, shape (n, 2)
        Cells (row, column) in the order of preference.
    adjacency, corner_cutting
        As `find_path` takes them.

    Returns
    -------
    tuple of int or None
        (row, column), None if no candidate can be reached.
    """
    # Where a diagonal step needs both cells beside it, straight steps reach the same cells.
    eight = adjacency == 8 and corner_cutting
    components, _ = ndimage.label(admissible, np.ones((3, 3)) if eight else None)
    reachable = components[candidates[:, 0], candidates[:, 1]] == components[start]
    if not reachable.any():
        return None
    row, column = candidates[int(np.argmax(reachable))].tolist()
    return row, column


def warm_up() -> None:
    """Compile the kernels, or load them from the cache, so that no later call has to."""
    for wide in (False, True):
        workspace = Workspace(wide)
        find_path(np.zeros((2, 2)), (0, 0), (1, 1), workspace=workspace)
        # No hundredths: costs without a table.
        find_path(np.full((2, 2), 0.001), (0, 0), (1, 1), workspace=workspace)


def _no_path(expanded: int) -> SearchResult:
    empty = np.empty((0, 2), dtype=np.int64)
    return SearchResult(False, empty, math.inf, math.inf, math.inf, expanded)


def _cell(cell: tuple[int, int], shape: tuple[int, ...], name: str) -> tuple[int, int]:
    """Return a cell as two plain integers, or raise ValueError."""
    try:
        row, column = (operator.index(i) for i in cell)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be two whole numbers (row, column), got {cell!r}") from None
    if not (0 <= row < shape[0] and 0 <= column < shape[1]):
        raise ValueError(
            f"{name} (row {row}, column {column}) lies outside the map of "
            f"{shape[0]} rows and {shape[1]} columns"
        )
    return row, column


def _check_alpha(alpha: float) -> None:
    if not (isinstance(alpha, Real) and 0.0 <= alpha <= 1.0):
        raise ValueError(f"alpha must lie in [0, 1], got {alpha!r}")


def _bars(barred: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return barred cells as an array, or raise ValueError."""
    if np.ma.is_masked(barred):
        raise ValueError("barred has masked values: fill them with True or False")
    bars = np.asarray(barred)
    if bars.dtype != np.bool_ or bars.shape != shape:
        raise ValueError(
            f"barred must be an array of bool of shape {shape}, "
            f"got {bars.dtype} of shape {bars.shape}"
        )
    return bars


def _check_choice(name: str, value: object, choices: tuple[object, ...]) -> None:
    if value not in choices:
        allowed = ", ".join(map(str, choices))
        raise ValueError(f"{name} must be one of {allowed}, got {value!r}")
