# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A map taken by windows against the same map taken whole, and what a replan touches."""

import dataclasses

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.jit import compiled
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_navigation import planning_map
from fuzzy_navigation.layer_params import LayerParameters
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.planner import Planner, PlanStatus
from fuzzy_navigation.risk import augment

HEIGHT, WIDTH = 30, 44
GEOMETRY = GridGeometry(WIDTH, HEIGHT, 0.1)
BELOW = 1e-9  # a risk with this added is no hundredth


def random_map(rng, shape=(HEIGHT, WIDTH)):
    risk = (rng.random(shape) ** 3).round(2)
    risk[rng.random(shape) < 0.03] = 1.0
    return risk


def same_answer(first, second):
    """Whether two results are the same in everything but how many cells were looked at."""
    return (
        (first.status, first.message, first.poses, first.alpha)
        == (second.status, second.message, second.poses, second.alpha)
        and (first.g1, first.g2, first.g3) == (second.g1, second.g2, second.g3)
        and first.path.tolist() == second.path.tolist()
    )


@pytest.mark.parametrize("footprint", ["square", "disc"])
@pytest.mark.parametrize("radius", [0.0, 0.23])
@pytest.mark.parametrize("off", [0.0, BELOW], ids=["hundredths", "exact"])
def test_windows_make_the_map_that_the_whole_makes(footprint, radius, off):
    rng = np.random.default_rng(3)
    parameters = PlannerParameters(robot_radius=radius, augmentation=footprint)
    by_windows, whole = Planner(GEOMETRY, parameters), Planner(GEOMETRY, parameters)
    risk = random_map(rng)
    by_windows.set_map(risk)
    places = [(0, 0), (HEIGHT - 1, WIDTH - 1), *rng.integers(0, (HEIGHT, WIDTH), (30, 2))]
    for k, (row, column) in enumerate(places):
        window = Window(row, min(HEIGHT, row + 9), column, min(WIDTH, column + 7))
        risk = risk.copy()
        risk[window.slices] = random_map(rng, window.shape)
        if k == len(places) // 2:
            risk[row, column] = min(1.0, risk[row, column] + off)  # from here on as it is
        by_windows.update_map(risk[window.slices], window)
        whole.set_map(risk)
        expected = augment(risk, radius, 0.1, footprint)
        np.testing.assert_array_equal(by_windows.augmented_risk, expected)
        start, goal = rng.random((2, 2)) * (0.1 * WIDTH, 0.1 * HEIGHT)
        for cost in ("g1", "g3"):
            answers = [p.plan(tuple(start), tuple(goal), cost) for p in (by_windows, whole)]
            assert same_answer(*answers)


def plans(planner, count=60):
    """Answers to requests of all kinds, half of them with barred cells."""
    rng = np.random.default_rng(9)
    out = []
    for k in range(count):
        start, goal, *barred = rng.random((2 + 12 * (k % 2), 2)) * (0.1 * WIDTH, 0.1 * HEIGHT)
        if k % 10 == 1:
            barred[0] = start
        cost, alpha = ("g1", "g2", "g3")[k % 3], (0.0, 0.05, 0.6)[k % 4 % 3]
        hits = rng.random((7 * (k % 3), 2)) * (0.1 * WIDTH, 0.1 * HEIGHT)
        out.append(planner.plan(tuple(start), tuple(goal), cost, alpha, barred=barred, hits=hits))
    return out


LAYER = LayerParameters(enabled=True, closed=0.1, limit=0.2, free=0.4)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"corner_cutting": False},
        {"diagonal": "sqrt2"},
        {"layer": LAYER},
        {"layer": LAYER, "corner_cutting": False, "least_risk": 0.03},
    ],
)
@pytest.mark.parametrize("patience", [1, 4096], ids=["looks_at_all", "looks_on_its_way"])
def test_hundredths_are_planned_on_as_any_risks_are(monkeypatch, options, patience):
    """A bar on a cell that is closed anyway makes the planner go the way of any risks."""
    monkeypatch.setattr(planning_map, "PATIENCE", patience)
    monkeypatch.setattr(planning_map, "_WORTH_A_LOOK", 0.0)
    risk = random_map(np.random.default_rng(5))
    risk[12, 1:-1] = 1.0
    nowhere = np.zeros(risk.shape, dtype=bool)
    parameters = PlannerParameters(robot_radius=0.04, tolerance=0.35, **options)
    coded, exact = Planner(GEOMETRY, parameters), Planner(GEOMETRY, parameters)
    coded.set_map(risk)
    exact.set_map(risk, barred=nowhere)
    answers = list(zip(plans(coded), plans(exact), strict=True))
    assert all(same_answer(*pair) for pair in answers)
    found = sum(first.status is PlanStatus.FOUND for first, _ in answers)
    assert 10 < found < 55
    # What one request marks, the next does not see.
    assert all(same_answer(*pair) for pair in zip(plans(coded), plans(coded), strict=True))
    np.testing.assert_array_equal(coded.augmented_risk, exact.augmented_risk)


@pytest.mark.parametrize("footprint", ["square", "disc"])
def test_bytes_make_the_map_that_risks_make(footprint):
    """Whole maps, one after the other, and windows, in hundredths against the same in floats."""
    rng = np.random.default_rng(8)
    planner = Planner(GEOMETRY, PlannerParameters(robot_radius=0.23, augmentation=footprint))
    for k in range(12):
        risk = random_map(rng)
        given = Hundredths(np.rint(100.0 * risk).astype(np.int8))
        planner.set_map(given)
        window = Window(k, k + 5, 3 * k, 3 * k + 8)
        risk[window.slices] = random_map(rng, window.shape)
        if k == 6:
            risk[k, 3 * k] += BELOW  # then a part in hundredths comes into a map of others
            planner.set_map(np.where(risk > 1.0, 1.0, risk))
        cells = np.rint(100.0 * risk[window.slices]).astype(np.int8)
        planner.update_map(Hundredths(cells), window)
        expected = augment((100.0 * risk).round() / 100.0, 0.23, 0.1, footprint)
        np.testing.assert_array_equal(planner.augmented_risk, expected)
        # What was handed over stays what it was.
        given.codes[:] = 0
        np.testing.assert_array_equal(planner.augmented_risk, expected)
    with pytest.raises(ValueError, match=r"shape \(2, 2\)"):
        planner.set_map(Hundredths(np.zeros((2, 2), np.int8)))
    with pytest.raises(ValueError, match=r"shape \(2, 2\)"):
        planner.update_map(Hundredths(np.zeros((2, 2), np.int8)), Window(0, 1, 0, 1))


def test_another_robot_augments_anew():
    risk = random_map(np.random.default_rng(1))
    planner = Planner(GEOMETRY)
    planner.set_map(risk)
    planner.parameters = dataclasses.replace(planner.parameters, robot_radius=0.1)
    np.testing.assert_array_equal(planner.augmented_risk, augment(risk, 0.1, 0.1, "disc"))


def test_what_is_refused_changes_nothing():
    risk = random_map(np.random.default_rng(2))
    planner = Planner(GEOMETRY)
    with pytest.raises(ValueError, match="first planning map must be whole"):
        planner.update_map(risk[:2, :2], Window(0, 2, 0, 2))
    planner.set_map(risk)
    before = planner.augmented_risk
    wrong = np.zeros((3, 3))
    wrong[1, 2] = 1.5
    for given, window, words in (
        (wrong, Window(3, 6, 3, 6), r"window of the planning map.*row 1, column 2: 1.5"),
        (wrong[1:], Window(3, 6, 3, 6), r"shape \(2, 3\).*\(3, 3\)"),
        ([[0.1], [0.1, 0.2]], Window(3, 5, 3, 5), "window of the planning map must be an array"),
        (wrong, Window(HEIGHT - 2, HEIGHT + 1, 3, 6), "no part of a map of 30 rows, 44 columns"),
        (wrong, Window(-1, 2, 3, 6), "no part of a map"),
        (wrong, Window(4, 2, 3, 6), "no part of a map"),
    ):
        with pytest.raises(ValueError, match=words):
            planner.update_map(given, window)
    planner.update_map(np.empty((0, 7)), Window(4, 4, 2, 9))
    np.testing.assert_array_equal(planner.augmented_risk, before)


def test_bars_of_the_map_outlive_windows():
    barred = np.zeros((HEIGHT, WIDTH), dtype=bool)
    barred[:, 20] = True
    planner = Planner(GEOMETRY, PlannerParameters(robot_radius=0.0))
    planner.set_map(np.zeros(barred.shape), barred)
    planner.update_map(np.full((6, 6), 0.01), Window(3, 9, 3, 9))
    assert planner.plan((0.5, 0.5), (4.0, 0.5)).status is PlanStatus.NO_PATH


@pytest.mark.parametrize(("size", "cost"), [(700, "g2"), (1300, "g3")])
def test_memory(size, cost):
    """At most 20 bytes a cell for the map and all that a search through the whole of it needs."""
    if not compiled() and size > 1000:
        pytest.skip("half a minute without compiled loops")
    rng = np.random.default_rng(4)
    planner = Planner(GridGeometry(size, size, 0.1), PlannerParameters(robot_radius=0.0))
    risk = (0.6 * rng.random((size, size))).round(2)
    if cost == "g3":  # over a ridge alone: all cells before it wait at one time or another
        risk[:, -3] = 0.99
    planner.set_map(risk)
    far = 0.1 * size - 0.05
    alpha = {"g2": 0.0, "g3": 1.0}[cost]
    assert planner.plan((0.05, 0.05), (far, far), cost, alpha).expanded > 0.5 * size**2
    assert planner.nbytes <= 20 * size**2
