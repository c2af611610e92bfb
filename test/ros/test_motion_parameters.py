# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion as a process: parameters that are changed while it runs."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from action_msgs.msg import GoalStatus
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter

from fuzzy_map_building.ros import names
from ros.harness import wait_until
from ros.motion_scene import RESULT, Scene, goal_at, staged


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Scene]:
    """One process for all tests of this module."""
    with staged(tmp_path_factory.mktemp("motion") / "motion.log") as scene:
        yield scene


@pytest.fixture
def scene(stage: Scene) -> Scene:
    """The process without a goal, the robot where it began."""
    stage.reset()
    return stage


def change(scene: Scene, *parameters: Parameter) -> list[SetParametersResult]:
    asked = SetParameters.Request(parameters=[p.to_parameter_msg() for p in parameters])
    service = f"{names.MOTION_NODE}/set_parameters"
    return scene.probe.call(SetParameters, service, asked).results


def test_changed_parameters_hold_at_once_or_say_that_they_wait(scene: Scene) -> None:
    handle = scene.go(3.0, 2.5)
    fast, slim, clearance, frames = change(
        scene,
        Parameter("follower.max_linear", value=0.2),
        Parameter("slim_radius", value=0.1),
        Parameter("clearance.override", value=0.5),
        Parameter("infrared.frame_ids", value=["a", "b"]),
    )
    assert (fast.successful, fast.reason) == (True, "")
    assert slim.successful
    assert slim.reason.startswith("taken, but slim_radius will hold only when the goal")
    assert slim.reason in scene.motion.wait_for_output(slim.reason)
    assert not clearance.successful
    assert "clearance.limit" in clearance.reason
    assert not frames.successful
    assert scene.values()["parameters_waiting"] == "slim_radius"
    # The speed, at once, which it brakes down to; the rest when the goal is reached.
    wait_until(lambda: scene.robot.speed <= 0.2, "the robot to be slower")
    scene.robot.commands.clear()
    assert scene.result(handle).result.outcome == RESULT.REACHED
    assert 0.1 < max(v for _, v, _ in scene.robot.commands) <= 0.2
    assert "parameters_waiting" not in scene.values()
    together = SetParametersAtomically.Request(
        parameters=[Parameter("beta", value=0.89).to_parameter_msg()]
    )
    service = f"{names.MOTION_NODE}/set_parameters_atomically"
    result = scene.probe.call(SetParametersAtomically, service, together).result
    assert (result.successful, result.reason) == (True, "")  # nobody drives
    assert scene.result(scene.send(goal_at(1.0, 1.0))).result.outcome == RESULT.REACHED
    asked = [(request.slim_radius, request.slim_above) for request in scene.planner.requests]
    assert asked == [(0.0, pytest.approx(0.6)), pytest.approx((0.1, 0.6))]
    assert all(request.any_angle for request in scene.planner.requests)
    change(scene, Parameter("follower.max_linear", value=0.6))


def test_what_it_knows_survives_a_change_of_parameters(scene: Scene) -> None:
    def shown() -> dict[str, str]:
        values = scene.values()
        kept = ("phase", "last_stop", "perceptions", "alpha", "distance_remaining")
        return {key: values[key] for key in kept}

    handle = scene.go(3.5, 2.5)
    assert scene.values()["phase"] == "moving"
    scene.probe.result_of(handle.cancel_goal_async())
    scene.result(handle)
    before = shown()
    assert (before["phase"], before["perceptions"]) == ("idle", "1")
    assert float(before["distance_remaining"]) > 0.5
    written = len(scene.motion.output())
    for concurrent in (True, False):
        change(scene, Parameter("concurrent", value=concurrent))
        change(scene, Parameter("patience", value=20 + concurrent))
        assert shown() == before
    # Goals are served at once, not when it has heard of everything anew.
    scene.robot.poses_come = False
    wait_until(lambda: not scene.robot.stands or scene.robot.idle, "the motion to be idle")
    change(scene, Parameter("patience", value=25))
    handle = scene.send(goal_at(scene.robot.x, scene.robot.y))
    assert scene.result(handle).result.outcome == RESULT.REACHED
    assert "no pose has come yet" not in scene.motion.output()[written:]


def test_a_goal_that_is_reached_at_once_ends_a_mission_with_parameters_of_before(
    scene: Scene,
) -> None:
    first = scene.go(3.5, 2.5)
    changed = Parameter("beta", value=0.85), Parameter("slim_radius", value=0.05)
    assert all(each.successful for each in change(scene, *changed))
    # Two missions end with one goal, and the parameters hold for the second.
    answer = scene.result(scene.send(goal_at(2.0, 1.5), tolerance=10.0))
    assert (answer.status, answer.result.outcome) == (GoalStatus.STATUS_SUCCEEDED, RESULT.REACHED)
    assert scene.result(first).result.outcome == RESULT.CANCELED
    assert "Traceback" not in scene.motion.output()
    assert scene.result(scene.send(goal_at(2.0, 1.5))).result.outcome == RESULT.REACHED
    assert scene.planner.requests[-1].slim_radius == pytest.approx(0.05)


def test_a_goal_that_takes_the_place_of_another_goes_by_what_waited(scene: Scene) -> None:
    first = scene.go(3.5, 2.5)
    # So slowly that it is on its way for as long as this may take.
    change(
        scene, Parameter("slim_radius", value=0.07), Parameter("follower.max_linear", value=0.02)
    )
    # One that cannot be ends nothing.
    refused = scene.result(scene.send(goal_at(1.5, 2.0), tolerance=-1.0)).result
    assert (refused.outcome, scene.values()["phase"]) == (RESULT.FAILED, "moving")
    change(scene, Parameter("follower.max_linear", value=0.6))
    second = scene.send(goal_at(1.5, 2.0))
    replaced = scene.result(first).result
    assert (replaced.outcome, replaced.message) == (
        RESULT.CANCELED,
        "a newer goal replaced this one",
    )
    assert "parameters_waiting" not in scene.values()
    assert scene.result(second).result.outcome == RESULT.REACHED
    assert scene.planner.requests[-1].slim_radius == pytest.approx(0.07)
