# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plans by hit points and the choice of the rung, against searches on hand-made layers."""

import dataclasses
import math
import tracemalloc

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.clearance_layer import clearance_layer
from fuzzy_navigation.params import LayerParameters, PlannerParameters
from fuzzy_navigation.planner import Planner, PlanStatus
from fuzzy_navigation.search import find_path

GEOMETRY = GridGeometry(40, 30, 0.1, (-1.0, 2.0))


def layered(risk=None, **parameters):
    """A planner for a point, so that the map's risks stay in their cells and count as they are."""
    values = np.zeros((30, 40)) if risk is None else risk
    plain = {"robot_radius": 0.0, "epsilon": 0.2, "least_risk": 0.0}
    planner = Planner(GEOMETRY, PlannerParameters(**(plain | parameters)))
    planner.set_map(values)
    return planner


def centre(row, column):
    """Return the centre [m] of a cell, told apart from the code that is tested."""
    return -1.0 + 0.1 * column + 0.05, 2.0 + 0.1 * row + 0.05


def wall(row0, row1, column, gap=0.02):
    """Hit points along a column of cells, from row to row."""
    x, y0 = centre(row0, column)
    _, y1 = centre(row1, column)
    return [(x, y) for y in np.arange(y0, y1 + 1e-9, gap)]


def test_hit_points_close_cells_and_cost_nearby():
    planner = layered(tolerance=0.0, diagonal="sqrt2")
    start, goal = centre(15, 5), centre(15, 35)
    free = planner.plan(start, goal)
    assert free.path[:, 0].tolist() == [15] * 31
    hits = wall(5, 20, 20)
    around = planner.plan(start, goal, hits=hits)
    assert around.alpha == 0.6
    at_wall = around.path[np.abs(around.path[:, 1] - 20) <= 1]
    assert at_wall[:, 0].min() >= 21
    # Exactly where the layer by itself puts a path of least cost.
    layer = clearance_layer(planner.geometry, np.array(hits), 0.0, LayerParameters())
    cut, cost = np.zeros((2, *planner.geometry.shape))
    cut[tuple(layer.cells.T)], cost[tuple(layer.cells.T)] = layer.cut, layer.cost
    direct = find_path(cost, (15, 5), (15, 35), epsilon=0.2, diagonal="sqrt2", cut=cut)
    np.testing.assert_array_equal(around.path, direct.path)
    # The costs that are reported are the map's own; the points are the request's alone.
    steps = np.abs(np.diff(around.path, axis=0)).sum(axis=1)
    length = 1.0 + np.where(steps == 2, math.sqrt(2.0), 1.0).sum()
    assert around.g1 == pytest.approx(0.2 * length)
    assert planner.plan(start, goal).path.tolist() == free.path.tolist()


def test_a_narrow_gap_is_taken_on_a_higher_rung():
    """Corners 0.16 m apart, passed 4.5 cm beside their line: c = 9.2 cm, mu_I about 0.76."""
    planner = layered(tolerance=0.0)
    x, y = centre(15, 20)
    hits = [(x, y + s * d) for d in np.arange(0.08, 4.0, 0.02) for s in (-1, 1)]
    result = planner.plan(centre(15, 5), centre(15, 35), hits=hits)
    assert (result.status, result.alpha) == (PlanStatus.FOUND, 0.8)
    assert [15, 20] in result.path.tolist()
    closed = [(x, y + s * d) for d in np.arange(0.0, 4.0, 0.02) for s in (-1, 1)]
    assert planner.plan(centre(15, 5), centre(15, 35), hits=closed).status is PlanStatus.NO_PATH


def test_hit_points_without_the_layer_do_not_count():
    planner = layered(tolerance=0.0, layer=LayerParameters(enabled=False))
    start, goal = centre(15, 5), centre(15, 35)
    with_hits = planner.plan(start, goal, hits=wall(5, 20, 20))
    assert with_hits.path.tolist() == planner.plan(start, goal).path.tolist()


def explored_band(risk=0.15):
    """A map of which a straight band is known to be free, and nothing else at all."""
    values = np.zeros((30, 40))
    values[13:18] = risk
    return values


@pytest.mark.parametrize("hits", [(), [(-0.9, 2.05)]])
@pytest.mark.parametrize("cost", ["g1", "g2"])
def test_unexplored_ground_is_preferred_unless_it_costs_as_much_as_free_ground(cost, hits):
    start, goal = centre(15, 5), centre(15, 35)
    options = {"tolerance": 0.0, "diagonal": "sqrt2", "cost": cost}
    aside = layered(explored_band(), **options).plan(start, goal, hits=hits).path
    straight = layered(explored_band(), least_risk=0.15, **options).plan(start, goal, hits=hits)
    assert (np.abs(aside[:, 0] - 15) > 2).any()
    assert straight.path[:, 0].tolist() == [15] * 31
    # What is reported are the risks of the map.
    assert straight.g1 == pytest.approx(31 * 0.35)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("cost", ["g1", "g2", "g3"])
def test_the_least_risk_is_that_of_a_map_without_lesser_ones(cost, seed):
    risk = np.round(np.random.default_rng(seed).uniform(0.0, 0.9, (30, 40)), 2)
    options = {"tolerance": 0.0, "diagonal": "sqrt2", "cost": cost}
    start, goal = centre(2, 3), centre(27, 36)
    found = layered(risk, least_risk=0.3, **options).plan(start, goal)
    direct = find_path(
        np.maximum(risk, 0.3),
        (2, 3),
        (27, 36),
        cost,
        found.alpha,
        adjacency=4 if cost == "g3" else 8,
        epsilon=0.2,
        diagonal="sqrt2",
        cut=risk,
    )
    np.testing.assert_array_equal(found.path, direct.path)


COLUMN = [centre(row, 25) for row in range(30)]


@pytest.mark.parametrize(
    ("hits", "barred", "told"),
    [
        (wall(0, 29, 20), [], "points that the robot's sensors hit"),
        ([], COLUMN, "cells that it was barred from"),
        (wall(0, 29, 20), COLUMN, "robot's sensors hit and cells that it was barred from"),
        (wall(0, 29, 20), COLUMN[::2], "points that the robot's sensors hit"),
        ([centre(15, 5)], [], "points that the robot's sensors hit"),  # at the start
    ],
)
def test_what_the_request_closes_is_not_laid_to_the_map(hits, barred, told):
    planner = layered(tolerance=0.0, robot_radius=0.23)
    start, goal = centre(15, 5), centre(15, 35)
    answer = planner.plan(start, goal, hits=hits, barred=barred)
    assert answer.status is PlanStatus.NO_PATH
    reason = answer.message.partition("; the map by itself has a path, but it is closed by ")[2]
    assert reason.endswith(told)
    # Where the map has none either, it is the map's.
    planner.set_map(two_doors(far_risk=1.0, near_risk=1.0))
    answer = planner.plan(start, goal, alpha=0.6, hits=hits, barred=barred)
    assert answer.status is PlanStatus.NO_PATH
    assert "by itself" not in answer.message


def two_doors(far_risk=0.0, near_risk=0.65):
    """A wall along column 20 with a near door of some risk and a free one far away."""
    risk = np.zeros((30, 40))
    risk[:, 20] = 1.0
    risk[15, 20] = near_risk
    risk[1, 20] = far_risk
    return risk


@pytest.mark.parametrize("cost", ["g1", "g2"])
@pytest.mark.parametrize("factor", [1.0, 1.2, 1.5, 3.0])
def test_the_lowest_rung_that_is_not_much_dearer(cost, factor):
    risk = two_doors()
    planner = layered(risk, rung_choice="cheapest", rung_factor=factor, cost=cost, tolerance=0.0)
    start, goal = centre(15, 15), centre(15, 25)
    result = planner.plan(start, goal)
    costs, paths = [], []
    for rung in (0.6, 0.7, 0.8, 0.9, 1.0):
        found = find_path(risk, (15, 15), (15, 25), cost, rung, epsilon=0.2, diagonal="sqrt2")
        costs.append(getattr(found, cost))
        paths.append(found.path)
    k = next(k for k in range(5) if costs[k] <= factor * min(costs))
    assert result.alpha == (0.6, 0.7, 0.8, 0.9, 1.0)[k]
    assert result.path.tolist() == paths[k].tolist()
    first = layered(risk, rung_choice="first", cost=cost, tolerance=0.0)
    assert first.plan(start, goal).alpha == 0.6
    if k:
        assert "much dearer one at alpha 0.6" in result.message


def test_the_rung_choice_makes_a_difference_in_these_rooms():
    start, goal = centre(15, 15), centre(15, 25)
    planner = layered(two_doors(), rung_choice="cheapest", cost="g1", tolerance=0.0)
    assert planner.plan(start, goal).alpha == 0.7
    planner.parameters = dataclasses.replace(planner.parameters, rung_factor=10.0)
    assert planner.plan(start, goal).alpha == 0.6
    planner.set_map(two_doors(far_risk=1.0))
    assert planner.plan(start, goal).message.endswith("none at alpha 0.6")
    # An alpha that is asked for is used alone.
    assert planner.plan(start, goal, alpha=0.9).alpha == 0.9


def test_hit_points_count_in_the_choice_of_the_rung():
    """A door that is free in the map but narrow to the sensors is dearer than it looks."""
    risk = two_doors(near_risk=0.0)
    x, y = centre(15, 20)
    hits = [(x, y - 0.1), (x, y + 0.1)]
    planner = layered(risk, rung_choice="cheapest", cost="g1", tolerance=0.0)
    start, goal = centre(15, 15), centre(15, 25)
    assert planner.plan(start, goal).alpha == 0.6
    assert planner.plan(start, goal, hits=hits).alpha == 0.7


def test_hit_points_on_cells_too_small_are_a_bad_request_before_memory_is_taken():
    geometry = GridGeometry(300, 300, 1e-3)
    planner = Planner(geometry, PlannerParameters(layer=LayerParameters(enabled=True)))
    planner.set_map(np.zeros(geometry.shape))
    hits = [(0.15, 0.15)] * 1000
    tracemalloc.start()
    result = planner.plan((0.1, 0.1), (0.2, 0.2), hits=hits)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert result.status is PlanStatus.BAD_REQUEST
    assert "1000 hit points are near to 90000000 cells of 0.001 m" in result.message
    assert peak < 2_000_000
    assert planner.plan((0.1, 0.1), (0.2, 0.2), hits=hits[:3]).status is not result.status
