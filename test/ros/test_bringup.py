# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bringup: three nodes that start together and end together."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticArray

from fuzzy_map_building.ros import names, qos
from fuzzy_navigation.ros.bringup import NODES, main, node_commands
from ros.harness import NodeProcess, Probe, Received, wait_until

STARTED = {names.MAPPER_NODE, names.PLANNER_NODE, names.MOTION_NODE}


def children(pid: int) -> dict[str, int]:
    """Return the ids of the nodes that a process has started, by name."""
    out: dict[str, int] = {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            command = (entry / "cmdline").read_bytes().decode()
        except (OSError, ValueError):
            continue
        for name, (module, _) in NODES.items():
            if parent == pid and module in command:
                out[name] = int(entry.name)
    return out


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


class Robot:
    """A bringup and the diagnostics of its nodes."""

    def __init__(
        self, probe: Probe, start_node: Callable[..., NodeProcess], *arguments: str, ns: str = ""
    ) -> None:
        self.diagnostics: Received[DiagnosticArray] = probe.subscribe(
            DiagnosticArray, ns + names.DIAGNOSTICS, qos.RELIABLE
        )
        self.process = start_node("bringup", arguments=list(arguments))

    def heard(self) -> set[str]:
        return {status.name for array in self.diagnostics.messages for status in array.status}

    def wait(self) -> dict[str, int]:
        """Wait until all nodes run; return their process ids."""
        wait_until(lambda: self.heard() == STARTED, f"all nodes, of {self.heard()}", 60.0)
        nodes = children(self.process.pid)
        assert nodes.keys() == NODES.keys()
        return nodes


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_all_of_them(
    probe: Probe, start_node: Callable[..., NodeProcess], number: signal.Signals
) -> None:
    robot = Robot(probe, start_node)
    nodes = robot.wait()
    robot.process.wait_for_output("bringup: started mapper, planner, motion")
    robot.process.assert_clean_stop(number)
    assert not any(map(alive, nodes.values()))


def test_who_cannot_be_told_anything_still_has_a_robot_that_works(
    probe: Probe, start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    (tmp_path / "bringup_0.log").symlink_to("/dev/full")  # where it writes to: a disk without room
    robot = Robot(probe, start_node, "--respawn")
    before = robot.wait()
    os.kill(before["planner"], signal.SIGKILL)
    wait_until(
        lambda: children(robot.process.pid).get("planner", before["planner"]) != before["planner"],
        "another planner",
        60.0,
    )
    robot.process.send(signal.SIGINT)
    assert robot.process.wait() == 0


def test_the_end_of_one_ends_all(probe: Probe, start_node: Callable[..., NodeProcess]) -> None:
    robot = Robot(probe, start_node)
    nodes = robot.wait()
    os.kill(nodes["planner"], signal.SIGKILL)
    assert robot.process.wait() == 1
    assert "planner was killed by SIGKILL; stopping the others" in robot.process.output()
    assert not any(map(alive, nodes.values()))


def test_nothing_is_left_when_bringup_itself_is_killed(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    robot = Robot(probe, start_node)
    nodes = robot.wait()
    robot.process.send(signal.SIGKILL)
    robot.process.wait()
    wait_until(lambda: not any(map(alive, nodes.values())), "the end of the nodes")


def test_a_signal_right_after_the_start_ends_all_of_them(
    start_node: Callable[..., NodeProcess],
) -> None:
    process = start_node("bringup")
    wait_until(lambda: len(children(process.pid)) == len(NODES), "the processes", 60.0)
    nodes = children(process.pid)
    process.assert_clean_stop(signal.SIGINT)
    assert not any(map(alive, nodes.values()))


def test_namespace_files_and_remappings_reach_the_nodes(
    probe: Probe, start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("/**/fuzzy_planner:\n  ros__parameters:\n    cost: g1\n")
    arguments = ["--preset", "oriolo1998", "--params-file", str(file), "--namespace", "robot1"]
    remap = ["--ros-args", "-r", "pose:=/localisation"]
    robot = Robot(probe, start_node, *arguments, *remap, ns="/robot1/")
    robot.wait()
    subscribers = probe.node.get_subscriptions_info_by_topic("/localisation")
    assert {info.node_name for info in subscribers} == {names.MAPPER_NODE, names.MOTION_NODE}
    planner = probe.node.get_service_names_and_types_by_node(names.PLANNER_NODE, "/robot1")
    assert "/robot1/plan_path" in {name for name, _ in planner}


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--preset", "oriol"], "unknown preset 'oriol'; did you mean 'oriolo1998'?"),
        (["--params-file", "nowhere.yaml"], "there is no parameter file 'nowhere.yaml'"),
        (["--perset", "x"], "unrecognized arguments: --perset"),
        (["--respawn", "0"], "must be at least 1, got 0"),
        (
            ["--ros-args", "-p", "coast:=g1"],
            "fuzzy_planner: cannot start: unknown parameter 'coast'",
        ),
    ],
)
def test_a_wrong_command_line_is_refused(
    start_node: Callable[..., NodeProcess], arguments: list[str], reason: str
) -> None:
    process = start_node("bringup", arguments=arguments)
    assert process.wait(60.0) == 2
    assert reason in process.output()
    assert "bringup: started" not in process.output()
    assert "Traceback" not in process.output()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (
            "fuzzy_mapper:\n  ros__parameters:\n\tmode: continuous\n",
            "it is no YAML document: line 3",
        ),
        ("fuzzy_maper: {ros__parameters: {}}", "there is no node 'fuzzy_maper'; did you mean"),
        (
            "fuzzy_mapper: {ros__parameters: {sonar.bearings: [0, 0.5]}}",
            "Sequence should be of same type. Value type 'double' do not belong at line_num 1",
        ),
    ],
)
def test_a_file_that_all_nodes_would_refuse_is_refused_once(
    start_node: Callable[..., NodeProcess], tmp_path: Path, content: str, reason: str
) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(content)
    process = start_node("bringup", arguments=["--params-file", str(file)])
    assert process.wait(60.0) == 2
    told = [line for line in process.output().splitlines() if "[rcl]" not in line]
    assert len(told) == 1
    assert told[0].startswith("bringup: ")
    assert reason in told[0]
    assert "/src/" not in told[0]  # where it came up in the sources of others


def test_what_nodes_would_refuse_is_told_before_any_is_started(
    start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(
        "/**/fuzzy_motion: {ros__parameters: {beta: 7.0}}\n"
        "/**/fuzzy_mapper: {ros__parameters: {sonar.mount_radius: far}}\n"
    )
    process = start_node("bringup", arguments=["--respawn", "--params-file", str(file)])
    started: dict[str, int] = {}
    while process.running:
        started |= children(process.pid)
    assert process.wait(60.0) == 2
    assert not started
    assert process.output().splitlines() == [
        "fuzzy_mapper: cannot start: parameter 'sonar.mount_radius' must be a number, got 'far' "
        f"(--params-file {file}, section '/**/fuzzy_mapper')",
        "fuzzy_motion: cannot start: parameter 'beta' must be at most 1.0, got 7.0 "
        f"(--params-file {file}, section '/**/fuzzy_motion')",
    ]


def test_a_planner_and_a_motion_that_do_not_agree_are_not_started(
    start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("/**/fuzzy_motion: {ros__parameters: {robot_radius: 0.2}}\n")
    process = start_node("bringup", arguments=["--params-file", str(file)])
    assert process.wait(60.0) == 2
    assert process.output().splitlines() == [
        "planner and motion do not agree: robot_radius is 0.23 in the planner and 0.2 in the "
        "motion; give both the same"
    ]


@pytest.mark.parametrize("namespace", ["a b", "1st", "a//b", "ä", "a/2", "/"])
def test_what_is_no_namespace_is_refused(namespace: str) -> None:
    with pytest.raises(ValueError, match="letters, digits, '_' and '/' between names"):
        node_commands(namespace=namespace)


def test_what_is_no_number_is_refused_in_plain_words(capsys: pytest.CaptureFixture[str]) -> None:
    for text in ("x", "1.5", ""):
        with pytest.raises(SystemExit):
            main(["--respawn", text])
        assert f"must be a whole number, got {text!r}" in capsys.readouterr().err


def test_each_node_gets_the_presets_that_it_knows(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.touch()
    commands = node_commands("lachekhab", [file], "/robot1/", ["-p", "use_sim_time:=true"])
    shared = ["--params-file", str(file), "-r", "__ns:=/robot1"]
    assert commands["mapper"][3:] == [
        "--ros-args",
        *shared,
        "-p",
        "preset:=lachekhab",
        "-p",
        "use_sim_time:=true",
    ]
    assert commands["planner"][3:] == ["--ros-args", *shared, "-p", "use_sim_time:=true"]
    assert all(len(command) == 3 for command in node_commands().values())


def test_a_snapshot_is_the_mappers_unless_a_file_names_another(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.touch()
    commands = node_commands("", [file], snapshot="/tmp/s.map")
    given = ["--ros-args", "-p", "snapshot.file:=/tmp/s.map", "--params-file", str(file)]
    assert commands["mapper"][3:] == given
    assert not any(
        "snapshot.file" in word for name in ("planner", "motion") for word in commands[name]
    )


def test_mapping_while_moving_is_for_mapper_and_motion_and_files_come_after(
    tmp_path: Path,
) -> None:
    file = tmp_path / "a.yaml"
    file.touch()
    commands = node_commands("", [file], concurrent=True)
    given = ["--params-file", str(file)]
    mapper = ("mode:=continuous", "fusion.max_count:=6", "consistency.max_offset:=0.2")
    settings = [word for setting in mapper for word in ("-p", setting)]
    assert commands["mapper"][3:] == ["--ros-args", *settings, *given]
    assert commands["planner"][3:] == ["--ros-args", *given]
    assert commands["motion"][3:] == ["--ros-args", "-p", "concurrent:=true", *given]
