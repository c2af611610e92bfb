# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Boxes of cells that the readings of a packet touch, for the kernels of all sensors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit

__all__ = ["put_box", "window_of_boxes"]


@njit
def put_box(
    boxes: NDArray[np.int64], i: int, rows: tuple[int, int], columns: tuple[int, int]
) -> None:
    """Write half-open rows and columns to a line of `boxes`; no row where there is no cell.

    Parameters
    ----------
    boxes : ndarray of int64, shape (n, 4)
        First and last row, first and last column of each box.
    i : int
        The line.
    rows, columns : tuple of int
        Half open [first, last).
    """
    boxes[i, 0] = rows[0]
    boxes[i, 1] = rows[1] if columns[1] > columns[0] else rows[0]
    boxes[i, 2] = columns[0]
    boxes[i, 3] = columns[1]


@njit
def window_of_boxes(boxes: NDArray[np.int64]) -> tuple[int, int, int, int, int]:
    """Return the number of boxes that hold cells, and the window around those.

    Parameters
    ----------
    boxes : ndarray of int64, shape (n, 4)
        As `put_box` writes them.

    Returns
    -------
    tuple of int
        Number of boxes; first and last row, first and last column; zeros if there is none.
    """
    inside = 0
    row0, row1, col0, col1 = 0, 0, 0, 0
    for i in range(len(boxes)):
        if boxes[i, 1] == boxes[i, 0]:
            continue
        if inside == 0:
            row0, row1, col0, col1 = boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3]
        inside += 1
        row0 = min(row0, boxes[i, 0])
        row1 = max(row1, boxes[i, 1])
        col0 = min(col0, boxes[i, 2])
        col1 = max(col1, boxes[i, 3])
    return inside, row0, row1, col0, col1
