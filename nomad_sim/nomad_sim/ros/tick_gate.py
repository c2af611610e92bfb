# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""When the simulator may take its next tick: the pace of the wall clock, and the lockstep.

In lockstep a tick waits for the velocity command that answers the tick before it. Which
tick a command answers cannot be read from it, and whoever commands may have a backlog of
ticks when he begins. So the two sides are brought into step once: after the first command
the ticks pause until no further command has come for `SETTLE_TIME`; from then on there is
one command for one tick.

Pure logic: wall time comes as an argument and is only compared.
"""

from __future__ import annotations

import enum
from typing import Final

__all__ = ["BACKLOG", "SETTLE_TIME", "TickGate"]

#: Silence after which a commander is taken to have no backlog any more [s].
SETTLE_TIME: Final = 0.2
#: Delay behind the pace up to which ticks are made up for; beyond it they are given up [s].
BACKLOG: Final = 0.25


class _State(enum.Enum):
    FREE = enum.auto()  # no command is waited for
    SETTLING = enum.auto()  # the first command has come; those to older ticks may follow
    WAITING = enum.auto()  # a tick is taken, its answer is not there
    ANSWERED = enum.auto()


class TickGate:
    """Decides when a tick is due.

    Parameters
    ----------
    now : float
        Wall time [s].
    period : float
        Wall time from tick to tick [s]; 0: none.
    lockstep : bool
        Whether ticks wait for commands.
    timeout : float
        Longest wait for a command, and for silence at the beginning [s of wall time].

    Attributes
    ----------
    timeouts : int
        How often a command was waited for in vain.
    dropped : float
        Time by which the ticks fell behind the pace and which was given up [s of wall time].
    """

    def __init__(
        self, now: float, period: float, lockstep: bool = False, timeout: float = 1.0
    ) -> None:
        self.timeouts = 0
        self.dropped = 0.0
        self._state = _State.FREE
        self._since = self._last_command = now
        self.configure(now, period, lockstep, timeout)

    def configure(self, now: float, period: float, lockstep: bool, timeout: float) -> None:
        """Change pace and lockstep; the next tick follows a period after `now`."""
        self._period = period
        self._lockstep = lockstep
        self._timeout = timeout
        self._due = now + period
        if not lockstep:
            self.disengage()

    @property
    def engaged(self) -> bool:
        """Whether ticks wait for commands now."""
        return self._state is not _State.FREE

    def disengage(self) -> None:
        """Wait for no command until the next one has come."""
        self._state = _State.FREE

    def commanded(self, now: float) -> None:
        """Take note of a command at wall time `now` [s]."""
        self._last_command = now
        if self._state is _State.WAITING:
            self._state = _State.ANSWERED
        elif self._state is _State.FREE and self._lockstep:
            self._state = _State.SETTLING
            self._since = now

    def wait(self, now: float) -> float:
        """Return how long to wait for the next tick [s], 0 when it may be taken at `now`.

        A wait for a command that has lasted too long ends here.
        """
        until = self._due
        if self._state is _State.WAITING:
            left = self._since + self._timeout - now
            if left > 0.0:
                return left
            self.timeouts += 1
            self.disengage()
        elif self._state is _State.SETTLING:
            silence = self._last_command + SETTLE_TIME
            until = max(until, min(silence, self._since + self._timeout))
        return max(0.0, until - now)

    def ticked(self, now: float) -> None:
        """Take note of a tick at wall time `now` [s]."""
        self._due += self._period
        behind = now - self._due
        if self._period == 0.0:
            self._due = now
        elif behind > BACKLOG:
            self.dropped += behind
            self._due = now
        if self._state is not _State.FREE:
            self._state = _State.WAITING
            self._since = now
