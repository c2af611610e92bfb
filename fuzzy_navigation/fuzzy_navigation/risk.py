# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Risk maps as planning and motion use them: augmentation, cuts, and the risk of a path.

Arrays are indexed [row, column]. "Paper" is Oriolo, Ulivi, Vendittelli, IEEE Trans.
SMC-B 28(3), 1998.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from fuzzy_map_building.grid import GridGeometry, Window

__all__ = [
    "DIAGONALS",
    "Footprint",
    "alpha_cut",
    "augment",
    "beta_cut",
    "changed_window",
    "check_effort",
    "checked_risk",
    "diagonal_factor",
    "path_risks",
    "real_numbers",
    "risks_of_path",
]

#: Cost of a diagonal step in straight steps.
DIAGONALS = {"unit": 1.0, "sqrt2": math.sqrt(2.0)}

# Side of the squares that a map is augmented in [cells].
_TILE = 1024
#: Most cells times rectangles of the footprint that a map is augmented with: some 20 s.
MOST_EFFORT = 1e9

N = TypeVar("N", np.int8, np.float64)

# Slack [cells] for lengths such as 0.3 / 0.1, which is 2.9999999999999996.
_SLACK = 1e-6


def real_numbers(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return an array as float64; numpy itself would read texts and drop imaginary parts.

    Raises
    ------
    ValueError
        If it is no array of real numbers, or some of it are masked.
    """
    if np.ma.is_masked(values):
        raise ValueError(
            f"{name} has masked values, and what they stand for is not told; give each a value, "
            "as 'filled' of numpy's masked arrays does"
        )
    try:
        array = np.asarray(values)
    except ValueError as error:  # rows of different lengths
        raise ValueError(f"{name} must be an array of real numbers: {error}") from error
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{name} must be an array of real numbers, got one of {array.dtype}")
    return array.astype(np.float64, copy=False)


def changed_window(before: NDArray[N], after: NDArray[N]) -> Window:
    """Return the smallest window that holds all cells in which two maps differ.

    Parameters
    ----------
    before, after : ndarray, shape (H, W)
        The maps.
    """
    differ = before != after
    rows = np.flatnonzero(differ.any(axis=1))
    if len(rows) == 0:
        return Window(0, 0, 0, 0)
    row0, row1 = int(rows[0]), int(rows[-1]) + 1
    columns = np.flatnonzero(differ[row0:row1].any(axis=0))
    return Window(row0, row1, int(columns[0]), int(columns[-1]) + 1)


def checked_risk(risk: ArrayLike, name: str = "risk") -> NDArray[np.float64]:
    """Return a map of risks as a C-contiguous array of float64, checked.

    Parameters
    ----------
    risk : array_like, shape (H, W)
        Risks in [0, 1].
    name : str
        What to call the map in messages.

    Raises
    ------
    ValueError
        If the map is not of real numbers, not two-dimensional, has no cell, or holds a
        value that is not finite or not in [0, 1].
    """
    values = np.ascontiguousarray(real_numbers(risk, name))
    if values.ndim != 2 or values.size == 0:
        raise ValueError(
            f"{name} must be an array of rows and columns with at least one cell, "
            f"got shape {values.shape}"
        )
    if not (values.min() >= 0.0 and values.max() <= 1.0):  # a NaN fails both
        wrong = ~((values >= 0.0) & (values <= 1.0))
        row, column = (int(i) for i in np.argwhere(wrong)[0])
        raise ValueError(
            f"{name} must lie in [0, 1] everywhere, but {int(wrong.sum())} cells do not, "
            f"the first at row {row}, column {column}: {values[row, column]}"
        )
    return values


@dataclass(frozen=True)
class Footprint:
    """The cells under the robot: a union of centred rectangles, whose filters are fast.

    Parameters
    ----------
    halves : tuple of (int, int)
        Cells (rows, columns) that each rectangle reaches from its centre.
    """

    halves: tuple[tuple[int, int], ...]

    @classmethod
    def of(
        cls, radius: float, resolution: float, shape: str, map_shape: tuple[int, ...]
    ) -> Footprint:
        """Return the footprint on a map, as `augment` describes it.

        Raises
        ------
        ValueError
            If an argument is out of its range.
        """
        if not (math.isfinite(resolution) and resolution > 0.0):
            raise ValueError(f"resolution must be positive and finite [m], got {resolution}")
        if not (math.isfinite(radius) and radius >= 0.0):
            raise ValueError(f"radius must be finite and not negative [m], got {radius}")
        # A footprint wider than the map reaches outside from everywhere: larger adds nothing.
        cells = min(radius / resolution, float(sum(map_shape)))
        if shape == "square":
            half = math.floor(cells + 0.5 + _SLACK)
            return cls(((half, half),))
        if shape != "disc":
            raise ValueError(f"shape must be 'square' or 'disc', got {shape!r}")
        halves = {}
        for k in range(math.floor(cells + _SLACK) + 1):
            halves[math.floor(math.sqrt((cells + _SLACK) ** 2 - k * k))] = k
        return cls(tuple((k, j) for j, k in halves.items()))

    def grown(self, window: Window, map_shape: tuple[int, ...]) -> Window:
        """Return the cells whose footprint touches a window, or those that its cells' do."""
        height, width = map_shape
        reach = self.reach
        return Window(
            max(0, window.row0 - reach),
            min(height, window.row1 + reach),
            max(0, window.col0 - reach),
            min(width, window.col1 + reach),
        )

    def largest_in(self, values: NDArray[N], outside: N, window: Window) -> NDArray[N]:
        """Return what `largest` does for some cells, and look at no others than it has to.

        Parameters
        ----------
        values : ndarray, shape (H, W)
            Values of all cells.
        outside : number
            Value of the cells outside.
        window : Window
            The cells.
        """
        out = np.empty(window.shape, values.dtype)
        for tile in _tiles(window):
            seen = self.grown(tile, values.shape)
            part = values[seen.slices]
            inside = seen.shape == tuple(n + 2 * self.reach for n in tile.shape)
            alike = (inside or part[0, 0] == outside) and bool((part == part[0, 0]).all())
            # What is near an inner side of the part seen is wrong, and not in the tile.
            row, column = tile.row0 - seen.row0, tile.col0 - seen.col0
            out[
                tile.row0 - window.row0 : tile.row1 - window.row0,
                tile.col0 - window.col0 : tile.col1 - window.col0,
            ] = (
                part[0, 0]
                if alike  # as most of a large map is that nobody has seen yet
                else self.largest(part, outside)[
                    row : row + tile.shape[0], column : column + tile.shape[1]
                ]
            )
        return out

    @property
    def reach(self) -> int:
        """Cells that it reaches from its centre, at most."""
        return max(max(half) for half in self.halves)

    def largest(self, values: NDArray[N], outside: N) -> NDArray[N]:
        """Return the largest value under the footprint on each cell.

        Parameters
        ----------
        values : ndarray, shape (H, W)
            Values of the cells.
        outside : number
            Value of the cells outside.
        """
        filtered = (
            ndimage.maximum_filter(
                values, size=(2 * rows + 1, 2 * columns + 1), mode="constant", cval=outside
            )
            for rows, columns in self.halves
        )
        out: NDArray[N] = functools.reduce(np.maximum, filtered)
        return out


def _tiles(window: Window) -> Iterator[Window]:
    """Yield windows of bounded size that cover a window."""
    for row in range(window.row0, window.row1, _TILE):
        for column in range(window.col0, window.col1, _TILE):
            yield Window(
                row,
                min(row + _TILE, window.row1),
                column,
                min(column + _TILE, window.col1),
            )


def check_effort(geometry: GridGeometry, radius: float, shape: str) -> None:
    """Refuse a map that takes too long to augment for whoever has to answer meanwhile.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map's cells lie.
    radius, shape
        As `augment` takes them.

    Raises
    ------
    ValueError
        If the map has too many cells for a robot of so many.
    """
    footprint = Footprint.of(radius, geometry.resolution, shape, geometry.shape)
    effort = geometry.width * geometry.height * len(footprint.halves)
    if effort > MOST_EFFORT:
        raise ValueError(
            f"a map of {geometry.width} x {geometry.height} cells of {geometry.resolution:g} m is "
            f"too fine for a robot of radius {radius:g} m: widening its obstacles by the robot "
            f"would take {effort / MOST_EFFORT:.0f} times as long as is reasonable; use larger "
            "cells"
        )


def augment(
    risk: ArrayLike, radius: float, resolution: float, shape: str = "square"
) -> NDArray[np.float64]:
    """Return the largest risk under the robot's footprint centred on each cell.

    Planning for a point on the augmented map is planning for the robot (paper, section
    IV-A2). Cells outside the map have the risk 1.

    Parameters
    ----------
    risk : array_like, shape (H, W)
        Risks in [0, 1].
    radius : float
        Radius of the robot [m].
    resolution : float
        Side of a cell [m].
    shape : {"square", "disc"}
        Footprint: a square of 2 round(radius / resolution) + 1 cells, halves rounded up,
        or the cells whose centres are no farther than `radius`.

    Returns
    -------
    ndarray of float64, shape (H, W)

    Raises
    ------
    ValueError
        If an argument is out of its range.

    Examples
    --------
    >>> risk = np.zeros((7, 7))
    >>> risk[3, 3] = 0.5
    >>> augment(risk, 0.1, 0.1, "disc")[1:-1, 1:-1]
    array([[0. , 0. , 0. , 0. , 0. ],
           [0. , 0. , 0.5, 0. , 0. ],
           [0. , 0.5, 0.5, 0.5, 0. ],
           [0. , 0. , 0.5, 0. , 0. ],
           [0. , 0. , 0. , 0. , 0. ]])
    """
    values = checked_risk(risk)
    return Footprint.of(radius, resolution, shape, values.shape).largest(values, np.float64(1.0))


def alpha_cut(risk: NDArray[np.float64], alpha: float) -> NDArray[np.bool_]:
    """Return the cells admissible for planning, mu_p <= alpha (paper, section IV-A2)."""
    return risk <= alpha


def beta_cut(risk: NDArray[np.float64], beta: float) -> NDArray[np.bool_]:
    """Return the cells explored well enough to move on, mu_m <= beta (paper, section IV-B)."""
    return risk <= beta


def path_risks(
    mu: NDArray[np.float64],
    path: NDArray[np.int64],
    diagonal: str = "unit",
    epsilon: float = 0.0,
) -> tuple[float, float, float]:
    """Return the costs g1, g2, g3 of a path (paper, section IV-A1).

    Parameters
    ----------
    mu : ndarray of float64, shape (H, W)
        Risk of each cell.
    path : ndarray of int64, shape (n, 2)
        Adjacent cells (row, column).
    diagonal : {"unit", "sqrt2"}
        Weight of a cell that is entered diagonally, in g1 and g2.
    epsilon : float
        Constant added to every risk, where `mu` does not hold it already.

    Returns
    -------
    g1, g2, g3 : float
        Sum of the risks, of their squares, and the largest; the first cell included.

    Raises
    ------
    ValueError
        If the path has no cell or `diagonal` is unknown.
    """
    if len(path) == 0:
        raise ValueError("a path has at least one cell, got none")
    return risks_of_path(mu[path[:, 0], path[:, 1]] + epsilon, path, diagonal)


def risks_of_path(
    mu: NDArray[np.float64], path: NDArray[np.int64], diagonal: str
) -> tuple[float, float, float]:
    """Return the costs g1, g2, g3 of a path from the risks of its cells.

    Parameters
    ----------
    mu : ndarray of float64, shape (n,)
        Risk of each of its cells, the constant epsilon included, n at least 1.
    path, diagonal
        As `path_risks` takes them.
    """
    factor = diagonal_factor(diagonal)
    once, squared = mu, mu * mu
    if factor != 1.0:
        steps = np.diff(path, axis=0, prepend=path[:1])
        weights = np.where(np.abs(steps).sum(axis=1) == 2, factor, 1.0)
        once, squared = weights * once, weights * squared
    # fsum: exact however long the path.
    return math.fsum(once.tolist()), math.fsum(squared.tolist()), float(mu.max())


def diagonal_factor(diagonal: str) -> float:
    """Return how much more a diagonal step costs: 1 for "unit", sqrt(2) for "sqrt2".

    Raises
    ------
    ValueError
        For another name.
    """
    if diagonal not in DIAGONALS:
        raise ValueError(f"diagonal must be one of {', '.join(DIAGONALS)}, got {diagonal!r}")
    return DIAGONALS[diagonal]
