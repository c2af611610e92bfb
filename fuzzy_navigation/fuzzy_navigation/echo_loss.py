# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whether the sonars hear again what they heard just before: a ring that does not is partly deaf.

That a wall does not echo says nothing. But what has echoed from close by echoes again, as long as
the robot and the beam are where they were: of a healthy ring hardly an echo is missing from the
next reading, of one that is partly deaf a good share.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

from fuzzy_map_building.sensor_params import SonarParameters
from fuzzy_map_building.types import SonarReading

__all__ = ["EchoLoss"]

#: Echoes from close by that are remembered: whether the next reading had them, too.
WINDOW = 64
#: From so many of them missing on a ring loses echoes, until fewer than `SOUND` are. Of a healthy
#: one at most 9 were missing, in 194 missions of all kinds and 40 halls; of one that is deaf half
#: the time 18 or more in each of 120 halls.
LOSSY, SOUND = 16, 8
#: From so many on it guards nobody, however slowly he drives.
DEAF = 56
#: Part of the sonars' greatest range within which an echo is to be heard again.
CLOSE = 0.65
#: Time [s], way [m] and turn [rad] up to which the next reading of a sonar tells of the same.
SOON, MOVED, TURNED = 0.5, 0.1, math.radians(3.0)


class EchoLoss:
    """Counts the echoes that the next reading of the same sonar lacks.

    Parameters
    ----------
    sonar : SonarParameters
        The ring.
    """

    def __init__(self, sonar: SonarParameters) -> None:
        self.adopt(sonar)
        #: The newest reading of each sonar.
        self._last: dict[int, SonarReading] = {}
        #: Of the newest echoes from close by, whether the next reading lacked them.
        self._missing: deque[bool] = deque(maxlen=WINDOW)
        self._lost = 0

    @property
    def lost(self) -> int:
        """Of `WINDOW` echoes those missing when the ring began to lose them; 0 if it does not."""
        return self._lost

    @property
    def deaf(self) -> str:
        """Why the ring guards nobody, in words; empty if it does."""
        missing = sum(self._missing)
        if missing < DEAF:
            return ""
        return f"of {WINDOW} echoes from close by sonars lack {missing} in their next reading"

    def adopt(self, sonar: SonarParameters) -> None:
        """Go by other parameters of the same ring from now on."""
        self._max_range = sonar.max_range

    def clear(self) -> None:
        """Forget all echoes."""
        self._last.clear()
        self._missing.clear()
        self._lost = 0

    def update(self, readings: Sequence[SonarReading]) -> None:
        """Take readings, each placed at its own pose; one that is faulty (NaN) is none."""
        for reading in readings:
            if math.isnan(reading.range):
                continue
            before = self._last.get(reading.sensor)
            self._last[reading.sensor] = reading
            if before is None or before.range >= CLOSE * self._max_range:
                continue
            if _same_view(before, reading):
                self._missing.append(reading.range >= self._max_range)
        missing = sum(self._missing)
        if missing < (SOUND if self._lost else LOSSY) or len(self._missing) < WINDOW:
            self._lost = 0
        elif not self._lost:
            self._lost = missing


def _same_view(before: SonarReading, now: SonarReading) -> bool:
    """Whether two readings of one sonar tell of the same place."""
    turned = now.pose.theta + now.bearing - before.pose.theta - before.bearing
    return (
        0.0 < now.stamp - before.stamp < SOON
        and before.pose.distance_to(now.pose.x, now.pose.y) < MOVED
        and abs(math.remainder(turned, math.tau)) < TURNED
    )
