# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Paths pulled straight: what they cost, what they pass, and where they lead."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.any_angle import MOST_KNOTS, pulled_straight
from fuzzy_navigation.params import motion_parameters
from fuzzy_navigation.planner import Planner
from fuzzy_navigation.search import find_path

BAR = 0.99


def length(places):
    return sum(math.dist(a, b) for a, b in itertools.pairwise(places))


def cost_by_hand(cells, places, weights):
    """Length of each piece times the weight of the cell that it enters."""
    return sum(
        math.dist(a, b) * weights[tuple(cell)]
        for a, b, cell in zip(places[:-1], places[1:], cells[1:], strict=True)
    )


def some_ground(seed, shape=(40, 50)):
    """Weights in patches with barred blocks, and a path of least cost through them."""
    rng = np.random.default_rng(seed)
    risk = np.kron(rng.choice([0.0, 0.1, 0.5], (8, 10)), np.ones((5, 5)))
    barred = np.kron(rng.random((8, 10)) < 0.15, np.ones((5, 5))).astype(bool)
    barred[:5, :5] = barred[-5:, -5:] = False
    start, goal = (1, 2), (shape[0] - 2, shape[1] - 3)
    found = find_path(risk, start, goal, "g2", 1.0, epsilon=0.2, diagonal="sqrt2", barred=barred)
    weights = (risk + 0.2) ** 2
    weights[barred] = math.inf
    return found.path, weights


@pytest.mark.parametrize("goal", [(7, 31), (31, 7), (20, 20), (0, 15), (13, 14)])
def test_on_even_ground_the_way_is_the_straight_line(goal):
    path = find_path(np.zeros((40, 40)), (3, 2), goal, "g2", diagonal="sqrt2").path
    cells, places = pulled_straight(path, np.ones((40, 40)))
    assert length(places) == pytest.approx(math.dist((3, 2), goal), rel=5e-3)
    assert cells[0].tolist() == [3, 2]
    assert cells[-1].tolist() == list(goal)


@pytest.mark.parametrize("seed", range(12))
def test_the_way_costs_no_more_and_stays_where_paths_may_go(seed):
    path, weights = some_ground(seed)
    cells, places = pulled_straight(path, weights)
    assert (np.abs(np.diff(cells, axis=0)).max(axis=1) == 1).all()
    assert (np.abs(places - cells) < 0.495).all()
    assert np.isfinite(weights[cells[:, 0], cells[:, 1]]).all()
    np.testing.assert_array_equal(cells[[0, -1]], path[[0, -1]])
    before = cost_by_hand(path, path, weights)
    # Places are kept off the sides of their cells: by a hundredth of a cell.
    assert cost_by_hand(cells, places, weights) <= before * 1.005


def test_some_of_these_ways_are_shorter():
    gains = []
    for seed in range(12):
        path, weights = some_ground(seed)
        cells, places = pulled_straight(path, weights)
        gains.append(cost_by_hand(cells, places, weights) / cost_by_hand(path, path, weights))
    assert np.mean(gains) < 0.98


def test_a_wall_is_not_crossed_and_its_corner_not_cut():
    weights = np.ones((20, 30))
    weights[5:, 14:16] = math.inf
    risk = np.where(np.isfinite(weights), 0.0, BAR)
    path = find_path(risk, (15, 3), (15, 26), "g2", diagonal="sqrt2", corner_cutting=False).path
    cells, places = pulled_straight(path, weights, corner_cutting=False)
    assert np.isfinite(weights[cells[:, 0], cells[:, 1]]).all()
    for a, b in zip(cells[:-1].tolist(), cells[1:].tolist(), strict=True):
        assert math.isfinite(weights[a[0], b[1]])
        assert math.isfinite(weights[b[0], a[1]])
    around = math.dist((15, 3), (4, 14)) + 1.0 + math.dist((4, 15), (15, 26))
    assert length(places) <= around * 1.03


def test_long_paths_keep_their_ends_and_their_cells():
    path = find_path(np.zeros((600, 40)), (0, 0), (599, 39), "g2", diagonal="sqrt2").path
    assert len(path) > MOST_KNOTS
    cells, places = pulled_straight(path, np.ones((600, 40)))
    np.testing.assert_array_equal(cells[[0, -1]], [(0, 0), (599, 39)])
    assert (np.abs(np.diff(cells, axis=0)).max(axis=1) == 1).all()
    assert length(places) == pytest.approx(math.dist((0, 0), (599, 39)), rel=2e-3)


def asked(any_angle, **request):
    """Return a plan over an empty map, and its geometry."""
    geometry = GridGeometry(60, 40, 0.1)
    planner = Planner(geometry)
    planner.set_map(np.zeros((40, 60)))
    return planner.plan((0.55, 0.55), (5.35, 2.45), any_angle=any_angle, **request), geometry


def test_the_planner_s_poses_lie_on_the_line_and_in_the_path_s_cells():
    plan, geometry = asked(True)
    off = [abs((p.y - 0.55) * 4.8 - (p.x - 0.55) * 1.9) / math.hypot(4.8, 1.9) for p in plan.poses]
    assert max(off) < 0.005
    for pose, cell in zip(plan.poses, plan.path.tolist(), strict=True):
        assert geometry.cell_of(pose.x, pose.y) == tuple(cell)


@pytest.mark.parametrize(
    ("any_angle", "request_of"),
    [(False, {}), (True, {"adjacency": 4}), (True, {"cost": "g3", "adjacency": 8})],
)
def test_other_paths_lead_through_the_centres(any_angle, request_of):
    plan, geometry = asked(any_angle, **request_of)
    for pose, cell in zip(plan.poses, plan.path.tolist(), strict=True):
        assert geometry.centre_of(*cell) == (pose.x, pose.y)


@pytest.mark.parametrize("preset", ["consistent", "oriolo1998"])
def test_only_the_motion_of_consistent_asks_for_it(preset):
    assert motion_parameters(preset).any_angle is (preset == "consistent")
