# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Maps in the whole numbers of an occupancy grid: -1 unknown, 0 to 100 else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["INDETERMINATE_CUT", "Hundredths", "belief_to_int8", "risk_to_int8"]

FloatArray = NDArray[np.float64]

#: A cell whose membership in the set of indeterminate cells exceeds this is unknown.
INDETERMINATE_CUT = 0.5


@dataclass(frozen=True, eq=False)
class Hundredths:
    """Risks of some cells in whole hundredths, a byte each: what the grid of a risk map holds.

    Parameters
    ----------
    codes : ndarray of int8, shape (rows, columns)
        0 to 100.

    Raises
    ------
    ValueError
        If it is no such array.

    Examples
    --------
    >>> Hundredths(np.array([[0, 60]], dtype=np.int8)).risks.tolist()
    [[0.0, 0.6]]
    """

    codes: NDArray[np.int8]

    def __post_init__(self) -> None:
        codes = self.codes
        if not isinstance(codes, np.ndarray) or codes.dtype != np.int8 or codes.ndim != 2:
            raise ValueError("risks in hundredths are an array of int8 with rows and columns")
        if codes.size == 0:
            raise ValueError(f"risks in hundredths take at least one cell, got {codes.shape}")
        if codes.min() < 0 or codes.max() > 100:
            raise ValueError(
                f"risks in hundredths lie in 0..100, got {codes.min()} to {codes.max()}"
            )

    @property
    def risks(self) -> FloatArray:
        """The risks in [0, 1], shape (rows, columns)."""
        return self.codes / 100.0


def risk_to_int8(risk: FloatArray) -> NDArray[np.int8]:
    """Return ``round(100 risk)`` of memberships in [0, 1], the grid of a risk map.

    Examples
    --------
    >>> risk_to_int8(np.array([0.0, 0.604, 1.0])).tolist()
    [0, 60, 100]
    """
    return np.rint(100.0 * risk).astype(np.int8)


def belief_to_int8(empty: FloatArray, occupied: FloatArray) -> NDArray[np.int8]:
    """Return the occupancy that two beliefs stand for, for tools that know one number.

    Where little is known, the membership ``1 - e - o`` in the set of indeterminate cells
    exceeds `INDETERMINATE_CUT`: -1. Else the belief not yet given to either side, or given
    to both, is split in halves: ``(1 + o - e) / 2``.

    Parameters
    ----------
    empty, occupied : ndarray of float64, shape (height, width)
        Beliefs E and O in [0, 1].

    Returns
    -------
    ndarray of int8, shape (height, width)
        -1, or 0 (free) to 100 (occupied).

    Examples
    --------
    >>> belief_to_int8(np.array([0.0, 0.9, 0.1]), np.array([0.0, 0.0, 0.8])).tolist()
    [-1, 5, 85]
    """
    grid = np.rint(50.0 * (1.0 + occupied - empty)).astype(np.int8)
    grid[1.0 - empty - occupied > INDETERMINATE_CUT] = -1
    return grid
