# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The time that a mission goes by: the stamps of the poses, and what passes between them.

The control reckons in the stamps of its poses, so that neither the delay of a message nor
that of a clock enters. When the poses stop, time has to go on, or nobody would notice:
then the node's clock counts, and should that stand too, as simulated time does when the
simulator dies, wall time.

A clock that is set ahead by hours, and the stamps with it, is nobody's silence either.

A process that did not run for a while, stopped by a debugger or starved by others, has heard of
nothing meanwhile: all that it waits for is late by its own fault. That it was held up shows
between two looks at the time, which it takes several times a second.
"""

from __future__ import annotations

import math

__all__ = ["PoseTime"]

#: A clock that has not moved for so long [s of wall time] stands.
STANDSTILL = 1.0
#: A clock that is farther ahead than this [s] from one look to the next, and goes so many times as
#: fast as the wall's, was set: no simulation runs so fast over topics.
LEAP, FASTEST = 5.0, 500.0
#: A process that takes no look at the time for so long did not run, and takes so long to hear what
#: has come meanwhile [s of wall time].
HELD_UP, CATCH_UP = 0.5, 0.5


class PoseTime:
    """Time [s] from the stamps of poses, continued by a clock, continued by wall time.

    Examples
    --------
    >>> time = PoseTime()
    >>> time.at_pose(100.0, clock=100.1, wall=7.0)
    100.0
    >>> time.now(clock=100.2, wall=7.1)
    100.1
    """

    def __init__(self) -> None:
        self._base: float | None = None
        self._passed = 0.0
        self._posed = False
        self._clock = 0.0
        self._wall = 0.0
        self._moved = 0.0
        self._caught_up = -math.inf

    @property
    def catching_up(self) -> bool:
        """Whether the process was held up, or the stamps leapt, shortly before the last look."""
        return self._wall < self._caught_up

    def at_pose(self, stamp: float, clock: float, wall: float) -> float:
        """Return the time of a pose: its stamp.

        Parameters
        ----------
        stamp : float
            Of the pose [s].
        clock, wall : float
            What the node's clock and the wall clock show now [s].
        """
        looked = self._wall
        before = self.now(clock, wall)
        if self._posed and _leapt(stamp - before, wall - looked):
            self._caught_up = wall + CATCH_UP
        self._base, self._passed, self._posed = stamp, 0.0, True
        return stamp

    def now(self, clock: float, wall: float) -> float:
        """Return the time now [s], for clocks as in `at_pose`.

        Before the first pose wall time passes: simulated time may begin anywhere.
        """
        if self._base is None:
            self._base, self._clock, self._wall, self._moved = clock, clock, wall, wall
        if wall - self._wall > HELD_UP:
            # A clock that has gone on is not heard yet.
            self._moved, self._caught_up = wall, wall + CATCH_UP
        if clock != self._clock:
            self._moved = wall
        if not self._posed:
            self._passed += wall - self._wall
        elif clock != self._clock:
            self._passed += _step(clock - self._clock, wall - self._wall)
        else:
            self._passed += max(wall - max(self._wall, self._moved + STANDSTILL), 0.0)
        self._clock, self._wall = clock, wall
        # Rounded: sums must not make a time a hair later than the stamp that it equals.
        return round(self._base + self._passed, 9)


def _step(clock: float, wall: float) -> float:
    """Return the time that has passed while the clock and the wall's went on so far [s]."""
    return wall if _leapt(clock, wall) else max(clock, 0.0)  # 0: it was set back


def _leapt(time: float, wall: float) -> bool:
    """Whether a time has gone ahead too far for as long as the wall's went on."""
    return time > LEAP and time > FASTEST * wall
