# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How far paths lead through the explored area, against the definition cell by cell."""

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
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
