# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Requests in metres: the ladder, the choice of the goal's cell, poses, refusals."""

import math

import numpy as np
import pytest
from scipy import ndimage

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.params import PAPER_PRESET, PlannerParameters, planner_parameters
from fuzzy_navigation.plan_request import MOST_BARRED, MOST_HITS
from fuzzy_navigation.planner import Planner, PlanStatus
from fuzzy_navigation.risk import path_risks

GEOMETRY = GridGeometry(40, 30, 0.1, (-1.0, 2.0))
POINT_ROBOT = {"robot_radius": 0.0}


def planner_for(risk, **parameters):
    """Return a planner by the paper's rules, with a map whose lower left corner is (-1, 2) m."""
    height, width = risk.shape
    geometry = GridGeometry(width, height, 0.1, (-1.0, 2.0))
    planner = Planner(geometry, planner_parameters(PAPER_PRESET, POINT_ROBOT | parameters))
    planner.set_map(risk)
    return planner


def centre(row, column):
    """Return the centre [m] of a cell, told apart from the code that is tested."""
    return -1.0 + 0.1 * column + 0.05, 2.0 + 0.1 * row + 0.05


def walled(level):
    """Return a map of 30 x 40 cells with a wall of risk `level` across it at column 20."""
    risk = np.zeros((30, 40))
    risk[:, 20] = level
    return risk


def test_status_numbers_are_those_of_the_service():
    assert [(s.name, s.value) for s in PlanStatus] == [
        ("FOUND", 0),
        ("NO_PATH", 1),
        ("START_OUTSIDE", 2),
        ("GOAL_OUTSIDE", 3),
        ("NO_MAP", 4),
        ("BAD_REQUEST", 5),
    ]


def test_poses_stand_at_cell_centres_and_head_to_the_next():
    planner = planner_for(np.zeros((30, 40)), tolerance=0.0)
    result = planner.plan(Pose2(*centre(5, 5), 1.0), centre(8, 15))
    assert result.status is PlanStatus.FOUND
    assert tuple(result.path[0]) == (5, 5)
    assert tuple(result.path[-1]) == (8, 15)
    assert len(result.poses) == len(result.path) == 11
    for (row, column), pose in zip(result.path.tolist(), result.poses, strict=True):
        assert (pose.x, pose.y) == pytest.approx(centre(row, column))
    for pose, following in zip(result.poses[:-1], result.poses[1:], strict=True):
        heading = math.atan2(following.y - pose.y, following.x - pose.x)
        assert pose.theta == pytest.approx(heading)
    assert result.poses[-1].theta == result.poses[-2].theta
    assert "11 cells" in result.message


def test_a_path_of_one_cell_keeps_the_robots_heading():
    planner = planner_for(np.ones((30, 40)))
    result = planner.plan(Pose2(0.02, 3.0, 2.5), (0.03, 3.01), alpha=0.5)
    assert result.status is PlanStatus.FOUND
    assert [pose.theta for pose in result.poses] == [2.5]
    assert planner.plan((0.02, 3.0), (0.03, 3.01), alpha=0.5).poses[0].theta == 0.0


@pytest.mark.parametrize(
    ("level", "rung"), [(0.0, 0.6), (0.6, 0.6), (0.61, 0.7), (0.7, 0.7), (0.95, 1.0), (1.0, 1.0)]
)
def test_the_ladder_is_climbed_to_the_first_rung_with_a_path(level, rung):
    planner = planner_for(walled(level))
    result = planner.plan(centre(15, 5), centre(15, 35))
    assert result.status is PlanStatus.FOUND
    assert result.alpha == rung
    assert result.g3 == pytest.approx(level + 0.2)
    assert result.expanded > 0
    assert ("none at alpha 0.6" in result.message) == (rung != 0.6)


def test_a_requested_alpha_is_used_alone():
    planner = planner_for(walled(0.7))
    start, goal = centre(15, 5), centre(15, 35)
    blocked = planner.plan(start, goal, alpha=0.65)
    assert blocked.status is PlanStatus.NO_PATH
    assert blocked.alpha == 0.65
    assert blocked.path.shape == (0, 2)
    assert blocked.poses == ()
    assert math.isinf(blocked.g1)
    assert "(2.55, 3.55) m" in blocked.message
    assert "alpha 0.65" in blocked.message
    # 0.7 arrives as 0.699999988 in a message's float32.
    strict = planner.plan(start, goal, alpha=1e-9)
    assert (strict.status, strict.alpha) == (PlanStatus.NO_PATH, 1e-9)
    through = planner.plan(start, goal, alpha=float(np.float32(0.7)))
    assert (through.status, through.alpha) == (PlanStatus.FOUND, 0.7)


def test_the_last_rung_without_a_path():
    planner = planner_for(walled(0.7), alpha_ladder=(0.5, 0.6))
    result = planner.plan(centre(15, 5), centre(15, 35))
    assert (result.status, result.alpha, result.expanded) == (PlanStatus.NO_PATH, 0.6, 0)
    assert result.message.endswith("at alpha 0.6 part them; allow a larger alpha")


def test_a_request_overrides_the_parameters():
    planner = planner_for(walled(0.3))
    start, goal = centre(15, 5), centre(20, 35)
    straight = [
        np.abs(np.diff(planner.plan(start, goal, adjacency=a).path, axis=0)).sum(axis=1)
        for a in (0, 4, 8)
    ]
    assert (straight[0] == 2).any()
    assert (straight[1] == 1).all()
    assert (straight[2] == 2).any()
    # g3 has 4-adjacency unless told otherwise, as in the paper.
    steps = np.abs(np.diff(planner.plan(start, goal, cost="g3").path, axis=0)).sum(axis=1)
    assert (steps == 1).all()
    steps = np.diff(planner.plan(start, goal, cost="g3", adjacency=8).path, axis=0)
    assert (np.abs(steps).sum(axis=1) == 2).any()
    # 4 and g1 as the planner's own parameters.
    planner = planner_for(walled(0.3), adjacency=4, cost="g1")
    steps = np.abs(np.diff(planner.plan(start, goal).path, axis=0)).sum(axis=1)
    assert (steps == 1).all()


def test_each_cost_is_minimised():
    risk = np.random.default_rng(4).random((30, 40)) * 0.6
    planner = planner_for(risk, adjacency=8, tolerance=0.0)
    results = {c: planner.plan(centre(1, 1), centre(28, 38), cost=c) for c in ("g1", "g2", "g3")}
    for cost, best in results.items():
        costs = path_risks(risk + 0.2, best.path)
        assert (best.g1, best.g2, best.g3) == pytest.approx(costs)
        assert all(getattr(best, cost) <= getattr(r, cost) + 1e-9 for r in results.values())
    assert results["g1"].path.tolist() != results["g3"].path.tolist()
    default = planner.plan(centre(1, 1), centre(28, 38))
    assert default.path.tolist() == results["g2"].path.tolist()


def test_the_robots_size_keeps_it_from_walls_and_borders():
    risk = np.zeros((30, 40))
    risk[:27, 20] = 1.0  # the free cells beside the wall's end are too few for the robot
    planner = planner_for(risk, robot_radius=0.23)
    start, goal = centre(15, 8), centre(15, 33)
    assert planner.plan(start, goal, alpha=0.6).status is PlanStatus.NO_PATH
    risk[21:, 20] = 0.0
    planner.set_map(risk)
    result = planner.plan(start, goal, alpha=0.6)
    assert result.status is PlanStatus.FOUND
    distance = ndimage.distance_transform_cdt(np.pad(risk == 0, 1), "chessboard")[1:-1, 1:-1]
    assert distance[tuple(result.path.T)].min() == 3
    assert planner.augmented_risk[0, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        planner.augmented_risk[0, 0] = 0.0


def test_where_the_robot_stands_at_its_goal_the_path_is_its_cell():
    # Corners and borders of cells, which are as near to four or two centres, and places within.
    planner = planner_for(np.zeros((30, 40)))
    for row in range(2, 28, 5):
        for column in range(2, 38, 3):
            for part in ((0.0, 0.0), (0.0, 0.5), (0.5, 0.0), (0.3, 0.8)):
                place = -1.0 + 0.1 * (column + part[0]), 2.0 + 0.1 * (row + part[1])
                for tolerance in (1e-6, 0.3):
                    result = planner.plan(place, place, tolerance=tolerance)
                    assert len(result.path) == 1
                    assert result.message.startswith("path of 1 cell at alpha")
                    pose = result.poses[0]
                    assert max(abs(pose.x - place[0]), abs(pose.y - place[1])) <= 0.05 + 1e-9


def test_the_nearest_admissible_cell_is_the_goal():
    risk = np.zeros((30, 40))
    risk[13:18, 29:34] = 1.0
    planner = planner_for(risk)
    x, y = centre(15, 31)
    result = planner.plan(centre(15, 5), (x + 0.02, y), alpha=0.6)
    assert tuple(result.path[-1]) == (15, 34)
    result = planner.plan(centre(15, 5), (x - 0.02, y - 0.01), alpha=0.6)
    assert tuple(result.path[-1]) == (15, 28)
    # In the very middle four cells are equally near: the lowest row, then column.
    result = planner.plan(centre(15, 5), (x, y), alpha=0.6)
    assert tuple(result.path[-1]) == (12, 31)
    refused = planner.plan(centre(15, 5), (x, y), alpha=0.6, tolerance=0.25)
    assert refused.status is PlanStatus.NO_PATH
    assert "within 0.25 m of the goal (2.15, 3.55) m" in refused.message
    assert "obstacle" in refused.message
    # A centre at exactly the tolerance counts, also with the rounding of float32.
    exact = planner.plan(centre(15, 5), (x, y), alpha=0.6, tolerance=float(np.float32(0.3)))
    assert exact.status is PlanStatus.FOUND


def test_a_nearest_cell_out_of_reach_gives_way_to_one_within():
    risk = np.zeros((30, 40))
    risk[13:18, 29:34] = 1.0
    risk[15, 31] = 0.0  # free, at the goal, and walled in
    planner = planner_for(risk)
    goal = centre(15, 31)
    result = planner.plan(centre(15, 5), goal, alpha=0.6)
    assert tuple(result.path[-1]) == (12, 31)
    closed = planner.plan(centre(15, 5), goal, alpha=0.6, tolerance=0.2)
    assert closed.status is PlanStatus.NO_PATH
    assert "part them" in closed.message


def test_without_tolerance_only_the_goals_cell_will_do():
    planner = planner_for(np.zeros((30, 40)), tolerance=0.0)
    x, y = centre(15, 31)
    # Near the cell's corner its centre is 6 cm away: still the goal's cell.
    result = planner.plan(centre(15, 5), (x + 0.045, y + 0.045))
    assert tuple(result.path[-1]) == (15, 31)
    blocked = np.zeros((30, 40))
    blocked[15, 31] = 1.0
    planner.set_map(blocked)
    assert planner.plan(centre(15, 5), (x, y), alpha=0.6).status is PlanStatus.NO_PATH


@pytest.mark.parametrize("corner_cutting", [True, False])
@pytest.mark.parametrize("adjacency", [4, 8])
def test_reachable_is_what_the_search_reaches(adjacency, corner_cutting):
    """Dense random pillars: a path to the goal's own cell exactly when a flood gets there."""
    rng = np.random.default_rng(11)
    found = 0
    for _ in range(60):
        risk = (rng.random((30, 40)) < 0.4).astype(float)
        planner = planner_for(risk, corner_cutting=corner_cutting, tolerance=0.0)
        start, goal = rng.integers(0, 30, 2), rng.integers(0, 30, 2)
        result = planner.plan(centre(*start), centre(*goal), alpha=0.5, adjacency=adjacency)
        flood, free = {tuple(start)}, risk < 0.5
        free[tuple(start)] = True
        queue = list(flood)
        while queue:
            row, column = queue.pop()
            for i in (-1, 0, 1):
                for j in (-1, 0, 1):
                    a, b = row + i, column + j
                    if (a, b) in flood or not (0 <= a < 30 and 0 <= b < 40) or not free[a, b]:
                        continue
                    if i and j:
                        if adjacency == 4:
                            continue
                        if not corner_cutting and not (free[a, column] and free[row, b]):
                            continue
                    flood.add((a, b))
                    queue.append((a, b))
        assert (result.status is PlanStatus.FOUND) == (tuple(goal) in flood)
        found += result.status is PlanStatus.FOUND
    assert 5 < found < 55


def test_barred_cells_of_a_finished_map():
    risk = np.zeros((30, 40))
    barred = np.zeros((30, 40), dtype=bool)
    barred[:, 20] = True
    planner = planner_for(risk)
    planner.set_map(risk, barred)
    assert planner.plan(centre(15, 5), centre(15, 35)).status is PlanStatus.NO_PATH
    barred[2, 20] = False  # the planner has its own copy
    assert planner.plan(centre(15, 5), centre(15, 35)).status is PlanStatus.NO_PATH
    planner.set_map(risk, barred)
    assert [2, 20] in planner.plan(centre(15, 5), centre(15, 35)).path.tolist()
    planner.set_map(risk)
    assert len(planner.plan(centre(15, 5), centre(15, 35)).path) < 35


def test_new_parameters_hold_from_the_next_request_on():
    planner = planner_for(walled(0.7))
    start, goal = centre(15, 5), centre(15, 35)
    planner.parameters = PlannerParameters(alpha_ladder=(0.5,), robot_radius=0.23)
    assert planner.plan(start, goal).status is PlanStatus.NO_PATH
    assert planner.augmented_risk[15, 18] == 0.7
    planner.parameters = PlannerParameters(alpha_ladder=(0.7,), robot_radius=0.0)
    assert planner.plan(start, goal).alpha == 0.7
    assert planner.augmented_risk[15, 18] == 0.0


def test_without_a_map_there_is_no_plan():
    planner = Planner(GEOMETRY)
    result = planner.plan((0.0, 3.0), (1.0, 3.0))
    assert result.status is PlanStatus.NO_MAP
    assert "no planning map" in result.message
    assert planner.augmented_risk is None
    planner.parameters = PlannerParameters(cost="g1")
    assert planner.parameters.cost == "g1"
    assert planner.plan((math.nan, 3.0), (1.0, 3.0)).status is PlanStatus.BAD_REQUEST


@pytest.mark.parametrize(
    ("start", "goal", "status", "words"),
    [
        ((-1.01, 3.0), (0.0, 3.0), PlanStatus.START_OUTSIDE, "start (-1.01, 3.00) m"),
        ((0.0, 5.0), (0.0, 3.0), PlanStatus.START_OUTSIDE, "x -1 to 3 m and y 2 to 5 m"),
        ((0.0, 3.0), (0.0, 1.99), PlanStatus.GOAL_OUTSIDE, "goal (0.00, 1.99) m"),
        ((0.0, 3.0), (1e300, 3.0), PlanStatus.GOAL_OUTSIDE, "choose a point inside"),
        ((9.0, 9.0), (9.0, 9.0), PlanStatus.START_OUTSIDE, "start"),
    ],
)
def test_positions_outside_the_map(start, goal, status, words):
    result = planner_for(np.zeros((30, 40))).plan(start, goal)
    assert result.status is status
    assert words in result.message
    assert len(result.path) == 0


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        ({"start": (math.nan, 3.0)}, "start must be finite"),
        ({"goal": (0.0, math.inf)}, "goal must be finite"),
        ({"goal": (0.0,)}, "goal must be a position"),
        ({"goal": None}, "goal must be a position"),
        ({"goal": ("a", "b")}, "goal must be a position"),
        ({"cost": "g9"}, "cost must be one of g1, g2, g3, got 'g9'"),
        ({"alpha": math.nan}, "alpha must lie in [0, 1], 0 for the ladder, got nan"),
        ({"alpha": 1.5}, "got 1.5"),
        ({"alpha": -0.5}, "got -0.5"),
        ({"alpha": "high"}, "request refused"),
        ({"adjacency": 6}, "adjacency must be 0, 4 or 8, got 6"),
        ({"tolerance": -0.1}, "tolerance must lie in [0, 10] m, 0 for the parameter, got -0.1"),
        ({"tolerance": 10.01}, "got 10.01"),
        ({"tolerance": math.nan}, "got nan"),
        ({"tolerance": math.inf}, "tolerance"),
        ({"hits": [(0.0, math.nan)]}, "hits positions must be finite"),
        ({"hits": [0.0, 1.0]}, "hits positions have the shape (any, 2), got (2,)"),
        ({"hits": "here"}, "request refused"),
        ({"hits": np.zeros((MOST_HITS + 1, 2))}, "hits positions may be 10000 at most"),
        ({"barred": [(0.0, math.inf)]}, "barred positions must be finite"),
        ({"barred": np.zeros((MOST_BARRED + 1, 2))}, "barred positions may be 100000 at most"),
    ],
)
def test_bad_requests_are_answered_not_raised(request_, words):
    planner = planner_for(np.zeros((30, 40)))
    result = planner.plan(**{"start": (0.0, 3.0), "goal": (1.0, 3.0), **request_})
    assert result.status is PlanStatus.BAD_REQUEST
    assert result.message.startswith("request refused: ")
    assert words in result.message
    assert planner.plan((0.0, 3.0), (1.0, 3.0)).status is PlanStatus.FOUND


def test_numbers_of_a_float32_message_are_told_as_they_were_meant():
    planner = planner_for(np.zeros((30, 40)))
    for field, value in (("alpha", 1.2), ("tolerance", 10.1), ("slim_radius", 5.3)):
        result = planner.plan(centre(1, 1), centre(2, 2), **{field: float(np.float32(value))})
        assert result.message.endswith(f", got {value}")


@pytest.mark.parametrize(
    ("risk", "barred", "words"),
    [
        (np.zeros((40, 30)), None, r"\(40, 30\).*\(30, 40\)"),
        (np.full((30, 40), math.nan), None, "planning map.*nan"),
        (np.full((30, 40), 1.01), None, "planning map.*1.01"),
        (np.zeros((30, 40)), np.zeros((40, 30), dtype=bool), r"barred.*\(40, 30\)"),
        (np.zeros((30, 40)), np.zeros((30, 40)), "barred.*bool.*float64"),
    ],
)
def test_a_refused_map_leaves_the_one_before(risk, barred, words):
    planner = planner_for(walled(0.7))
    before = planner.plan(centre(15, 5), centre(15, 35))
    with pytest.raises(ValueError, match=words):
        planner.set_map(risk, barred)
    after = planner.plan(centre(15, 5), centre(15, 35))
    assert after.path.tolist() == before.path.tolist()
    assert after.alpha == 0.7


def test_the_map_is_copied():
    risk = np.zeros((30, 40))
    planner = planner_for(risk)
    risk[:] = 1.0
    assert planner.augmented_risk.max() == 0.0
    planner.parameters = PlannerParameters(robot_radius=0.0)
    assert planner.augmented_risk.max() == 0.0
