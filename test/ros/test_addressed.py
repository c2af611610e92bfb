# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Misspelt names of nodes in parameter files and rules, which ROS passes over in silence."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzy_map_building.ros.addressed import MAX_FILE_SIZE, Addressed, section_parameters
from ros.harness import NodeProcess

PARAMETERS = "{ros__parameters: {mode: continuous}}"


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], str]:
    def write(content: str) -> str:
        file = tmp_path / "params.yaml"
        file.write_text(content)
        return str(file)

    return write


def addressed(*arguments: str) -> Addressed:
    return Addressed(["mapper", "--ros-args", *arguments])


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("fuzzy_maper", "fuzzy_mapper"),
        ("/fuzzymapper", "fuzzy_mapper"),
        ("/robot/fuzzy_planer", "fuzzy_planner"),
        ("fuzzy_moton", "fuzzy_motion"),
        ("nomad_sym", "nomad_sim"),
        ("Fuzzy_Mapper", "fuzzy_mapper"),
    ],
)
def test_a_name_that_is_nearly_one_of_ours_is_refused(
    write: Callable[[str], str], name: str, meant: str
) -> None:
    message = f"no node '{name.rpartition('/')[2]}'; did you mean '{meant}'"
    path = write(f"fuzzy_mapper: {PARAMETERS}\n{name}: {PARAMETERS}")
    with pytest.raises(ValueError, match=rf"--params-file {path}: there is {message}"):
        addressed("--params-file", path)
    for rule in (["-p", f"{name}:mode:=continuous"], ["-r", f"{name}:pose:=/other"]):
        with pytest.raises(ValueError, match=message):
            addressed(*rule)


@pytest.mark.parametrize(
    "content",
    [
        f"fuzzy_mapper: {PARAMETERS}",
        f"/**: {PARAMETERS}",
        f"/robot/*: {PARAMETERS}",
        f"robot: {{fuzzy_mapper: {PARAMETERS}}}",
        # Of other nodes, ours or not, and of second ones of ours.
        f"fuzzy_planner: {PARAMETERS}\nnomad_sim: {PARAMETERS}",
        f"fuzzy_mapper: {PARAMETERS}\nplanner_server: {PARAMETERS}\namcl: {PARAMETERS}",
        f"fuzzy_mapper: {PARAMETERS}\nfuzzy_mapper_left: {PARAMETERS}",
    ],
)
def test_files_for_several_nodes_and_wildcards_are_nobodys_mistake(
    write: Callable[[str], str], content: str
) -> None:
    for node in ("fuzzy_mapper", "fuzzy_planner"):
        assert addressed("--params-file", write(content)).unheard(node) == []


def test_an_empty_file_says_so(write: Callable[[str], str]) -> None:
    (told,) = addressed("--params-file", write("# nothing")).unheard("fuzzy_mapper")
    assert told.endswith(" is empty")


def test_a_node_under_another_name_is_known_by_it(write: Callable[[str], str]) -> None:
    path = write(f"mapster: {PARAMETERS}\nfuzzy_maps: {PARAMETERS}")
    with pytest.raises(ValueError, match="no node 'fuzzy_maps'"):
        addressed("--params-file", path, "-r", "__node:=mapster")
    renamed = addressed("--params-file", path, "-r", "fuzzy_mapper:__node:=fuzzy_maps")
    assert renamed.unheard("fuzzy_maps") == []
    assert "only for '/mapster', '/fuzzy_maps'" in renamed.unheard("fuzzy_mapper")[0]


def test_rules_that_name_no_node_are_left_alone() -> None:
    addressed("-p", "mode:=continuous", "-r", "pose:=/fuzzy_maper:x", "-r", "rostopic://pose:=/a")
    addressed("-p", "fuzzy_mapper:preset:=a:b", "-r", "__ns:=/fuzzy_maper")


def test_names_with_their_namespaces(write: Callable[[str], str]) -> None:
    content = f"/**: {PARAMETERS}\na: {{b: {{c: {PARAMETERS}}}, /d: {PARAMETERS}}}"
    assert list(section_parameters(write(content))) == ["/**", "/a/b/c", "/a/d"]
    assert section_parameters(write("# nothing")) == {}


def test_the_origin_of_a_refused_parameter_is_the_last_that_gave_it(
    write: Callable[[str], str],
) -> None:
    path = write(
        "/**: {ros__parameters: {robot_radius: 9.0, area: {size_x: 1.0}}}\n"
        "/**/fuzzy_motion: {ros__parameters: {beta: 0.2}}\n"
    )
    file = f"--params-file {path}"
    given = addressed("--params-file", path)
    reason = "parameter 'robot_radius' must be at most 5.0 m, got 9.0"
    assert given.origin(reason, "fuzzy_planner") == f" ({file}, section '/**')"
    assert given.origin("parameter 'area.size_x' is bad", "a") == f" ({file}, section '/**')"
    assert (
        given.origin("'beta' is bad", "fuzzy_motion") == f" ({file}, section '/**/fuzzy_motion')"
    )
    assert given.origin("'beta' is bad", "fuzzy_planner") == ""
    assert given.origin("'bta' is unknown; did you mean 'beta'?", "fuzzy_motion") == ""
    given = addressed("--params-file", path, "-p", "robot_radius:=8.0")
    assert given.origin(reason, "fuzzy_planner") == " (-p robot_radius:=8.0)"
    given = addressed("-p", "robot_radius:=8.0", "--params-file", path)
    assert given.origin(reason, "fuzzy_planner") == f" ({file}, section '/**')"
    given = addressed("--params-file", path, "-p", "fuzzy_motion:robot_radius:=8.0")
    assert given.origin(reason, "fuzzy_planner") == f" ({file}, section '/**')"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("a: [", "is no YAML"),
        ("- 1", "mapping of node names"),
        ("a: &a {ros__parameters: {}}\nb: *a", "aliases"),
        ("a: 1" + ":0" * 200, "too large|needs the key"),
        ("a: 1", "'a' needs the key 'ros__parameters'"),
        ("a:\n  ros__parameters:\n    b: 1\n    b: 2\n", ".yaml: line 4: 'b' is repeated"),
        ("a: {ros__parameters: {}}\na: {ros__parameters: {}}", "line 2: 'a' is repeated"),
        ("!!map a", "is no YAML"),
        ("? [a]\n: 1", "is no YAML"),
        ("a: {ros__parameters: 1}", "must hold parameters by name"),
        ("a: " + "{b: " * 3000, "nested too deeply"),
        ("# " + MAX_FILE_SIZE * "x", "longer than"),
    ],
)
def test_what_is_no_parameter_file(
    write: Callable[[str], str], content: str, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        section_parameters(write(content))


def test_nobody_waits_at_a_pipe_for_parameters(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.yaml"
    os.mkfifo(pipe)
    with pytest.raises(ValueError, match=r"pipe\.yaml: a pipe is no parameter file"):
        addressed("--params-file", str(pipe))


def test_a_node_refuses_a_file_with_a_misspelt_node(
    start_node: Callable[..., NodeProcess], write: Callable[[str], str]
) -> None:
    path = write(f"fuzzy_maper: {PARAMETERS}")
    process = start_node("mapper", arguments=["--ros-args", "--params-file", path])
    assert process.wait() == 2
    assert process.output() == (
        f"fuzzy_mapper: cannot start: --params-file {path}: there is no node 'fuzzy_maper'; "
        "did you mean 'fuzzy_mapper'?\n"
    )


def test_a_node_says_what_a_file_lacks_in_its_own_words(
    start_node: Callable[..., NodeProcess], write: Callable[[str], str]
) -> None:
    path = write("fuzzy_mapper: {mode: continuous}")
    process = start_node("mapper", arguments=["--ros-args", "--params-file", path])
    assert process.wait() == 2
    assert process.output() == (
        f"fuzzy_mapper: cannot start: {path}: 'fuzzy_mapper' needs the key 'ros__parameters' "
        "above its parameters, such as 'mode'\n"
    )


def test_a_node_that_no_section_of_a_file_speaks_to_says_so(
    start_node: Callable[..., NodeProcess], write: Callable[[str], str]
) -> None:
    path = write(f"mapper: {PARAMETERS}")
    process = start_node("planner", arguments=["--ros-args", "--params-file", path])
    process.wait_for_output(f"{path} has no section for 'fuzzy_planner', only for '/mapper'")
