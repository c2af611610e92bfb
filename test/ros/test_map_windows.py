# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Windows of large maps over real middleware: what the mapper sends, what a planner makes."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from numpy.typing import NDArray
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from fuzzy_map_building.grid import Window
from fuzzy_map_building.map_follower import MapWindow
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.map_conversions import grid_from_msg, window_to_msg
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.planner import Planner
from ros.fake_robot import FakeRobot
from ros.harness import NodeProcess, Probe, wait_until
from ros.planner_driver import GEOMETRY, GOAL, START, Driver, map_message, world

TOPICS = (names.PLANNING_MAP, names.MOTION_MAP, names.MAP)
UNKNOWN = {names.MOTION_MAP: 100, names.PLANNING_MAP: 0, names.MAP: -1}
SECOND = 1_000_000_000


def followed(whole: OccupancyGrid, windows: list[OccupancyGridUpdate]) -> NDArray[np.int8]:
    """Return what the windows make of a map, as the README tells those who follow them."""
    values = grid_from_msg(whole)[1].copy()
    state = whole.header.stamp
    for message in windows:
        assert message.header.frame_id == "map"
        assert message.map_load_time == whole.info.map_load_time
        assert message.previous == state
        state = message.header.stamp
        cells = np.reshape(message.data, (message.height, message.width))
        assert cells.size < values.size
        x, y = message.x, message.y
        values[y : y + message.height, x : x + message.width] = cells
    return values


def test_the_mapper_sends_windows_at_once_and_the_whole_in_time(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    patient = dict.fromkeys(["perception.max_pose_gap", "perception.pose_timeout"], 15.0)
    large = {"area.size_x": 40.0, "publishing.small_map": 20_000, "publishing.period": 60.0}
    start_node("mapper", parameters={"mode": "continuous", **large, **patient})
    whole = {t: probe.subscribe(OccupancyGrid, t, qos.LATCHED) for t in TOPICS}
    windows = {
        t: probe.subscribe(OccupancyGridUpdate, names.updates_of(t), qos.WINDOWS) for t in TOPICS
    }
    first = {t: received.wait_for() for t, received in whole.items()}
    for topic, message in first.items():
        assert (grid_from_msg(message)[1] == UNKNOWN[topic]).all()
    robot = FakeRobot(probe, Pose2(3.0, 3.0), lambda sensor, _: 0.8 + 0.1 * sensor)
    for received in windows.values():
        wait_until(lambda r=received: len(r) >= 4, "windows")
    robot.blind = True
    robot.close()
    time.sleep(0.3)  # for the last packet
    kept = {t: followed(first[t], windows[t].messages) for t in TOPICS}
    assert all(len(received) == 1 for received in whole.values())
    for topic in (names.MOTION_MAP, names.PLANNING_MAP):
        served = probe.call(GetMap, f"{topic}/get", GetMap.Request()).map
        assert served.header.stamp == windows[topic].last.header.stamp
        np.testing.assert_array_equal(grid_from_msg(served)[1], kept[topic])
    assert (kept[names.MOTION_MAP] < 50).any(), "nothing was explored: the test is void"

    # A period is over: the last state comes whole, once.
    request = SetParameters.Request(
        parameters=[Parameter("publishing.period", value=0.1).to_parameter_msg()]
    )
    for received in whole.values():
        received.clear()
    service = f"{names.MAPPER_NODE}/set_parameters"
    assert probe.call(SetParameters, service, request).results[0].successful
    for topic, received in whole.items():
        np.testing.assert_array_equal(grid_from_msg(received.wait_for())[1], kept[topic])
    # What was reset is told whole, at once.
    for received in whole.values():
        received.clear()
    probe.call(Trigger, names.RESET_MAP, Trigger.Request())
    for topic, received in whole.items():
        received.wait_for(lambda m, t=topic: (grid_from_msg(m)[1] == UNKNOWN[t]).all())


@pytest.fixture
def planner(probe: Probe, start_node: Callable[..., NodeProcess]) -> Driver:
    return Driver(probe, start_node("planner"))


def test_the_planner_follows_windows_and_falls_back_to_the_whole_map(
    probe: Probe, planner: Driver
) -> None:
    windows = probe.publisher(
        OccupancyGridUpdate, names.updates_of(names.PLANNING_MAP), qos.WINDOWS
    )
    values = world()
    planner.give_and_wait(map_message(values))
    wall = Window(8, 16, 20, 21)

    def send(previous: float, stamp: float, cells: int, window: Window = wall) -> None:
        shape = window.shape
        new = np.full(shape, cells, np.int8)
        times = round(previous * SECOND), round(stamp * SECOND)
        windows.publish(window_to_msg(MapWindow(SECOND, *times, window, new)))

    def wait_for(stamp: float) -> None:
        wanted = Time(sec=int(stamp), nanosec=round(stamp % 1 * SECOND))
        wait_until(lambda: planner.plan().path.header.stamp == wanted, f"the map of {stamp} s")

    def check(opening: int) -> None:
        values[wall.slices] = opening
        core = Planner(GEOMETRY)
        core.set_map(values / 100.0)
        answer, expected = planner.plan(), core.plan(START, GOAL)
        assert (answer.status, answer.g2) == (expected.status, expected.g2)
        assert (expected.alpha == 1.0) == (opening == 100)

    before = planner.counts()
    send(1.0, 2.0, 30)
    wait_for(2.0)
    check(30)
    # The first of two is missing: the second waits, the whole map makes good for both.
    send(3.0, 4.0, 0)
    planner.wait_for_counts(before, {"windows.taken": 1, "windows.waiting": 1})
    check(30)
    message = map_message(values)
    message.header.stamp, message.info.map_load_time = Time(sec=3), Time(sec=1)
    planner.give(message)
    wait_for(4.0)
    check(0)
    # A whole map that is older than the windows', and windows that do not fit.
    planner.give(map_message(np.full(values.shape, 100, np.int8), 1))
    send(4.0, 5.0, 100, Window(28, 33, 0, 1))
    send(2.5, 4.5, 100)
    planner.wait_for_counts(before, {"rejected.planning_map_updates.unfit": 2})
    check(0)
    send(4.0, 5.0, 100)
    wait_for(5.0)
    check(100)
    # A map that is begun anew, though stamped earlier.
    message = map_message(values)
    message.header.stamp = message.info.map_load_time = Time(nanosec=SECOND // 2)
    planner.give(message)
    wait_for(0.5)
