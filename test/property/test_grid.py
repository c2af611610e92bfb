# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""World <-> cell arithmetic for any grid."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fuzzy_map_building.grid import GridGeometry, cells_between

GRIDS = st.builds(
    GridGeometry,
    st.integers(1, 300),
    st.integers(1, 300),
    st.floats(0.001, 10.0),
    st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)),
)
ANYWHERE = st.floats(allow_nan=True, allow_infinity=True)


@given(GRIDS, st.data())
def test_the_centre_of_a_cell_lies_in_it(grid: GridGeometry, data: st.DataObject) -> None:
    cell = data.draw(st.tuples(st.integers(0, grid.height - 1), st.integers(0, grid.width - 1)))
    assert grid.cell_of(*grid.centre_of(*cell)) == cell


@given(GRIDS, st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_point_lies_within_half_a_cell_of_its_cell_s_centre(
    grid: GridGeometry, right: float, up: float
) -> None:
    x0, y0, x1, y1 = grid.bounds
    x, y = x0 + right * (x1 - x0), y0 + up * (y1 - y0)
    assume(grid.contains(x, y))
    cx, cy = grid.centre_of(*grid.cell_of(x, y))
    half = 0.5 * grid.resolution + 1e-9 * max(1.0, abs(x), abs(y))
    assert abs(x - cx) <= half
    assert abs(y - cy) <= half


@given(GRIDS, ANYWHERE, ANYWHERE)
def test_outside_never_wraps_around(grid: GridGeometry, x: float, y: float) -> None:
    x0, y0, x1, y1 = grid.bounds
    margin = 1e-9 * max(1.0, abs(x0), abs(y0), abs(x1), abs(y1))
    outside = not (x0 - margin <= x <= x1 + margin and y0 - margin <= y <= y1 + margin)
    if outside:
        assert not grid.contains(x, y)
        with pytest.raises(ValueError, match="outside"):
            grid.cell_of(x, y)
    cells, inside = grid.cells_of([[x, y]])
    assert bool(inside[0]) == grid.contains(x, y)
    if inside[0]:
        assert (cells >= 0).all()
        assert (cells < grid.shape).all()


@given(GRIDS, st.floats(-1e6, 1e6), st.floats(-1e6, 1e6), st.floats(0.0, 1e6))
def test_a_window_is_in_the_grid_and_holds_its_circle(
    grid: GridGeometry, x: float, y: float, radius: float
) -> None:
    window = grid.window(x, y, radius)
    assert 0 <= window.row0 <= window.row1 <= grid.height
    assert 0 <= window.col0 <= window.col1 <= grid.width
    xs, ys = grid.centres()
    slack = 1e-9 * max(1.0, abs(x), abs(y), *map(abs, grid.bounds))
    columns = np.flatnonzero(np.abs(xs - x) <= radius - slack)
    rows = np.flatnonzero(np.abs(ys - y) <= radius - slack)
    if len(columns) and len(rows):
        assert window.col0 <= columns[0]
        assert columns[-1] < window.col1
        assert window.row0 <= rows[0]
        assert rows[-1] < window.row1
    if not window.empty:
        x0, y0 = grid.origin
        sides = (
            (y - radius, y + radius, y0, grid.resolution, grid.height),
            (x - radius, x + radius, x0, grid.resolution, grid.width),
        )
        assert cells_between(*sides[0]) == (window.row0, window.row1)
        assert cells_between(*sides[1]) == (window.col0, window.col1)


@given(st.floats(0.01, 50.0), st.floats(0.01, 50.0), st.floats(0.05, 2.0))
def test_from_size_covers(size_x: float, size_y: float, resolution: float) -> None:
    grid = GridGeometry.from_size(size_x, size_y, resolution)
    slack = 2e-6 * resolution
    for cells, size in ((grid.width, size_x), (grid.height, size_y)):
        assert cells * resolution >= size - slack
        assert (cells - 1) * resolution < size or cells == 1
    assert math.isclose(grid.resolution, resolution)
