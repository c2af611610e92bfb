# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Paths that are bent less, against a general solver of the same problem."""

import numpy as np
import pytest
from scipy.optimize import NonlinearConstraint, minimize

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.elastic_band import band, bent_least, roomy_band

#: Cells of a path that goes up a slope of 1 in 3.
STAIRS = np.array([(0.1 * k, 0.1 * (k // 3)) for k in range(13)])


def energy(points: np.ndarray) -> float:
    """Sum of squared second differences, term by term."""
    total = 0.0
    for k in range(1, len(points) - 1):
        for axis in range(2):
            bend = points[k - 1][axis] - 2.0 * points[k][axis] + points[k + 1][axis]
            total += bend * bend
    return total


def least(points: np.ndarray, tolerance: np.ndarray) -> float:
    """The least energy within the tolerance, by sequential quadratic programming."""
    free = tolerance > 0.0

    def placed(moves: np.ndarray) -> np.ndarray:
        out = points.copy()
        out[free] += moves.reshape(-1, 2)
        return out

    within = NonlinearConstraint(
        lambda moves: (moves.reshape(-1, 2) ** 2).sum(axis=1), 0.0, tolerance[free] ** 2
    )
    found = minimize(
        lambda moves: energy(placed(moves)),
        np.zeros(2 * int(free.sum())),
        constraints=[within],
        method="SLSQP",
        options={"maxiter": 200, "ftol": 1e-10},
    )
    return energy(placed(found.x))


@pytest.mark.parametrize("width", [0.02, 0.05])
def test_it_comes_close_to_the_least_bending_within_the_tolerance(width: float) -> None:
    tolerance = np.full(len(STAIRS), width)
    tolerance[[0, -1]] = 0.0
    bent = bent_least(STAIRS, tolerance)
    off = np.hypot(*(bent - STAIRS).T)
    assert (off <= tolerance + 1e-9).all()
    best = least(STAIRS, tolerance)
    assert best - 1e-6 <= energy(bent) <= best + 0.03 * energy(STAIRS)


def test_points_that_must_not_move_stay_and_the_others_yield() -> None:
    tolerance = np.full(len(STAIRS), 0.05)
    tolerance[[0, 4, 5, -1]] = 0.0
    bent = bent_least(STAIRS, tolerance)
    np.testing.assert_array_equal(bent[[0, 4, 5, -1]], STAIRS[[0, 4, 5, -1]])
    assert energy(bent) < 0.5 * energy(STAIRS)


def test_a_straight_line_and_too_few_points_stay_as_they_are() -> None:
    line = np.column_stack((np.arange(8) * 0.1, np.full(8, 0.3)))
    np.testing.assert_allclose(bent_least(line, np.full(8, 0.05)), line, atol=1e-12)
    for n in (1, 2):
        np.testing.assert_array_equal(bent_least(STAIRS[:n], np.full(n, 0.05)), STAIRS[:n])


def test_the_way_of_a_robot_that_moves_begins_in_its_direction() -> None:
    tolerance = np.full(len(STAIRS), 0.05)
    pose = Pose2(0.0, 0.0, 0.4)
    first = {}
    for robot in (None, pose):
        way = band(STAIRS, robot, tolerance, 0.1)
        np.testing.assert_array_equal(way[[0, -1]], STAIRS[[0, -1]])
        dx, dy = way[1] - way[0]
        first[robot] = np.arctan2(dy, dx)
    assert abs(first[pose] - 0.4) < abs(first[None] - 0.4)


@pytest.mark.parametrize("side", [0.0, 0.4, 0.5, 0.7])
def test_a_band_with_room_loses_none_and_bends_less(side: float) -> None:
    rng = np.random.default_rng(7)
    energies = np.zeros(2)
    for _ in range(20):
        way = STAIRS + rng.uniform(-0.03, 0.03, STAIRS.shape)
        wall = np.column_stack((np.linspace(0.0, 1.2, 25), np.linspace(0.0, 0.4, 25) - 0.36))
        other = np.column_stack((wall[:, 0], wall[:, 1] + 0.36 + side))
        hits = np.vstack([wall, other]) if side else np.empty((0, 2))
        bent = roomy_band(way, None, hits, 0.23, 0.15, 0.1)
        np.testing.assert_array_equal(bent[[0, -1]], way[[0, -1]])
        assert np.hypot(*(bent - way).T).max() <= 0.05 + 1e-9
        energies += energy(way), energy(bent)
        for old, new in zip(way, bent, strict=True):
            before = min((np.hypot(*(h - old)) - 0.23 for h in hits), default=np.inf)
            after = min((np.hypot(*(h - new)) - 0.23 for h in hits), default=np.inf)
            assert after >= min(before, 0.15) - 0.002 - 1e-9
    assert energies[1] < 0.6 * energies[0]


def test_points_with_little_room_move_along_the_wall() -> None:
    # A zigzag 0.1 m from a wall: there is nowhere enough room to move by a spare of it.
    way = np.array([(0.1 * k, 0.33 + 0.02 * (k % 2)) for k in range(13)])
    wall = np.array([(0.02 * k, 0.0) for k in range(-10, 80)])
    bent = roomy_band(way, None, wall, 0.23, 0.15, 0.1)
    assert energy(bent) < 0.7 * energy(way)
    assert (bent[1:-1, 1] >= way[1:-1, 1] - 0.0025).all()
