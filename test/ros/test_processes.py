# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""ProcessGroup: every process it starts ends, however its end comes about."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzy_map_building.ros.discovery import DISCOVERY_RANGE, PROFILES
from fuzzy_navigation.ros.processes import (
    Ended,
    ProcessGroup,
    child_environment,
    python_module,
)

DEADLINE = 15.0
#: Says that it is ready, then ends cleanly on SIGTERM.
POLITE = """
import signal, sys, time
signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
print("ready", flush=True)
time.sleep(600)
"""
#: Does not end on SIGTERM.
STUBBORN = POLITE.replace("lambda *_: sys.exit(0)", "signal.SIG_IGN")
#: Starts a process, prints its id, and ends without it.
CARELESS = """
import subprocess, sys
print(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"]).pid, flush=True)
"""
#: Holds a group of one polite process, prints its id and waits to be killed.
HOLDER = """
import sys, time
from fuzzy_navigation.ros.processes import ProcessGroup
group = ProcessGroup(grace=5.0)
print(group.start("polite", [sys.executable, "-c", sys.argv[1]]), flush=True)
time.sleep(600)
"""


def python(source: str, *arguments: str) -> list[str]:
    return [sys.executable, "-c", source, *arguments]


def runs(pid: int) -> bool:
    """Whether a process exists and is no zombie."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state not in "ZX"


def eventually(condition: Callable[[], bool]) -> bool:
    end = time.monotonic() + DEADLINE
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def start(group: ProcessGroup, name: str, source: str, folder: Path) -> int:
    """Start a Python process and return its id when its first line is out."""
    out = folder / name
    with out.open("wb") as stream:
        pid = group.start(name, python(source), stdout=stream)
    assert eventually(lambda: b"\n" in out.read_bytes())
    return pid


def test_stop_ends_every_process_and_tells_the_exit_codes(tmp_path: Path) -> None:
    group = ProcessGroup()
    pids = [start(group, f"p{i}", POLITE, tmp_path) for i in range(3)]
    assert group.running == ("p0", "p1", "p2")
    assert group.stop() == {"p0": 0, "p1": 0, "p2": 0}
    assert not any(runs(pid) for pid in pids)
    assert group.stop() == {"p0": 0, "p1": 0, "p2": 0}


def test_what_ignores_the_stop_is_killed(tmp_path: Path) -> None:
    group = ProcessGroup(grace=0.2)
    pid = start(group, "stubborn", STUBBORN, tmp_path)
    assert group.stop() == {"stubborn": -signal.SIGKILL}
    assert not runs(pid)


def test_a_process_that_an_interrupt_meets_before_it_leads_a_group_ends_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def leaderless(_: int, __: int) -> None:
        raise ProcessLookupError

    group = ProcessGroup(grace=0.2)
    polite = start(group, "polite", POLITE, tmp_path)
    stubborn = start(group, "stubborn", STUBBORN, tmp_path)
    monkeypatch.setattr(os, "killpg", leaderless)
    assert group.stop() == {"polite": 0, "stubborn": -signal.SIGKILL}
    assert not runs(polite)
    assert not runs(stubborn)


def test_leaving_the_context_by_an_error_ends_the_processes(tmp_path: Path) -> None:
    pids = []

    def fail_inside() -> None:
        with ProcessGroup() as group:
            pids.append(start(group, "polite", POLITE, tmp_path))
            raise RuntimeError("inside")

    with pytest.raises(RuntimeError, match="inside"):
        fail_inside()
    assert not runs(pids[0])


def test_wait_returns_the_process_that_ended(tmp_path: Path) -> None:
    with ProcessGroup() as group:
        start(group, "polite", POLITE, tmp_path)
        group.start("failing", python("raise SystemExit(3)"))
        assert group.wait(lambda: False, DEADLINE) == Ended("failing", 3)
        assert group.running == ("polite",)


def test_wait_ends_by_condition_and_by_time() -> None:
    with ProcessGroup() as group:
        group.start("polite", python(POLITE), stdout=subprocess.DEVNULL)
        assert group.wait(lambda: True) is None
        assert group.wait(lambda: False, 0.05) is None


def test_what_a_process_left_behind_ends_with_it(tmp_path: Path) -> None:
    with ProcessGroup() as group:
        start(group, "careless", CARELESS, tmp_path)
        left_behind = int((tmp_path / "careless").read_text())
        assert group.wait(lambda: False, DEADLINE) == Ended("careless", 0)
        assert eventually(lambda: not runs(left_behind))


def test_the_guardian_ends_the_processes_of_a_program_that_was_killed() -> None:
    holder = subprocess.Popen(python(HOLDER, POLITE), stdout=subprocess.PIPE)
    assert holder.stdout is not None
    pid = int(holder.stdout.readline())
    assert runs(pid)
    holder.kill()
    holder.wait(DEADLINE)
    holder.stdout.close()
    assert eventually(lambda: not runs(pid))


def test_a_group_without_its_guardian_still_ends_its_processes(tmp_path: Path) -> None:
    with ProcessGroup() as group:
        os.kill(group._guardian.pid, signal.SIGKILL)
        group._guardian.wait(DEADLINE)
        # The process whose start finds out is not lost either.
        with contextlib.suppress(ValueError):
            group.start("polite", python(POLITE), stdout=subprocess.DEVNULL)
    assert group.running == ()


def test_send_passes_a_signal_on(tmp_path: Path) -> None:
    with ProcessGroup() as group:
        start(group, "polite", POLITE, tmp_path)
        group.send("polite", signal.SIGUSR1)
        assert group.wait(lambda: False, DEADLINE) == Ended("polite", -signal.SIGUSR1)
        group.send("polite", signal.SIGUSR1)
        with pytest.raises(KeyError):
            group.send("impolite", signal.SIGUSR1)


def test_refusals(tmp_path: Path) -> None:
    with ProcessGroup() as group:
        group.start("once", python("pass"))
        with pytest.raises(ValueError, match="'once' was started before"):
            group.start("once", python("pass"))
        with pytest.raises(OSError, match="no_such_program"):
            group.start("missing", [str(tmp_path / "no_such_program")])
        assert "missing" not in group.running
    with pytest.raises(ValueError, match="was stopped"):
        group.start("late", python("pass"))


@pytest.mark.parametrize(
    ("code", "text"),
    [
        (0, "motion ended with exit code 0"),
        (2, "motion ended with exit code 2"),
        (-9, "motion was killed by SIGKILL"),
        (-250, "motion was killed by signal 250"),
    ],
)
def test_an_end_reads_as_a_sentence(code: int, text: str) -> None:
    assert str(Ended("motion", code)) == text


def test_children_stay_on_this_machine_unless_the_user_says_otherwise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(DISCOVERY_RANGE, raising=False)
    assert child_environment(ROS_DOMAIN_ID="7")[DISCOVERY_RANGE] == "LOCALHOST"
    assert child_environment(ROS_DOMAIN_ID="7")["ROS_DOMAIN_ID"] == "7"
    monkeypatch.setenv(DISCOVERY_RANGE, "SUBNET")
    assert child_environment()[DISCOVERY_RANGE] == "SUBNET"


def test_children_announce_themselves_as_told_unless_the_user_has_profiles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(PROFILES, raising=False)
    assert Path(child_environment()[PROFILES]).is_file()
    monkeypatch.setenv(PROFILES, "/of/the/user.xml")
    assert child_environment()[PROFILES] == "/of/the/user.xml"


def test_a_module_runs_with_this_interpreter() -> None:
    command = python_module("platform")
    out = subprocess.run(command, capture_output=True, check=True, timeout=DEADLINE)
    assert out.stdout.strip()
