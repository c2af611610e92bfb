# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: what is not called unreachable because the map may be wrong."""

from __future__ import annotations

import math

import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.doubts import MOST_TIMES, Doubts
from fuzzy_navigation.mission_types import Commands, Outcome, Perceive, Plan
from fuzzy_navigation.params import motion_parameters
from fuzzy_navigation.plan_types import PlanResult, PlanStatus
from unit.fuzzy_navigation.mission_script import Script, finish_of, paper_script

GOAL = (3.05, 2.05)
NO_PATH = PlanResult(PlanStatus.NO_PATH, "no way")


def no_path(script: Script, commands: Commands) -> Commands:
    """Answer requests for plans with no path until something else comes."""
    while isinstance(commands[-1], Plan):
        commands = script.mission.on_plan(script.now, commands[-1].request, NO_PATH)
    return commands


def test_after_a_jump_of_the_pose_it_looks_again_and_then_does_not_know() -> None:
    script = paper_script()
    script.tick()
    script.start(*GOAL)
    script.pose = Pose2(1.05, 2.65, 0.0)
    script.tick()
    commands = no_path(script, script.perceive(script.run()))
    assert isinstance(commands[-1], Perceive)
    finish = finish_of(no_path(script, script.perceive(commands)))
    assert finish.outcome is Outcome.FAILED
    assert "no way; on the way the pose jumped by 0.60 m" in finish.message
    assert "the map may be wrong" in finish.message


@pytest.mark.parametrize(("noisy", "doubt"), [(3, True), (2, False)])
def test_infrareds_that_tell_now_this_now_that_are_a_reason_to_look_again(
    noisy: int, doubt: bool
) -> None:
    script = Script(motion_parameters(overrides={"frontier_looks": 0}))

    def flickering(x: float, y: float, direction: float) -> float:
        sensor = round((direction - script.pose.theta) / (math.pi / 8.0))
        return 0.1 if 4 <= sensor < 4 + noisy and round(script.now / 0.05) % 2 else math.inf

    script.tick()
    commands = script.start(*GOAL)
    script.seen = flickering
    for _ in range(10):
        script.tick()
    script.seen = lambda x, y, direction: math.inf
    commands = no_path(script, script.perceive(commands))
    if doubt:
        assert isinstance(commands[-1], Perceive)
        commands = no_path(script, script.perceive(commands))
        assert f"{noisy} infrareds told now of this" in finish_of(commands).message
    assert finish_of(commands).outcome is (Outcome.FAILED if doubt else Outcome.UNREACHABLE)


def test_a_doubt_is_good_for_one_more_look_and_a_mission_for_a_few() -> None:
    doubts = Doubts()
    doubts.note("")
    assert not doubts.look_again()
    for _ in range(MOST_TIMES):
        doubts.note("because")
        doubts.note("because")
        assert doubts.look_again()
        assert not doubts.look_again()
    doubts.note("at last")
    assert not doubts.look_again()
    assert doubts.reason == "at last"
    doubts.forget()
    assert doubts.reason == ""
