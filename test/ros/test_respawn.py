# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Processes that are started anew: when, how often, and when not."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from fuzzy_navigation.ros import respawn
from fuzzy_navigation.ros.processes import Ended, ProcessGroup
from fuzzy_navigation.ros.respawn import Backoff, keep_running

#: Writes a line and ends.
SHORT = "import sys; open(sys.argv[1], 'a').write('x\\n'); sys.exit(int(sys.argv[2]))"


def starts(file: Path) -> int:
    return len(file.read_text().splitlines()) if file.exists() else 0


def run(folder: Path, code: int, limit: int) -> tuple[Ended | None, int, list[str]]:
    """Return the end of a process that ends at once, its starts, and what was said."""
    file, said = folder / "starts", []
    with ProcessGroup() as group:
        group.start("short", [sys.executable, "-c", SHORT, str(file), str(code)])
        ended = keep_running(group, limit, lambda: starts(file) > 9, said.append)
    return ended, starts(file), said


def test_each_pause_is_twice_the_last_up_to_a_limit_of_its_own() -> None:
    backoff, now, pauses = Backoff(limit=7), 0.0, []
    while (due := backoff.ended("mapper", now)) is not None:
        pauses.append(due - now)
        now = due + 1.0
    assert pauses == [0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0]
    assert backoff.ended("planner", now) == now + 0.5


def test_who_ran_for_a_minute_has_recovered() -> None:
    backoff = Backoff(limit=1)
    assert backoff.ended("mapper", 0.0) == 0.5
    assert backoff.ended("mapper", 0.5 + 60.1) == 61.1
    assert backoff.ended("mapper", 61.1 + 59.9) is None


@pytest.mark.parametrize("code", [0, 3])
def test_a_process_is_started_anew_so_often(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    monkeypatch.setattr(respawn, "FIRST_DELAY", 0.05)
    ended, count, said = run(tmp_path, code, limit=2)
    assert ended == Ended("short", code)
    assert count == 3
    assert said == [
        f"short ended with exit code {code}; it will be started anew in {pause} s"
        for pause in (0.05, 0.1)
    ]


@pytest.mark.parametrize(("code", "limit"), [(2, 5), (3, 0)], ids=["refused", "not wanted"])
def test_a_process_is_not_started_anew(tmp_path: Path, code: int, limit: int) -> None:
    assert run(tmp_path, code, limit) == (Ended("short", code), 1, [])


def test_a_stop_ends_the_pause(tmp_path: Path) -> None:
    file = tmp_path / "starts"
    with ProcessGroup() as group:
        group.start("short", [sys.executable, "-c", SHORT, str(file), "3"])
        assert keep_running(group, 5, lambda: bool(group.ended), lambda _: None) is None
        with pytest.raises(ValueError, match="no process 'other' has ended"):
            group.restart("other")
    assert starts(file) == 1
