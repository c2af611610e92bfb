# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Saving and loading a map that takes long: the mapper goes on meanwhile."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from fuzzy_msgs.action import BuildMap
from fuzzy_msgs.srv import MapFile
from rclpy.task import Future
from std_srvs.srv import Trigger

from fuzzy_map_building.map_io import load_map
from fuzzy_map_building.ros import names
from fuzzy_map_building.types import Pose2
from ros.fake_robot import FakeRobot
from ros.harness import NodeProcess, Probe, wait_until
from ros.stack import Status

#: Files take as long as those of a large map do, until the folder has a file `go_on`.
SLOW = """
import pathlib, time
from fuzzy_map_building.ros import map_services
def slow(work):
    def wait(file, what):
        pathlib.Path(str(file) + ".begun").touch()
        if file.name == "full":
            raise OSError(28, "No space left on device", "full")
        while not (pathlib.Path(file).parent / "go_on").exists():
            time.sleep(0.01)
        return work(file, what)
    return wait
map_services.save_map = slow(map_services.save_map)
map_services.load_map = slow(map_services.load_map)
"""


def test_the_mapper_goes_on_while_a_file_is_written_and_read(
    probe: Probe, start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    patient = dict.fromkeys(["turret.timeout", "perception.timeout"], 60.0)
    status = Status(probe, names.MAPPER_NODE)
    start_node("mapper", parameters={"map_folder": str(tmp_path), **patient}, patch=SLOW)
    robot = FakeRobot(probe, Pose2(3.0, 3.0), lambda sensor, angle: 1.0 + 0.1 * sensor)
    client = probe.action_client(BuildMap, names.BUILD_MAP)

    def perceive() -> int:
        handle = probe.send_goal(client, BuildMap.Goal())
        return int(probe.result_of(handle.get_result_async()).result.perception)

    def ask(service: str, file: str = "") -> Future:
        """Send a request, and wait until its file is being worked on."""
        kind = MapFile if file else Trigger
        caller = probe.node.create_client(kind, service)
        assert caller.wait_for_service(30.0)
        request = MapFile.Request(path=file) if file else Trigger.Request()
        future = probe.run(lambda: caller.call_async(request))
        if file:
            begun = tmp_path / f"{file}.begun"
            wait_until(begun.exists, f"the work on {file}")
            begun.unlink()
        return future

    def let_go(*futures: Future) -> list[str]:
        (tmp_path / "go_on").touch()
        wait_until(lambda: all(f.done() for f in futures), "the answers")
        (tmp_path / "go_on").unlink()
        return [f.result().message for f in futures]

    assert perceive() == 1
    saving = ask(names.SAVE_MAP, "one")
    assert perceive() == 2  # while the first map is written
    reset = ask(names.RESET_MAP)
    time.sleep(0.3)
    assert not saving.done()
    assert not reset.done()  # one after the other
    told = let_go(saving, reset)
    assert told == [f"1 perception saved to {tmp_path / 'one'}", "the map is empty"]
    saved = load_map(tmp_path / "one")
    assert saved.perceptions == saved.count.max() == 1

    assert perceive() == 1
    assert perceive() == 2
    loading = ask(names.LOAD_MAP, "one")
    assert perceive() == 3  # of the map that the loaded one replaces
    assert let_go(loading) == [f"1 perception loaded from {tmp_path / 'one'}"]
    again = ask(names.SAVE_MAP, "again")
    let_go(again)
    loaded = load_map(tmp_path / "again")
    for name in ("empty", "occupied", "count"):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(saved, name))
    assert perceive() == 2

    (tmp_path / "damaged").write_bytes(b"no map")
    assert "no map file" in let_go(ask(names.LOAD_MAP, "damaged"))[0]
    assert perceive() == 3
    robot.close()

    # Each kind of refusal in words, counted under a word of its own.
    (tmp_path / "go_on").touch()
    for path, word, told in (
        ("damaged", "unusable_file", "it is no map file"),
        ("~/one", "bad_name", "does not stand for a home"),
        ("absent", "bad_name", "there is no file"),
        ("full", "file_system", "No space left on device"),
    ):
        service = names.SAVE_MAP if path == "full" else names.LOAD_MAP
        answer = probe.call(MapFile, service, MapFile.Request(path=path))
        assert not answer.success
        assert told in answer.message
        assert "Errno" not in answer.message
        key = f"rejected.{service}.{word}"
        status.wait(lambda values, key=key: key in values, key)
