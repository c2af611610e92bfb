# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: sensors and poses that cannot be trusted."""

import dataclasses
import math

import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import Drive, Finish, Outcome, Perceive
from fuzzy_navigation.params import motion_parameters
from unit.fuzzy_navigation.mission_script import DT, Script, cells_along, finish_of, paper_script

STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


def consistent(**overrides: object) -> Script:
    return Script(motion_parameters(overrides=overrides))


def drive(script: Script, **broken: object) -> Finish:
    """Let sensors be broken from x = 1.5 m on until the verdict, and return it."""
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    began, place = script.now, script.pose
    commands: tuple = ()
    while script.mission.active:
        script.now += DT
        infrared = [r for r in script.infrared() if r.sensor != broken.get("infrared")]
        sonar = [
            dataclasses.replace(r, range=math.nan) if broken.get("nan") else r
            for r in script.sonar()
            if r.sensor != broken.get("sonar")
        ]
        commands = script.mission.on_pose(script.now, script.pose, infrared, sonar)
        for command in commands:
            if isinstance(command, Drive):
                script.pose = Pose2(script.pose.x + DT * command.linear, script.pose.y)
        if script.now > began + 0.5 + DT:
            assert commands[0] == STAND
        assert script.now < began + 20.0
    assert script.pose.x - place.x < 0.6 * (0.5 + 2 * DT)
    return finish_of(commands)


@pytest.mark.parametrize(
    ("broken", "named"),
    [({"sonar": 5}, "sonar_5"), ({"nan": True}, "sonar_0, sonar_1, sonar_2, sonar_3 and 12 more")],
)
def test_sonars_that_guard_it_must_not_fall_silent(broken: dict, named: str) -> None:
    finish = drive(consistent(), **broken)
    assert finish.outcome is Outcome.FAILED
    assert f"no readings from {named}" in finish.message
    # Where they guard nothing nobody misses them.
    script = paper_script()
    script.set_out(GOAL)
    while script.mission.active:
        script.tick(sonar=False)
    assert finish_of(tuple(script.commands)).outcome is Outcome.REACHED


def test_sonars_that_come_back_let_it_go_on() -> None:
    script = consistent()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    for _ in range(30):
        commands = script.tick(sonar=False)
    assert commands == (STAND,)
    assert "no readings from sonar_0" in script.mission.feedback().hold
    assert finish_of(script.run()).outcome is Outcome.REACHED


@pytest.mark.parametrize("ring", ["infrared", "sonar"])
def test_a_sensor_that_tells_the_same_while_the_robot_turns_makes_it_stand(ring: str) -> None:
    script = consistent()
    stuck = {ring: 4}
    script.tick()
    commands = script.perceive(script.start(1.05, 3.55))
    script.plan(commands, cells_along((1.05, 2.05), (1.05, 3.55)))
    for _ in range(60):
        commands = script.tick(stuck=stuck)
    assert commands == (STAND,)
    assert f"from {ring}_4" in script.mission.feedback().hold
    assert math.radians(40.0) < script.pose.theta < math.radians(80.0)
    assert script.pose.y < 2.1
    script.tick()  # it has recovered
    assert script.mission.feedback().hold == ""


def test_a_dazzled_sensor_is_named_in_the_verdict() -> None:
    script = paper_script()
    script.set_out(GOAL)
    commands: tuple = ()
    while script.mission.active:
        commands = script.tick(dazzled=3)
        if any(isinstance(c, Perceive) for c in commands):
            script.again(commands, GOAL, alpha=0.6)
    finish = finish_of(tuple(script.commands))
    assert finish.outcome is Outcome.LIVELOCK
    assert "CLEARANCE: infrared_3 sees something 0.0" in finish.message


def test_a_pose_that_jumps_makes_it_stand_and_perceive_anew() -> None:
    script = paper_script()
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.pose = Pose2(script.pose.x + 0.5, script.pose.y, script.pose.theta)
    assert script.tick() == (STAND,)
    assert "jumped by 0.5" in script.mission.feedback().hold
    began = script.now
    commands = script.run()
    assert isinstance(commands[-1], Perceive)
    assert script.now - began == pytest.approx(1.0, abs=2 * DT)
    script.again(commands, GOAL, alpha=0.6)
    assert finish_of(script.run()).outcome is Outcome.REACHED


def test_a_pose_that_jumps_during_a_perception_has_it_made_again() -> None:
    script = paper_script()
    script.tick()
    (first,) = script.start(*GOAL)
    script.pose = Pose2(1.05, 2.65, 0.0)
    assert script.tick() == (STAND,)
    script.show_map()
    assert script.mission.on_perception(script.now, first.request, True) == ()
    commands = script.run()
    assert isinstance(commands[-1], Perceive)


def test_a_pose_that_jumps_again_and_again_ends_it() -> None:
    script = paper_script()
    script.tick()
    script.start(*GOAL)
    for k in range(200):
        script.pose = Pose2(1.05 + 0.6 * (k % 2), 2.05, 0.0)
        commands = script.tick()
        if not script.mission.active:
            break
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "the pose jumped 3 times in a row" in finish.message


@pytest.mark.parametrize(("delay", "fastest"), [(0.0, 0.6), (0.05, 0.6), (0.25, 0.2), (0.5, 0.1)])
def test_the_later_the_poses_the_slower_it_drives(delay: float, fastest: float) -> None:
    script = paper_script()
    script.set_out(GOAL)
    while script.mission.active:
        script.tick(delay=delay)
    speeds = [c.linear for c in script.commands if isinstance(c, Drive)]
    assert max(speeds) == pytest.approx(fastest, rel=0.25)
    assert max(speeds) <= fastest + 1e-9
