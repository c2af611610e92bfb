# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion as a process: missing partners, and its end."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator

import pytest
from action_msgs.msg import GoalStatus

from ros.harness import NodeProcess, Probe, wait_until
from ros.motion_scene import PARAMETERS, RESULT, Scene, goal_at


@pytest.fixture
def make_scene(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> Iterator[Callable[..., Scene]]:
    """Start a process for this test alone, among the partners that it names."""
    scenes: list[Scene] = []

    def make(patch: str = "", **partners: bool) -> Scene:
        motion = start_node("motion", parameters=PARAMETERS, patch=patch)
        scenes.append(Scene(probe, motion, **partners))
        return scenes[-1]

    yield make
    for scene in scenes:
        scene.close()


def test_a_missing_mapper_is_named(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(mapper=False)
    answer = scene.result(scene.send(goal_at(2.0, 2.0)))
    assert answer.status == GoalStatus.STATUS_ABORTED
    assert answer.result.outcome == RESULT.FAILED
    assert "nobody serves the action 'build_map'" in answer.result.message


def test_a_mapper_that_goes_away_is_named(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene()
    scene.mapper.behaviour = "hang"
    handle = scene.send(goal_at(2.0, 2.0))
    wait_until(lambda: scene.mapper.goals == 1, "the perception to begin")
    scene.mapper.leave()
    result = scene.result(handle).result
    assert result.outcome == RESULT.FAILED
    assert "'build_map'" in result.message


def test_a_missing_planner_is_named(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(planner=False)
    result = scene.result(scene.send(goal_at(2.0, 2.0))).result
    assert result.outcome == RESULT.FAILED
    assert "nobody serves 'plan_path'" in result.message


def test_a_motion_that_was_paused_blames_nobody_and_goes_on(
    make_scene: Callable[..., Scene],
) -> None:
    scene = make_scene()
    handle = scene.go(3.5, 2.5)
    scene.diagnostics.clear()
    before = len(scene.motion.output())
    scene.motion.send(signal.SIGSTOP)
    # Longer than it waits for poses; their stamps have gone on as well.
    resumed = scene.robot.time + 2.0 * PARAMETERS["timeout.lost"]
    scene.robot.halt()
    wait_until(lambda: scene.robot.time > resumed, "the pause")
    scene.motion.send(signal.SIGCONT)
    answer = scene.result(handle)
    assert answer.result.outcome == RESULT.REACHED
    said = [status.message for array in scene.diagnostics.messages for status in array.status]
    said.append(scene.motion.output()[before:])
    assert not any("no pose" in text or "nothing comes" in text for text in said)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("moving", [True, False], ids=["moving", "perceiving"])
def test_a_stop_leaves_the_robot_standing(
    make_scene: Callable[..., Scene], number: signal.Signals, moving: bool
) -> None:
    scene = make_scene()
    if moving:
        handle = scene.go(3.5, 2.5)
    else:
        scene.mapper.behaviour = "hang"
        handle = scene.send(goal_at(3.5, 2.5))
        wait_until(lambda: scene.mapper.goals == 1, "the perception to begin")
    answer = handle.get_result_async()
    scene.motion.assert_clean_stop(number)
    wait_until(lambda: scene.robot.stands, "the last command")
    result = scene.probe.result_of(answer, "the last verdict").result
    assert result.outcome == RESULT.CANCELED
    assert "stopped" in result.message


FAULT = """
from fuzzy_navigation.mission import Mission

whole, said = Mission.on_pose, []

def on_pose(*arguments):
    commands = whole(*arguments)
    said.extend(c.linear for c in commands if hasattr(c, "linear") and c.linear > 0.3)
    if len(said) > 5:
        raise RuntimeError("a fault in the mission")
    return commands

Mission.on_pose = on_pose
"""


def test_a_fault_while_it_drives_leaves_the_robot_standing(
    make_scene: Callable[..., Scene],
) -> None:
    scene = make_scene(patch=FAULT)
    answer = scene.send(goal_at(3.5, 2.5)).get_result_async()
    assert scene.motion.wait() == 1
    wait_until(lambda: scene.robot.stands, "the last command")
    assert max(v for _, v, _ in scene.robot.commands) > 0.3, "it did not drive: the test is void"
    last = scene.motion.output().strip().splitlines()[-1]
    assert last == (
        "fuzzy_motion: ended by a fault in the program: RuntimeError: a fault in the mission"
    )
    # Whoever sent the goal learns of it as well.
    assert scene.probe.result_of(answer, "the last verdict").result.outcome == RESULT.CANCELED


def test_an_idle_node_stops_without_a_word_to_the_robot(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene()
    scene.motion.assert_clean_stop(signal.SIGINT)
    assert not scene.robot.commands
