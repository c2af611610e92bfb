# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: what is commanded on the way, and where the robot stops."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import Window
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import (
    Drive,
    Outcome,
    Perceive,
    Phase,
    Plan,
    Stop,
)
from fuzzy_navigation.motion import LEAST_SPEED
from unit.fuzzy_navigation.mission_script import (
    DT,
    GEOMETRY,
    Script,
    cells_along,
    finish_of,
    paper_script,
    wall_at,
)

STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


def test_perceives_plans_and_drives_to_the_goal() -> None:
    script = Script()
    script.tick()
    commands = script.start(*GOAL)
    assert [type(c) for c in commands] == [Perceive]
    assert script.mission.phase is Phase.PERCEIVING
    assert script.tick() == (STAND,)
    commands = script.perceive(commands)
    assert [type(c) for c in commands] == [Plan]
    plan = commands[0]
    assert isinstance(plan, Plan)
    assert plan.start == script.pose
    assert plan.goal == Pose2(*GOAL)
    assert 0.28 < plan.tolerance < 0.3
    assert script.mission.phase is Phase.PLANNING
    assert script.tick() == (STAND,)
    assert script.plan(commands, cells_along((1.05, 2.05), GOAL)) == ()
    assert script.mission.phase is Phase.MOVING
    assert script.mission.feedback().alpha == 0.6
    assert script.mission.feedback().distance_remaining == pytest.approx(2.0)
    finish = finish_of(script.run())
    assert finish.outcome is Outcome.REACHED
    assert finish.mission == 1
    assert finish.perceptions == 1
    assert finish.path_length == pytest.approx(2.0, abs=0.01)
    assert finish.min_clearance == math.inf
    assert finish.duration == pytest.approx(script.now - 100.0 - DT)
    assert script.pose.distance_to(*GOAL) < 0.01
    assert not script.mission.active
    assert script.mission.feedback().last_stop is Stop.GOAL
    assert script.tick() == ()
    np.testing.assert_allclose(script.mission.travelled[0], (1.05, 2.05))
    np.testing.assert_allclose(script.mission.travelled[-1], GOAL, atol=0.03)
    np.testing.assert_allclose(script.mission.plan_path[[0, -1]], [(1.05, 2.05), GOAL])


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.04, -0.03), (-0.049, 0.049)])
def test_stops_at_the_goal_itself_not_at_the_centre_of_its_cell(
    offset: tuple[float, float],
) -> None:
    script = Script()
    goal = GOAL[0] + offset[0], GOAL[1] + offset[1]
    script.set_out(goal)
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert script.pose.distance_to(*goal) < 0.01


def test_a_path_may_end_in_another_cell_within_the_tolerance() -> None:
    script = Script()
    script.tick()
    commands = script.perceive(script.start(*GOAL))
    script.plan(commands, cells_along((1.05, 2.05), (2.85, 1.95)))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert script.pose.distance_to(2.85, 1.95) < 0.01


def test_a_goal_in_the_robots_own_cell_is_driven_to() -> None:
    script = Script()
    script.tick()
    commands = script.start(1.09, 2.02, tolerance=0.02)
    script.plan(script.perceive(commands), cells_along((1.05, 2.05)))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert script.pose.distance_to(1.09, 2.02) < 0.01


def test_a_goal_where_the_robot_stands_is_reached_without_a_perception() -> None:
    script = Script()
    script.tick()
    finish = finish_of(script.start(1.05, 2.3))
    assert finish.outcome is Outcome.REACHED
    assert finish.perceptions == 0
    assert not [c for c in script.commands if isinstance(c, Perceive)]


def test_waits_for_the_first_pose() -> None:
    script = Script()
    assert script.start(*GOAL) == ()
    assert script.mission.feedback().hold.startswith("no pose has come yet")
    assert math.isnan(script.mission.feedback().distance_remaining)
    commands = script.tick()
    assert [type(c) for c in commands] == [Drive, Perceive]
    assert script.mission.feedback().hold == ""


def test_map_and_answer_may_come_in_any_order() -> None:
    script = Script()
    script.tick()
    (perceive,) = script.start(*GOAL)
    assert isinstance(perceive, Perceive)
    assert script.mission.on_perception(script.now, perceive.request, True) == ()
    assert [type(c) for c in script.show_map()] == [Plan]


def test_a_map_from_before_the_perception_does_not_count() -> None:
    script = Script()
    script.tick()
    (perceive,) = script.start(*GOAL)
    assert isinstance(perceive, Perceive)
    mission = script.mission
    assert mission.on_perception(script.now, perceive.request, True) == ()
    assert mission.on_map(script.now, GEOMETRY, script.risk, stamp=script.now - 1.0) == ()
    follow = mission.on_map(script.now, GEOMETRY, script.risk, stamp=script.now)
    assert [type(c) for c in follow] == [Plan]


def test_a_window_is_a_map_that_has_come_and_stops_the_robot_where_it_closes_the_way() -> None:
    script = Script()
    script.tick()
    mission = script.mission
    window = Window(0, 1, 0, 1)
    corner = Hundredths(np.zeros((1, 1), np.int8))
    with pytest.raises(ValueError, match="first motion map must be whole"):
        mission.on_window(script.now, corner, window)
    codes = np.rint(100.0 * script.risk).astype(np.int8)
    mission.on_map(script.now, GEOMETRY, Hundredths(codes))
    (perceive,) = script.start(*GOAL)
    assert isinstance(perceive, Perceive)
    assert mission.on_perception(script.now, perceive.request, True) == ()
    assert mission.on_window(script.now, corner, window, stamp=script.now - 1.0) == ()
    follow = script.take(mission.on_window(script.now, corner, window, stamp=script.now))
    assert [type(c) for c in follow] == [Plan]
    script.plan(follow, cells_along((1.05, 2.05), GOAL))
    for _ in range(20):
        script.tick()
    # A wall across all of the way but where the robot is now.
    x = script.pose.x + 0.6
    column = GEOMETRY.cell_of(x, script.pose.y)[1]
    wall = Window(0, GEOMETRY.height, column, column + 1)
    mission.on_window(script.now, Hundredths(np.full(wall.shape, 100, np.int8)), wall)
    assert any(isinstance(command, Perceive) for command in script.run())
    assert script.pose.x < x - 0.1


def test_the_log_has_an_entry_for_each_perception() -> None:
    script = Script()
    script.risk[:, 20:] = 1.0
    script.set_out(GOAL)
    commands = script.run()
    script.risk[:] = 0.0
    script.again(commands, GOAL, alpha=0.8)
    finish_of(script.run())
    first, second = script.mission.log
    assert (first.perception, first.stop, first.alpha) == (1, Stop.NONE, 0.0)
    assert first.distance_remaining == pytest.approx(2.0)
    assert (second.perception, second.stop, second.alpha) == (2, Stop.UNEXPLORED, 0.6)
    assert second.pose.distance_to(1.75, 2.05) < 0.005
    assert second.distance_remaining == pytest.approx(1.3, abs=0.005)
    assert second.stamp > first.stamp
    assert script.mission.feedback().alpha == 0.8


def test_stands_in_the_last_cell_before_the_unexplored_ones() -> None:
    script = Script()
    script.risk[:, 20:] = 0.91
    script.set_out(GOAL)
    assert [type(c) for c in script.run()] == [Drive, Perceive]
    # Augmented by two cells: column 17, centre 1.75 m, is the last.
    assert script.pose.distance_to(1.75, 2.05) < 0.005
    assert max(pose.x for pose in script.poses) < 1.76
    assert script.mission.feedback().last_stop is Stop.UNEXPLORED


def test_a_map_that_comes_on_the_way_shortens_the_way() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.3:
        script.tick()
    script.risk[:, 25:] = 1.0
    assert script.show_map() == ()
    script.run()
    assert script.pose.x == pytest.approx(2.25, abs=0.01)
    assert script.mission.feedback().last_stop is Stop.UNEXPLORED


def test_a_map_that_shuts_the_way_at_once_makes_it_brake() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.6:
        script.tick()
    x, v = script.pose.x, next(c for c in script.commands[::-1] if isinstance(c, Drive)).linear
    script.risk[:] = 1.0
    script.show_map()
    script.run()
    braking = v * v / (2.0 * script.parameters.follower.linear_acceleration)
    assert script.pose.x <= x + braking + 0.05
    assert script.mission.feedback().last_stop is Stop.UNEXPLORED


@pytest.mark.parametrize("wall", [2.5, 2.53, 2.57])
def test_stops_before_the_cell_that_is_too_close_to_what_the_infrareds_see(wall: float) -> None:
    script = paper_script()
    script.seen = wall_at(wall)
    script.set_out(GOAL)
    commands = script.run()
    assert [type(c) for c in commands] == [Drive, Perceive]
    assert script.mission.feedback().last_stop is Stop.CLEARANCE
    # The cells' centres are 0.05 m off the tenths; the last one with 0.12 m of clearance.
    last = math.floor((wall - 0.23 - 0.12 - 0.05) * 10.0 + 1e-9) / 10.0 + 0.05
    assert script.pose.x == pytest.approx(last, abs=0.01)
    assert max(pose.x for pose in script.poses) < last + 0.01
    assert max(c.linear for c in script.commands if isinstance(c, Drive)) > 0.4


def test_a_wall_that_appears_in_front_makes_it_brake_within_its_clearance() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.8:
        script.tick()
    script.seen = wall_at(script.pose.x + 0.23 + 0.35)
    wall = script.pose.x + 0.23 + 0.35
    script.run()
    assert script.mission.feedback().last_stop is Stop.CLEARANCE
    assert wall - script.pose.x - 0.23 > 0.0


@pytest.mark.parametrize("clearance", [0.02, 0.13, 0.2, 0.4])
def test_beside_a_wall_it_is_no_faster_than_its_clearance_lets_it_brake(clearance: float) -> None:
    script = paper_script()
    script.pose = Pose2(1.05, 0.55, 0.5 * math.pi)
    script.seen = wall_at(1.05 + 0.23 + clearance)
    script.set_out((1.05, 3.05))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    v = max(c.linear for c in script.commands if isinstance(c, Drive))
    a = script.parameters.follower.linear_acceleration
    assert v <= max(math.sqrt(2.0 * a * clearance), LEAST_SPEED)
    # But it does not crawl.
    assert v >= min(0.75 * math.sqrt(2.0 * a * clearance) - 0.05, 0.5)


def test_along_a_wall_that_is_too_close_it_may_leave() -> None:
    script = Script()
    script.seen = wall_at(1.05 + 0.23 + 0.08)
    script.set_out((0.45, 2.05), (0.45, 1.05))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert finish_of(tuple(script.commands)).min_clearance == pytest.approx(0.08, abs=0.001)


def test_a_sensor_that_touches_leaves_no_clearance_and_no_less() -> None:
    script = Script()
    script.seen = lambda x, y, direction: 0.0 if math.cos(direction) < -0.9 else math.inf
    script.set_out(GOAL)
    finish = finish_of(script.run())
    assert finish.outcome is Outcome.REACHED
    assert str(finish.min_clearance) == "0.0"


def test_the_strict_rule_holds_it_at_a_wall_for_good() -> None:
    script = paper_script(**{"clearance.rule": "strict"})
    script.seen = wall_at(1.05 + 0.23 + 0.08)
    script.set_out((0.45, 2.05))
    for _ in range(5):
        script.again(script.run(), (0.45, 2.05), alpha=0.6)
    finish = finish_of(script.run())
    assert finish.outcome is Outcome.LIVELOCK
    assert finish.perceptions == 6
    assert script.pose.distance_to(1.05, 2.05) < 1e-9


def test_after_a_perception_without_progress_it_may_come_closer_once() -> None:
    script = paper_script()
    script.seen = wall_at(2.45)
    script.set_out(GOAL)
    commands = script.run()
    assert script.pose.x == pytest.approx(2.05, abs=0.01), "0.17 m left, 0.07 m at the next cell"
    # Again: no step is allowed, for the robot has only just come here.
    script.again(commands, GOAL, alpha=0.6)
    commands = script.run()
    assert script.pose.x == pytest.approx(2.05, abs=0.01)
    # That brought no progress: now down to 0.05 m.
    script.again(commands, GOAL, alpha=0.6)
    commands = script.run()
    assert script.pose.x == pytest.approx(2.15, abs=0.01)
    assert script.mission.feedback().last_stop is Stop.CLEARANCE
    # That was progress: 0.12 m again, and the next cell would touch.
    script.again(commands, GOAL, alpha=0.6)
    script.run()
    assert script.pose.x == pytest.approx(2.15, abs=0.01)


def test_a_robot_that_was_pushed_off_its_path_stops_and_perceives() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.pose = Pose2(script.pose.x, script.pose.y + 0.2, 0.5)
    assert [type(c) for c in script.run()] == [Drive, Perceive]
    assert script.mission.feedback().last_stop is Stop.NONE
    assert script.pose.x < 1.9


def test_goal_within_the_tolerance_of_a_stop_is_reached() -> None:
    script = Script()
    script.risk[:, 31:] = 1.0  # the goal is two cells outside the explored area
    script.set_out(GOAL)
    finish = finish_of(script.run())
    assert finish.outcome is Outcome.REACHED
    assert "0.2" in finish.message
