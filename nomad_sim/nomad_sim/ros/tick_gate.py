# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""When the simulator may take its next tick: the pace of the wall clock, and the lockstep.

In lockstep a tick waits for the velocity command that answers the pose of the tick before it:
the one with the pose's stamp. Commands to older poses, of which whoever commands may have a
backlog, and commands that answer nothing let no tick pass.

Pure logic: wall time comes as an argument and is only compared.
"""

from __future__ import annotations

from typing import Final

__all__ = ["BACKLOG", "TickGate"]

#: Delay behind the pace up to which ticks are made up for; beyond it they are given up [s].
BACKLOG: Final = 0.25
#: Stamps that differ by less are of the same pose [s]: they pass through floating point.
SAME: Final = 1e-3


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
        Longest wait for a command [s of wall time].

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
        self._engaged = False
        self._asked: float | None = None  # stamp of the pose whose answer is not there
        self._since = now
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
        return self._engaged

    def disengage(self) -> None:
        """Wait for no command until the next one has come."""
        self._engaged = False

    def answered(self, now: float, stamp: float) -> None:
        """Take note, at wall time `now`, of a command that answers the pose of a stamp [s]."""
        if self._asked is not None and abs(stamp - self._asked) < SAME:
            self._asked = None
        if self._lockstep and not self._engaged:
            self._engaged = True
            self._since = now

    def wait(self, now: float) -> float:
        """Return how long to wait for the next tick [s], 0 when it may be taken at `now`.

        A wait for a command that has lasted too long ends here.
        """
        if self._engaged and self._asked is not None:
            left = self._since + self._timeout - now
            if left > 0.0:
                return left
            self.timeouts += 1
            self.disengage()
        return max(0.0, self._due - now)

    def ticked(self, now: float, asked: float | None) -> None:
        """Take note of a tick at wall time `now` [s].

        Parameters
        ----------
        now : float
            When it was taken [s].
        asked : float or None
            Stamp of the newest pose that was told with it [s]; None if none was: then there is
            nothing to answer.
        """
        self._due += self._period
        behind = now - self._due
        if self._period == 0.0:
            self._due = now
        elif behind > BACKLOG:
            self.dropped += behind
            self._due = now
        self._asked = asked
        self._since = now
