# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion as a process: what sonars hear ahead and infrareds do not see."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState, Range

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp, stamp_from_seconds
from ros.harness import wait_until
from ros.motion_scene import RESULT, Scene, goal_at, staged

RADIUS = 0.23
#: Where the glass stands: across the way, at this x [m].
GLASS = 2.6
#: The robot is on its way from here on [m]; it starts at 1.0.
UNDER_WAY = 1.5


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Scene]:
    """One process for all tests of this module."""
    with staged(tmp_path_factory.mktemp("motion") / "motion.log") as scene:
        yield scene


class Echoes:
    """A sonar ahead on a turret that stands, and what it hears of a pane of glass."""

    def __init__(self, scene: Scene) -> None:
        #: Where the glass stands; +inf: nowhere.
        self.glass = GLASS
        #: What the sonar does once the robot is under way: works, silent, faulty or, wherever it
        #: is, lossy: it misses every fourth echo of a wall. It fails by
        #: where the robot is, which moves on while a starved test sleeps.
        self.fault = "works"
        self.rounds = 0
        self.field_of_view = math.radians(25.0)
        #: How long before the pose that it comes with a range was measured [s].
        self.before = 0.0
        self._sonar = scene.probe.node.create_publisher(Range, names.SONAR, qos.RANGES)
        self._turret = scene.probe.node.create_publisher(
            JointState, names.JOINT_STATES, qos.JOINT_STATES
        )
        scene.probe.node.create_subscription(PoseStamped, names.POSE, self._on_pose, qos.RELIABLE)

    def _on_pose(self, message: PoseStamped) -> None:
        joint = JointState(name=["turret_joint"], position=[0.0])
        joint.header.stamp = message.header.stamp
        self._turret.publish(joint)
        x, turned = message.pose.position.x, message.pose.orientation
        fault = self.fault if x > UNDER_WAY else "works"
        if fault != "silent":
            ahead = math.cos(2.0 * math.atan2(turned.z, turned.w))
            distance = (self.glass - x) / ahead - RADIUS if ahead > 0.0 else math.inf
            # It never hears nothing at all, as if it were deaf: there is a wall behind all.
            distance = min(distance, 6.0 - 0.01 * (turned.z % 0.1))
            # What is too close it tells as it is, though REP 117 has -inf for it.
            distance = math.nan if fault == "faulty" else max(distance, 0.0)
            if self.fault == "lossy":
                self.rounds += 1
                distance = math.inf if self.rounds % 4 == 0 else 3.0
            echo = Range(field_of_view=self.field_of_view, max_range=6.5, range=distance)
            measured = seconds_from_stamp(message.header.stamp) - self.before
            echo.header.frame_id, echo.header.stamp = "sonar_0", stamp_from_seconds(measured)
            self._sonar.publish(echo)


def change(scene: Scene, name: str, value: object) -> None:
    asked = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
    service = f"{names.MOTION_NODE}/set_parameters"
    assert scene.probe.call(SetParameters, service, asked).results[0].successful


def test_sonars_guard_the_robot_once_the_guard_is_on(scene: Scene) -> None:
    echoes = Echoes(scene)
    change(scene, "sonar_guard.enabled", False)
    assert scene.result(scene.send(goal_at(3.5, 1.05))).result.outcome == RESULT.REACHED
    assert scene.robot.x > GLASS  # nobody guarded it

    scene.reset()
    change(scene, "sonar_guard.enabled", True)
    wait_until(
        lambda: scene.probe.node.count_subscribers(names.SONAR) == 1, "the motion to hear sonars"
    )
    result = scene.result(scene.send(goal_at(3.5, 1.05))).result
    assert result.outcome != RESULT.REACHED
    assert 0.03 < GLASS - scene.robot.x - RADIUS < 0.3

    # The same from where the glass is too close to be measured.
    scene.reset()
    start = GLASS - RADIUS - 0.1
    scene.robot.x, scene.robot.y = start, 1.05  # straight ahead lies the goal
    scene.robot.poses.clear()
    wait_until(lambda: len(scene.robot.poses) > 3, "the motion to hear where the robot is")
    result = scene.result(scene.send(goal_at(3.5, 1.05))).result
    assert result.outcome != RESULT.REACHED
    assert scene.robot.x < start + 0.05

    scene.reset()
    echoes.glass = math.inf  # it has gone
    assert scene.result(scene.send(goal_at(3.5, 1.05))).result.outcome == RESULT.REACHED

    # What was heard before a change of parameters has not to come anew.
    early = "rejected.sonar.before_pose"
    scene.reset()
    before, echoes.before = scene.values().get(early, "0"), 0.02
    for patience in (20, 25):
        change(scene, "patience", patience)
        scene.values()
    assert scene.values().get(early, "0") == before
    echoes.before = 0.0

    # One that loses echoes guards a robot that drives slowly.
    scene.reset()
    echoes.fault = "lossy"
    # Of four rounds three tell of an echo, of 64 in all.
    wait_until(lambda: echoes.rounds > 120, "the sonar to lose enough echoes")
    change(scene, "watch.lossy_speed", 0.1)
    told = "driving at no more than 0.1 m/s"
    handle = scene.send(goal_at(3.5, 1.05))
    scene.problem(told)
    assert scene.result(handle).result.outcome == RESULT.REACHED
    assert max(speed for _, speed, _ in scene.robot.commands) == pytest.approx(0.1)
    assert scene.motion.output().count(told) == 1
    echoes.fault = "works"

    # Who guards the robot must not fall silent, nor report nothing but faults.
    for fault in ("silent", "faulty"):
        scene.reset()
        echoes.fault = fault
        result = scene.result(scene.send(goal_at(3.5, 1.05))).result
        assert result.outcome == RESULT.FAILED
        assert "no readings from sonar_0" in result.message
        assert UNDER_WAY < scene.robot.x < GLASS
    assert int(scene.values()["rejected.sonar.faulty"]) > 10

    change(scene, "sonar_guard.enabled", False)
    wait_until(
        lambda: scene.probe.node.count_subscribers(names.SONAR) == 0, "the motion to hear nothing"
    )


def test_sonar_messages_that_cannot_be_are_refused(scene: Scene) -> None:
    change(scene, "sonar_guard.enabled", True)
    node = scene.probe.node
    wait_until(lambda: node.count_subscribers(names.SONAR) == 1, "the motion to hear sonars")
    sonar = node.create_publisher(Range, names.SONAR, qos.RANGES)
    joints = node.create_publisher(JointState, names.JOINT_STATES, qos.JOINT_STATES)
    stranger = Range(field_of_view=math.radians(25.0), max_range=6.5, range=1.0)
    stranger.header.frame_id = "sonar_16"
    joint = JointState(name=["turret_joint"], position=[math.nan])

    def refused() -> bool:
        sonar.publish(stranger)
        joints.publish(joint)
        return {"rejected.sonar.unknown_frame", "rejected.joint_states.not_finite"} <= set(
            scene.values()
        )

    wait_until(refused, "the motion to refuse both")
