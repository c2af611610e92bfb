# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How far paths lead through the explored area, against the definition cell by cell."""

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.explored_area import ExploredArea

GEOMETRY = GridGeometry(12, 9, 0.1, (1.0, -2.0))


def row(y: int, columns: range) -> np.ndarray:
    return np.array([GEOMETRY.centre_of(y, x) for x in columns])


def test_the_path_ends_before_the_first_cell_whose_surroundings_are_too_risky() -> None:
    risk = np.zeros(GEOMETRY.shape)
    risk[4, 9] = 0.91
    area = ExploredArea(GEOMETRY, risk, 0.9, 0.1, "square")
    path = row(4, range(2, 11))
    # Augmented by one cell, column 8 is the first outside; its index in the path is 6.
    assert area.reach(path) == 5
    assert area.reach(path[:6]) == 5
    assert area.reach(path[:1]) == 0


def test_beta_itself_is_allowed() -> None:
    area = ExploredArea(GEOMETRY, np.full(GEOMETRY.shape, 0.9), 0.9, 0.0, "square")
    assert area.reach(row(4, range(2, 8))) == 5


def test_the_cells_up_to_the_robot_are_exempt() -> None:
    risk = np.zeros(GEOMETRY.shape)
    risk[4, 2:5] = 1.0
    area = ExploredArea(GEOMETRY, risk, 0.9, 0.0, "square")
    path = row(4, range(2, 8))
    assert area.reach(path) == 0
    assert area.reach(path, at=1) == 1
    assert area.reach(path, at=2) == 5
    assert area.reach(path, at=5) == 5


def test_it_ends_where_the_map_does() -> None:
    area = ExploredArea(GEOMETRY, np.zeros(GEOMETRY.shape), 0.9, 0.0, "square")
    assert area.reach(row(4, range(2, 20))) == 9


def test_what_the_body_covers_is_free() -> None:
    """Against the corners of each cell, one by one."""
    robot, radius = Pose2(1.53, -1.52, 2.0), 0.23
    covered = {
        (y, x)
        for y in range(9)
        for x in range(12)
        if all(
            robot.distance_to(cx + dx, cy + dy) <= radius
            for cx, cy in [GEOMETRY.centre_of(y, x)]
            for dx in (-0.05, 0.05)
            for dy in (-0.05, 0.05)
        )
    }
    assert len(covered) > 4
    # Farther out the footprint leaves the map, or the risk touches the exempt start alone.
    for y in range(2, 7):
        for x in range(1, 11):
            # One risky cell: in the way unless the body covers it.
            risk = np.zeros(GEOMETRY.shape)
            risk[y, x] = 1.0
            area = ExploredArea(GEOMETRY, risk, 0.9, radius, "square", robot)
            path = row(y, range(2, 10))
            passes = area.reach(path) == len(path) - 1
            assert passes is ((y, x) in covered)


@pytest.mark.parametrize(
    ("risk", "message"),
    [
        (np.zeros((9, 11)), r"\(9, 11\) .* \(9, 12\)"),
        (np.full((9, 12), 1.5), r"must lie in \[0, 1\]"),
        (np.full((9, 12), np.nan), r"must lie in \[0, 1\]"),
    ],
)
def test_a_bad_map_is_refused(risk: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ExploredArea(GEOMETRY, risk, 0.9, 0.1, "square")


@pytest.mark.parametrize("footprint", ["square", "disc"])
@pytest.mark.parametrize("radius", [0.0, 0.23])
def test_windows_and_whole_maps_make_the_area_that_the_map_makes(
    footprint: str, radius: float
) -> None:
    """By windows, by maps that differ here and there, and from floats: the same cells."""
    rng = np.random.default_rng(7)
    rules = 0.9, radius, footprint
    codes = rng.integers(0, 101, GEOMETRY.shape).astype(np.int8)
    area = ExploredArea(GEOMETRY, Hundredths(codes), *rules)
    for k in range(60):
        row, column = rng.integers(0, (9, 12)).tolist()
        window = Window(row, min(9, row + 3), column, min(12, column + 4))
        codes = codes.copy()
        codes[window.slices] = rng.choice([0, 60, 90, 91, 100], window.shape)
        # The robot moves on between the maps, and stands partly outside at times.
        robot = Pose2(*rng.uniform((0.9, -2.1), (2.3, -1.0))) if k % 5 else None
        if k % 3:
            area.update(Hundredths(codes[window.slices]), window, robot)
        else:
            area.renew(Hundredths(codes), robot)
        expected = ExploredArea(GEOMETRY, codes / 100.0, *rules, robot)
        np.testing.assert_array_equal(area.cells, expected.cells)
        assert area.codes is not None
        np.testing.assert_array_equal(area.codes.codes, codes)


@pytest.mark.parametrize("beta", [0.0, 0.07, 0.29, 0.57, 0.9, 1.0])
def test_a_hundredth_is_judged_as_the_risk_it_stands_for(beta: float) -> None:
    codes = np.arange(108).clip(0, 100).astype(np.int8).reshape(GEOMETRY.shape)
    area = ExploredArea(GEOMETRY, Hundredths(codes), beta, 0.0, "disc")
    np.testing.assert_array_equal(area.cells, codes / 100.0 <= beta)


def test_windows_that_do_not_fit_change_nothing() -> None:
    codes = np.zeros(GEOMETRY.shape, np.int8)
    area = ExploredArea(GEOMETRY, Hundredths(codes), 0.9, 0.0, "disc")
    full = Hundredths(np.full((2, 2), 100, np.int8))
    for window, words in (
        (Window(8, 10, 0, 2), "no part of a map of 9 rows, 12 columns"),
        (Window(-1, 1, 0, 2), "no part of a map"),
        (Window(3, 3, 0, 2), "no part of a map"),
        (Window(0, 3, 0, 2), r"has \(2, 2\) .* has \(3, 2\)"),
    ):
        with pytest.raises(ValueError, match=words):
            area.update(full, window, None)
    with pytest.raises(ValueError, match=r"\(2, 2\) .* \(9, 12\)"):
        area.renew(full, None)
    assert area.cells.all()
    exact = ExploredArea(GEOMETRY, codes / 100.0, 0.9, 0.0, "disc")
    with pytest.raises(ValueError, match="hundredths"):
        exact.update(full, Window(0, 2, 0, 2), None)
