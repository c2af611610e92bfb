# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the mapper does with what comes in, with a clock that only the test turns.

Simulated time stands until the test sets it, so that every wait ends when it is meant to.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.action import BuildMap
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, Range
from std_srvs.srv import Trigger

from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_map_building.ros.map_conversions import grid_from_msg
from fuzzy_map_building.types import Pose2, SonarReading
from ros.fake_robot import Talker, joint_to_msg, range_to_msg
from ros.harness import NodeProcess, Probe, Received, wait_until

K_EMPTY = 0.9


class Bench:
    """A mapper in continuous mode, whoever talks to it, and the time.

    Parameters
    ----------
    probe : Probe
        Who talks to it and listens.
    log : Path
        Where its output goes.
    **parameters
        Others than packets of eight readings.

    Attributes
    ----------
    start : float
        Time [s] at which the present test began.
    """

    def __init__(self, probe: Probe, log: Path, **parameters: object) -> None:
        self.probe = probe
        self.mapper = NodeProcess(
            "mapper",
            log,
            parameters={
                "mode": "continuous",
                "packet_size": 8,
                "use_sim_time": True,
                # Lone cones do not add up: let one reading be enough to show in the motion map.
                "evidence.k_empty": K_EMPTY,
                **parameters,
            },
        )
        self.mapper.wait_for_output("mapping")
        self.start = 0.0
        self._clock = probe.publisher(Clock, names.CLOCK, qos.CLOCK)
        self.talker = Talker(probe)
        self.maps: Received[OccupancyGrid] = probe.subscribe(
            OccupancyGrid, names.MOTION_MAP, qos.LATCHED
        )
        self.diagnostics: Received[DiagnosticArray] = probe.subscribe(
            DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE
        )
        self._before: dict[str, int] = {}
        self._log_read = 0

    def begin(self) -> None:
        """Empty the map and let so much time pass that nothing of the test before is left."""
        self.start += 100.0
        self.set_time(self.start)
        self.probe.call(Trigger, names.RESET_MAP, Trigger.Request())
        stamp = stamp_from_seconds(self.start)
        self.maps.wait_for(lambda m: m.header.stamp == stamp)
        self.maps.clear()
        self._before = self._rejected()
        self._log_read = len(self.mapper.output())

    def set_time(self, now: float) -> None:
        """Turn the clock, and wait until the mapper has seen it."""
        stamp = stamp_from_seconds(now)

        def seen() -> bool:
            # Again and again: a node subscribes to /clock as best effort.
            self._clock.publish(Clock(clock=stamp))
            return any(m.header.stamp == stamp for m in list(self.diagnostics.messages))

        self.diagnostics.clear()
        wait_until(seen, f"time {now} s", step=0.1)

    def pose(self, after: float, x: float, y: float, theta: float = 0.0) -> None:
        stamp = stamp_from_seconds(self.start + after)
        self.talker.pose(pose_to_msg(Pose2(x, y, theta), stamp))

    def joint(self, after: float, angle: float) -> None:
        self.talker.joint(joint_to_msg(stamp_from_seconds(self.start + after), angle))

    def range(self, after: float, sensor: int, value: float) -> None:
        self.talker.range(range_to_msg(sensor, stamp_from_seconds(self.start + after), value))

    def value(self, key: str) -> int:
        """Return a number of the newest diagnostics."""
        return next(int(v.value) for v in self.diagnostics.last.status[0].values if v.key == key)

    def wait_for_value(self, key: str, value: int) -> None:
        self.diagnostics.clear()
        wait_until(
            lambda: len(self.diagnostics) > 0 and self.value(key) == value, f"{key} = {value}"
        )

    def _rejected(self) -> dict[str, int]:
        prefix = "rejected."
        values = self.diagnostics.last.status[0].values
        return {v.key[len(prefix) :]: int(v.value) for v in values if v.key.startswith(prefix)}

    def rejected(self) -> dict[str, int]:
        """Return what was refused in this test, by topic and reason."""
        now = self._rejected()
        return {
            key: n - self._before.get(key, 0)
            for key, n in now.items()
            if n != self._before.get(key, 0)
        }

    def wait_for_rejected(self, wanted: dict[str, int]) -> None:
        """Wait until exactly this was refused."""
        try:
            wait_until(lambda: self.rejected() == wanted, "the refusals")
        except AssertionError:
            assert self.rejected() == wanted

    def log(self) -> str:
        """Return what the mapper has written in this test."""
        return self.mapper.output()[self._log_read :]


@pytest.fixture(scope="module")
def shared_bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    probe = Probe()
    bench = Bench(probe, tmp_path_factory.mktemp("mapper") / "mapper.log")
    yield bench
    bench.mapper.close()
    probe.close()


@pytest.fixture
def bench(shared_bench: Bench) -> Bench:
    shared_bench.begin()
    return shared_bench


def core() -> FuzzyMapper:
    parameters = mapper_parameters(overrides={"evidence.k_empty": K_EMPTY})
    return FuzzyMapper(parameters.area.geometry(), parameters)


def assert_equals_core(message: OccupancyGrid, mapper: FuzzyMapper) -> None:
    geometry, values = grid_from_msg(message)
    assert geometry == mapper.geometry
    assert (mapper.motion_risk < 0.9).any(), "the readings explored nothing: the test is void"
    assert np.abs(values - 100.0 * mapper.motion_risk).max() <= 1.0


def test_readings_of_a_moving_robot_are_placed_at_their_own_stamps(bench: Bench) -> None:
    # Driving along x at 0.5 m/s and turning through pi, where headings wrap; the turret
    # turns, too. The ranges come first, in an order that is not that of their sonars.
    readings = []
    for k, sensor in enumerate((3, 0, 7, 12, 9, 15, 4, 1)):
        after = 0.01 + 0.02 * k
        value = round(1.0 + 0.1 * k, 4)
        bench.range(after, sensor, value)
        fraction = after / 0.2
        place = Pose2(2.0 + 0.1 * fraction, 3.0, 3.1 + fraction * (2 * math.pi - 6.2))
        bearing = sensor * math.radians(22.5) + 0.2 * fraction
        readings.append(SonarReading(place, bearing, value))
    bench.pose(0.0, 2.0, 3.0, 3.1)
    bench.joint(0.0, 0.0)
    bench.pose(0.2, 2.1, 3.0, -3.1)
    bench.joint(0.2, 0.2)
    expected = core()
    expected.update(readings)
    assert_equals_core(bench.maps.wait_for(), expected)
    bench.wait_for_value("perceptions", 1)


def test_a_robot_outside_the_area_is_told_of_while_it_is_there(bench: Bench) -> None:
    def message() -> str:
        text: str = bench.diagnostics.last.status[0].message
        return text

    told = (
        "the robot at (9.00, -1.50) m stands outside the mapped area, x 0 to 7.6 m and y 0 to "
        "6.3 m, where it can be given no goal: set 'area.origin_x', 'area.origin_y', "
    )
    for k in range(3):
        bench.pose(-0.3 + 0.1 * k, 9.0, -1.5)
    wait_until(lambda: message().startswith(told), "the diagnostics to tell")
    assert bench.log().count(told) == 1
    bench.pose(0.0, 2.0, 3.0)
    wait_until(lambda: message() == "ok", "the diagnostics to be content")


def test_angles_between_which_none_lies_end_nothing(bench: Bench) -> None:
    for after, angle in ((-0.2, 1.7e308), (-0.1, -1.7e308)):
        bench.pose(after, 2.0, 3.0)
        bench.joint(after, angle)
    bench.range(-0.15, 0, 1.0)
    bench.wait_for_rejected({"joint_states.too_large": 2})


def test_readings_wait_for_their_pose_and_are_given_up_after_the_limit(bench: Bench) -> None:
    bench.pose(-0.1, 2.0, 3.0)
    bench.joint(-0.1, 0.0)
    bench.joint(0.3, 0.0)
    for sensor in range(8):
        bench.range(0.1, sensor, 1.0)
    bench.wait_for_value("waiting_readings", 8)
    bench.set_time(bench.start + 0.4)
    bench.wait_for_value("waiting_readings", 8)  # 0.3 s old, the limit is 0.5 s
    # The pose comes in time.
    bench.pose(0.3, 2.0, 3.0)
    expected = core()
    ring = [SonarReading(Pose2(2.0, 3.0), k * math.radians(22.5), 1.0) for k in range(8)]
    expected.update(ring)
    assert_equals_core(bench.maps.wait_for(), expected)
    # These find no pose at all.
    bench.maps.clear()
    for sensor in range(8):
        bench.range(0.4, sensor, 0.5)
    bench.wait_for_value("waiting_readings", 8)
    bench.set_time(bench.start + 1.0)
    bench.wait_for_rejected({"sonar.no_pose": 8})
    assert bench.value("waiting_readings") == 0
    assert bench.value("perceptions") == 1
    assert len(bench.maps) == 0


def spoilt(kind: str) -> Callable[[Bench, Callable[..., None]], None]:
    """Return what sends a message of a kind, good but for what a function does to it."""

    def send(bench: Bench, spoil: Callable[..., None]) -> None:
        stamp = stamp_from_seconds(bench.start + 0.1)
        message: Range | PoseStamped | JointState
        if kind == names.SONAR:
            message = range_to_msg(0, stamp, 1.0)
        elif kind == names.POSE:
            message = pose_to_msg(Pose2(6.0, 1.0), stamp)
        else:
            message = joint_to_msg(stamp, 0.1)
        spoil(message)
        {
            names.SONAR: bench.talker.range,
            names.POSE: bench.talker.pose,
            names.JOINT_STATES: bench.talker.joint,
        }[kind](message)

    return send


def test_bad_input_is_refused_counted_and_leaves_the_map(bench: Bench) -> None:
    sonar, pose, joint = (spoilt(k) for k in (names.SONAR, names.POSE, names.JOINT_STATES))

    def late(seconds: float) -> Time:
        return stamp_from_seconds(bench.start + seconds)

    bad = [
        ("sonar.unknown_frame", sonar, lambda m: setattr(m.header, "frame_id", "sonar_99")),
        ("sonar.unknown_frame", sonar, lambda m: setattr(m.header, "frame_id", "")),
        ("sonar.field_of_view", sonar, lambda m: setattr(m, "field_of_view", 0.2)),
        ("sonar.field_of_view", sonar, lambda m: setattr(m, "field_of_view", math.nan)),
        ("sonar.no_stamp", sonar, lambda m: setattr(m.header, "stamp", Time())),
        ("sonar.negative_stamp", sonar, lambda m: setattr(m.header, "stamp", Time(sec=-3))),
        ("sonar.future", sonar, lambda m: setattr(m.header, "stamp", late(50))),
        ("sonar.no_pose", sonar, lambda m: setattr(m.header, "stamp", late(-50))),
        ("pose.not_finite", pose, lambda m: setattr(m.pose.position, "x", math.nan)),
        ("pose.not_finite", pose, lambda m: setattr(m.pose.position, "y", math.inf)),
        ("pose.not_finite", pose, lambda m: setattr(m.pose.orientation, "z", math.nan)),
        ("pose.quaternion_norm", pose, lambda m: setattr(m.pose.orientation, "z", 1.0)),
        ("pose.quaternion_norm", pose, lambda m: setattr(m.pose.orientation, "w", 0.0)),
        ("pose.wrong_frame", pose, lambda m: setattr(m.header, "frame_id", "odom")),
        ("pose.no_stamp", pose, lambda m: setattr(m.header, "stamp", Time())),
        ("pose.future", pose, lambda m: setattr(m.header, "stamp", late(1))),
        ("pose.out_of_order", pose, lambda m: setattr(m.header, "stamp", late(-1))),
        ("pose.duplicate", pose, lambda m: setattr(m.header, "stamp", late(0))),
        ("joint_states.not_finite", joint, lambda m: setattr(m, "position", [math.nan])),
        ("joint_states.no_position", joint, lambda m: setattr(m, "position", [])),
        ("joint_states.no_stamp", joint, lambda m: setattr(m.header, "stamp", Time())),
        ("joint_states.future", joint, lambda m: setattr(m.header, "stamp", late(2))),
        ("joint_states.out_of_order", joint, lambda m: setattr(m.header, "stamp", late(-91))),
    ]
    # What other joints do is no business of the mapper's.
    joint(bench, lambda m: setattr(m, "name", ["arm_joint"]))
    bench.pose(0.0, 2.0, 3.0)
    bench.joint(0.0, 0.0)
    totals: dict[str, int] = {}
    for number, (key, send, spoil) in enumerate(bad):
        send(bench, spoil)
        totals[key] = totals.get(key, 0) + 1
        if number % 8 == 7:  # the queue of poses holds ten
            bench.wait_for_rejected(totals)
    bench.wait_for_rejected(totals)
    assert len(bench.maps) == 0

    # None of it has moved a reading: the next packet is placed where the good poses are.
    bench.pose(0.2, 2.0, 3.0)
    bench.joint(0.2, 0.0)
    values = [math.nan, -1.0, 0.05, 7.0, 1.0, 1.0, math.inf, -math.inf]
    for sensor, value in enumerate(values):
        bench.range(0.1, sensor, value)
    expected = core()
    readings = [
        SonarReading(Pose2(2.0, 3.0), k * math.radians(22.5), v) for k, v in enumerate(values)
    ]
    report = expected.update(readings)
    assert report.accepted == 4
    assert_equals_core(bench.maps.wait_for(), expected)
    bench.wait_for_rejected({**totals, "sonar.nan": 1, "sonar.out_of_range": 3})
    # Each kind is named in the log once, with what to do; a second one within seconds is not.
    log = bench.log()
    assert log.count("from frame 'sonar_99', which is none of the 16 sensors") == 1
    assert "normalise the quaternion" in log
    assert log.count("field of view") == 1


def test_a_sonar_that_repeats_a_stamp_or_goes_back_is_refused(bench: Bench) -> None:
    for after in (0.1, 0.1, 0.05):
        bench.range(after, 0, 1.0)
    bench.wait_for_rejected({"sonar.duplicate": 1, "sonar.out_of_order": 1})
    assert bench.value("waiting_readings") == 1


def test_a_clock_that_is_set_back_begins_anew(bench: Bench) -> None:
    bench.pose(0.0, 2.0, 3.0)
    bench.joint(0.0, 0.0)
    bench.range(0.1, 0, 1.0)
    bench.wait_for_value("waiting_readings", 1)
    bench.set_time(bench.start - 90.0)
    bench.wait_for_value("waiting_readings", 0)
    assert "the clock went back by 90.0 s" in bench.log()
    for after in (-90.0, -89.8):
        bench.pose(after, 4.0, 3.0)
        bench.joint(after, 0.0)
    for sensor in range(8):
        bench.range(-89.9, sensor, 1.0)
    expected = core()
    expected.update([SonarReading(Pose2(4.0, 3.0), k * math.radians(22.5), 1.0) for k in range(8)])
    assert_equals_core(bench.maps.wait_for(), expected)


def test_a_clock_that_stands_ends_a_perception(bench: Bench) -> None:
    client = bench.probe.action_client(BuildMap, names.BUILD_MAP)
    handle = bench.probe.send_goal(client, BuildMap.Goal())
    assert handle.accepted
    response = bench.probe.result_of(handle.get_result_async(), "the result")
    assert response.status == GoalStatus.STATUS_ABORTED
    assert f"the clock has stood at {bench.start:.3f} s" in bench.log()
    assert "the clock has stood" in response.result.message


def test_a_clock_that_races_does_not_cut_a_perception_short(bench: Bench) -> None:
    # Half a minute passes at once: much more than the turret and the sonars are given.
    client = bench.probe.action_client(BuildMap, names.BUILD_MAP)
    taken: list[int] = []
    handle = bench.probe.send_goal(
        client, BuildMap.Goal(), lambda m: taken.append(m.feedback.readings)
    )
    bench.set_time(bench.start + 30.0)
    result = handle.get_result_async()
    stamps = itertools.count(30.0, 0.002)
    for stage, angle in enumerate(mapper_parameters().turret.angles):

        def all_taken(angle: float = angle, wanted: int = 16 * (stage + 1)) -> bool:
            # Again and again: ranges may get lost.
            before, between, behind = (next(stamps) for _ in range(3))
            for after in (before, behind):
                bench.joint(after, angle)
                bench.pose(after, 2.0, 3.0)
            for sensor in range(16):
                bench.range(between, sensor, 1.0)
            return result.done() or wanted in taken

        wait_until(all_taken, f"the readings of stand {stage}", step=0.2)
    assert bench.probe.result_of(result).result.readings == 48
