# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""README.md: every block in it is run as it stands, every name in it exists."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python

from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.ros import names, qos
from nomad_sim.ros.demo_options import parse_options
from nomad_sim.ros.domain import DOMAINS, RESERVED
from nomad_sim.world_io import load_world
from ros.harness import EXECUTABLES, NodeProcess, Probe, command_of, wait_until

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)
#: Longest run of a command on a busy machine [s].
LONG = 280.0

Start = Callable[..., NodeProcess]


def blocks(language: str) -> list[str]:
    return [text for kind, text in BLOCKS if kind == language]


#: What a reader types into a shell, line by line.
LINES = [line for text in blocks("sh") for line in text.splitlines()]
CAMPAIGNS = [line for line in LINES if "/campaign " in line]
STUDIES = [line for line in LINES if line.startswith("python3 test/")]
SIMULATORS = [line for line in LINES if line.endswith("/sim")]
BRINGUPS = [line for line in LINES if "/bringup " in line]
DEMOS = [line for line in LINES if line.startswith("make demo")]
PACKAGES = [line for line in LINES if "apt-get install" in line]
TESTS = [line for line in LINES if line == "make test"]
INSTALLATIONS = [line for line in LINES if "pip install" in line]
#: Variables by which a make that these tests run in would change those that they start.
OUTER = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "DEMO_ARGS", "TEST_ARGS", "PYTHON")


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that looks like the built clone, but where what is written does no harm."""
    (tmp_path / "test").symlink_to(ROOT / "test")
    for executable, (package, _) in EXECUTABLES.items():
        file = tmp_path / "install" / package / "lib" / package / executable
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f'#!/bin/sh\nexec {shlex.join(command_of(executable))} "$@"\n')
        file.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    # As `make shell` has it.
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(p for p in sys.path if p))
    return tmp_path


def run(line: str) -> str:
    """Return what a line prints; it must succeed."""
    done = subprocess.run(line, shell=True, capture_output=True, text=True, timeout=LONG)
    assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
    assert "Traceback" not in done.stderr, done.stderr
    return done.stdout


def made(line: str) -> list[str]:
    """Return the commands that a line with make would run."""
    done = subprocess.run(
        [*shlex.split(line), "--dry-run"],
        cwd=ROOT,
        env={name: value for name, value in os.environ.items() if name not in OUTER},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip().splitlines()


def test_no_block_goes_untested() -> None:
    known = [*CAMPAIGNS, *STUDIES, *SIMULATORS, *BRINGUPS, *DEMOS, *PACKAGES, *TESTS]
    known += INSTALLATIONS
    assert sorted(known) == sorted(LINES)
    assert {kind for kind, _ in BLOCKS} == {"sh", "python", "yaml"}
    assert README.count("```") == 2 * len(BLOCKS)


def test_the_packages_to_install_exist() -> None:
    (line,) = PACKAGES
    command = shlex.split(line)
    assert command[:3] == ["sudo", "apt-get", "install"]
    if shutil.which("apt-cache") is None:
        pytest.skip("no apt here")
    known = subprocess.run(["apt-cache", "pkgnames"], capture_output=True, text=True, check=True)
    if len(available := set(known.stdout.split())) < 10_000:
        pytest.skip("apt knows only what is installed; needs `apt-get update`")
    assert set(command[3:]) <= available


def test_the_installation_without_ros_is_complete(tmp_path: Path) -> None:
    (line,) = INSTALLATIONS
    program, *options = shlex.split(line)
    assert (program, options[:3]) == ("python3", ["-m", "pip", "install"])
    for package in options[3:]:
        shutil.copytree(
            ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("*.egg-info")
        )
    # What is not here comes from elsewhere: that pip would fetch it is not tried.
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--no-warn-script-location"]
    command = [sys.executable, *options, "--quiet", *offline, "--target", str(tmp_path / "site")]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=LONG)
    mission = (
        "from nomad_sim import headless as h; print(h.__file__, h.run_mission('lab').outcome.name)"
    )
    done = subprocess.run(
        [sys.executable, "-c", mission],
        cwd=tmp_path / "site",
        env={"PATH": os.environ["PATH"], "HOME": str(tmp_path), "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        timeout=LONG,
    )
    site, outcome = done.stdout.split()
    assert site == str(tmp_path / "site" / "nomad_sim" / "headless.py"), done.stderr
    assert outcome == "REACHED"


def test_make_test_builds_and_tests() -> None:
    (line,) = TESTS
    assert made(line) == [".ci/build", ".ci/in_environment .ci/test"]


def demo_arguments(line: str) -> list[str]:
    """Return what a line hands to the demonstration."""
    build, command = made(line)
    assert build == ".ci/build"
    runner, executable, *arguments = shlex.split(command)
    assert (runner, executable) == (".ci/in_environment", "install/nomad_sim/lib/nomad_sim/demo")
    assert os.access(ROOT / runner, os.X_OK)
    return arguments


def test_make_demo_hands_its_options_on(clone: Path) -> None:
    plain, other = (parse_options(demo_arguments(line)) for line in DEMOS)
    assert (plain.world.name, plain.seed, plain.output) == ("lab", 0, Path("build/demo"))
    assert (other.world.name, other.seed, other.output) == ("office", 3, Path("build/office"))


def test_the_domains_are_those_of_the_demonstration() -> None:
    told = " ".join(README.split())
    assert f"a ROS domain of its own, from {RESERVED[0]} to {RESERVED[-1]}, and says which" in told
    assert f"`--domain` chooses one from {DOMAINS[0]} to {DOMAINS[-1]}." in told


def test_make_shell_asks_for_a_prompt_only_where_somebody_types(tmp_path: Path) -> None:
    _, command = made("make shell")
    runner = tmp_path / ".ci" / "in_environment"
    runner.parent.mkdir()
    runner.write_text('#!/bin/sh\nshift\necho "options: $*."\n')
    runner.chmod(0o755)
    terminal, end = os.openpty()
    try:
        for stdin, options in ((subprocess.DEVNULL, "options: .\n"), (end, "options: -i.\n")):
            done = subprocess.run(
                ["sh", "-c", command],
                cwd=tmp_path,
                stdin=stdin,
                capture_output=True,
                text=True,
                check=True,
            )
            assert done.stdout == options
    finally:
        os.close(terminal)
        os.close(end)


def test_what_runs_in_two_shells_meets(tmp_path: Path) -> None:
    (tmp_path / "Makefile").symlink_to(ROOT / "Makefile")
    for name, line in (("build", ":"), ("in_environment", 'echo "domain $ROS_DOMAIN_ID"')):
        script = tmp_path / ".ci" / name
        script.parent.mkdir(exist_ok=True)
        script.write_text(f"#!/bin/sh\n{line}\n")
        script.chmod(0o755)
    for given, expected in ((None, "0"), ("7", "7")):
        environment = {k: v for k, v in os.environ.items() if k not in ("ROS_DOMAIN_ID", *OUTER)}
        if given is not None:
            environment["ROS_DOMAIN_ID"] = given
        done = subprocess.run(
            ["make", "shell"],
            cwd=tmp_path,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stdout == f"domain {expected}\n"


@pytest.mark.timeout(LONG + 20.0)
def test_make_demo_crosses_the_laboratory(clone: Path, start_node: Start) -> None:
    demo = start_node("demo", arguments=demo_arguments("make demo"))
    assert demo.wait(LONG) == 0, demo.output()
    out = clone / "build" / "demo"
    summary: dict[str, Any] = json.loads((out / "summary.json").read_text())
    assert (summary["verdict"], summary["contacts"]) == ("reached", 0)
    told = [row for row in demo.output().splitlines() if row.startswith("perception")]
    assert len(told) == summary["perceptions"]
    assert {file.name for file in out.glob("*.png")} == set(summary["figures"]) != set()


@pytest.mark.parametrize("text", [t for t in blocks("python") if "rclpy" not in t])
def test_python_as_it_stands(text: str) -> None:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, "README.md", "exec"), {"__name__": "__main__"})
    first, *values = printed.getvalue().split()
    if "run_mission" in text:
        assert (first, values[-1]) == ("REACHED", "0")
    else:
        # From one cell to the tenth beside it, each with a risk of at least epsilon.
        assert (first, values[0]) == ("True", "11")
        g1, g2, g3 = map(float, values[1:])
        assert 11 * 0.2**2 <= g2 <= g1 * g3 <= 11 * g3**2


@pytest.mark.timeout(LONG + 20.0)
@pytest.mark.parametrize("line", CAMPAIGNS)
def test_a_campaign(line: str, clone: Path) -> None:
    printed = run(line)
    words = shlex.split(line)
    out = clone / words[words.index("--output") + 1]
    if "--replay" in words:
        assert (out / "mission.png").read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
        assert "reached" in printed.lower()
    else:
        missions = (out / "missions.csv").read_text().splitlines()
        count = "--generated" if "--generated" in words else "--seeds"
        assert len(missions) == 1 + int(words[words.index(count) + 1])
        assert all("reached" in row.lower() for row in missions[1:])


@pytest.mark.timeout(LONG + 20.0)
@pytest.mark.parametrize("line", STUDIES)
def test_a_study(line: str, clone: Path) -> None:
    run(line)
    assert {f.name for f in (clone / "build/studies").iterdir()} == {
        "experiment1.md",
        "experiment1.png",
    }


def parameter_file(of: str) -> str:
    """Return the parameter file that speaks of something."""
    (text,) = (t for t in blocks("yaml") if "ros__parameters" in t and of in t)
    return text


def robot_file() -> str:
    return parameter_file("preset")


def test_the_mappers_area_is_that_of_the_other_world() -> None:
    sections = yaml.safe_load(parameter_file("{area"))
    assert sections["/**"]["ros__parameters"] == {"use_sim_time": True}
    area = sections[f"/**/{names.MAPPER_NODE}"]["ros__parameters"]
    mapper = mapper_parameters(overrides=area)
    assert mapper.area.geometry().bounds == load_world("office").geometry(0.1).bounds


@pytest.mark.timeout(LONG + 60.0)
def test_a_goal_of_ones_own(clone: Path, start_node: Start) -> None:
    (simulator,) = SIMULATORS
    started, _ = BRINGUPS
    (client,) = (text for text in blocks("python") if "rclpy" in text)
    # Not in real time, but the way that the text tells of.
    (fast,) = re.findall(r"`sim (--ros-args -p rate:=[^`]*)`", README)
    start_node(Path(simulator).name, arguments=shlex.split(fast))
    executable, *arguments = shlex.split(started)
    nodes = start_node(Path(executable).name, arguments=arguments)
    told = run(shlex.join([sys.executable, "-c", client])).splitlines()
    safe = [int(row.split()[2]) for row in told if row.startswith("motion map: ")]
    path, verdict, saved = (row for row in told if not row.startswith("motion map: "))
    assert path.startswith("path found: True ")
    assert verdict.startswith("reached: True the robot stands ")
    assert (clone / "lab.map").is_file()
    assert "lab.map" in saved
    assert safe[0] == 0
    assert safe[-1] > 1000
    nodes.assert_clean_stop(signal.SIGINT)


def _plain(value: Any) -> Any:
    return value if isinstance(value, (str, bool, int, float)) else list(value)


def test_bringup_takes_the_robots_parameters(clone: Path, probe: Probe, start_node: Start) -> None:
    _, line = BRINGUPS
    executable, *arguments = shlex.split(line)
    file = clone / arguments[arguments.index("--params-file") + 1]
    file.write_text(robot_file())
    heard = probe.subscribe(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
    process = start_node(Path(executable).name, arguments=arguments)

    def nodes() -> set[str]:
        return {status.name for message in list(heard.messages) for status in message.status}

    nodes_of_bringup = {names.MAPPER_NODE, names.PLANNER_NODE, names.MOTION_NODE}
    wait_until(lambda: nodes() == nodes_of_bringup, "the three nodes", 60.0)
    for pattern, section in yaml.safe_load(robot_file()).items():
        given = section["ros__parameters"]
        node = pattern.removeprefix("/**/")
        request = GetParameters.Request(names=list(given))
        response = probe.call(GetParameters, f"{node}/get_parameters", request)
        values = [parameter_value_to_python(value) for value in response.values]
        assert dict(zip(given, [_plain(v) for v in values], strict=True)) == given
    process.assert_clean_stop(signal.SIGINT)
