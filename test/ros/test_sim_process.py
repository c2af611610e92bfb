# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulators of their own: against the core, in lockstep, and how they start and end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, Range

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp
from nomad_sim.ros.params import simulation_parameters
from nomad_sim.simulator import Simulator
from nomad_sim.world_io import load_world
from ros.harness import NodeProcess, Probe, Received, wait_until
from ros.room import Answering, Robot, stamp, write_room

Start = Callable[..., NodeProcess]


@pytest.fixture
def room(tmp_path: Path) -> str:
    return write_room(tmp_path)


def test_a_preset_for_all_nodes_does_not_end_it(
    start_node: Start, room: str, tmp_path: Path
) -> None:
    file = tmp_path / "all.yaml"
    file.write_text("/**: {ros__parameters: {preset: oriolo1998}}")
    arguments = ["--ros-args", "--params-file", str(file)]
    process = start_node("sim", arguments=arguments, parameters={"world": room})
    process.wait_for_output("there are no presets here: 'oriolo1998' is not used")
    process.wait_for_output("seed 0, rate 1")
    process.assert_clean_stop()


def test_a_tick_tells_what_the_core_measures(probe: Probe, start_node: Start, room: str) -> None:
    """Noise and all: the node adds nothing to the core but stamps."""
    deep = QoSProfile(depth=2000, reliability=ReliabilityPolicy.BEST_EFFORT)
    clock: Received[Clock] = probe.subscribe(Clock, names.CLOCK, qos.CLOCK)
    sonar: Received[Range] = probe.subscribe(Range, names.SONAR, deep)
    infrared: Received[Range] = probe.subscribe(Range, names.INFRARED, deep)
    joints: Received[JointState] = probe.subscribe(JointState, names.JOINT_STATES, deep)
    odom: Received[Odometry] = probe.subscribe(Odometry, names.ODOM, qos.RELIABLE)
    truth = probe.subscribe(PoseStamped, names.GROUND_TRUTH_POSE, qos.RELIABLE)
    poses = probe.subscribe(PoseStamped, names.POSE, QoSProfile(depth=2000))
    start = {"override": True, "x": 1.3, "y": 1.1, "theta": 0.7}
    given = {"world": room, "rate": 4.0, "seed": 7, **{f"start.{k}": v for k, v in start.items()}}
    process = start_node("sim", parameters=given)
    # A subscription hears nothing until it has been found: compared is what came after every
    # topic had been heard, and one second later, since the sensors of a topic fire in turn.
    heard = (poses, sonar, infrared, joints, odom, truth)
    wait_until(lambda: all(topic.messages for topic in heard), "every topic of the simulator")
    since = max(stamp(topic.messages[0]) for topic in heard) + 1.0
    poses.wait_for(lambda m: stamp(m) > since + 3.0)
    clock.wait_for(lambda m: seconds_from_stamp(m.clock) > since + 3.0)
    process.assert_clean_stop()

    first = min(stamp(m) for m in poses.messages if stamp(m) >= since - 1e-6)
    last = stamp(poses.last)
    values = simulation_parameters(given)
    core = Simulator(load_world(room), values, values.start.pose())
    sonars, infrareds, ticks = {}, {}, []
    while (now := round(core.time + 1.05, 6)) <= last + 1e-6:
        core.step(0.0, 0.0)
        if now >= first:
            ticks.append(now)
            infrareds.update({(now, i): r for i, r in enumerate(core.infrared())})
        for event in core.sonar_events:
            if event.stamp + 1.0 > first:
                sonars[round(event.stamp + 1.0, 6), event.sensor] = event.range

    def of(received: Received[Range], prefix: str, since: float) -> dict[tuple[float, int], float]:
        return {
            (round(stamp(m), 6), int(m.header.frame_id.removeprefix(prefix))): m.range
            for m in received.messages
            if since <= stamp(m) <= last + 1e-6
        }

    assert len(ticks) > 50
    assert [stamp(m) for m in poses.messages if stamp(m) >= first - 1e-6] == pytest.approx(ticks)
    # Ranges go out as best effort, a busy machine loses some: what came is what was measured.
    for came, measured in (
        (of(infrared, "infrared_", first), infrareds),
        (of(sonar, "sonar_", first + 1e-6), sonars),
    ):
        assert came == pytest.approx({key: measured[key] for key in came}, rel=1e-6)
        assert {sensor for _, sensor in came} == set(range(16))
    assert len(infrareds) == 16 * len(ticks)
    assert len(sonars) >= 5 * len(ticks) - 8
    for message in (poses.last.pose, truth.last.pose):
        assert (message.position.x, message.position.y) == pytest.approx((1.3, 1.1))
        assert 2 * math.atan2(message.orientation.z, message.orientation.w) == pytest.approx(0.7)
    assert odom.last.header.frame_id == "odom"
    assert odom.last.child_frame_id == "base_link"
    assert (poses.last.header.frame_id, list(joints.last.name)) == ("map", ["turret_joint"])
    assert sonar.last.radiation_type == Range.ULTRASOUND
    assert infrared.last.radiation_type == Range.INFRARED
    assert math.degrees(sonar.last.field_of_view) == pytest.approx(25.0)
    assert (sonar.last.min_range, sonar.last.max_range) == pytest.approx((0.12, 6.5))


@pytest.fixture
def lockstep(start_node: Start, room: str) -> NodeProcess:
    given = {"world": room, "rate": 0.0, "lockstep": True, "lockstep_timeout": 2.0}
    return start_node("sim", parameters=given)


def test_in_lockstep_every_tick_waits_for_its_answer(lockstep: NodeProcess, probe: Probe) -> None:
    robot = Robot(probe)
    answering = Answering(probe)
    wait_until(lambda: len(answering.answers) > 400, "400 answers")
    answering.on = False
    asked = len(answering.answers)
    time.sleep(0.5)  # unpaced, it would make hundreds of ticks in this time
    assert robot.time <= answering.answers[-1] + 0.11
    # While it stood, it was one tick ahead of the answers, never more.
    answers = answering.answers[100:asked]
    assert np.diff(answers) == pytest.approx(np.full(len(answers) - 1, 0.05))
    turned = robot.pose.last.pose.orientation
    assert turned.z != 0.0
    robot.after(5.0)  # goes on after the timeout
    assert robot.values()["lockstep"] == "free"
    assert robot.values()["lockstep_timeouts"] == "1"
    answering.on = True
    assert robot.values(lambda v: v["lockstep"] == "engaged")


def test_what_it_cannot_start_with_is_one_line(start_node: Start) -> None:
    refused: list[tuple[dict[str, Any], str]] = [
        ({"world": "labb"}, "did you mean 'lab'?"),
        ({"world": "missing/file.yaml"}, "missing/file.yaml"),
        ({"rat": 1.0}, "did you mean 'rate'?"),
        ({"rate": -1.0}, "'rate' must be at least 0"),
        ({"seed": "one"}, "'seed' must be a whole number"),
        ({"start.override": True, "start.x": 3.5, "start.y": 1.0}, "cannot start at (3.5, 1)"),
        ({"start.override": True, "start.x": 99.0}, "the start (99, 0) m lies outside the area"),
    ]
    started = [(start_node("sim", parameters=given), text) for given, text in refused]
    for process, text in started:
        assert process.wait() == 2
        lines = process.output().strip().splitlines()
        assert len(lines) == 1, process.output()
        assert text in lines[0]
