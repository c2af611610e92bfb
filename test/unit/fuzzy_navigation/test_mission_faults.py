# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: what does not come, what is bad, and who interferes."""

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
from fuzzy_navigation.planner import PlanResult, PlanStatus
from unit.fuzzy_navigation.mission_script import (
    DT,
    GEOMETRY,
    Script,
    finish_of,
    paper_script,
    wall_at,
)

STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


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
    script = paper_script()
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


def pause(script: Script, seconds: float) -> None:
    """Let time pass in which the process does not run; it hears of the next tick first."""
    script.now += seconds
    script.mission.resume(script.now + DT)


@pytest.mark.parametrize("seconds", [1.0, 100.0])
def test_a_pause_of_the_process_is_nobody_elses_fault(seconds: float) -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    pause(script, seconds)
    assert script.mission.on_tick(script.now + DT) == ()
    (drive,) = script.tick()
    assert isinstance(drive, Drive)
    # It has come to stand without commands.
    assert 0.0 < drive.linear <= script.parameters.follower.linear_acceleration * 0.2
    assert script.mission.feedback().hold == ""
    finish = finish_of(script.run())
    assert finish.outcome is Outcome.REACHED
    assert seconds < finish.duration < seconds + 10.0


def test_way_that_was_come_in_a_pause_is_no_jump_of_the_pose() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    pause(script, 1.0)
    script.pose = Pose2(script.pose.x + 0.39, script.pose.y, script.pose.theta)
    assert script.tick() != (STAND,)
    assert script.mission.feedback().hold == ""


def test_what_is_missing_after_a_pause_is_blamed_on_it_at_first() -> None:
    script = Script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    pause(script, 10.0)
    assert script.tick(infrared=False) == (STAND,)
    assert "the motion itself was held up" in script.mission.feedback().hold
    assert script.tick(infrared=False) == (STAND,)
    assert "no readings from infrared_0" in script.mission.feedback().hold


def test_an_answer_has_the_rest_of_its_time_after_a_pause() -> None:
    script = Script(**{"timeout.plan": 2.0})
    script.tick()
    script.perceive(script.start(*GOAL))
    pause(script, 100.0)
    for _ in range(round(1.9 / DT)):
        assert script.tick() == (STAND,)
    script.run(2.0)  # it asks again
    assert [type(c) for c in script.commands if not isinstance(c, Drive)] == [Perceive, Plan, Plan]


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
    assert "still said to be at (1.05, 2.05) m" in finish_of(commands).message
    assert script.now - 100.0 < 0.9 + 0.2 / 0.3 + 10.0


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
    # Up to 12 cm before it, in the cell's part that leaves it most room.
    assert script.pose.x == pytest.approx(2.105, abs=0.01)


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
