# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper as a process of its own, over real middleware, against the core in this process."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.action import BuildMap
from fuzzy_msgs.srv import MapFile
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_io import load_map, save_map
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.map_conversions import grid_from_msg
from fuzzy_map_building.types import Pose2, SonarReading
from ros.fake_robot import FakeRobot
from ros.harness import NodeProcess, Probe, wait_until

POSE = Pose2(1.25, 5.25, 0.0)
#: Limits of waiting [s]: never met by what comes, however slow the machine; soon met in vain.
LONG, SHORT = 15.0, 0.3
ANGLES = (0.0, math.radians(7.5), math.radians(15.0))


def measure(sensor: int, angle: float) -> float:
    """Return ranges that differ for every sonar and turret angle; one echo is lost.

    A float32 holds four decimals exactly enough to be read back as what they were.
    """
    return math.inf if sensor == 5 else round(0.6 + 0.07 * sensor + angle, 4)


def expected_map() -> FuzzyMapper:
    """Return the core's map of one perception of the fake robot."""
    parameters = mapper_parameters()
    core = FuzzyMapper(parameters.area.geometry(), parameters)
    core.update(
        [
            SonarReading(POSE, bearing + angle, measure(sensor, angle))
            for angle in ANGLES
            for sensor, bearing in enumerate(parameters.sonar.bearings)
        ]
    )
    return core


@pytest.fixture(scope="module")
def module_probe() -> Iterator[Probe]:
    probe = Probe("mapper_probe")
    yield probe
    probe.close()


@pytest.fixture(scope="module")
def map_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("maps")


@pytest.fixture(scope="module")
def mapper(tmp_path_factory: pytest.TempPathFactory, map_folder: Path) -> Iterator[NodeProcess]:
    log = tmp_path_factory.mktemp("mapper") / "mapper.log"
    # Where the machine holds somebody up, readings come late, and poses with gaps.
    patient = ["turret.timeout", "perception.timeout", "perception.max_pose_gap"]
    parameters = {"map_folder": str(map_folder), **dict.fromkeys(patient, LONG)}
    process = NodeProcess("mapper", log, parameters=parameters)
    process.wait_for_output("mapping")
    yield process
    process.close()


@pytest.fixture
def robot(module_probe: Probe, mapper: NodeProcess) -> Iterator[FakeRobot]:
    module_probe.call(Trigger, names.RESET_MAP, Trigger.Request())
    robot = FakeRobot(module_probe, POSE, measure)
    # Else the first command may come before the middleware has joined the two.
    wait_until(robot.obeys, "the mapper to find the turret")
    yield robot
    robot.close()


@pytest.fixture(scope="module")
def build_map(module_probe: Probe, mapper: NodeProcess) -> ActionClient:
    return module_probe.action_client(BuildMap, names.BUILD_MAP)


def perceive(probe: Probe, client: ActionClient) -> tuple[int, BuildMap.Result]:
    handle = probe.send_goal(client, BuildMap.Goal())
    assert handle.accepted
    response = probe.result_of(handle.get_result_async(), "the result of the perception")
    return response.status, response.result


def set_parameters(probe: Probe, **values: float) -> None:
    request = SetParameters.Request(
        parameters=[
            Parameter(name.replace("__", "."), value=value).to_parameter_msg()
            for name, value in values.items()
        ]
    )
    response = probe.call(SetParameters, f"{names.MAPPER_NODE}/set_parameters", request)
    assert all(r.successful for r in response.results), response


def motion_map(probe: Probe) -> np.ndarray:
    message = probe.call(GetMap, names.GET_MOTION_MAP, GetMap.Request()).map
    return grid_from_msg(message)[1].copy()


def test_a_perception_gives_the_maps_of_the_core(
    module_probe: Probe, robot: FakeRobot, build_map: ActionClient
) -> None:
    feedback: list[BuildMap.Feedback] = []
    handle = module_probe.send_goal(
        build_map, BuildMap.Goal(), lambda m: feedback.append(m.feedback)
    )
    assert handle.accepted
    response = module_probe.result_of(handle.get_result_async(), "the result")
    assert response.status == GoalStatus.STATUS_SUCCEEDED
    result = response.result
    assert (result.perception, result.readings, result.rejected) == (1, 48, 0)
    assert result.message == ""
    assert 0.0 < result.duration < 60.0
    # The last ones may come after the result, and are then dropped by the client.
    assert feedback
    assert [f.readings for f in feedback] == sorted(f.readings for f in feedback)
    assert {f.expected for f in feedback} == {48}
    np.testing.assert_allclose(sorted(set(robot.commands)), ANGLES)

    # Latched: whoever comes late has the maps, all of one moment.
    core = expected_map()
    late = {
        topic: module_probe.subscribe(OccupancyGrid, topic, qos.LATCHED).wait_for()
        for topic in (names.MOTION_MAP, names.PLANNING_MAP, names.MAP)
    }
    assert len({(m.header.stamp.sec, m.header.stamp.nanosec) for m in late.values()}) == 1
    for topic, risk in (
        (names.MOTION_MAP, core.motion_risk),
        (names.PLANNING_MAP, core.planning_risk),
    ):
        geometry, values = grid_from_msg(late[topic])
        assert geometry == core.geometry
        assert values.min() >= 0
        assert np.abs(values - 100.0 * risk).max() <= 1.0
        served = module_probe.call(GetMap, f"{topic}/get", GetMap.Request()).map
        np.testing.assert_array_equal(grid_from_msg(served)[1], values)
    assert (core.motion_risk < 0.5).any(), "the readings explored nothing: the test is void"
    # `map`: unknown where little is known, low where the beliefs say empty, high where occupied.
    occupancy = grid_from_msg(late[names.MAP])[1]
    assert occupancy[0, 75] == -1
    assert (occupancy[core.empty > 0.7] < 50).all()
    assert (occupancy[core.empty > 0.7] >= 0).all()
    assert (occupancy[core.occupied > 0.7] > 50).all()


def test_a_second_perception_counts_on_and_a_reset_begins_anew(
    module_probe: Probe, robot: FakeRobot, build_map: ActionClient
) -> None:
    assert perceive(module_probe, build_map)[1].perception == 1
    assert perceive(module_probe, build_map)[1].perception == 2
    answer = module_probe.call(Trigger, names.RESET_MAP, Trigger.Request())
    assert answer.success
    assert (motion_map(module_probe) == 100).all()
    assert perceive(module_probe, build_map)[1].perception == 1


def test_only_one_perception_at_a_time_and_a_canceled_one_leaves_the_map(
    module_probe: Probe, robot: FakeRobot, build_map: ActionClient, mapper: NodeProcess
) -> None:
    robot.measure = lambda sensor, angle: 1.0 if sensor else math.nan
    robot.blind = True
    first = module_probe.send_goal(build_map, BuildMap.Goal())
    assert first.accepted
    assert not module_probe.send_goal(build_map, BuildMap.Goal()).accepted
    assert "goal rejected" in mapper.wait_for_output("goal rejected")
    robot.blind = False
    module_probe.result_of(first.cancel_goal_async(), "the answer to the cancel")
    response = module_probe.result_of(first.get_result_async(), "the result")
    assert response.status == GoalStatus.STATUS_CANCELED
    assert "canceled" in response.result.message
    assert (motion_map(module_probe) == 100).all()
    # The next one is served as if nothing had been, and counts the faulty sonar.
    status, result = perceive(module_probe, build_map)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert (result.readings, result.rejected) == (45, 3)


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("turret_stuck", "the turret did not reach"),
        ("blind", "no reading of any of the 16 sonars"),
        ("lost", "no reading of any of the 16 sonars"),
        ("unstamped", "of one clock; refused: sonar range has no stamp"),
    ],
)
def test_a_perception_that_cannot_be_made_is_aborted_with_a_word(
    module_probe: Probe,
    robot: FakeRobot,
    build_map: ActionClient,
    mapper: NodeProcess,
    fault: str,
    message: str,
) -> None:
    robot.angle = 1.0
    setattr(robot, fault, True)
    set_parameters(module_probe, turret__timeout=SHORT, perception__timeout=SHORT)
    status, result = perceive(module_probe, build_map)
    set_parameters(module_probe, turret__timeout=LONG, perception__timeout=LONG)
    assert status == GoalStatus.STATUS_ABORTED
    assert result.readings == 0
    assert message in result.message
    assert (motion_map(module_probe) == 100).all()
    mapper.wait_for_output(message)
    diagnostics = module_probe.subscribe(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
    diagnostics.wait_for(
        lambda m: message in m.status[0].message, what=f"'{message}' in diagnostics"
    )


def test_a_perception_of_faulty_readings_is_none(
    module_probe: Probe, robot: FakeRobot, build_map: ActionClient, mapper: NodeProcess
) -> None:
    robot.measure = lambda sensor, angle: 9.0 if sensor else math.nan
    status, result = perceive(module_probe, build_map)
    assert status == GoalStatus.STATUS_ABORTED
    assert result.perception == 0
    assert result.message == "none of 48 readings gave evidence (3 nan, 45 out of range)"
    assert (motion_map(module_probe) == 100).all()
    mapper.wait_for_output("none of 48 readings gave evidence (3 nan, 45 out of range)")


def test_a_robot_without_a_turret_perceives_where_its_sonars_look(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    start_node(
        "mapper",
        parameters={"preset": "lachekhab", "perception.timeout": LONG},
        remap={"__ns": "/pioneer", "sonar": "/sonar", "pose": "/pose"},
    ).wait_for_output("mapping")
    # The mapper has no use for them, but the robot waits for who hears it.
    probe.subscribe(JointState, names.JOINT_STATES, qos.JOINT_STATES)
    robot = FakeRobot(probe, Pose2(3.0, 3.0), lambda sensor, angle: 1.0 + 0.1 * sensor)
    client = probe.action_client(BuildMap, "pioneer/build_map")
    status, result = perceive(probe, client)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert result.readings == 8
    assert robot.commands == []
    robot.close()
    parameters = mapper_parameters("lachekhab")
    core = FuzzyMapper(parameters.area.geometry(), parameters)
    core.update(
        [
            SonarReading(Pose2(3.0, 3.0), bearing, round(1.0 + 0.1 * sensor, 4))
            for sensor, bearing in enumerate(parameters.sonar.bearings)
        ]
    )
    message = probe.call(GetMap, "pioneer/planning_map/get", GetMap.Request()).map
    geometry, values = grid_from_msg(message)
    assert geometry == core.geometry
    assert np.abs(values - 100.0 * core.planning_risk).max() <= 1.0


def test_save_restart_and_load_restore_the_exact_state(
    module_probe: Probe,
    robot: FakeRobot,
    build_map: ActionClient,
    mapper: NodeProcess,
    map_folder: Path,
    tmp_path: Path,
) -> None:
    perceive(module_probe, build_map)
    perceive(module_probe, build_map)
    before = motion_map(module_probe)
    name = "lab.fuzzy"
    answer = module_probe.call(MapFile, names.SAVE_MAP, MapFile.Request(path=name))
    assert answer.success, answer.message
    assert answer.message == f"2 perceptions saved to {map_folder / name}"
    saved = load_map(map_folder / name)
    core = expected_map()
    np.testing.assert_allclose(saved.empty, core.empty, atol=1e-9)  # mean of twice the same
    np.testing.assert_array_equal(saved.count, 2 * core.count)
    assert saved.perceptions == 2

    # Another process, which knows nothing of the first.
    other = NodeProcess(
        "mapper",
        tmp_path / "other.log",
        parameters={"map_folder": str(map_folder)},
        remap={"__ns": "/other"},
    )
    try:
        answer = module_probe.call(MapFile, "other/load_map", MapFile.Request(path=name))
        assert answer.success, answer.message
        message = module_probe.call(GetMap, "other/motion_map/get", GetMap.Request()).map
        np.testing.assert_array_equal(grid_from_msg(message)[1], before)
        again = MapFile.Request(path="again.fuzzy")
        assert module_probe.call(MapFile, "other/save_map", again).success
        loaded = load_map(map_folder / again.path)
        for name in ("empty", "occupied", "count"):
            np.testing.assert_array_equal(getattr(loaded, name), getattr(saved, name))
        assert loaded.perceptions == saved.perceptions
        other.assert_clean_stop()
    finally:
        other.close()


def test_files_that_are_refused_leave_the_map(
    module_probe: Probe, robot: FakeRobot, build_map: ActionClient, map_folder: Path
) -> None:
    perceive(module_probe, build_map)
    before = motion_map(module_probe)
    (map_folder / "junk").write_bytes(b"PK\x03\x04 no map at all")
    # Opening a pipe would wait for ever for who writes to it.
    os.mkfifo(map_folder / "pipe")
    (map_folder / "folder").mkdir()
    save_map(map_folder / "other_grid", FuzzyMapper(GridGeometry(3, 2, 0.1)).state())
    (map_folder / "link").symlink_to(map_folder.parent)
    outside = map_folder.parent / "outside"
    save_map(outside, expected_map().state())
    there = sorted(path.name for path in map_folder.parent.rglob("*"))
    for service, names_of_files in (
        (names.SAVE_MAP, ["absent/map", "long" * 100]),
        (names.LOAD_MAP, ["absent", "junk", "other_grid"]),
    ):
        # None of these is a file in the map folder.
        astray = ["", "/dev/zero", "../outside", str(outside), "link/outside", "folder", "pipe"]
        for name in (*names_of_files, *astray):
            answer = module_probe.call(MapFile, service, MapFile.Request(path=name))
            assert not answer.success, (service, name)
            assert len(answer.message) > 10, (service, name, answer.message)
    np.testing.assert_array_equal(motion_map(module_probe), before)
    assert (map_folder / "pipe").is_fifo()
    assert sorted(path.name for path in map_folder.parent.rglob("*")) == there


def test_the_map_folder_of_a_running_mapper_stays(
    module_probe: Probe, mapper: NodeProcess
) -> None:
    parameter = Parameter("map_folder", value="/").to_parameter_msg()
    response = module_probe.call(
        SetParameters,
        f"{names.MAPPER_NODE}/set_parameters",
        SetParameters.Request(parameters=[parameter]),
    )
    assert not response.results[0].successful
    assert "map_folder" in response.results[0].reason
