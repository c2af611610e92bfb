# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: what is commanded, where the robot stops, and what is said of it."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import InfraredReading, Pose2
from fuzzy_navigation.mission_types import (
    Drive,
    Finish,
    Outcome,
    Perceive,
    Phase,
    Plan,
    Stop,
)
from fuzzy_navigation.motion import LEAST_SPEED
from fuzzy_navigation.planner import PlanResult, PlanStatus
from unit.fuzzy_navigation.mission_script import (
    DT,
    GEOMETRY,
    Script,
    cells_along,
    finish_of,
    wall_at,
)

STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


# -- the way it goes ----------------------------------------------------------------------------


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
    assert script.mission.feedback().hold == "no pose yet"
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


# -- where it stops -----------------------------------------------------------------------------


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
    script = Script()
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
    script = Script()
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


def test_the_strict_rule_holds_it_at_a_wall_for_good() -> None:
    script = Script(**{"clearance.rule": "strict"})
    script.seen = wall_at(1.05 + 0.23 + 0.08)
    script.set_out((0.45, 2.05))
    for _ in range(5):
        script.again(script.run(), (0.45, 2.05), alpha=0.6)
    finish = finish_of(script.run())
    assert finish.outcome is Outcome.LIVELOCK
    assert finish.perceptions == 6
    assert script.pose.distance_to(1.05, 2.05) < 1e-9


def test_after_a_perception_without_progress_it_may_come_closer_once() -> None:
    script = Script()
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


# -- verdicts -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("alpha", "outcome", "words"),
    [
        (0.6, Outcome.LIVELOCK, "seems free"),
        (0.7, Outcome.UNREACHABLE, "believed occupied"),
        (1.0, Outcome.UNREACHABLE, "believed occupied"),
    ],
)
def test_no_progress_is_a_livelock_only_on_a_path_that_seems_free(
    alpha: float, outcome: Outcome, words: str
) -> None:
    script = Script()
    script.risk[:] = 1.0
    commands = script.set_out(GOAL, alpha=alpha)
    for _ in range(5):
        commands = script.again(commands, GOAL, alpha=alpha)
    finish = finish_of(commands)
    assert finish.outcome is outcome
    assert finish.perceptions == 6
    assert words in finish.message
    assert "(1.05, 2.05)" in finish.message


def test_progress_begins_the_count_anew() -> None:
    script = Script(livelock_limit=2)
    script.risk[:, 20:] = 1.0
    commands = script.set_out(GOAL)
    commands = script.again(script.run(), GOAL, alpha=0.6)
    script.risk[:, 20:25] = 0.0
    script.again(commands, GOAL, alpha=0.6)
    commands = script.run()
    assert script.pose.x == pytest.approx(2.25, abs=0.01)
    commands = script.again(commands, GOAL, alpha=0.6)
    assert [type(c) for c in commands] == [Perceive]
    assert finish_of(script.again(commands, GOAL, alpha=0.6)).outcome is Outcome.LIVELOCK


def test_the_cap_on_perceptions_ends_it() -> None:
    script = Script(perception_cap=3, livelock_limit=10)
    script.risk[:] = 1.0
    commands = script.set_out(GOAL)
    for _ in range(2):
        commands = script.again(commands, GOAL, alpha=0.6)
    finish = finish_of(commands)
    assert finish.outcome is Outcome.UNREACHABLE
    assert finish.perceptions == 3
    assert "perception_cap" in finish.message
    assert "2.00 m" in finish.message


def planned(script: Script, status: PlanStatus, message: str = "because") -> tuple:
    """Start, perceive, and answer the request for a plan with a status."""
    script.tick()
    (plan,) = script.perceive(script.start(*GOAL))
    assert isinstance(plan, Plan)
    result = PlanResult(status, message)
    return plan, script.mission.on_plan(script.now, plan.request, result)


@pytest.mark.parametrize(
    ("status", "outcome"),
    [
        (PlanStatus.NO_PATH, Outcome.UNREACHABLE),
        (PlanStatus.START_OUTSIDE, Outcome.FAILED),
        (PlanStatus.GOAL_OUTSIDE, Outcome.FAILED),
        (PlanStatus.BAD_REQUEST, Outcome.FAILED),
    ],
)
def test_the_planners_no_ends_it(status: PlanStatus, outcome: Outcome) -> None:
    _, commands = planned(Script(), status)
    finish = finish_of(commands)
    assert finish.outcome is outcome
    assert finish.message == "because"


def test_a_planner_without_a_map_is_asked_again() -> None:
    script = Script()
    _, commands = planned(script, PlanStatus.NO_MAP)
    assert commands == ()
    for _ in range(2):
        start = script.now
        commands = script.run(2.0)
        assert script.now - start == pytest.approx(1.0, abs=0.1)
        plan = commands[-1]
        assert isinstance(plan, Plan)
        commands = script.mission.on_plan(
            script.now, plan.request, PlanResult(PlanStatus.NO_MAP, "none yet")
        )
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "3 times in a row" in finish.message
    assert "none yet" in finish.message


@pytest.mark.parametrize("goal", [(-0.1, 2.0), (6.01, 2.0), (2.0, 4.01)])
def test_a_goal_outside_the_map_is_refused(goal: tuple[float, float]) -> None:
    script = Script()
    script.tick()
    commands = script.start(*goal)
    assert [type(c) for c in commands] == [Perceive], "without a map nobody knows"
    finish = finish_of(script.show_map())
    assert finish.outcome is Outcome.FAILED
    assert "outside the map" in finish.message
    finish = finish_of(script.start(*goal))
    assert finish.outcome is Outcome.FAILED
    assert finish.mission == 2


@pytest.mark.parametrize(
    ("poses", "words"),
    [
        ([], "no pose"),
        ([Pose2(1.05, 2.05), Pose2(1.35, 2.05)], "jumps"),
        ([Pose2(1.05, 2.05), Pose2(1.15, 7.05)], "leaves the map"),
        ([Pose2(2.05, 2.05), Pose2(2.15, 2.05)], "starts at"),
    ],
)
def test_a_path_that_cannot_be_followed_is_asked_for_again(poses: list[Pose2], words: str) -> None:
    script = Script()
    script.tick()
    commands = script.perceive(script.start(*GOAL))
    for _ in range(2):
        assert script.plan(commands, poses) == ()
        commands = script.run(2.0)
    finish = finish_of(script.plan(commands, poses))
    assert finish.outcome is Outcome.FAILED
    assert words in finish.message


# -- what does not come -------------------------------------------------------------------------


def test_a_failed_perception_is_tried_again_and_then_given_up() -> None:
    script = Script()
    script.tick()
    commands = script.start(*GOAL)
    for k in range(3):
        perceive = commands[-1]
        assert isinstance(perceive, Perceive)
        assert perceive.request == k + 1
        commands = script.mission.on_perception(
            script.now, perceive.request, False, "the turret is stuck"
        )
        if k < 2:
            assert commands == ()
            commands = script.run(2.0)
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "the turret is stuck" in finish.message
    assert finish.perceptions == 0


def test_failures_are_forgotten_once_it_works() -> None:
    script = Script()
    script.risk[:] = 1.0
    script.tick()
    commands = script.start(*GOAL)
    for _ in range(4):
        for _ in range(2):
            perceive = commands[-1]
            assert isinstance(perceive, Perceive)
            assert script.mission.on_perception(script.now, perceive.request, False) == ()
            commands = script.run(2.0)
        commands = script.again(commands, GOAL, alpha=0.6)
        assert [type(c) for c in commands] == [Perceive]


@pytest.mark.parametrize("answered", [False, True])
def test_a_perception_that_does_not_end_is_given_up(answered: bool) -> None:
    script = Script(**{"timeout.build_map": 5.0})
    script.tick()
    commands = script.start(*GOAL)
    for _ in range(2):
        if answered:
            request = commands[-1].request
            assert script.mission.on_perception(script.now, request, True) == ()
        commands = script.run(7.0)
        assert isinstance(commands[-1], Perceive)
    if answered:
        script.mission.on_perception(script.now, commands[-1].request, True)
    finish = finish_of(script.run(7.0))
    assert finish.outcome is Outcome.FAILED
    assert ("no map" if answered else "no answer") in finish.message
    assert script.now - 100.0 == pytest.approx(3 * 5.0 + 2 * 1.0, abs=0.5)


def test_a_planner_that_does_not_answer_is_given_up() -> None:
    script = Script(**{"timeout.plan": 2.0})
    script.tick()
    commands = script.perceive(script.start(*GOAL))
    for k in range(2):
        assert isinstance(commands[-1], Plan)
        if k:
            assert script.mission.on_plan_error(script.now, commands[-1].request, "gone") == ()
        commands = script.run(4.0)
    finish = finish_of(script.run(4.0))
    assert finish.outcome is Outcome.FAILED
    assert "the planner did not answer" in finish.message


def test_answers_to_old_requests_change_nothing() -> None:
    script = Script()
    script.tick()
    (old,) = script.start(*GOAL)
    _, _, new = script.start(2.05, 3.05)
    assert isinstance(old, Perceive)
    assert isinstance(new, Perceive)
    script.show_map()
    mission = script.mission
    assert mission.on_perception(script.now, old.request, True) == ()
    assert mission.on_perception(script.now, old.request, False) == ()
    assert mission.phase is Phase.PERCEIVING
    (plan,) = mission.on_perception(script.now, new.request, True)
    assert isinstance(plan, Plan)
    result = PlanResult(PlanStatus.NO_PATH, "old")
    assert mission.on_plan(script.now, plan.request + 1, result) == ()
    assert mission.on_plan(script.now, new.request, result) == ()
    assert mission.on_plan_error(script.now, new.request, "old") == ()
    assert mission.on_perception(script.now, new.request, False) == ()
    assert mission.phase is Phase.PLANNING


def test_without_a_pose_it_stands_and_goes_on_when_poses_are_back() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    assert script.mission.on_tick(script.now + 0.4) == ()
    assert script.mission.on_tick(script.now + 0.6) == (STAND,)
    assert "no pose for 0.6 s" in script.mission.feedback().hold
    assert script.mission.on_tick(script.now + 3.0) == (STAND,)
    script.now += 3.0
    commands = script.tick()
    (drive,) = commands
    assert isinstance(drive, Drive)
    assert drive.linear <= script.parameters.follower.linear_acceleration * 0.2
    assert script.mission.feedback().hold == ""
    assert finish_of(script.run()).outcome is Outcome.REACHED


@pytest.mark.parametrize("moving", [False, True])
def test_poses_that_do_not_come_back_end_it(moving: bool) -> None:
    script = Script()
    if moving:
        script.set_out(GOAL)
        script.tick()
    else:
        script.tick()
        script.start(*GOAL)
    commands: tuple = ()
    while not any(isinstance(c, Finish) for c in commands):
        script.now += 0.2
        commands = script.mission.on_tick(script.now)
        assert script.now < 120.0
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "no pose" in finish.message
    assert script.now == pytest.approx(100.0 + 10.0 + 0.5, abs=0.7)


def test_a_first_pose_that_never_comes_ends_it() -> None:
    script = Script()
    script.start(*GOAL)
    commands: tuple = ()
    while not commands:
        script.now += 0.2
        commands = script.mission.on_tick(script.now)
    assert finish_of(commands).outcome is Outcome.FAILED


def test_without_infrared_it_stands_and_goes_on_when_it_is_back() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    for _ in range(30):
        commands = script.tick(infrared=False)
    assert commands == (STAND,)
    assert "no readings from infrared_0, infrared_1" in script.mission.feedback().hold
    assert finish_of(script.run()).outcome is Outcome.REACHED


def test_one_silent_sensor_is_enough_to_stand_and_in_the_end_to_give_up() -> None:
    script = Script()
    script.set_out(GOAL)
    heard = script.now - DT
    commands: tuple = ()
    while script.mission.active:
        script.now += DT
        readings = [r for r in script.infrared() if r.sensor != 5]
        commands = script.mission.on_pose(script.now, script.pose, readings)
        assert commands[0] == STAND or script.now <= heard + 0.5 + DT
        assert script.now < heard + 12.0
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "infrared_5" in finish.message


def test_a_robot_that_does_not_obey_ends_it() -> None:
    script = Script()
    script.set_out(GOAL)
    pose = script.pose
    commands: tuple = ()
    while script.mission.active:
        script.pose = pose
        commands = script.tick()
        assert script.now < 130.0
    assert finish_of(commands).outcome is Outcome.FAILED
    assert "does not do what it is told" in finish_of(commands).message


def test_a_clock_that_steps_back_neither_ends_nor_blinds_it() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.now -= 50.0
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert finish_of(tuple(script.commands)).duration < 10.0


def test_after_a_step_back_of_the_clock_it_still_sees() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.now -= 50.0
    script.tick()
    script.seen = wall_at(2.5)
    script.run()
    assert script.mission.feedback().last_stop is Stop.CLEARANCE
    assert script.pose.x == pytest.approx(2.15, abs=0.01)


# -- who interferes -----------------------------------------------------------------------------


@pytest.mark.parametrize("phase", ["waiting", "perceiving", "planning", "moving", "retrying"])
def test_cancel_makes_it_stand_in_the_same_call(phase: str) -> None:
    script = Script()
    if phase == "waiting":
        script.start(*GOAL)
    elif phase == "moving":
        script.set_out(GOAL)
        while script.pose.x < 1.5:
            script.tick()
    else:
        script.tick()
        commands = script.start(*GOAL)
        if phase == "planning":
            script.perceive(commands)
        if phase == "retrying":
            script.mission.on_perception(script.now, commands[-1].request, False)
    commands = script.mission.cancel(script.now, "enough")
    finish = finish_of(commands)
    assert len(commands) == 2
    assert finish.outcome is Outcome.CANCELED
    assert finish.message == "enough"
    assert script.mission.cancel(script.now) == ()
    for _ in range(60):
        assert script.tick() == ()
    assert script.mission.on_tick(script.now + 100.0) == ()


def test_a_new_goal_replaces_the_old_one() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    commands = script.start(1.05, 3.05)
    assert commands[0] == STAND
    finish = commands[1]
    assert isinstance(finish, Finish)
    assert (finish.mission, finish.outcome) == (1, Outcome.CANCELED)
    assert finish.path_length > 0.4
    script.again(commands, (1.05, 3.05), alpha=0.6)
    finish = finish_of(script.run())
    assert (finish.mission, finish.outcome) == (2, Outcome.REACHED)
    assert finish.perceptions == 1
    assert finish.path_length < 1.6


@pytest.mark.parametrize(
    ("goal", "tolerance", "message"),
    [
        ((math.nan, 1.0), 0.0, "finite"),
        ((1.0, math.inf), 0.0, "finite"),
        ((1.0, 1.0), -0.1, "tolerance"),
        ((1.0, 1.0), math.nan, "tolerance"),
        ((1.0, 1.0), math.inf, "tolerance"),
        ((1.0, 1.0), 0.005, "at least 0.02 m"),
    ],
)
def test_a_bad_goal_is_refused_and_the_mission_goes_on(
    goal: tuple[float, float], tolerance: float, message: str
) -> None:
    script = Script()
    script.set_out(GOAL)
    with pytest.raises(ValueError, match=message):
        script.mission.start(script.now, goal, tolerance)
    assert finish_of(script.run()).mission == 1


@pytest.mark.parametrize("now", [math.nan, math.inf, -math.inf])
def test_a_time_that_is_none_is_refused(now: float) -> None:
    script = Script()
    script.set_out(GOAL)
    mission = script.mission
    before = mission.feedback()
    calls = [
        lambda: mission.start(now, GOAL),
        lambda: mission.cancel(now),
        lambda: mission.on_pose(now, script.pose, script.infrared()),
        lambda: mission.on_tick(now),
        lambda: mission.on_map(now, GEOMETRY, script.risk),
        lambda: mission.on_perception(now, 1, True),
        lambda: mission.on_plan(now, 1, PlanResult(PlanStatus.NO_PATH, "")),
        lambda: mission.on_plan_error(now, 1, ""),
    ]
    for call in calls:
        with pytest.raises(ValueError, match="time of an event"):
            call()
    assert mission.feedback() == before


def test_bad_data_are_refused_and_change_nothing() -> None:
    script = Script()
    script.set_out(GOAL)
    mission = script.mission
    stranger = InfraredReading(script.pose, 0.0, 0.1, script.now, 99)
    with pytest.raises(ValueError, match="sensor 99"):
        mission.on_pose(script.now, Pose2(5.0, 5.0), [stranger])
    with pytest.raises(ValueError, match="must lie in"):
        mission.on_map(script.now, GEOMETRY, np.full(GEOMETRY.shape, np.nan))
    assert mission.feedback().pose == script.pose
    assert finish_of(script.run()).outcome is Outcome.REACHED
