# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The slimmer robot's path: where to look when an opening seems too narrow."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.params import PAPER_PRESET, planner_parameters
from fuzzy_navigation.planner import Planner, PlanStatus
from fuzzy_navigation.search import find_path

GEOMETRY = GridGeometry(41, 21, 0.1)
#: Column of the wall, rows of its opening, and belief in the rest of it.
WALL, OPENING, BELIEF = 20, (3, 4, 5), 0.8
START, GOAL = (1.05, 1.55), (3.05, 1.55)


def closed_by_cones(belief: float = BELIEF) -> np.ndarray:
    """A wall believed to some degree; its opening, far from the straight line, is 0.3 m wide."""
    risk = np.zeros(GEOMETRY.shape)
    risk[:, WALL] = belief
    risk[OPENING, WALL] = 0.0
    return risk


def planner(risk: np.ndarray, **parameters: object) -> Planner:
    """Return a planner by the paper's rules, with which the slimmer robot is of use."""
    overrides = {"robot_radius": 0.23, "tolerance": 0.0, **parameters}
    out = Planner(GEOMETRY, planner_parameters(PAPER_PRESET, overrides))
    out.set_map(risk)
    return out


def crossing(path: np.ndarray) -> int:
    """Row in which a path crosses the wall."""
    (row,) = path[path[:, 1] == WALL, 0]
    return int(row)


def test_it_leads_to_the_opening_that_is_too_narrow() -> None:
    p = planner(closed_by_cones())
    through_the_wall = p.plan(START, GOAL)
    assert through_the_wall.alpha == 0.8
    assert crossing(through_the_wall.path) == 15
    slim = p.plan(START, GOAL, slim_radius=0.12, slim_above=0.6)
    assert (slim.status, slim.alpha) == (PlanStatus.FOUND, 0.8)
    assert crossing(slim.path) == OPENING[1]
    assert "slimmer" in slim.message
    # It is the best path of a disc of that radius, found without the planner.
    near = [(j, k) for j in range(-2, 3) for k in range(-2, 3) if math.hypot(j, k) <= 1.2]
    grown = np.pad(closed_by_cones(), 2, constant_values=1.0)
    grown = np.max([np.roll(grown, shift, (0, 1)) for shift in near], axis=0)[2:-2, 2:-2]
    best = find_path(grown, (15, 10), (15, 30), "g2", alpha=0.6, epsilon=0.2)
    assert len(slim.path) == len(best.path)
    values = [(grown[r, c] + 0.2) ** 2 for r, c in slim.path]
    assert sum(values) == pytest.approx(best.g2)
    # Costs are the true robot's, for whom the opening is as risky as the wall.
    assert slim.g3 == pytest.approx(BELIEF + 0.2)


@pytest.mark.parametrize(
    ("belief", "radius", "above"),
    [(0.6, 0.12, 0.6), (0.8, 0.12, 0.8), (0.8, 0.0, 0.6), (0.8, 0.3, 0.6)],
    ids=["the true one has a path", "its rung is low enough", "no slim one", "not slim enough"],
)
def test_else_the_path_is_the_true_robots(belief: float, radius: float, above: float) -> None:
    p = planner(closed_by_cones(belief))
    plain = p.plan(START, GOAL)
    np.testing.assert_array_equal(
        p.plan(START, GOAL, slim_radius=radius, slim_above=above).path, plain.path
    )


def test_where_nobody_gets_through_there_is_no_path() -> None:
    p = planner(closed_by_cones(), alpha_ladder=(0.6, 0.7))
    assert p.plan(START, GOAL, slim_radius=0.12, slim_above=0.6).status is PlanStatus.NO_PATH


@pytest.mark.parametrize(
    "request_",
    [{"slim_radius": -0.1}, {"slim_radius": math.nan}, {"slim_radius": 6.0}]
    + [{"slim_radius": 0.1, "slim_above": above} for above in (-0.1, 1.1, math.nan)],
)
def test_senseless_values_are_refused(request_: dict[str, float]) -> None:
    result = planner(closed_by_cones()).plan(START, GOAL, **request_)
    assert result.status is PlanStatus.BAD_REQUEST
    assert list(request_)[-1] in result.message
