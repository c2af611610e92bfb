# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Maps in the whole numbers of an occupancy grid."""

import numpy as np

from fuzzy_map_building.occupancy import belief_to_int8, risk_to_int8


def test_risk_is_rounded_and_never_unknown() -> None:
    risk = np.linspace(0.0, 1.0, 1001)
    grid = risk_to_int8(risk)
    assert grid.dtype == np.int8
    assert (grid.min(), grid.max()) == (0, 100)
    assert np.abs(grid - 100.0 * risk).max() <= 0.5 + 1e-9


def test_belief_is_unknown_where_little_is_believed() -> None:
    e, o = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 41))
    grid = belief_to_int8(e, o)
    unknown = 1.0 - e - o > 0.5
    np.testing.assert_array_equal(grid == -1, unknown)
    assert grid[~unknown].min() >= 0
    assert grid.max() == 100


def test_belief_at_known_points() -> None:
    points = [
        (0.0, 0.0, -1),
        (0.49, 0.0, -1),
        (0.5, 0.0, 25),
        (1.0, 0.0, 0),
        (0.0, 1.0, 100),
        (0.5, 0.5, 50),
        (1.0, 1.0, 50),  # contradiction
        (0.8, 0.1, 15),
    ]
    e, o, value = (np.array(v) for v in zip(*points, strict=True))
    np.testing.assert_array_equal(belief_to_int8(e, o), value)


def test_more_belief_in_obstacles_never_looks_freer() -> None:
    e = np.full(50, 0.6)
    grid = belief_to_int8(e, np.linspace(0.0, 1.0, 50))
    assert (np.diff(grid.astype(int)) >= 0).all()
