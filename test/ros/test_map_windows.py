# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Windows of large maps over real middleware: what the mapper sends, what a planner makes."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from fuzzy_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from numpy.typing import NDArray
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from fuzzy_map_building.grid import Window
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import nanoseconds_from_stamp
from fuzzy_map_building.ros.map_conversions import grid_from_msg
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.planner import Planner
from ros.fake_robot import FakeRobot
from ros.harness import NodeProcess, Probe, wait_until
from ros.planner_driver import GEOMETRY, GOAL, START, Driver, map_message, world

TOPICS = (names.PLANNING_MAP, names.MOTION_MAP, names.MAP)
UNKNOWN = {names.MOTION_MAP: 100, names.PLANNING_MAP: 0, names.MAP: -1}
#: Where the planner's map may be opened, and where nothing is.
WALL, NOWHERE = Window(8, 16, 20, 21), Window(0, 0, 0, 0)


HASTY = "from fuzzy_navigation.ros import followed_map\nfollowed_map.PATIENCE = 0.1\n"


def stamp_of(seconds: float) -> Time:
    return Time(sec=int(seconds), nanosec=round(seconds % 1 * 1e9))


def followed(whole: OccupancyGrid, windows: list[OccupancyGridUpdate]) -> NDArray[np.int8]:
    """Return what the windows make of a map, as the README tells those who follow them."""
    values = grid_from_msg(whole)[1].copy()
    newest = nanoseconds_from_stamp(whole.header.stamp)
    for message in windows:
        assert message.header.frame_id == "map"
        stamp = nanoseconds_from_stamp(message.header.stamp)
        if stamp <= newest:
            continue
        newest = stamp
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
    for received in (*whole.values(), *windows.values()):
        received.clear()
    probe.call(Trigger, names.RESET_MAP, Trigger.Request())
    for topic, received in whole.items():
        anew = received.wait_for(lambda m, t=topic: (grid_from_msg(m)[1] == UNKNOWN[t]).all())
        empty = windows[topic].wait_for(lambda m: m.width == m.height == 0)
        assert (empty.header.stamp, len(empty.data)) == (anew.header.stamp, 0)


def test_the_fields_are_those_of_map_msgs() -> None:
    # http://docs.ros.org/en/noetic/api/map_msgs/html/msg/OccupancyGridUpdate.html
    assert list(OccupancyGridUpdate.get_fields_and_field_types().items()) == [
        ("header", "std_msgs/Header"),
        ("x", "int32"),
        ("y", "int32"),
        ("width", "uint32"),
        ("height", "uint32"),
        ("data", "sequence<int8>"),
    ]


@pytest.fixture
def planner(probe: Probe, start_node: Callable[..., NodeProcess]) -> Driver:
    """A planner that lets a map be behind for a moment only before it warns."""
    return Driver(probe, start_node("planner", patch=HASTY))


class Somebody:
    """Publishes windows of the planner's map, and keeps what the map should be."""

    def __init__(self, probe: Probe, planner: Driver) -> None:
        self.planner = planner
        self.values = world()
        topic = names.updates_of(names.PLANNING_MAP)
        self._windows = probe.publisher(OccupancyGridUpdate, topic, qos.WINDOWS)

    def send(self, stamp: float, cells: int, window: Window = WALL) -> None:
        # Field by field, as any other publisher of six fields does.
        message = OccupancyGridUpdate()
        message.header.frame_id = "map"
        message.header.stamp = stamp_of(stamp)
        message.x, message.y = window.col0, window.row0
        message.height, message.width = window.shape
        message.data = [cells] * (message.width * message.height)
        self._windows.publish(message)

    def give(self, stamp: float, opening: int | None = None) -> None:
        values = self.values.copy()
        if opening is not None:
            values[WALL.slices] = opening
        message = map_message(values)
        message.header.stamp = stamp_of(stamp)
        self.planner.give(message)

    def check(self, stamp: float, opening: int) -> None:
        """Wait until the planner has the map of this stamp, and look at it."""
        wanted = stamp_of(stamp)
        wait_until(
            lambda: self.planner.plan().path.header.stamp == wanted, f"the map of {stamp} s"
        )
        self.values[WALL.slices] = opening
        core = Planner(GEOMETRY)
        core.set_map(self.values / 100.0)
        answer, expected = self.planner.plan(), core.plan(START, GOAL)
        assert (answer.status, answer.g2) == (expected.status, expected.g2)
        assert (expected.alpha == 1.0) == (opening == 100)


def test_windows_of_somebody_else_are_followed(probe: Probe, planner: Driver) -> None:
    somebody = Somebody(probe, planner)
    planner.give_and_wait(map_message(somebody.values))
    before = planner.counts()
    for stamp, opening in ((2.0, 30), (2.5, 100), (3.0, 0)):
        somebody.send(stamp, opening)
        somebody.check(stamp, opening)
    planner.wait_for_counts(
        before, {"windows.taken": 3, "windows.waiting": 0, "windows.missed": 0}
    )


def test_the_planner_follows_windows_and_falls_back_to_the_whole_map(
    probe: Probe, planner: Driver
) -> None:
    mapper = Somebody(probe, planner)
    planner.give_and_wait(map_message(mapper.values))
    before = planner.counts()
    mapper.send(1.0, 0, NOWHERE)
    mapper.send(2.0, 30)
    mapper.check(2.0, 30)
    # What is refused is missing: the next window waits, the whole map makes good for both.
    mapper.send(3.0, 100, Window(28, 33, 0, 1))
    mapper.send(4.0, 0)
    planner.wait_for_counts(
        before,
        {"rejected.planning_map_updates.unfit": 1, "windows.taken": 1, "windows.waiting": 1},
    )
    mapper.check(2.0, 30)
    warned = planner.diagnostics.wait_for(lambda m: " behind: " in m.status[0].message)
    assert warned.status[0].level == DiagnosticStatus.WARN
    mapper.give(4.0, 100)
    mapper.check(4.0, 100)
    planner.diagnostics.clear()
    planner.diagnostics.wait_for(lambda m: m.status[0].message == "ok")
    mapper.send(5.0, 0)
    mapper.check(5.0, 0)
    # A whole map that is older than the windows'.
    mapper.give(4.5, 100)
    mapper.send(6.0, 0, Window(0, 1, 0, 1))
    mapper.values[0, 0] = 0
    mapper.check(6.0, 0)
    # A map that is another one, though stamped earlier: the window after it waits for it.
    mapper.send(0.5, 0, NOWHERE)
    mapper.send(0.75, 100)
    planner.wait_for_counts(before, {"windows.taken": 3, "windows.waiting": 1})
    mapper.check(6.0, 0)
    mapper.give(0.5, 30)
    mapper.check(0.75, 100)
