# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The life of a process: what ends it, and with which exit code."""

from __future__ import annotations

import importlib
import os
import re
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from fuzzy_map_building import jit
from fuzzy_map_building.ros.run import stop_on_signals
from ros.harness import EXECUTABLES

ROOT = Path(__file__).resolve().parents[2]

PREAMBLE = """
    import os, signal, sys
    import rclpy
    from rclpy.node import Node
    from std_msgs.msg import Empty
    from fuzzy_map_building.ros.run import spin_node
"""


def run(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    code = textwrap.dedent(PREAMBLE) + textwrap.dedent(program)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def complaints(done: subprocess.CompletedProcess[str]) -> str:
    """Return what came on stderr beside a node's remark on how kernels run here."""
    remark = jit.remark()
    lines = done.stderr.splitlines(keepends=True)
    return "".join(line for line in lines if not (remark and line.endswith(f": {remark}\n")))


@pytest.mark.parametrize("home", [True, False])
def test_who_cannot_keep_a_log_is_told_what_to_set(
    home: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("HOME")
    monkeypatch.delenv("ROS_HOME", raising=False)
    if home:
        monkeypatch.setenv("ROS_LOG_DIR", "/proc/log")
    else:
        monkeypatch.delenv("ROS_LOG_DIR", raising=False)
    done = run("sys.exit(spin_node(lambda: Node('mute'), name='mute'))")
    assert done.returncode == 2
    assert "mute: cannot start: ROS cannot keep a log" in done.stderr
    assert "set ROS_LOG_DIR to a folder that can be written" in done.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_become_a_flag_and_the_handlers_come_back(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    with stop_on_signals() as stop:
        assert not stop.requested
        os.kill(os.getpid(), number)
        assert stop.requested
    assert signal.getsignal(number) is before


def test_a_node_may_say_goodbye() -> None:
    done = run("""
        class Polite(Node):
            def __init__(self):
                super().__init__("polite")
                self.create_timer(0.01, lambda: os.kill(os.getpid(), signal.SIGTERM))
                self.farewell = self.create_publisher(Empty, "farewell", 1)
                self.create_subscription(Empty, "farewell", self.on_farewell, 1)

            def on_stop(self):
                self.farewell.publish(Empty())

            def on_farewell(self, message):
                print("heard by an executor that still spins")

        sys.exit(spin_node(Polite))
    """)
    assert (done.returncode, complaints(done)) == (0, "")
    assert done.stdout == "heard by an executor that still spins\n"


@pytest.mark.parametrize(("given", "wanted"), [(None, "LOCALHOST"), ("SUBNET", "SUBNET")])
def test_only_this_machine_is_spoken_to_unless_told_otherwise(
    given: str | None, wanted: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if given is None:
        monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
    else:
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", given)
    done = run("""
        # What the middleware will read, before it begins.
        rclpy.init = lambda **given: print(os.getenv("ROS_AUTOMATIC_DISCOVERY_RANGE"))
        spin_node(lambda: sys.exit(0))
    """)
    assert done.stdout == f"{wanted}\n", done.stderr


def test_a_signal_during_the_start_ends_the_node_when_it_is_up() -> None:
    done = run("""
        def slow():
            os.kill(os.getpid(), signal.SIGINT)
            return Node("slow")

        sys.exit(spin_node(slow))
    """)
    assert (done.returncode, done.stdout, complaints(done)) == (0, "", "")


def test_a_context_that_somebody_else_shuts_down_ends_the_node() -> None:
    done = run("""
        class Brief(Node):
            def __init__(self):
                super().__init__("brief")
                self.create_timer(0.01, lambda: rclpy.shutdown())

        sys.exit(spin_node(Brief))
    """)
    assert (done.returncode, complaints(done)) == (0, "")


@pytest.mark.parametrize("error", ["ValueError('a\\n  world')", "OSError('a world')"])
def test_what_refuses_the_start_is_told_in_one_line(error: str) -> None:
    done = run(f"""
        def refuse():
            Node("refused")
            raise {error}

        sys.exit(spin_node(refuse))
    """)
    assert done.returncode == 2
    assert done.stderr == "-c: cannot start: a world\n"


@pytest.mark.parametrize("where", ["start", "callback"])
def test_a_fault_in_the_program_does_not_pass_for_a_stop(where: str) -> None:
    done = run(
        """
        class Faulty(Node):
            def __init__(self, fails):
                super().__init__("faulty")
                self.create_timer(0.01, self.fail)
                if fails:
                    self.fail()

            def fail(self):
                raise RuntimeError("a fault")

        where = sys.argv.pop()
        sys.exit(spin_node(lambda: Faulty(where == "start")))
        """,
        where,
    )
    assert done.returncode == 1
    assert done.stderr.strip().splitlines()[-1].endswith("RuntimeError: a fault")


def test_a_node_that_fails_may_still_say_what_matters() -> None:
    done = run("""
        class Faulty(Node):
            def __init__(self):
                super().__init__("faulty")
                self.create_timer(0.01, self.fail)

            def fail(self):
                raise RuntimeError("a fault\\nin two lines")

            def on_fault(self):
                print("the robot stands", flush=True)
                raise ValueError("a second fault")

            def on_stop(self):
                print("the actions are ended", flush=True)

        sys.exit(spin_node(Faulty))
    """)
    assert done.returncode == 1
    assert done.stdout == "the robot stands\nthe actions are ended\n"
    told = done.stderr.strip().splitlines()[-1]
    assert told == "-c: ended by a fault in the program: RuntimeError: a fault in two lines"
    assert "a second fault" not in done.stderr


@pytest.mark.parametrize("executable", ["mapper", "planner", "motion", "sim"])
def test_help_is_a_usage_and_starts_nothing(
    executable: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    package, module = EXECUTABLES[executable]
    monkeypatch.setattr(sys, "argv", [executable, "--help"])
    assert importlib.import_module(module).main() == 0
    told, errors = capsys.readouterr()
    assert errors == ""
    assert told.startswith(f"usage: {executable} ")
    assert f"ros2 run {package} {executable}" in told
    assert all(word in told for word in ("--params-file FILE", "-p NAME:=VALUE", "-r FROM:=TO"))
    assert max(map(len, told.splitlines())) < 100
    (config,) = re.findall(r"share/(\w+/config/\w+\.yaml)", told)
    assert (ROOT / config).is_file()
