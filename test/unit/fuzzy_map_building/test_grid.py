# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""World <-> cell arithmetic, against plain arithmetic and brute force."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import (
    COARSEST,
    FINEST,
    MAX_CELLS,
    GridGeometry,
    Window,
    cells_between,
    centre_along,
)

GRID = GridGeometry(7, 5, 0.25, (-1.0, 2.0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 5, 0.1), "width"),
        ((5, -1, 0.1), "height"),
        ((2.5, 5, 0.1), "width"),
        ((True, 5, 0.1), "width"),
        ((math.inf, 5, 0.1), "width"),
        ((5, math.nan, 0.1), "height"),
        ((MAX_CELLS, 2, 0.1), "exceeds the limit"),
        ((5, 5, 0.0), "resolution"),
        ((5, 5, -0.1), "resolution"),
        ((5, 5, math.nan), "resolution"),
        ((5, 5, 0.1, (0.0, math.inf)), "origin"),
        ((5, 5, 0.1, (0.0,)), "origin"),
        ((5, 5, 0.1, (0.0, 0.0, 0.0)), "origin"),
        ((5, 5, 0.1, 3.0), "origin"),
        ((5, 5, 0.1, ("0", 0.0)), "origin"),
        ((5, 5, 0.1, (0.0, 10**400)), "origin"),
        (("5", 5, 0.1), "width"),
        ((10**400, 5, 0.1), "exceeds the limit"),
        ((5, 5, "0.1"), "resolution"),
        ((5, 5, 1e-300), "resolution must be from"),
        ((5, 5, 1e300), "resolution must be from"),
        ((5, 5, 10**400), "resolution"),
        ((5, 5, 0.1, (1e308, 0.0)), "too far away"),
        ((5, 5, 0.1, (0.0, -1e308)), "too far away"),
        ((5, 5, 0.99e-3), r"resolution must be from 0.001 to 10 m .*, got 0.00099 m"),
        ((5, 5, 10.1), r"resolution must be from 0.001 to 10 m .*, got 10.1 m"),
        ((5, 5, 1e7), "resolution must be from"),
        # Each on its own is fine.
        ((5, 5, 0.1, (1e8 - 0.4, 0.0)), "too far away"),
        ((10**7 + 1, 1, 10.0), "too far away"),
    ],
)
def test_nonsense_is_refused_by_name(arguments: tuple, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        GridGeometry(*arguments)


def test_whole_numbers_of_any_type_are_taken() -> None:
    grid = GridGeometry(np.int64(7), 5.0, 1, (0, 0))
    assert (grid.width, grid.height, grid.resolution, grid.origin) == (7, 5, 1.0, (0.0, 0.0))
    assert all(type(v) is int for v in (grid.width, grid.height))


@pytest.mark.parametrize(
    ("size", "resolution", "cells"),
    [(7.6, 0.1, 76), (6.3, 0.1, 63), (0.05, 0.1, 1), (1.01, 0.1, 11), (18.0, 0.1, 180)],
)
def test_from_size_covers_the_area_and_no_more(size: float, resolution: float, cells: int) -> None:
    assert GridGeometry.from_size(size, size, resolution).shape == (cells, cells)


def test_far_cells_are_told_apart() -> None:
    # UTM coordinates, and the farthest that the finest and the coarsest cells may lie.
    for resolution, far in ((0.1, 9.9e6), (FINEST, 9.9e7), (COARSEST, 9.9e7)):
        grid = GridGeometry(50, 40, resolution, (far, -far))
        for row in range(40):
            for column in range(50):
                assert grid.cell_of(*grid.centre_of(row, column)) == (row, column)


@pytest.mark.parametrize(
    "sizes", [(1e300, 1.0, 1e-300), (1.0, 1e300, 0.1), (1.0, 10**400, 0.1), (1e5, 1e5, 1e-3)]
)
def test_areas_of_too_many_cells_are_refused(sizes: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match=r"exceeds the limit|must be finite"):
        GridGeometry.from_size(*sizes)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "1"])
def test_from_size_refuses_nonsense(bad: float) -> None:
    for sizes in ((bad, 1.0, 0.1), (1.0, bad, 0.1), (1.0, 1.0, bad)):
        with pytest.raises(ValueError, match="finite"):
            GridGeometry.from_size(*sizes)


def test_corners_and_edges() -> None:
    assert GRID.bounds == (-1.0, 2.0, 0.75, 3.25)
    assert GRID.cell_of(-1.0, 2.0) == (0, 0)  # the lower left corner belongs to the grid
    assert not GRID.contains(0.75, 2.5)  # the upper ones do not
    assert not GRID.contains(0.0, 3.25)
    assert GRID.cell_of(0.7499, 3.2499) == (4, 6)
    assert not GRID.contains(math.nan, 2.5)
    # Negative indices must never wrap to the far side.
    for point in ((-1.0001, 2.5), (0.0, 1.9999)):
        with pytest.raises(ValueError, match="outside the map area"):
            GRID.cell_of(*point)


def test_cells_of_agrees_with_cell_of() -> None:
    rng = np.random.default_rng(0)
    points = np.vstack(
        [rng.uniform((-1.5, 1.5), (1.25, 3.75), (300, 2)), [[math.nan, 2.5], [math.inf, 2.5]]]
    )
    cells, inside = GRID.cells_of(points)
    assert 0 < inside.sum() < 300
    for point, cell, is_inside in zip(points, cells, inside, strict=True):
        if is_inside:
            assert tuple(cell) == GRID.cell_of(*point)
        else:
            assert tuple(cell) == (-1, -1)
            assert not GRID.contains(*point)


def test_centres() -> None:
    x, y = GRID.centres()
    assert x.shape == (7,)
    assert y.shape == (5,)
    for row in range(5):
        for column in range(7):
            assert GRID.centre_of(row, column) == pytest.approx((x[column], y[row]))
    x, y = GRID.centres(Window(1, 3, 2, 6))
    assert (x[0], y[0]) == pytest.approx(GRID.centre_of(1, 2))
    assert (len(y), len(x)) == (2, 4)


@pytest.mark.parametrize("centre", [(0.0, 2.5), (-1.2, 2.1), (0.75, 3.25), (5.0, 5.0)])
@pytest.mark.parametrize("radius", [0.0, 0.1, 0.3, 10.0])
def test_window_holds_every_cell_within_reach(centre: tuple[float, float], radius: float) -> None:
    window = GRID.window(*centre, radius)
    for row in range(5):
        for column in range(7):
            x, y = GRID.centre_of(row, column)
            if math.hypot(x - centre[0], y - centre[1]) <= radius:
                assert window.row0 <= row < window.row1
                assert window.col0 <= column < window.col1
    assert 0 <= window.row0 <= window.row1 <= 5
    assert 0 <= window.col0 <= window.col1 <= 7
    np.zeros(GRID.shape)[window.slices] += 1.0


@pytest.mark.parametrize("bad", [(math.nan, 0.0, 1.0), (0.0, math.inf, 1.0), (0.0, 0.0, -1.0)])
def test_a_window_needs_a_circle(bad: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="circle"):
        GRID.window(*bad)


def test_union_of_windows() -> None:
    a, b = Window(1, 3, 2, 4), Window(2, 6, 0, 3)
    nothing = Window(4, 4, 0, 9)
    assert a.union(b) == b.union(a) == Window(1, 6, 0, 4)
    assert a.union(nothing) == a
    assert nothing.union(a) == a
    assert nothing.empty
    assert not a.empty
    assert a.shape == (2, 2)


@pytest.mark.parametrize(
    ("low", "high", "cells"),
    [
        (-0.9, -0.4, (0, 3)),
        (0.1, 0.4, (4, 6)),
        (-1e300, 1e300, (0, 7)),
        (-math.inf, math.inf, (0, 7)),
        (3.0, 4.0, (0, 0)),
        (-4.0, -3.0, (0, 0)),
        (math.nan, 1.0, (0, 0)),
        (0.0, math.nan, (0, 0)),
        (0.1, 0.1, (4, 5)),  # a point is in one cell
    ],
)
def test_cells_between_are_those_touched_clipped_to_the_grid(
    low: float, high: float, cells: tuple[int, int]
) -> None:
    assert cells_between(low, high, -1.0, 0.25, 7) == cells


def test_centre_along_is_the_centre_of_the_cell() -> None:
    for row, column in ((0, 0), (2, 6), (-1, 9)):
        x = centre_along(GRID.origin[0], column, GRID.resolution)
        y = centre_along(GRID.origin[1], row, GRID.resolution)
        assert (x, y) == GRID.centre_of(row, column)
