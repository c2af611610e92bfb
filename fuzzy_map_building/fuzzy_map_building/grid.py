# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The one place for world <-> cell arithmetic.

Arrays are indexed [row, column]; rows grow with y and columns with x, so that a
C-contiguous array flattened is the data of a ``nav_msgs/OccupancyGrid``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from numbers import Integral, Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.jit import njit

__all__ = [
    "COARSEST",
    "FINEST",
    "MAX_CELLS",
    "GridGeometry",
    "Window",
    "cells_between",
    "centre_along",
    "where_both",
]

#: Largest grid that is accepted [cells]: bounds every allocation that a request can cause.
MAX_CELLS = 64_000_000
#: Shortest and longest side of a cell [m], wherever a map comes from: below it no range sensor
#: tells anything, above it no robot finds its way.
FINEST, COARSEST = 1e-3, 10.0
# Farthest coordinate of a grid [m]: up to it floats tell places in the finest cell apart.
_FARTHEST = 1e8
# A factor that is nearer to 0 is taken for 0.
_LEVEL = 1e-9


@dataclass(frozen=True)
class Window:
    """A rectangle of cells, half open: rows [row0, row1), columns [col0, col1)."""

    row0: int
    row1: int
    col0: int
    col1: int

    def __str__(self) -> str:
        return (
            f"rows {self.row0} to {self.row1 - 1}, columns {self.col0} to {self.col1 - 1}"
            if not self.empty
            else "no cells"
        )

    @property
    def slices(self) -> tuple[slice, slice]:
        """Index of the window in an array of the whole grid."""
        return slice(self.row0, self.row1), slice(self.col0, self.col1)

    @property
    def shape(self) -> tuple[int, int]:
        """Number of (rows, columns)."""
        return self.row1 - self.row0, self.col1 - self.col0

    @property
    def empty(self) -> bool:
        """Whether the window holds no cell."""
        return self.row1 <= self.row0 or self.col1 <= self.col0

    def union(self, other: Window) -> Window:
        """Return the smallest window that holds both."""
        if self.empty:
            return other
        if other.empty:
            return self
        return Window(
            min(self.row0, other.row0),
            max(self.row1, other.row1),
            min(self.col0, other.col0),
            max(self.col1, other.col1),
        )


def _number(name: str, value: object) -> float:
    """Return a finite float [m], or raise ValueError."""
    try:
        number = float(value) if isinstance(value, Real) else math.nan
    except OverflowError:  # a whole number beyond the floats
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{name} must be finite [m], got {value!r}")
    return number


def _whole(value: object) -> bool:
    """Whether a value is a whole number, of whatever type."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    return isinstance(value, Integral) or (math.isfinite(value) and math.floor(value) == value)


@dataclass(frozen=True)
class GridGeometry:
    """Where the square cells of a map lie in the world.

    Parameters
    ----------
    width, height : int
        Number of columns (along x) and rows (along y).
    resolution : float
        Side of a cell [m].
    origin : tuple of float
        Corner (x, y) [m] of cell (0, 0) in ``map``, its lowest x and y.

    Raises
    ------
    ValueError
        If a count is not a positive whole number, the grid has more than `MAX_CELLS` cells,
        a cell's side is not from `FINEST` to `COARSEST`, or the grid reaches beyond 1e8 m.

    Examples
    --------
    >>> geometry = GridGeometry(76, 63, 0.1, (0.0, 0.0))
    >>> geometry.cell_of(1.25, 5.25)
    (52, 12)
    >>> geometry.centre_of(52, 12)
    (1.25, 5.25)
    """

    width: int
    height: int
    resolution: float
    origin: tuple[float, float] = field(default=(0.0, 0.0))

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            value = getattr(self, name)
            if not _whole(value) or value < 1:
                raise ValueError(
                    f"the {name} must be a positive whole number of cells, got {value!r}"
                )
            object.__setattr__(self, name, int(value))
        if self.width * self.height > MAX_CELLS:
            raise ValueError(
                f"a grid of {self.width} x {self.height} cells exceeds the limit of "
                f"{MAX_CELLS} cells; use a coarser resolution or a smaller area"
            )
        resolution = _number("the resolution", self.resolution)
        if not FINEST <= resolution <= COARSEST:
            raise ValueError(
                f"the resolution must be from {FINEST:g} to {COARSEST:g} m (the side of a cell), "
                f"got {resolution:.9g} m"
            )
        object.__setattr__(self, "resolution", resolution)
        try:
            x, y = self.origin
        except (TypeError, ValueError):
            raise ValueError(f"the origin must be (x, y) [m], got {self.origin!r}") from None
        origin = (_number("the origin", x), _number("the origin", y))
        object.__setattr__(self, "origin", origin)
        farthest = max(map(abs, self.bounds))
        if not farthest <= _FARTHEST:  # a NaN fails
            raise ValueError(
                f"a map of {self} reaches {farthest:g} m and is too far away: the limit is "
                f"{_FARTHEST:g} m; choose an origin nearer to 0"
            )

    def __str__(self) -> str:
        x, y = self.origin
        return (
            f"{self.width} x {self.height} cells of {self.resolution:.9g} m from "
            f"({x:.9g}, {y:.9g}) m on"
        )

    @classmethod
    def from_size(
        cls,
        size_x: float,
        size_y: float,
        resolution: float,
        origin: tuple[float, float] = (0.0, 0.0),
    ) -> GridGeometry:
        """Return the smallest grid that covers an area of `size_x` by `size_y` [m].

        Examples
        --------
        >>> GridGeometry.from_size(7.6, 6.3, 0.1).shape
        (63, 76)
        """
        lengths = (size_x, size_y, resolution)
        names = ("size_x", "size_y", "resolution")
        if not all(_number(name, v) > 0.0 for name, v in zip(names, lengths, strict=True)):
            raise ValueError(f"sizes and resolution must be positive and finite, got {lengths}")

        def cells(size: float) -> int:
            # 7.6 / 0.1 is 75.99999999999999: a millionth of a cell is no further cell.
            count = size / resolution - 1e-6
            if not count <= MAX_CELLS:  # also where the division overflows
                raise ValueError(
                    f"a side of {size:g} m in cells of {resolution:g} m exceeds the limit of "
                    f"{MAX_CELLS} cells; use a coarser resolution or a smaller area"
                )
            return max(math.ceil(count), 1)

        return cls(cells(size_x), cells(size_y), resolution, origin)

    @property
    def shape(self) -> tuple[int, int]:
        """Shape (height, width) of an array over the grid."""
        return self.height, self.width

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Return (x_min, y_min, x_max, y_max) of the area [m]."""
        x0, y0 = self.origin
        return (
            x0,
            y0,
            x0 + self.width * self.resolution,
            y0 + self.height * self.resolution,
        )

    def contains(self, x: float, y: float) -> bool:
        """Whether the point (x, y) [m] lies in a cell of the grid; False for NaN."""
        column = (x - self.origin[0]) / self.resolution
        row = (y - self.origin[1]) / self.resolution
        return 0.0 <= column < self.width and 0.0 <= row < self.height

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """Return (row, column) of the cell that holds (x, y) [m].

        Raises
        ------
        ValueError
            If the point lies outside the grid or is not finite.
        """
        if not self.contains(x, y):
            x0, y0, x1, y1 = self.bounds
            raise ValueError(
                f"point ({x:.9g}, {y:.9g}) m lies outside the map area, x {x0:.9g} to {x1:.9g} m "
                f"and y {y0:.9g} to {y1:.9g} m"
            )
        column = int((x - self.origin[0]) / self.resolution)
        row = int((y - self.origin[1]) / self.resolution)
        return row, column

    def centre_of(self, row: int, column: int) -> tuple[float, float]:
        """Return the centre (x, y) [m] of a cell, inside the grid or not."""
        return (
            self.origin[0] + (column + 0.5) * self.resolution,
            self.origin[1] + (row + 0.5) * self.resolution,
        )

    def cells_of(self, points: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the cells that hold many points.

        Parameters
        ----------
        points : array_like, shape (N, 2)
            Positions (x, y) [m].

        Returns
        -------
        cells : ndarray of int64, shape (N, 2)
            (row, column) of each point, (-1, -1) outside.
        inside : ndarray of bool, shape (N,)
            Which points lie in the grid.
        """
        xy = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        with np.errstate(over="ignore"):  # infinitely far is outside as well
            fraction = (xy - np.asarray(self.origin)) / self.resolution
        inside = ((fraction >= 0.0) & (fraction < (self.width, self.height))).all(axis=1)
        cells = np.full(xy.shape, -1, dtype=np.int64)
        cells[inside] = np.floor(fraction[inside])[:, ::-1]
        return cells, inside

    def centre_coordinates(
        self,
        row: NDArray[np.int64] | NDArray[np.float64],
        column: NDArray[np.int64] | NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the centres' x of columns and y of rows [m]; of fractions, places between."""
        x: NDArray[np.float64] = self.origin[0] + np.add(column, 0.5) * self.resolution
        y: NDArray[np.float64] = self.origin[1] + np.add(row, 0.5) * self.resolution
        return x, y

    def centres(
        self, window: Window | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the coordinates of cell centres along each axis.

        Returns
        -------
        x : ndarray of float64, shape (columns,)
        y : ndarray of float64, shape (rows,)
            Centres [m] of the window's columns and rows, or of the whole grid's.
        """
        w = window if window is not None else Window(0, self.height, 0, self.width)
        return self.centre_coordinates(np.arange(w.row0, w.row1), np.arange(w.col0, w.col1))

    def window(self, x: float, y: float, radius: float) -> Window:
        """Return the cells whose centres can lie within `radius` of (x, y) [m], clipped.

        The window may be empty when the circle lies outside the grid.
        """
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(radius) and radius >= 0):
            raise ValueError(
                f"a circle needs a finite centre and a radius of 0 or more, got centre "
                f"({x}, {y}) m and radius {radius} m"
            )

        def clip(low: float, high: float, count: int) -> tuple[int, int]:
            first = max(0, min(count, math.floor(low / self.resolution)))
            last = max(first, min(count, math.floor(high / self.resolution) + 1))
            return first, last

        row0, row1 = clip(y - radius - self.origin[1], y + radius - self.origin[1], self.height)
        col0, col1 = clip(x - radius - self.origin[0], x + radius - self.origin[0], self.width)
        return Window(row0, row1, col0, col1)


@njit
def centre_along(origin: float, index: int, resolution: float) -> float:
    """Return a coordinate [m] of a cell's centre by its row or column."""
    return origin + (index + 0.5) * resolution


@njit
def cells_between(
    low: float, high: float, origin: float, resolution: float, count: int
) -> tuple[int, int]:
    """Return the rows or columns that an interval touches, clipped to the grid.

    Parameters
    ----------
    low, high : float
        The interval [m], both ends belonging to it; infinite ones and NaN may be given.
    origin, resolution : float
        Where the first cell begins, and the side of a cell [m].
    count : int
        Number of rows or columns.

    Returns
    -------
    first, last : int
        Half open [first, last); empty, ``last == first``, where the interval is NaN or
        lies outside the grid.

    Examples
    --------
    >>> cells_between(0.25, 0.31, 0.0, 0.1, 76), cells_between(-0.2, 0.05, 0.0, 0.1, 76)
    ((2, 4), (0, 1))
    """
    first = (low - origin) / resolution
    last = (high - origin) / resolution
    if not (first < count and last >= 0.0 and first <= last):
        return 0, 0
    # Clipped before they become whole numbers: far ends overflow an integer.
    row0 = math.floor(first) if first > 0.0 else 0
    row1 = math.floor(last) + 1 if last < count else count
    return row0, row1


@njit
def where_both(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """Return the interval of x in which ``a x >= b`` and ``c x >= d``.

    A condition whose x has a factor of 0, or nearly so, is left out.

    Returns
    -------
    low, high : float
        Ends of the interval, maybe infinite; low above high where there is no such x.

    Examples
    --------
    >>> where_both(2.0, 1.0, -1.0, -3.0), where_both(0.0, 1.0, 1.0, 4.0)
    ((0.5, 3.0), (4.0, inf))
    """
    low, high = -math.inf, math.inf
    if a > _LEVEL:
        low = b / a
    elif a < -_LEVEL:
        high = b / a
    if c > _LEVEL:
        low = max(low, d / c)
    elif c < -_LEVEL:
        high = min(high, d / c)
    return low, high
