# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Processes that belong together: all of them run, or none is left.

Used by every program that starts nodes::

    with stop_on_signals() as stop, ProcessGroup() as group:
        group.start("mapper", python_module("fuzzy_map_building.ros.mapper_node"))
        group.start("planner", python_module("fuzzy_navigation.ros.planner_node"))
        ended = group.wait(lambda: stop.requested)
    # here every process has ended and was reaped, whatever happened inside

Each process leads a session of its own: a Ctrl-C in the terminal reaches only the program
that started it, which passes the stop on, and whatever the process starts in turn can be
ended with it. A small guardian process holds the other end of a pipe; should the starting
program be killed outright, the pipe breaks and the guardian ends what is left.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import IO, Final

from fuzzy_map_building.ros.discovery import set_discovery

__all__ = [
    "CLEAN_ENDS",
    "Ended",
    "ProcessGroup",
    "child_environment",
    "python_module",
]

#: Time that processes get to end after the stop before they are killed [s]. Taking a node down
#: needs 0.6 s of a processor, which on a machine that starves it can be more than 10 s.
GRACE: Final = 30.0
#: Time between two looks at the processes [s].
PERIOD: Final = 0.02
#: Exit codes of a process that was asked to end: one that had not got as far as to handle
#: the signal ends by it.
CLEAN_ENDS: Final = (0, -signal.SIGTERM)

# Reads "+pid" and "-pid" lines until the pipe breaks, then ends the groups still listed:
# the clean stop first, so that a robot is left standing.
_GUARDIAN: Final = """
import os, signal, sys, time
groups = set()
for line in sys.stdin:
    (groups.add if line[0] == "+" else groups.discard)(int(line[1:]))
def send(number):
    for group in list(groups):
        try:
            os.killpg(group, number)
        except OSError:
            groups.discard(group)
send(signal.SIGTERM)
end = time.monotonic() + float(sys.argv[1])
while groups and time.monotonic() < end:
    time.sleep(0.05)
    send(0)
send(signal.SIGKILL)
"""


@dataclass(frozen=True)
class Ended:
    """A process that has ended.

    Parameters
    ----------
    name : str
        As given to `ProcessGroup.start`.
    code : int
        Exit code; minus the number of the signal that killed it.
    """

    name: str
    code: int

    def __str__(self) -> str:
        if self.code >= 0:
            return f"{self.name} ended with exit code {self.code}"
        try:
            reason = signal.Signals(-self.code).name
        except ValueError:
            reason = f"signal {-self.code}"
        return f"{self.name} was killed by {reason}"


def python_module(module: str, *arguments: str) -> list[str]:
    """Return the command that runs a module's ``main`` with this very interpreter."""
    return [sys.executable, "-m", module, *arguments]


def child_environment(**changes: str) -> dict[str, str]:
    """Return the environment for the nodes of one robot.

    Their traffic stays on this machine unless the user has said otherwise.

    Parameters
    ----------
    **changes : str
        Variables to set, e.g. ``ROS_DOMAIN_ID="7"``.
    """
    environment = dict(os.environ)
    set_discovery(environment)
    # No module of the working directory may take the place of an installed one.
    environment["PYTHONSAFEPATH"] = "1"
    environment.update(changes)
    return environment


class ProcessGroup:
    """Starts processes, watches them, and ends every one of them.

    A context manager: leaving it ends and reaps all processes. Not for several threads.

    Parameters
    ----------
    grace : float
        Time that processes get to end after the stop before they are killed [s].

    Attributes
    ----------
    ended : tuple of Ended
        The processes that have ended, in the order in which it was noticed.
    """

    def __init__(self, grace: float = GRACE) -> None:
        self._grace = grace
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self._starts: dict[str, Callable[[], subprocess.Popen[bytes]]] = {}
        self._ended: list[Ended] = []
        self._guardian = subprocess.Popen(
            [sys.executable, "-I", "-S", "-c", _GUARDIAN, str(grace)],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            start_new_session=True,
        )

    def __enter__(self) -> ProcessGroup:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.stop()

    @property
    def running(self) -> tuple[str, ...]:
        """Names of the processes that run, in the order of their start."""
        self._reap()
        return tuple(self._running)

    @property
    def ended(self) -> tuple[Ended, ...]:
        """The processes that have ended, in the order in which it was noticed."""
        self._reap()
        return tuple(self._ended)

    def start(
        self,
        name: str,
        command: Sequence[str],
        *,
        env: Mapping[str, str] | None = None,
        stdout: int | IO[bytes] | None = None,
        stderr: int | IO[bytes] | None = None,
    ) -> int:
        """Start a process and return its id.

        Parameters
        ----------
        name : str
            What to call it, once in a group.
        command : sequence of str
            Program and arguments; no shell.
        env : mapping, optional
            Environment; `child_environment` when None.
        stdout, stderr : file or int, optional
            As for `subprocess.Popen`; inherited when None.

        Raises
        ------
        ValueError
            If a process of this name was started before, or the group was stopped.
        OSError
            If the program cannot be started.
        """
        if name in self._starts:
            raise ValueError(f"a process '{name}' was started before; give each its own name")
        variables = dict(child_environment() if env is None else env)

        def start() -> subprocess.Popen[bytes]:
            return subprocess.Popen(
                command,
                env=variables,
                stdin=subprocess.DEVNULL,
                stdout=stdout,
                stderr=stderr,
                start_new_session=True,
            )

        pid = self._start(name, start)
        self._starts[name] = start
        return pid

    def restart(self, name: str) -> int:
        """Start a process that has ended once more, as before, and return its id.

        Files that it was given must still be open. `ended` tells of its former end no longer.

        Raises
        ------
        ValueError
            If it has not ended, or the group was stopped.
        OSError
            If the program cannot be started.
        """
        former = [ended for ended in self.ended if ended.name == name]
        if not former:
            raise ValueError(f"no process '{name}' has ended")
        pid = self._start(name, self._starts[name])
        self._ended.remove(former[0])
        return pid

    def _start(self, name: str, start: Callable[[], subprocess.Popen[bytes]]) -> int:
        if self._guardian.poll() is not None:
            raise ValueError(f"cannot start '{name}': the group was stopped")
        process = start()
        self._running[name] = process
        self._tell_guardian(f"+{process.pid}\n")
        return process.pid

    def wait(self, until: Callable[[], bool], timeout: float | None = None) -> Ended | None:
        """Wait until a process ends, `until` returns True, or the time is over.

        Parameters
        ----------
        until : callable
            Asked every `PERIOD`; may do some work of its own.
        timeout : float, optional
            Longest wait [s]; for ever when None.

        Returns
        -------
        Ended or None
            The first process of the group that has ended, None when none has.
        """
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            if self.ended:
                return self._ended[0]
            if until() or (end is not None and time.monotonic() >= end):
                return None
            time.sleep(PERIOD)

    def send(self, name: str, number: int) -> None:
        """Send a signal to one process; without effect when it has ended.

        Raises
        ------
        KeyError
            If no process of this name was ever started.
        """
        self._reap()
        if name in self._running:
            os.kill(self._running[name].pid, number)
        elif not any(e.name == name for e in self._ended):
            raise KeyError(name)

    def stop(self) -> dict[str, int]:
        """End all processes and return the exit code of each by name.

        They are asked with SIGTERM, and have `grace` to end; then they are killed. May be
        called again.
        """
        for name in self.running:
            self.send(name, signal.SIGTERM)
        end = time.monotonic() + self._grace
        while self.running and time.monotonic() < end:
            time.sleep(PERIOD)
        for process in self._running.values():
            _kill_group(process.pid)
        while self.running:
            time.sleep(PERIOD)
        self._dismiss_guardian()
        return {e.name: e.code for e in self._ended}

    def _reap(self) -> None:
        """Take note of the processes that have ended, and end what they left behind."""
        for name, process in list(self._running.items()):
            # Not reaped before its group is killed: until then nobody can get its id.
            if os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                continue
            _kill_group(process.pid)
            del self._running[name]
            self._ended.append(Ended(name, process.wait()))
            self._tell_guardian(f"-{process.pid}\n")

    def _tell_guardian(self, line: str) -> None:
        assert self._guardian.stdin is not None
        # A guardian that somebody killed must not hinder the group.
        with contextlib.suppress(BrokenPipeError):
            self._guardian.stdin.write(line.encode())
            self._guardian.stdin.flush()

    def _dismiss_guardian(self) -> None:
        assert self._guardian.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self._guardian.stdin.close()
        self._guardian.wait()


def _kill_group(pid: int) -> None:
    """Kill a process that is not reaped yet, and all that it started."""
    try:
        os.killpg(pid, signal.SIGKILL)
    except ProcessLookupError:
        # An interrupt from the terminal has met it before it had a session of its own.
        os.kill(pid, signal.SIGKILL)
