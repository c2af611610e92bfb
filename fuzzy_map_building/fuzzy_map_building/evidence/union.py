# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The evidence of two kinds of sensors made one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.evidence.protocols import LocalEvidence
from fuzzy_map_building.fuzzy_sets import dombi_union
from fuzzy_map_building.jit import for_kernel, njit

__all__ = ["united_evidence"]

FloatArray = NDArray[np.float64]


def united_evidence(sonar: LocalEvidence, infrared: LocalEvidence, lam: float) -> LocalEvidence:
    """Return the evidence of a packet of sonar and infrared readings.

    Beliefs of empty are united by the Dombi union, beliefs of occupied by the maximum: that
    two kinds of sensors hear of free space adds up, but an arc and a ray that hits it are
    about the same surface.

    Parameters
    ----------
    sonar, infrared : LocalEvidence
        What either kind says of the cells of its window.
    lam : float
        lambda of the Dombi union.

    Returns
    -------
    LocalEvidence
        Over the smallest window that holds both; ``accepted`` and ``rejected`` are the sonars'.
    """
    window = sonar.window.union(infrared.window)
    empty, occupied = np.zeros((2, *window.shape))
    row, column = sonar.window.row0 - window.row0, sonar.window.col0 - window.col0
    height, width = sonar.window.shape
    empty[row : row + height, column : column + width] = sonar.empty
    occupied[row : row + height, column : column + width] = sonar.occupied
    if infrared.accepted > 0:
        _unite(
            for_kernel(infrared.empty),
            for_kernel(infrared.occupied),
            infrared.window.row0 - window.row0,
            infrared.window.col0 - window.col0,
            float(lam),
            for_kernel(empty),
            for_kernel(occupied),
        )
    return LocalEvidence(window, empty, occupied, sonar.accepted, dict(sonar.rejected))


@njit
def _unite(
    ray_empty: FloatArray,
    ray_occupied: FloatArray,
    row0: int,
    column0: int,
    lam: float,
    empty: FloatArray,
    occupied: FloatArray,
) -> None:
    """Unite the evidence of a window with that of a larger one, in which it begins somewhere."""
    for row in range(ray_empty.shape[0]):
        for column in range(ray_empty.shape[1]):
            here, there = row0 + row, column0 + column
            empty[here, there] = dombi_union(empty[here, there], ray_empty[row, column], lam)
            occupied[here, there] = max(occupied[here, there], ray_occupied[row, column])
