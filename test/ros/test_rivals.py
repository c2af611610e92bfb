# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Two who do what a robot has one node for: told, and not when one has died for the other."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator

import pytest
from fuzzy_msgs.action import BuildMap
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer
from std_srvs.srv import Trigger

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.rivals import LOOKS, Rivals
from ros.harness import NodeProcess, Probe, wait_until
from ros.test_bringup import STARTED, Robot, children

ADVICE = "stop all but one, or give each robot a namespace of its own"


@pytest.fixture
def other() -> Iterator[Probe]:
    other = Probe("other")
    yield other
    other.close()


def test_who_stays_is_told_of_by_name_and_once_in_the_log(
    probe: Probe, other: Probe, capfd: pytest.CaptureFixture[str]
) -> None:
    probe.node.create_publisher(Twist, names.CMD_VEL, qos.RELIABLE)
    rivals = Rivals(probe.node, [names.CMD_VEL], [names.PLAN_PATH])
    assert [rivals.look() for _ in range(LOOKS + 1)] == [""] * (LOOKS + 1)

    def known() -> list[str]:
        infos = probe.node.get_publishers_info_by_topic(names.CMD_VEL)
        return sorted(info.node_name for info in infos)

    # Who leaves and comes again begins anew.
    teleop = other.node.create_publisher(Twist, names.CMD_VEL, qos.RELIABLE)
    wait_until(lambda: known() == ["other", "probe"], "the rival")
    assert [rivals.look() for _ in range(LOOKS - 1)] == [""] * (LOOKS - 1)
    other.run(lambda: other.node.destroy_publisher(teleop))
    wait_until(lambda: known() == ["probe"], "its end")
    assert rivals.look() == ""
    teleop = other.node.create_publisher(Twist, names.CMD_VEL, qos.RELIABLE)
    wait_until(lambda: known() == ["other", "probe"], "the rival")
    assert [rivals.look() for _ in range(LOOKS - 1)] == [""] * (LOOKS - 1)
    text = f"'/cmd_vel' has 2 publishers (/other, /probe): {ADVICE}"
    assert [rivals.look() for _ in range(3)] == [text] * 3
    assert capfd.readouterr().err.count(text) == 1
    other.run(lambda: other.node.destroy_publisher(teleop))
    wait_until(lambda: known() == ["probe"], "its end")
    assert rivals.look() == ""


def test_two_simulators_share_the_clock_whatever_their_namespaces(
    start_node: Callable[..., NodeProcess],
) -> None:
    robots = ("robot1", "robot2")
    options = ("--ros-args", "-r")
    first, _ = (start_node("sim", arguments=[*options, f"__ns:=/{robot}"]) for robot in robots)
    told = first.wait_for_output("'/clock' has 2 publishers")
    assert "(/robot1/nomad_sim, /robot2/nomad_sim)" in told
    assert f"{ADVICE}, and its nodes a clock by -r /clock:=/NAME/clock" in told
    assert "pose" not in told


def test_servers_are_counted(probe: Probe, other: Probe) -> None:
    rivals = Rivals(probe.node, services=[names.PLAN_PATH])
    for each in (probe, other):
        each.node.create_service(Trigger, names.PLAN_PATH, lambda _, response: response)
    wait_until(lambda: probe.node.count_services(names.PLAN_PATH) == 2, "both servers")
    text = f"'/plan_path' has 2 servers: {ADVICE}"
    assert [rivals.look() for _ in range(LOOKS)] == [""] * (LOOKS - 1) + [text]


def test_servers_of_an_action_are_counted(probe: Probe, other: Probe) -> None:
    rivals = Rivals(probe.node, actions=[names.BUILD_MAP])
    servers = [
        ActionServer(each.node, BuildMap, names.BUILD_MAP, lambda _: BuildMap.Result())
        for each in (probe, other)
    ]
    goals = f"{names.BUILD_MAP}/_action/send_goal"
    wait_until(lambda: probe.node.count_services(goals) == 2, "both servers")
    text = f"'/build_map' has 2 servers: {ADVICE}"
    assert [rivals.look() for _ in range(LOOKS)] == [""] * (LOOKS - 1) + [text]
    for server in servers:
        server.destroy()


def said(robot: Robot) -> dict[str, str]:
    """Return the newest message of each node."""
    statuses = [s for array in list(robot.diagnostics.messages) for s in array.status]
    return {status.name: status.message for status in statuses}


def test_two_bringups_tell_of_each_other_while_both_are_there(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    robot = Robot(probe, start_node)
    nodes = robot.wait()
    second = start_node("bringup")
    motion = "(/fuzzy_motion, /fuzzy_motion)"
    mapper = "(/fuzzy_mapper, /fuzzy_mapper)"
    expected = {
        names.MOTION_NODE: f"'/cmd_vel' has 2 publishers {motion}; "
        f"'/cmd_vel_stamped' has 2 publishers {motion}; '/navigate' has 2 servers: {ADVICE}",
        names.MAPPER_NODE: f"'/turret/command' has 2 publishers {mapper}; "
        f"'/motion_map' has 2 publishers {mapper}; '/planning_map' has 2 publishers {mapper}; "
        f"'/map' has 2 publishers {mapper}; '/build_map' has 2 servers: {ADVICE}",
        names.PLANNER_NODE: f"'/plan_path' has 2 servers: {ADVICE}",
    }
    for process in (robot.process, second):
        for text in expected.values():
            assert process.wait_for_output(text).count(text) == 1
    wait_until(lambda: all(expected[n] in m for n, m in said(robot).items()), "all to tell")
    assert children(robot.process.pid) == nodes
    second.assert_clean_stop()
    wait_until(lambda: not any(ADVICE in m for m in said(robot).values()), "all to be content")


def test_a_node_that_takes_the_place_of_a_killed_one_tells_of_none(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    robot = Robot(probe, start_node, "--respawn")
    for pid in robot.wait().values():
        os.kill(pid, signal.SIGKILL)
    # Who has known the dead ones sees them beside the new ones.
    wait_until(lambda: probe.node.count_publishers(names.CMD_VEL) == 2, "a ghost", 60.0)
    robot.diagnostics.clear()

    def looks() -> int:
        statuses = [s.name for array in list(robot.diagnostics.messages) for s in array.status]
        return min(statuses.count(name) for name in STARTED)

    wait_until(lambda: looks() > LOOKS, "the looks of all", 60.0)
    assert ADVICE not in robot.process.output()
    assert not any(ADVICE in message for message in said(robot).values())
