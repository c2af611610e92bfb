# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The demonstration as a user runs it, in a room small enough to be quick."""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from matplotlib.image import imread

from fuzzy_map_building.params import mapper_parameters
from nomad_sim.world_io import load_world
from ros.harness import NodeProcess, wait_until

ROOM = """
name: room
area: {{origin: [0.0, 0.0], size: [3.0, 2.4]}}
start: {{position: [0.75, 1.25], heading_deg: 0.0}}
goal: {{position: [2.25, 1.25]}}
expected: {expected}
walls:
  - material: painted_wall
    closed: true
    points: [[-0.05, -0.05], [3.05, -0.05], [3.05, 2.45], [-0.05, 2.45]]
"""
#: Marks every process of a demonstration, however far from it in the tree.
MARK = "DEMO_TEST"
#: Long enough for the first start on a machine, which compiles.
LONG = 110.0

Start = Callable[..., NodeProcess]


@pytest.fixture
def room(tmp_path: Path) -> Path:
    # A name that needs quoting wherever it passes a command line or YAML.
    file = tmp_path / "it's a room.yaml"
    file.write_text(ROOM.format(expected="reached"))
    return file


@pytest.fixture
def demo(start_node: Start, tmp_path: Path) -> Callable[..., NodeProcess]:
    """Start the demonstration with arguments; results go to the folder ``out``."""

    def start(*arguments: object) -> NodeProcess:
        given = ["--output", str(tmp_path / "out"), *map(str, arguments)]
        return start_node("demo", arguments=given, environment={MARK: str(tmp_path)})

    return start


def marked(folder: Path) -> dict[int, str]:
    """Return the command lines of all processes of the demonstration by id."""
    found = {}
    for process in Path("/proc").iterdir():
        try:
            environment = (process / "environ").read_bytes().split(b"\0")
            if f"{MARK}={folder}".encode() in environment:
                line = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                if line:  # a zombie has none
                    found[int(process.name)] = line
        except (OSError, ValueError):
            continue  # not a process, ended meanwhile, or another user's
    return found


def assert_nothing_left(folder: Path) -> None:
    wait_until(lambda: not marked(folder), f"the end of {marked(folder)}")


def moving(demo: NodeProcess) -> None:
    """Wait until the first perception has been told of."""
    demo.wait_for_output("perception   1 at", LONG)


def test_it_reaches_the_goal_and_leaves_figures_and_a_summary(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "perception_99.png").write_text("of an earlier run")
    params = tmp_path / "my parameters.yaml"
    params.write_text("/**/fuzzy_mapper: {ros__parameters: {evidence.visibility_radius: 1.25}}")
    process = demo("--world", room, "--seed", 3, "--params-file", params)
    assert process.wait(LONG) == 0, process.output()
    assert_nothing_left(tmp_path)

    summary: dict[str, Any] = json.loads((out / "summary.json").read_text())
    world = load_world(room)
    assert summary["success"] is True
    assert (summary["verdict"], summary["expected_verdict"]) == ("reached", "reached")
    assert (summary["seed"], summary["preset"], summary["contacts"]) == (3, "consistent", 0)
    assert summary["goal"] == [2.25, 1.25]
    # The straight way is 1.5 m long, and 0.3 m before its end is good enough.
    assert 1.1 < summary["path_length_m"] < 4.0
    assert summary["shortest_path_m"] == pytest.approx(1.5)
    assert summary["simulated_duration_s"] > summary["path_length_m"] / 0.6
    assert 0.0 < summary["least_true_clearance_m"] < world.still.distance(0.75, 1.25)

    log = summary["log"]
    assert [entry["perception"] for entry in log] == list(range(1, summary["perceptions"] + 1))
    assert (log[0]["x"], log[0]["y"]) == pytest.approx((0.75, 1.25))
    assert log[0]["stopped_by"] == "none"
    assert all(e["stopped_by"] in ("unexplored", "clearance") for e in log[1:])
    assert [e["stamp_s"] for e in log] == sorted(e["stamp_s"] for e in log)
    # However long the simulator has run before, times begin with the goal.
    (sent,) = {round(e["stamp_s"] - e["since_goal_s"], 3) for e in log}
    assert 1.0 < sent < log[0]["stamp_s"]
    lines = [line for line in process.output().splitlines() if line.startswith("perception")]
    for entry, line in zip(log, lines, strict=True):
        why = f"stopped by {entry['stopped_by']} +alpha"
        if entry["stopped_by"] == "none":
            why = "at the start, "
        told = rf"perception +{entry['perception']} at +{entry['since_goal_s']:.2f} s, .* m: {why}"
        assert re.match(told, line)

    # The mapped area is the world's, the file counts, everything else is the preset's.
    used = summary["parameters"]["fuzzy_mapper"]
    assert (used["area.size_x"], used["area.size_y"]) == (3.0, 2.4)
    assert used["evidence.visibility_radius"] == 1.25
    assert used["evidence.k_empty"] == mapper_parameters().evidence.k_empty
    assert set(summary["parameters"]) == {
        "nomad_sim",
        "fuzzy_mapper",
        "fuzzy_planner",
        "fuzzy_motion",
    }
    assert summary["parameters"]["nomad_sim"]["world"] == str(room)

    figures = {file.name for file in out.glob("*.png")}
    assert figures == set(summary["figures"])
    assert f"perception_{summary['perceptions']:02d}.png" in figures
    for name in figures:
        picture = imread(out / name)
        assert min(picture.shape[:2]) > 300
        assert picture.std() > 0.1  # something is on it


def test_a_robot_without_infrareds_gets_there(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    nodes = ("nomad_sim", "fuzzy_mapper", "fuzzy_motion")
    none = "{ros__parameters: {infrared.frame_ids: [], infrared.bearings: []}}"
    params = tmp_path / "sonars.yaml"
    params.write_text("".join(f"/**/{node}: {none}\n" for node in nodes))
    process = demo("--world", room, "--params-file", params)
    assert process.wait(LONG) == 0, process.output()
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (summary["verdict"], summary["contacts"]) == ("reached", 0)
    for node in nodes:
        assert summary["parameters"][node]["infrared.frame_ids"] == []


def test_a_wrong_verdict_is_no_success(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    room.write_text(ROOM.format(expected="unreachable"))
    params = tmp_path / "paper.yaml"
    params.write_text("/**: {ros__parameters: {preset: oriolo1998}}")
    process = demo("--world", room, "--no-lockstep", "--rate", 1, "--params-file", params)
    assert process.wait(LONG) == 1, process.output()
    assert "REACHED (true: unreachable)" in process.output()
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["success"] is False
    # What a section for all nodes says counts, and the simulator, which has no presets, runs.
    used = summary["parameters"]
    assert {name: p.get("preset") for name, p in used.items()} == {
        "nomad_sim": None,
        "fuzzy_mapper": "oriolo1998",
        "fuzzy_planner": "oriolo1998",
        "fuzzy_motion": "oriolo1998",
    }
    assert used["fuzzy_motion"]["layer.enabled"] is used["fuzzy_planner"]["layer.enabled"] is False
    assert (
        "there are no presets here: 'oriolo1998' is not used"
        in (tmp_path / "out" / "logs" / "sim.log").read_text()
    )


def test_no_verdict_in_time_is_no_success(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    process = demo("--world", room, "--rate", 1, "--timeout", 2)
    assert process.wait(LONG) == 1, process.output()
    assert "no verdict within 2 s" in process.output()
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["verdict"] is None
    assert_nothing_left(tmp_path)


def test_ctrl_c_on_the_way_leaves_nothing_behind(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    process = demo("--world", room, "--rate", 1)
    moving(process)
    assert len(marked(tmp_path)) >= 5
    process.send(signal.SIGINT)
    assert process.wait() == 130
    assert "Traceback" not in process.output()
    assert_nothing_left(tmp_path)


def test_a_termination_at_the_start_leaves_nothing_behind(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    process = demo("--world", room)
    process.wait_for_output("to watch:", LONG)
    process.send(signal.SIGTERM)
    assert process.wait() == 130
    assert_nothing_left(tmp_path)


def test_a_node_that_dies_ends_it(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    process = demo("--world", room)
    planner = wait_until(
        lambda: [pid for pid, line in marked(tmp_path).items() if "planner_node" in line],
        "the planner",
        LONG,
    )
    os.kill(planner[0], signal.SIGKILL)
    assert process.wait() == 3
    assert "planner was killed by SIGKILL" in process.output()
    assert_nothing_left(tmp_path)


def test_a_parameter_that_a_node_refuses_ends_it(
    demo: Callable[..., NodeProcess], room: Path, tmp_path: Path
) -> None:
    params = tmp_path / "params.yaml"
    params.write_text("fuzzy_planner: {ros__parameters: {epsilom: 0.1}}")
    process = demo("--world", room, "--params-file", params)
    assert process.wait(LONG) == 2
    assert process.output() == (
        "fuzzy_planner: cannot start: unknown parameter 'epsilom'; did you mean 'epsilon'? "
        f"(--params-file {params}, section '/fuzzy_planner')\n"
    )
    assert_nothing_left(tmp_path)


def test_what_cannot_be_is_refused_in_one_line(start_node: Start, tmp_path: Path) -> None:
    process = start_node("demo", arguments=["--output", str(tmp_path / "out"), "--world", "labb"])
    assert process.wait(LONG) == 2
    assert process.output() == "demo: unknown world 'labb'; did you mean 'lab'?\n"
    assert not (tmp_path / "out").exists()
