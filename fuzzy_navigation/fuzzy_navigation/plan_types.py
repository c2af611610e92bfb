# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What goes into and comes out of the planner."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2

__all__ = ["MAX_TOLERANCE", "PlanResult", "PlanStatus", "RiskLayer"]

#: Largest tolerance of a goal [m], in parameters and requests alike.
MAX_TOLERANCE = 10.0


class PlanStatus(IntEnum):
    """Outcome of a request, with the numbers of ``PlanPath.srv``."""

    FOUND = 0
    NO_PATH = 1
    START_OUTSIDE = 2
    GOAL_OUTSIDE = 3
    NO_MAP = 4
    BAD_REQUEST = 5


@dataclass(frozen=True)
class RiskLayer:
    """A second layer of risk over the augmented planning map, for one request.

    Parameters
    ----------
    cells : ndarray of int64, shape (n, 2)
        Cells (row, column) that have such a risk, each once.
    cut : ndarray of float64, shape (n,)
        A cell is admissible by the larger of its risk and this; may exceed 1.
    cost : ndarray of float64, shape (n,)
        A path pays the larger of a cell's risk and this, in [0, 1].
    """

    cells: NDArray[np.int64]
    cut: NDArray[np.float64]
    cost: NDArray[np.float64]


@dataclass(frozen=True)
class PlanResult:
    """Answer to a request.

    Parameters
    ----------
    status : PlanStatus
        What came of it.
    message : str
        The same in words: what happened, where, and what can be done.
    path : ndarray of int64, shape (n, 2)
        Cells (row, column), start and goal included; n = 0 unless found.
    poses : tuple of Pose2
        Centres of the path's cells [m], each heading to the next [rad]; of a path at any angle
        the places where its lines pass through them.
    g1, g2, g3 : float
        Costs of the path on M_p^a + epsilon; infinite unless found.
    alpha : float
        Rung that the path was found on, else the last one that was tried; 0 if none was.
    expanded : int
        Number of cells expanded.
    """

    status: PlanStatus
    message: str
    path: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    poses: tuple[Pose2, ...] = ()
    g1: float = math.inf
    g2: float = math.inf
    g3: float = math.inf
    alpha: float = 0.0
    expanded: int = 0
