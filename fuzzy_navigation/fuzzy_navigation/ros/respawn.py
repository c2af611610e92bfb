# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Starts processes anew that have ended, later each time, and not for ever."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from fuzzy_map_building.ros.run import EXIT_REFUSED
from fuzzy_navigation.ros.processes import PERIOD, Ended, ProcessGroup

__all__ = ["DEFAULT_LIMIT", "Backoff", "keep_running"]

#: How often in a row a process is started anew.
DEFAULT_LIMIT: Final = 5
#: Pause before a process is started anew, at first and at most [s]; it doubles each time.
FIRST_DELAY: Final = 0.5
LONGEST_DELAY: Final = 8.0
#: A process that has run for so long [s] has recovered: its next end is the first in a row.
STEADY: Final = 60.0


@dataclass
class _Row:
    """Ends in a row."""

    ends: int
    due: float


class Backoff:
    """Says when to start a process anew.

    Parameters
    ----------
    limit : int
        How often in a row; 0: never.

    Examples
    --------
    >>> backoff = Backoff(limit=2)
    >>> [backoff.ended("mapper", now) for now in (100.0, 102.0, 104.0)]
    [100.5, 103.0, None]
    >>> backoff.ended("planner", 104.0)
    104.5
    """

    def __init__(self, limit: int = DEFAULT_LIMIT) -> None:
        self._limit = limit
        self._rows: dict[str, _Row] = {}

    def ended(self, name: str, now: float) -> float | None:
        """Return when to start a process anew that has ended, or None to give up.

        Parameters
        ----------
        name : str
            Which one.
        now : float
            Time of its end [s], of a clock that only goes forward.
        """
        row = self._rows.get(name)
        if row is None or now - row.due > STEADY:
            row = self._rows[name] = _Row(0, now)
        row.ends += 1
        if row.ends > self._limit:
            return None
        row.due = now + min(FIRST_DELAY * 2.0 ** (row.ends - 1), LONGEST_DELAY)
        return row.due


def keep_running(
    group: ProcessGroup, limit: int, until: Callable[[], bool], say: Callable[[str], None]
) -> Ended | None:
    """Start the processes of a group anew when they end, until it is time to stop.

    Parameters
    ----------
    group : ProcessGroup
        The processes, started.
    limit : int
        How often in a row each of them is started anew; see `Backoff`.
    until : callable
        Asked several times a second whether it is time to stop.
    say : callable
        Told in a sentence of each process that has ended and will be started anew.

    Returns
    -------
    Ended or None
        The process that was given up: it has ended too often, or what it was started with
        was refused and would be again. None when `until` has said so.
    """
    backoff = Backoff(limit)
    due: dict[str, float] = {}
    while not until():
        now = time.monotonic()
        for name in [name for name, when in due.items() if now >= when]:
            group.restart(name)
            del due[name]
        for ended in group.ended:
            if ended.name in due:
                continue
            when = None if ended.code == EXIT_REFUSED else backoff.ended(ended.name, now)
            if when is None:
                return ended
            say(f"{ended}; it will be started anew in {when - now:g} s")
            due[ended.name] = when
        time.sleep(PERIOD)
    return None
