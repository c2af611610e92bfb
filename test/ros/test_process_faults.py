# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""kill -9 of nodes in the middle of a mission: what is left, and what comes back."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
from fuzzy_msgs.action import Navigate
from fuzzy_msgs.srv import MapFile
from geometry_msgs.msg import PoseStamped
from std_srvs.srv import Trigger

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_io import load_map, save_map
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.ros import names, qos
from nomad_sim.ros.sim_node import TICK
from ros.harness import START_DEADLINE, NodeProcess, Probe, wait_until
from ros.motion_scene import goal_at
from ros.room import stamp
from ros.stack import Status, silent, speeds
from ros.test_bringup import children

Start = Callable[..., NodeProcess]

#: Wait of a tick for its command [s of wall time].
LOCKSTEP_TIMEOUT = 2.0


def test_killed_nodes_come_back_and_the_robot_stands_meanwhile(
    probe: Probe, start_node: Start
) -> None:
    mapper, planner = Status(probe, names.MAPPER_NODE), Status(probe, names.PLANNER_NODE)
    truth = probe.subscribe(PoseStamped, names.GROUND_TRUTH_POSE, qos.RELIABLE)
    given = {"world": "lab", "rate": 8, "lockstep": True, "lockstep_timeout": LOCKSTEP_TIMEOUT}
    start_node("sim", parameters=given)
    arguments = ["--respawn", "--ros-args", "-p", "use_sim_time:=true"]
    bringup = start_node("bringup", arguments=arguments)
    client = probe.action_client(Navigate, names.NAVIGATE)
    truth.wait_for(timeout=START_DEADLINE)
    planner.wait(lambda _: True, "the planner")
    feedback: list[Navigate.Feedback] = []
    goal = Navigate.Goal(goal=goal_at(6.3, 1.3))
    probe.send_goal(client, goal, lambda message: feedback.append(message.feedback))
    made = mapper.wait(lambda v: int(v["snapshot_perceptions"]) >= 1, "a snapshot")

    # The mapper: its map comes back, the mission goes on with it.
    mapper.forget()
    os.kill(children(bringup.pid)["mapper"], signal.SIGKILL)
    back = mapper.wait(lambda v: int(v["perceptions"]) >= 1, "the map of before")
    assert int(back["perceptions"]) >= int(made["snapshot_perceptions"])
    bringup.wait_for_output("mapper was killed by SIGKILL; it will be started anew in 0.5 s")
    bringup.wait_for_output("went on from")
    known = int(back["perceptions"])
    wait_until(lambda: feedback[-1].perceptions > known, "the mission to go on")

    # The motion: the robot stands.
    truth.clear()
    victim = children(bringup.pid)["motion"]
    wait_until(lambda: any(v > 0.2 for _, v in speeds(truth.messages[-3:])), "the drive")
    os.kill(victim, signal.SIGKILL)
    # In lockstep the simulator now waits for the answer to its last pose. What motion had said
    # was not later than that, whether or not it came to say it by both of its topics.
    wait_until(lambda: silent(truth, LOCKSTEP_TIMEOUT / 3), "the simulator to wait")
    gone = stamp(truth.last)
    truth.wait_for(lambda message: stamp(message) > gone + 2.0)
    after = [(t, v) for t, v in speeds(truth.messages) if t > gone + TICK / 2]
    assert after[0][1] > 0.05, "it did not drive: the test is void"
    assert max(v for t, v in after if t > gone + 0.5 + TICK / 2) == 0.0
    bringup.assert_clean_stop()


def _state(geometry: GridGeometry, perceptions: int) -> MapState:
    half = np.full(geometry.shape, 0.5)
    count = np.full(geometry.shape, perceptions, dtype=np.int32)
    return MapState(geometry, half, half.copy(), count, perceptions)


def test_snapshots_that_are_refused_and_those_that_were_replaced(
    probe: Probe, start_node: Start, tmp_path: Path
) -> None:
    geometry = mapper_parameters().area.geometry()
    saved = {n: str(tmp_path / f"{n}.map") for n in (3, 5)}
    for perceptions, path in saved.items():
        save_map(path, _state(geometry, perceptions))
    file = tmp_path / "folder" / "s.map"
    file.parent.mkdir()
    save_map(file, _state(geometry, 7))
    status = Status(probe, names.MAPPER_NODE)
    given = {"snapshot.file": str(file), "snapshot.period": 3600.0}
    mapper = start_node("mapper", parameters=given)
    # One that does not tell with which parameters it was made is told of and kept.
    said = status.wait(lambda v: v.get("rejected.snapshot.refused") == "1", "the refusal")
    assert said["perceptions"] == "0"
    assert load_map(file.with_name("s.map.refused")).perceptions == 7
    assert "the map begins empty" in mapper.output()
    # What a load or a reset has replaced is gone when the answer is there.
    for perceptions, path in saved.items():
        assert probe.call(MapFile, names.LOAD_MAP, MapFile.Request(path=path)).success
        wait_until(file.exists, "the snapshot", step=0.001)
        assert load_map(file).perceptions == perceptions
    assert probe.call(Trigger, names.RESET_MAP, Trigger.Request()).success
    assert not file.exists() or load_map(file).perceptions == 0
    mapper.assert_clean_stop()
    assert load_map(file).perceptions == 0
    assert sorted(os.listdir(file.parent)) == ["s.map", "s.map.refused"]


def test_a_snapshot_that_cannot_be_is_refused_at_the_start(start_node: Start) -> None:
    mapper = start_node("mapper", parameters={"snapshot.file": "/no/such/folder/s.map"})
    assert mapper.wait() == 2
    reason = "parameter 'snapshot.file': there is no folder '/no/such/folder'"
    assert reason in mapper.output()
