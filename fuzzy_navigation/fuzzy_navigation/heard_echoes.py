# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sonar returns on the way from what is not yet close to the body.

A corner of glass beside the path is heard from half a metre away and, off the axis of every
sonar, no more when the body is about to pass it. Infrareds do not see it at all. Single returns
from so far often come from elsewhere; those that come from one place while the robot moves on do
not.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from fuzzy_map_building.types import Pose2, SonarReading

__all__ = ["HeardEchoes"]

#: Returns whose places on the axes are no farther apart [m] may come from the same thing.
SAME = 0.08
#: So far [m] the robot has to come on between them: echoes of a robot that stands are all alike.
APART = 0.03
#: Returns that are kept of each kind; the oldest go.
KEPT = 128


class _Heard(NamedTuple):
    """A return, and where it seems to come from [m]."""

    echo: SonarReading
    x: float
    y: float

    def agrees(self, other: _Heard) -> bool:
        """Whether another return seems to come from there as well, heard from another place."""
        place = other.echo.pose
        # Asked of each that is kept, and most come from elsewhere.
        return (
            abs(self.x - other.x) <= SAME
            and math.hypot(self.x - other.x, self.y - other.y) <= SAME
            and self.echo.pose.distance_to(place.x, place.y) >= APART
        )


class HeardEchoes:
    """Remembers short returns until the robot is close to where they came from.

    Parameters
    ----------
    mount_radius : float
        Distance of the sonars' faces from the robot's centre [m].
    """

    def __init__(self, mount_radius: float) -> None:
        self.adopt(mount_radius)
        self._once: deque[_Heard] = deque(maxlen=KEPT)
        self._again: deque[_Heard] = deque(maxlen=KEPT)

    def adopt(self, mount_radius: float) -> None:
        """Go by another radius [m] from now on."""
        self._mount_radius = mount_radius

    def forget(self) -> None:
        """Forget all returns."""
        self._once.clear()
        self._again.clear()

    def take(self, echoes: Sequence[SonarReading], below: float) -> None:
        """Remember returns of a robot on its way.

        Parameters
        ----------
        echoes : sequence of SonarReading
            Readings, each placed at its own pose.
        below : float
            Distance from the robot's centre [m] below which they are remembered.
        """
        for echo in echoes:
            distance = echo.range + self._mount_radius
            if not 0.0 <= distance < below:
                continue
            angle, pose = echo.pose.theta + echo.bearing, echo.pose
            x, y = pose.x + distance * math.cos(angle), pose.y + distance * math.sin(angle)
            new = _Heard(echo, x, y)
            confirmed = [old for old in self._once if new.agrees(old)]
            for old in confirmed:
                self._once.remove(old)
            self._again.extend(confirmed)
            known = confirmed or any(new.agrees(old) for old in self._again)
            (self._again if known else self._once).append(new)

    def due(self, pose: Pose2, reach: float) -> list[SonarReading]:
        """Return, once, the returns heard more than once from where the robot is now close.

        Parameters
        ----------
        pose : Pose2
            Where the robot is.
        reach : float
            Distance from its centre [m] that is close.
        """
        here_x, here_y = pose.x, pose.y
        due = [h for h in self._again if math.hypot(h.x - here_x, h.y - here_y) < reach]
        for heard in due:
            self._again.remove(heard)
        return [heard.echo for heard in due]
