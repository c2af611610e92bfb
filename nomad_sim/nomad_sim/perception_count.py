# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How many perceptions a robot has taken, for obstacles that come and go with them.

A perception that the robot stands for is told by whoever asked for it. A robot that maps on its
way takes some without being asked; that it does is seen from its turret, which turns while the
robot drives: a robot that perceives and moves by turns holds it still on its way. Such a robot
takes one whenever it has come as far as the others come from one perception to the next.
"""

from __future__ import annotations

__all__ = ["PerceptionCount"]

#: Way from one perception to the next of a robot that maps on it [m].
WAY = 0.8
#: How often the turret is sent elsewhere on such a way at least: once more than a perception of a
#: robot that stands takes, for one may begin before the robot has come to rest.
TURNS = 4
#: Speed above which the robot drives [m/s].
DRIVING = 0.1


class PerceptionCount:
    """Counts perceptions.

    Examples
    --------
    >>> count = PerceptionCount()
    >>> count.take()
    >>> for _ in range(4):
    ...     count.drive(0.2)
    ...     count.turn(0.5)
    >>> count.taken
    2
    """

    def __init__(self) -> None:
        self._taken = 0
        self._way = 0.0
        self._turns = 0

    @property
    def taken(self) -> int:
        """Number of perceptions."""
        return self._taken

    def take(self) -> None:
        """Count a perception that the robot stood for."""
        self._taken += 1
        self._way, self._turns = 0.0, 0

    def drive(self, way: float) -> None:
        """Take note that the robot has come a way on [m]."""
        self._way += abs(way)

    def turn(self, speed: float) -> None:
        """Take note that the turret is sent to another angle at some speed of the robot [m/s]."""
        self._turns += abs(speed) > DRIVING
        if self._turns >= TURNS and self._way >= WAY:
            self.take()
