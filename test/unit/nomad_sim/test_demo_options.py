# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The demonstration's command line: what it takes, and what it refuses before it starts."""

from pathlib import Path

import pytest

from nomad_sim.ros.demo_options import DEFAULT_RATE, DemoOptions, parse_options

#: A room with a cell that nothing leads into.
ROOM = """
name: room
area: {origin: [0.0, 0.0], size: [3.0, 2.0]}
start: {position: [0.75, 1.0]}
goal: {position: [1.5, 1.0]}
expected: reached
walls:
  - {material: painted_wall, closed: true, points: [[0, 0], [3, 0], [3, 2], [0, 2]]}
  - {material: painted_wall, points: [[2.0, 0], [2.0, 2]]}
circles:
  - {material: wood, center: [2.75, 0.25], radius: 0.1}
"""


@pytest.fixture
def room(tmp_path: Path) -> Path:
    file = tmp_path / "room.yaml"
    file.write_text(ROOM)
    return file


def parse(folder: Path, *arguments: object) -> DemoOptions:
    given = ["--world", folder / "room.yaml", "--output", folder / "out", *arguments]
    return parse_options([str(a) for a in given])


def test_defaults_are_the_laboratory_of_experiment_1(tmp_path: Path) -> None:
    options = parse_options(["--output", str(tmp_path)])
    assert options.world.name == "lab"
    assert (options.seed, options.rate, options.lockstep) == (0, DEFAULT_RATE, True)
    assert (options.expected, options.preset) == (("reached",), "consistent")


def test_options_are_taken_over(room: Path, tmp_path: Path) -> None:
    options = parse(tmp_path, "--start", 0.5, 0.5, 1.5, "--seed", 4, "--no-lockstep", "--rate", 0)
    start = options.world.start
    assert (start.x, start.y, start.theta) == (0.5, 0.5, 1.5)
    assert options.world.goal == (1.5, 1.0)
    assert (options.seed, options.lockstep, options.rate) == (4, False, 0.0)
    assert options.world_source == str(room)
    assert (tmp_path / "out").is_dir()


def test_the_true_verdict_is_that_of_the_goal_asked_for(room: Path, tmp_path: Path) -> None:
    assert room.exists()
    assert parse(tmp_path).expected == ("reached",)
    assert parse(tmp_path, "--goal", 0.5, 0.5).expected == ("reached",)
    assert parse(tmp_path, "--goal", 2.5, 1.0).expected == ("unreachable",)
    # From within the cell it is the other way round.
    assert parse(tmp_path, "--start", 2.5, 1.0, 0).expected == ("unreachable",)
    assert parse(tmp_path, "--start", 2.5, 1.0, 0, "--goal", 2.5, 0.5).expected == ("reached",)
    # A corner where the body has 3 cm left as near as the goal's tolerance asks for.
    assert parse(tmp_path, "--goal", 0.05, 0.05).expected == ("reached", "unreachable")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--world", "labb"], "did you mean 'lab'?"),
        (["--world", "missing.yaml"], "missing.yaml"),
        (["--goal", "3.5", "1"], r"--goal \(3.5, 1\) m lies outside the area of world 'room'"),
        (["--start", "-1", "1", "0"], r"--start \(-1, 1\) m lies outside"),
        (["--start", "0.1", "1", "0"], r"cannot start at \(0.1, 1\)"),
        (["--goal", "2.7", "0.3"], r"--goal \(2.7, 0.3\) m lies in an obstacle of world 'room'"),
        (["--start", "2.7", "0.3", "0"], r"cannot start at \(2.7, 0.3\)"),
        (["--output", ""], "--output"),
        (["--output", "/proc"], "--output /proc: "),
        (["--rate", "-1"], "'rate' must be at least 0"),
        (["--seed", "-1"], "'seed' must be at least 0"),
        (["--preset", "oriolo"], "did you mean 'oriolo1998'?"),
        (["--preset", "map_building"], "map_building"),  # none of the planner's
        (["--params-file", "none.yaml"], "none.yaml: No such file"),
        (["--output", "room.yaml/out"], "room.yaml/out: cannot make this folder: Not a directory"),
    ],
)
def test_what_cannot_be_is_refused(
    room: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(room.parent)
    with pytest.raises(ValueError, match=message):
        parse(room.parent, *arguments)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("fuzzy_maper: {ros__parameters: {}}", "unknown node.*did you mean 'fuzzy_mapper'"),
        ("a: [", "is no YAML"),
        ("- 1", "mapping of node names"),
        ("", "is empty"),
        ("fuzzy_mapper: {mode: continuous}", "needs the key 'ros__parameters'"),
    ],
)
def test_parameter_files_that_ros_would_not_use_are_refused(
    room: Path, content: str, message: str
) -> None:
    file = room.parent / "params.yaml"
    file.write_text(content)
    with pytest.raises(ValueError, match=message):
        parse(room.parent, "--params-file", file)


def test_an_area_too_large_for_the_mapper_is_refused(room: Path) -> None:
    room.write_text(ROOM.replace("size: [3.0, 2.0]", "size: [999, 999]"))
    with pytest.raises(ValueError, match="9990 x 9990 cells exceeds the limit of"):
        parse(room.parent)
    file = room.parent / "params.yaml"
    file.write_text("fuzzy_mapper: {ros__parameters: {area.resolution: 1.0}}")
    assert parse(room.parent, "--params-file", file).world.size == (999.0, 999.0)


def test_parameter_files_for_any_node_are_taken(room: Path) -> None:
    file = room.parent / "params.yaml"
    file.write_text(
        "/**: {ros__parameters: {a: 1}}\n/robot/fuzzy_motion: {ros__parameters: {beta: 0.8}}"
    )
    assert parse(room.parent, "--params-file", file).params_file == file


@pytest.mark.parametrize(
    "arguments",
    [
        ["--rate", "nan"],
        ["--goal", "1"],
        ["--goal", "inf", "1"],
        ["--timeout", "0"],
        ["--domain", "102"],
        ["--unknown"],
    ],
)
def test_a_command_line_that_cannot_be_read_ends_with_2(
    room: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        parse(room.parent, *arguments)
    assert end.value.code == 2
    assert "usage:" in capsys.readouterr().err
