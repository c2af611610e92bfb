# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The simulator as a process of its own, over real middleware, against its core in this one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from fuzzy_msgs.action import BuildMap
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.action import ActionServer
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from std_srvs.srv import Trigger

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.conversions import stamped_twist_to_msg
from nomad_sim.simulator import Simulator
from nomad_sim.world_io import parse_world
from ros.harness import NodeProcess, Probe, wait_until
from ros.room import RATE, ROOM, Robot, stamp, twist, write_room


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write_room(tmp_path_factory.mktemp("world"))


@pytest.fixture(scope="module")
def module_probe() -> Iterator[Probe]:
    probe = Probe("sim_probe")
    yield probe
    probe.close()


@pytest.fixture(scope="module")
def sim(room: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    log = tmp_path_factory.mktemp("sim") / "sim.log"
    given = {"world": room, "rate": RATE, "noise": False}
    process = NodeProcess("sim", log, parameters=given)
    yield process
    process.close()


@pytest.fixture(scope="module")
def module_robot(module_probe: Probe, sim: NodeProcess) -> Robot:
    return Robot(module_probe)


@pytest.fixture
def robot(module_robot: Robot) -> Robot:
    """The robot of the module's simulator, at its start."""
    module_robot.reset()
    return module_robot


def set_parameter(probe: Probe, name: str, value: Any) -> Any:
    request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
    response = probe.call(SetParameters, f"{names.SIMULATOR_NODE}/set_parameters", request)
    return response.results[0]


def test_topics_have_their_types_and_qualities(robot: Robot) -> None:
    reliable, best_effort = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
    volatile, latched = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
    expected = {
        "/clock": ("rosgraph_msgs/msg/Clock", reliable, volatile),
        "/sonar": ("sensor_msgs/msg/Range", best_effort, volatile),
        "/infrared": ("sensor_msgs/msg/Range", best_effort, volatile),
        "/joint_states": ("sensor_msgs/msg/JointState", best_effort, volatile),
        "/pose": ("geometry_msgs/msg/PoseStamped", reliable, volatile),
        "/odom": ("nav_msgs/msg/Odometry", reliable, volatile),
        "/ground_truth/map": ("nav_msgs/msg/OccupancyGrid", reliable, latched),
        "/ground_truth/pose": ("geometry_msgs/msg/PoseStamped", reliable, volatile),
        "/contact": ("std_msgs/msg/Bool", reliable, latched),
        "/diagnostics": ("diagnostic_msgs/msg/DiagnosticArray", reliable, volatile),
    }

    def offered() -> dict[str, tuple[str, ReliabilityPolicy, DurabilityPolicy]]:
        infos = {t: robot.probe.node.get_publishers_info_by_topic(t) for t in expected}
        return {
            topic: (i.topic_type, i.qos_profile.reliability, i.qos_profile.durability)
            for topic, found in infos.items()
            for i in found
            if i.node_name == names.SIMULATOR_NODE
        }

    wait_until(lambda: offered() == expected, f"{expected}, offered: {offered()}")


def test_it_drives_as_told_and_stops_without_commands(robot: Robot) -> None:
    commands = robot.probe.publisher(Twist, names.CMD_VEL, qos.RELIABLE)
    odom = robot.probe.subscribe(Odometry, names.ODOM, QoSProfile(depth=2000))
    assert robot.x == pytest.approx(1.0)
    commands.publish(twist(0.3))
    odom.wait_for(lambda m: m.twist.twist.linear.x == pytest.approx(0.3))
    began = odom.wait_for(lambda m: m.twist.twist.linear.x > 0.0)
    ended = odom.wait_for(lambda m: stamp(m) > stamp(began) and m.twist.twist.linear.x == 0.0)
    # Half a second after the command it stands; the first tick was over when it was told of.
    assert 0.3 <= stamp(ended) - stamp(began) <= 0.45 + 1e-6
    robot.after(0.1)
    stood = robot.x
    assert 0.05 < stood - 1.0 < 0.12
    robot.after(1.0)
    assert robot.x == stood


def test_the_turret_turns_at_its_rate(robot: Robot) -> None:
    joints = robot.probe.subscribe(JointState, names.JOINT_STATES, qos.JOINT_STATES)
    turret = robot.probe.publisher(Float64, names.TURRET_COMMAND, qos.RELIABLE)
    turret.publish(Float64(data=math.pi / 3))
    joints.wait_for(lambda m: m.position[0] == pytest.approx(math.pi / 3))
    turning = [m for m in list(joints.messages) if 0.0 < m.position[0] < math.pi / 3 - 1e-9]
    # Some of the twenty may have been lost: at best effort nothing else is promised.
    times, angles = [stamp(m) for m in turning], [m.position[0] for m in turning]
    assert len(turning) > 3
    assert np.diff(angles) == pytest.approx(math.pi / 3 * np.diff(times))


def stamped(linear: float, stamp: float = 1.0, frame: str = "base_link") -> TwistStamped:
    message = stamped_twist_to_msg(stamp, linear, 0.0)
    message.header.frame_id = frame
    return message


def test_it_drives_by_stamped_commands_as_well(robot: Robot) -> None:
    commands = robot.probe.publisher(TwistStamped, names.STAMPED_CMD_VEL, qos.RELIABLE)
    odom = robot.probe.subscribe(Odometry, names.ODOM, QoSProfile(depth=2000))
    commands.publish(stamped(0.3, robot.time))
    odom.wait_for(lambda m: m.twist.twist.linear.x == pytest.approx(0.3))


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (twist(math.nan), "not_finite"),
        (twist(0.1, math.inf), "not_finite"),
        (twist(0.1, lateral=0.1), "not_planar"),
        (twist(6.1), "absurd"),
        (twist(0.0, -11.0), "absurd"),
        (stamped(math.nan), "not_finite"),
        (stamped(6.1), "absurd"),
        (stamped(0.1, stamp=0.0), "no_stamp"),
        (stamped(0.1, frame="map"), "wrong_frame"),
    ],
)
def test_bad_commands_move_nothing_and_are_counted(
    robot: Robot, message: Twist | TwistStamped, reason: str
) -> None:
    topic = names.CMD_VEL if isinstance(message, Twist) else names.STAMPED_CMD_VEL
    commands = robot.probe.publisher(type(message), topic, qos.RELIABLE)
    before, key = robot.pose.last.pose, f"rejected.{topic}.{reason}"
    count = int(robot.values().get(key, "0"))
    commands.publish(message)
    assert robot.values(lambda v: v.get(key) == str(count + 1))
    robot.after(0.2)
    assert robot.pose.last.pose == before


@pytest.mark.parametrize("angle", [math.nan, -math.inf, 1e6])
def test_bad_turret_angles_turn_nothing_and_are_counted(robot: Robot, angle: float) -> None:
    joints = robot.probe.subscribe(JointState, names.JOINT_STATES, qos.JOINT_STATES)
    turret = robot.probe.publisher(Float64, names.TURRET_COMMAND, qos.RELIABLE)
    key = "rejected.turret/command.bad_angle"
    count = int(robot.values().get(key, "0"))
    turret.publish(Float64(data=angle))
    assert robot.values(lambda v: v.get(key) == str(count + 1))
    assert joints.wait_for().position[0] == 0.0


def test_contact_is_told_and_reset_begins_anew(robot: Robot) -> None:
    contact = robot.probe.subscribe(Bool, names.CONTACT, qos.LATCHED)
    commands = robot.probe.publisher(Twist, names.CMD_VEL, qos.RELIABLE)
    assert contact.wait_for().data is False

    def touched() -> bool:
        commands.publish(twist(0.6))
        return bool(contact.last.data)

    wait_until(touched, "a contact with the wall", step=0.01)
    robot.after(0.1)
    assert robot.x == pytest.approx(4.0 - 0.23, abs=0.02)
    values = robot.values()
    assert values["contacts"] == "1"
    assert float(values["least_clearance"]) == pytest.approx(0.0, abs=1e-3)

    before = robot.time
    response = robot.probe.call(Trigger, names.RESET_SIMULATOR, Trigger.Request())
    assert response.success
    robot.after(1.0)
    assert robot.x == 1.0
    stamps = [stamp(m) for m in robot.pose.messages]
    assert stamps == sorted(stamps)
    # Nobody may interpolate between the poses before and after.
    assert max(np.diff([t for t in stamps if t >= before])) >= 1.0
    assert contact.last.data is False
    assert robot.values()["contacts"] == "0"


def test_perceptions_that_succeed_count(robot: Robot) -> None:
    """The crate leaves with the first completed perception, not with one that failed."""
    truth = robot.probe.subscribe(OccupancyGrid, names.GROUND_TRUTH_MAP, qos.LATCHED)
    crate = 25 * 40 + 32
    assert truth.wait_for().data[crate] == 100
    world = parse_world(ROOM)
    expected = Simulator(world).ground_truth_grid(world.geometry(0.1))
    assert (np.array(truth.last.data).reshape(30, 40) == 100 * expected).all()

    ends = ["abort", "succeed"]

    def execute(handle: Any) -> BuildMap.Result:
        getattr(handle, ends.pop(0))()
        return BuildMap.Result()

    # Its stamps are of simulated time, as the mapper's are.
    robot.probe.node.set_parameters([Parameter("use_sim_time", value=True)])
    wait_until(lambda: robot.probe.node.get_clock().now().nanoseconds > 0, "simulated time")
    ActionServer(robot.probe.node, BuildMap, names.BUILD_MAP, execute)
    status = f"/{names.BUILD_MAP}/_action/status"
    wait_until(lambda: robot.probe.node.count_subscribers(status) > 0, "the simulator's ear")
    client = robot.probe.action_client(BuildMap, names.BUILD_MAP)
    for counted in ("0", "1"):
        handle = robot.probe.send_goal(client, BuildMap.Goal())
        robot.probe.result_of(handle.get_result_async())
        robot.values()  # a status from after the end of the goal
        assert robot.values(lambda v, n=counted: v["perceptions"] == n)
    assert truth.wait_for(lambda m: m.data[crate] == 0)


def test_the_rate_is_kept_and_a_slow_machine_is_told(robot: Robot) -> None:
    try:
        assert set_parameter(robot.probe, "rate", 2.0).successful
        robot.values()  # this period may include the rate before
        assert robot.values(lambda v: abs(float(v["rate"]) - 2.0) < 0.3)
        assert set_parameter(robot.probe, "rate", 1000.0).successful
        message = robot.diagnostics.wait_for(lambda m: "times real time" in m.status[0].message)
        assert message.status[0].level == DiagnosticStatus.WARN
        assert "instead of 1000: the machine is too slow" in message.status[0].message
    finally:
        set_parameter(robot.probe, "rate", RATE)


@pytest.mark.parametrize("rate", [1e-200, 5e-324])
def test_time_almost_stands_and_goes_on(robot: Robot, rate: float) -> None:
    try:
        assert set_parameter(robot.probe, "rate", rate).successful
    finally:
        set_parameter(robot.probe, "rate", RATE)
    robot.values()


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("rate", -1.0, ""),
        ("rate", math.nan, ""),
        ("seed", 5, ""),
        ("sonar.max_range", 0.1, "min_"),
    ],
)
def test_bad_parameters_are_refused(robot: Robot, name: str, value: Any, reason: str) -> None:
    result = set_parameter(robot.probe, name, value)
    assert not result.successful
    assert reason in result.reason
    response = robot.probe.call(
        GetParameters,
        f"{names.SIMULATOR_NODE}/get_parameters",
        GetParameters.Request(names=["rate"]),
    )
    assert response.values[0].double_value == RATE
