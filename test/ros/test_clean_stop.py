# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""SIGINT and SIGTERM to each node under load: exit code 0, no traceback, nothing left.

``STOPS=20 pytest ros/test_clean_stop.py -k under_load`` repeats each stop so often, every time
a little later.
"""

from __future__ import annotations

import math
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from action_msgs.msg import GoalStatus
from fuzzy_msgs.action import BuildMap
from fuzzy_msgs.srv import PlanPath
from nav_msgs.msg import OccupancyGrid
from rclpy.task import Future

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import create_steady_timer
from fuzzy_map_building.types import Pose2
from ros.fake_robot import FakeRobot
from ros.harness import START_DEADLINE, NodeProcess, Probe, wait_until
from ros.motion_scene import PARAMETERS, Scene
from ros.planner_driver import Driver, map_message, request, world
from ros.room import Answering, write_room

STOPS = int(os.environ.get("STOPS", "1"))

Start = Callable[..., NodeProcess]


def busy_mapper(probe: Probe, start_node: Start, folder: Path, later: int) -> NodeProcess:
    """Fuses fifty packets a second, each with three maps to publish."""
    mapper = start_node("mapper", parameters={"mode": "continuous", "packet_size": 16})
    maps = probe.subscribe(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
    FakeRobot(probe, Pose2(3.0, 3.0), lambda sensor, angle: 1.0 + 0.1 * sensor)
    wait_until(lambda: len(maps) > 20 + later, "the maps of many packets", START_DEADLINE)
    return mapper


def busy_planner(probe: Probe, start_node: Start, folder: Path, later: int) -> NodeProcess:
    """Always has twenty requests to answer."""
    planner = Driver(probe, start_node("planner"))
    planner.give_and_wait(map_message(world()))
    client = probe.node.create_client(PlanPath, names.PLAN_PATH)
    sent: list[Future] = []

    def ask() -> None:
        while sum(not future.done() for future in sent[-100:]) < 20:
            sent.append(client.call_async(request()))

    create_steady_timer(probe.node, 0.005, ask)
    wait_until(lambda: len(sent) > 100 + 3 * later, "many requests")
    return planner.process


def busy_motion(probe: Probe, start_node: Start, folder: Path, later: int) -> NodeProcess:
    """Drives a robot that makes its next step as soon as it is told how."""
    scene = Scene(probe, start_node("motion", parameters=PARAMETERS))
    scene.go(3.5, 2.5)
    wait_until(lambda: scene.robot.x > 1.1 + 0.05 * later, "the robot on its way")
    return scene.motion


def busy_sim(probe: Probe, start_node: Start, folder: Path, later: int) -> NodeProcess:
    """Takes the next tick as soon as the one before is answered."""
    given = {"world": write_room(folder), "rate": 0.0, "lockstep": True}
    sim = start_node("sim", parameters=given)
    answering = Answering(probe)
    wait_until(lambda: len(answering.answers) > 100 + 3 * later, "many ticks")
    return sim


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda n: n.name)
@pytest.mark.parametrize("repetition", range(STOPS))
@pytest.mark.parametrize("busy", [busy_mapper, busy_planner, busy_motion, busy_sim])
def test_a_stop_under_load_is_clean(
    probe: Probe,
    start_node: Start,
    tmp_path: Path,
    busy: Callable[[Probe, Start, Path, int], NodeProcess],
    repetition: int,
    number: signal.Signals,
) -> None:
    busy(probe, start_node, tmp_path, repetition).assert_clean_stop(number)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_stop_during_a_perception_aborts_it_and_tells_its_client(
    probe: Probe, start_node: Callable[..., NodeProcess], number: signal.Signals
) -> None:
    mapper = start_node("mapper", parameters={"turret.timeout": 60})
    robot = FakeRobot(probe, Pose2(3.0, 3.0), lambda sensor, angle: math.inf)
    robot.turret_stuck = True
    robot.angle = 1.0
    client = probe.action_client(BuildMap, names.BUILD_MAP)
    handle = probe.send_goal(client, BuildMap.Goal())
    result = handle.get_result_async()
    wait_until(lambda: robot.commands, "a command to the turret")
    mapper.assert_clean_stop(number)
    response = probe.result_of(result)
    assert response.status == GoalStatus.STATUS_ABORTED
    assert response.result.message == "the mapper was stopped"
    assert "perception failed: the mapper was stopped" in mapper.output()
    robot.close()


def test_a_second_signal_during_the_stop_changes_nothing(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    mapper = start_node("mapper")
    probe.subscribe(OccupancyGrid, names.MOTION_MAP, qos.LATCHED).wait_for()
    mapper.send(signal.SIGTERM)
    mapper.assert_clean_stop(signal.SIGINT)
