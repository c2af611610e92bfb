# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""SIGINT and SIGTERM to the mapper under load: exit code 0, no traceback, nothing left.

``STOPS=20 pytest ros/test_clean_stop.py`` repeats each stop so often.
"""

from __future__ import annotations

import math
import os
import signal
from collections.abc import Callable

import pytest
from action_msgs.msg import GoalStatus
from fuzzy_msgs.action import BuildMap
from nav_msgs.msg import OccupancyGrid

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.types import Pose2
from ros.fake_robot import FakeRobot
from ros.harness import NodeProcess, Probe, wait_until

STOPS = int(os.environ.get("STOPS", "1"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("repetition", range(STOPS))
def test_stop_while_packets_are_fused_without_a_pause(
    probe: Probe,
    start_node: Callable[..., NodeProcess],
    number: signal.Signals,
    repetition: int,
) -> None:
    mapper = start_node("mapper", parameters={"mode": "continuous", "packet_size": 16})
    maps = probe.subscribe(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
    robot = FakeRobot(probe, Pose2(3.0, 3.0), lambda sensor, angle: 1.0 + 0.1 * sensor)
    # Fifty packets a second, each with three maps to publish.
    wait_until(lambda: len(maps) > 20 + repetition, "the maps of many packets")
    mapper.assert_clean_stop(number)
    robot.close()


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
