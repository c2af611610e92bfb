# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion as a process, with scripted partners: a robot, a mapper, a planner."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator

import pytest
from action_msgs.msg import GoalStatus
from fuzzy_msgs.action import Navigate
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.action import ActionClient
from rclpy.qos import QoSProfile

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp
from ros.harness import wait_until
from ros.motion_scene import PARAMETERS, RESULT, Scene, goal_at, staged


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


def test_it_reaches_a_goal_and_says_how(scene: Scene) -> None:
    handle = scene.send(goal_at(2.55, 2.05), tolerance=0.1)
    assert handle.accepted
    answer = scene.result(handle)
    assert answer.status == GoalStatus.STATUS_SUCCEEDED
    result = answer.result
    assert result.outcome == RESULT.REACHED
    robot = scene.robot
    assert math.hypot(robot.x - 2.55, robot.y - 2.05) <= 0.1
    assert robot.stands
    straight = math.hypot(1.55, 1.05)
    assert straight - 0.1 <= result.path_length <= 1.4 * straight
    assert result.perceptions == 1
    assert result.min_clearance == math.inf
    assert straight / 0.6 <= result.duration <= 30.0
    request = scene.planner.requests[-1]
    assert (request.goal.pose.position.x, request.goal.pose.position.y) == (2.55, 2.05)
    assert 0.0 < request.tolerance <= 0.1

    phases = [f.phase for f in scene.feedback]
    first = [phases.index(phase) for phase in (0, 2)]
    assert first == sorted(first)
    moving = [f for f in scene.feedback if f.phase == Navigate.Feedback.MOVING]
    assert {f.perceptions for f in moving} == {1}
    assert {round(f.alpha, 6) for f in moving} == {0.6}
    left = [f.distance_remaining for f in moving]
    assert left == sorted(left, reverse=True)
    assert moving[-1].pose.header.frame_id == "map"


def test_while_it_serves_a_goal_it_answers_every_pose_once_else_never(scene: Scene) -> None:
    robot = scene.robot
    assert not robot.commands
    handle = scene.send(goal_at(2.05, 1.05))
    wait_until(lambda: robot.commands, "the first command")
    start = time.monotonic()
    scene.result(handle)
    end = time.monotonic()
    commands = sum(start < t < end for t, _, _ in robot.commands)
    poses = sum(start < t < end for t in robot.poses)
    assert poses > 20
    # On a busy machine some poses of the last moment have no answer yet.
    assert abs(commands - poses) <= 0.2 * poses
    # Idle again: nothing but silence after the final zero.
    wait_until(lambda: robot.idle, "silence")
    assert robot.stands
    count = len(robot.commands)
    poses = len(robot.poses)
    wait_until(lambda: len(robot.poses) > poses + 50, "more poses")
    assert len(robot.commands) == count


def test_stamped_commands_tell_which_pose_they_answer(scene: Scene) -> None:
    stamped = scene.probe.subscribe(TwistStamped, names.STAMPED_CMD_VEL, QoSProfile(depth=1000))
    poses = scene.probe.subscribe(PoseStamped, names.POSE, QoSProfile(depth=1000))
    before = len(scene.robot.commands)
    scene.result(scene.send(goal_at(1.5, 1.05)))
    wait_until(lambda: len(stamped) == len(scene.robot.commands) - before, "the last command")
    for message, (_, linear, angular) in zip(
        stamped.messages, scene.robot.commands[before:], strict=True
    ):
        assert message.header.frame_id == "base_link"
        assert (message.twist.linear.x, message.twist.angular.z) == (linear, angular)
    answered = [seconds_from_stamp(m.header.stamp) for m in stamped.messages]
    assert answered == sorted(answered)
    came = {round(seconds_from_stamp(m.header.stamp), 6) for m in poses.messages}
    # The first may answer a pose that came before anybody listened here.
    assert {round(a, 6) for a in answered[1:]} <= came
    assert len(set(answered)) > 20


def test_the_stop_conditions_reach_the_feedback(scene: Scene) -> None:
    """The map is free to x = 2 m only; the second perception finds the rest free."""
    scene.mapper.values[:, 20:] = 95
    handle = scene.send(goal_at(3.05, 1.05))
    wait_until(lambda: scene.mapper.goals == 2, "a second perception")
    assert 1.5 < scene.robot.x < 2.0
    scene.mapper.values[:] = 0
    result = scene.result(handle).result
    assert (result.outcome, result.perceptions) == (RESULT.REACHED, 2)
    assert {f.last_stop for f in scene.feedback} >= {
        Navigate.Feedback.NONE,
        Navigate.Feedback.UNEXPLORED,
    }


def test_an_obstacle_in_front_stops_the_robot(scene: Scene) -> None:
    handle = scene.go(3.05, 1.05)
    scene.robot.distance = 0.15
    wait_until(lambda: scene.robot.stands, "the robot to stand")
    wait_until(
        lambda: any(f.last_stop == Navigate.Feedback.CLEARANCE for f in scene.feedback),
        "the reason in the feedback",
    )
    scene.robot.distance = math.inf
    result = scene.result(handle).result
    assert result.outcome == RESULT.REACHED
    # What the infrared says, less the way that the robot brakes on.
    assert 0.1 < result.min_clearance <= 0.15 + 1e-3


def test_cancel_makes_the_robot_stand_within_200_ms(scene: Scene) -> None:
    # A busy machine may hold one cancel up, but not one after the other.
    assert min(cancelled_after(scene) for _ in range(3)) < 0.2
    # And it serves the next goal.
    assert scene.result(scene.send(goal_at(1.5, 1.0))).result.outcome == RESULT.REACHED


def cancelled_after(scene: Scene) -> float:
    """Return the time from a cancel until the answer is there and the robot stands [s]."""
    scene.reset()
    handle = scene.go(3.5, 2.5)
    begin = time.monotonic()
    response = scene.probe.result_of(handle.cancel_goal_async(), "an answer to the cancel")
    answered = time.monotonic()
    assert len(response.goals_canceling) == 1
    answer = scene.result(handle)
    assert answer.status == GoalStatus.STATUS_CANCELED
    assert answer.result.outcome == RESULT.CANCELED
    assert "cancel" in answer.result.message
    wait_until(lambda: scene.robot.stands, "the robot to stand")
    stood = min(t for t, v, w in scene.robot.commands if t > begin and v == w == 0.0)
    assert all(v == w == 0.0 for t, v, w in scene.robot.commands if t > stood)
    return max(stood, answered) - begin


def test_cancel_while_the_mapper_works_cancels_the_perception(scene: Scene) -> None:
    scene.mapper.behaviour = "hang"
    handle = scene.send(goal_at(3.5, 2.5))
    wait_until(lambda: scene.mapper.goals == 1, "the perception to begin")
    scene.probe.result_of(handle.cancel_goal_async())
    assert scene.result(handle).result.outcome == RESULT.CANCELED
    wait_until(lambda: scene.mapper.cancelled == 1, "the perception to be cancelled")
    assert all(v == w == 0.0 for _, v, w in scene.robot.commands)


def test_a_newer_goal_takes_the_place_of_the_older(scene: Scene) -> None:
    first = scene.go(3.5, 2.5)
    second = scene.send(goal_at(1.5, 2.0))
    answer = scene.result(first)
    assert answer.status == GoalStatus.STATUS_ABORTED
    assert answer.result.outcome == RESULT.CANCELED
    assert "newer goal" in answer.result.message
    assert scene.result(second).result.outcome == RESULT.REACHED
    assert math.hypot(scene.robot.x - 1.5, scene.robot.y - 2.0) < 0.3


def test_every_goal_of_a_burst_is_answered(scene: Scene) -> None:
    """Many more than the ten requests that wait by ROS's default."""
    node = scene.probe.node
    client = ActionClient(
        node,
        Navigate,
        names.NAVIGATE,
        goal_service_qos_profile=qos.REQUESTS,
        result_service_qos_profile=qos.REQUESTS,
    )
    wait_until(client.server_is_ready, "the action")
    goals = [Navigate.Goal(goal=goal_at(2.0 + 0.01 * k, 2.0)) for k in range(60)]
    sent = scene.probe.run(lambda: [client.send_goal_async(goal) for goal in goals])
    handles = [scene.probe.result_of(future, "an answer to the goal") for future in sent]
    assert all(handle.accepted for handle in handles)
    asked = scene.probe.run(lambda: [handle.get_result_async() for handle in handles])
    results = [scene.probe.result_of(future, "a verdict", 60.0).result for future in asked]
    assert [r.outcome for r in results] == [RESULT.CANCELED] * 59 + [RESULT.REACHED]
    assert math.hypot(scene.robot.x - 2.59, scene.robot.y - 2.0) < 0.3


def test_the_topic_goal_pose_does_the_same(scene: Scene) -> None:
    goals = scene.probe.publisher(PoseStamped, names.GOAL_POSE, qos.RELIABLE)
    first = scene.go(3.5, 2.5)
    goals.publish(goal_at(1.5, 2.0))
    assert scene.result(first).result.outcome == RESULT.CANCELED
    wait_until(lambda: math.hypot(scene.robot.x - 1.5, scene.robot.y - 2.0) < 0.3, "the goal")
    scene.motion.wait_for_output("REACHED")
    wait_until(lambda: scene.robot.stands, "the robot to stand")


@pytest.mark.parametrize(
    ("behaviour", "told", "reason"),
    [
        ("abort", "the turret is stuck", "the mapper aborted it: the turret is stuck"),
        ("abort", "", "the mapper aborted it: its diagnostics say why"),
        ("reject", "", "rejected it"),
    ],
)
def test_a_mapper_that_fails_is_asked_again_then_named(
    scene: Scene, behaviour: str, told: str, reason: str
) -> None:
    scene.mapper.behaviour, scene.mapper.reason = behaviour, told
    result = scene.result(scene.send(goal_at(2.0, 2.0))).result
    assert result.outcome == RESULT.FAILED
    assert reason in result.message
    assert scene.mapper.goals == PARAMETERS["attempts"]
    scene.mapper.behaviour = "succeed"
    assert scene.result(scene.send(goal_at(2.0, 2.0))).result.outcome == RESULT.REACHED


def test_it_plans_on_the_map_of_its_own_perception_only(scene: Scene) -> None:
    scene.mapper.behaviour = "late_map"  # the action ends before the map comes
    scene.planner.behind = 3  # and the planner hears of it later still
    handle = scene.send(goal_at(2.0, 2.0))
    assert scene.result(handle).result.outcome == RESULT.REACHED
    assert len(scene.planner.requests) == 4


def test_a_planner_that_never_hears_of_the_map_is_named(scene: Scene) -> None:
    scene.planner.behind = 10**6
    result = scene.result(scene.send(goal_at(2.0, 2.0))).result
    assert result.outcome == RESULT.FAILED
    assert "does it hear 'planning_map'" in result.message
    assert all(v == w == 0.0 for _, v, w in scene.robot.commands)


@pytest.mark.parametrize(
    ("changes", "outcome", "reason"),
    [
        (
            {"status": PlanPath.Response.NO_PATH, "message": "walled in"},
            RESULT.UNREACHABLE,
            "walled in",
        ),
        ({"status": PlanPath.Response.BAD_REQUEST, "message": "no"}, RESULT.FAILED, "no"),
        ({"status": 77}, RESULT.FAILED, "unknown status 77"),
        ({"alpha": math.nan}, RESULT.FAILED, "impossible alpha"),
    ],
)
def test_what_the_planner_answers_is_heeded(
    scene: Scene, changes: dict[str, object], outcome: int, reason: str
) -> None:
    scene.planner.changes = changes
    result = scene.result(scene.send(goal_at(2.0, 2.0))).result
    assert result.outcome == outcome
    assert reason in result.message
    assert all(v == w == 0.0 for _, v, w in scene.robot.commands)


def test_a_planner_with_other_parameters_is_refused_and_told_of(scene: Scene) -> None:
    scene.planner.changes = {"parameters": ["robot_radius=0.2", "layer.enabled=false"]}
    result = scene.result(scene.send(goal_at(2.0, 2.0))).result
    assert result.outcome == RESULT.FAILED
    difference = (
        "planner and motion do not agree: robot_radius is 0.2 in the planner and 0.23 in the "
        "motion, layer.enabled is false in the planner and true in the motion"
    )
    assert difference in result.message
    assert all(v == w == 0.0 for _, v, w in scene.robot.commands)
    scene.problem(difference)
    assert scene.values()["rejected.plan_path.other_parameters"] == "2"  # as many as attempts
    # One that agrees is followed, whatever else it tells, and nothing is said any more.
    scene.planner.changes = {"parameters": ["robot_radius=0.23", "of_another_kind"]}
    assert scene.result(scene.send(goal_at(2.0, 1.05))).result.outcome == RESULT.REACHED
    scene.diagnostics.clear()
    scene.diagnostics.wait_for(lambda array: "do not agree" not in array.status[0].message)


@pytest.mark.parametrize("source", ["pose", "infrared"])
def test_silence_makes_the_robot_stand_until_it_ends(scene: Scene, source: str) -> None:
    handle = scene.go(3.5, 2.5)
    if source == "pose":
        scene.robot.poses_come = False
        reason = "no pose for"
    else:
        scene.robot.infrared_come[1] = False
        reason = "no readings from infrared_1"
    wait_until(lambda: scene.robot.stands, "the robot to stand")
    scene.motion.wait_for_output(f"the robot stands: {reason}")
    scene.robot.poses_come, scene.robot.infrared_come[1] = True, True
    assert scene.result(handle).result.outcome == RESULT.REACHED


@pytest.mark.parametrize("source", ["pose", "infrared", "clock"])
def test_a_silence_that_does_not_end_ends_the_mission(scene: Scene, source: str) -> None:
    handle = scene.go(3.5, 2.5)
    if source == "pose":
        scene.robot.poses_come = False
    elif source == "infrared":
        scene.robot.infrared_come = [False, False]
    else:
        scene.robot.clock_runs = False  # the simulator is gone: everything is silent
    result = scene.result(handle).result
    assert result.outcome == RESULT.FAILED
    assert ("infrared_0" if source == "infrared" else "no pose") in result.message
    assert scene.robot.stands


def test_the_verdict_says_why_no_pose_can_be_used(scene: Scene) -> None:
    handle = scene.go(3.5, 2.5)
    scene.robot.pose_offset = 1e6  # of another clock
    result = scene.result(handle).result
    assert result.outcome == RESULT.FAILED
    assert "no usable pose for" in result.message
    assert "ahead of the clock: synchronise the clocks; is use_sim_time set" in result.message


def test_the_diagnostics_say_why_the_robot_stands(scene: Scene) -> None:
    handle = scene.go(3.5, 2.5)
    scene.robot.clock_runs = False
    scene.problem("the robot stands: no pose for")
    scene.robot.clock_runs = True
    assert scene.result(handle).result.outcome in (RESULT.REACHED, RESULT.FAILED)
    values = scene.values()
    assert values["active"] == "False"
    assert int(values["ticks"]) > 20


def test_a_clock_that_is_set_back_does_no_harm(scene: Scene) -> None:
    handle = scene.go(3.5, 2.5)
    scene.robot.time = 1.0
    assert scene.result(handle).result.outcome == RESULT.REACHED
    assert scene.result(scene.send(goal_at(1.5, 1.5))).result.outcome == RESULT.REACHED
