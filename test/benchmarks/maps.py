# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Maps to search, each with a start and a goal. Risks are hundredths, as planning maps carry."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import minimum_spanning_tree

__all__ = ["MAPS", "Case"]

Cell = tuple[int, int]


@dataclass(frozen=True)
class Case:
    """A map and the way asked for: admissible are risks up to 0.6, as in the paper."""

    risk: NDArray[np.float64]
    start: Cell
    goal: Cell


def smooth(height: int, width: int) -> Case:
    """Return a map of hills and valleys between walls; a path has to go round the hills."""
    rng = np.random.default_rng(0)
    risk = ndimage.gaussian_filter(rng.random((height, width)), 2.0)
    risk = (risk - risk.min()) / np.ptp(risk)
    for _ in range(8):
        row, column = rng.integers(height), rng.integers(width)
        reach = int(rng.integers(5, 25))
        risk[row, column : column + reach] = 1.0
        risk[row : row + reach, column] = 1.0
    risk[0, 0] = risk[-1, -1] = 0.0
    return Case(risk.round(2), (0, 0), (height - 1, width - 1))


def maze(size: int) -> Case:
    """Return a maze of corridors one cell wide, with one way between any two places."""
    rng = np.random.default_rng(0)
    half = (size - 1) // 2
    places = np.arange(half * half).reshape(half, half)
    sideways = [places[:, :-1].ravel(), places[:, 1:].ravel()]
    upwards = [places[:-1].ravel(), places[1:].ravel()]
    tails, heads = np.hstack([sideways, upwards])
    lengths = rng.random(len(tails)) + 1.0
    tree = minimum_spanning_tree(coo_matrix((lengths, (tails, heads)), (half**2, half**2)))
    risk = np.ones((size, size))
    risk[1 : 2 * half : 2, 1 : 2 * half : 2] = 0.0
    (r0, c0), (r1, c1) = np.divmod(tree.tocoo().row, half), np.divmod(tree.tocoo().col, half)
    risk[r0 + r1 + 1, c0 + c1 + 1] = 0.0
    return Case(risk, (1, 1), (2 * half - 1, 2 * half - 1))


def rooms(size: int) -> Case:
    """Return a building: rooms of 100 cells, most walls with a door, walls that are felt."""
    rng = np.random.default_rng(0)
    pitch, middle = 100, size - 50
    free = np.ones((size, size), dtype=bool)
    free[pitch::pitch], free[:, pitch::pitch] = False, False
    for side in range(pitch // 2, size, pitch):
        for wall in range(pitch, size, pitch):
            first, second = side + rng.integers(-33, 33, 2)
            if rng.random() < 0.95:
                free[wall, first : first + 8] = True
            if rng.random() < 0.95:
                free[second : second + 8, wall] = True
    near = np.clip(0.55 - 0.05 * ndimage.distance_transform_cdt(free), 0.0, 1.0)
    risk = np.where(free, near + 0.05 * rng.random((size, size)), 1.0)
    return Case(risk.round(2), (50, 50), (middle, middle))


#: Maps by name, from small to large.
MAPS: dict[str, Callable[[], Case]] = {
    "map 180x120": lambda: smooth(120, 180),
    "maze 1000x1000": lambda: maze(1000),
    **{f"rooms {n}x{n}": functools.partial(rooms, n) for n in (300, 500, 1000, 2000, 4000)},
}
