# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whether the sonars hear at all: a ring that is deaf tells what open space tells.

That there is no echo says much only where there should be one. Of a single sonar it says little,
for smooth walls send most echoes elsewhere; of all of them, round after round, turned to what
infrareds see or to where echoes came from just before, it says that they are deaf.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.sensor_params import SonarParameters
from fuzzy_map_building.types import SonarReading

__all__ = ["HearingWatch"]

Points = NDArray[np.float64]

#: Rounds of the whole ring almost without an echo that make a silence. In 105 missions in
#: generated worlds the longest silence of a ring that hears was half a round.
ROUNDS = 4
#: One in so many readings may be an echo all the same: a ring that is all but deaf.
STRAY = 32
#: So many points that infrareds see, or that echoes came from, have to be in the beams.
WITNESSES = 3
#: Part of the sonars' greatest range within which echoes that came before are to be heard again.
CLOSE = 0.5
#: Rounds whose echoes are kept, as many as a perception has; the oldest go.
KEPT = 3


class HearingWatch:
    """Watches over the sonars of a robot as a whole.

    Parameters
    ----------
    sonar : SonarParameters
        The ring.
    """

    def __init__(self, sonar: SonarParameters) -> None:
        count = len(sonar.frame_ids)
        self.adopt(sonar)
        self._echoes: deque[tuple[float, float]] = deque(maxlen=KEPT * count)
        #: Where the newest beams began, x, y [m], their directions [rad], and whether they echoed.
        self._beams: deque[tuple[float, float, float, bool]] = deque(maxlen=ROUNDS * count)

    def adopt(self, sonar: SonarParameters) -> None:
        """Go by other parameters of the same ring from now on."""
        self._sonar = sonar

    def clear(self) -> None:
        """Forget the silence and, as after a pose that jumped, where echoes came from."""
        self._echoes.clear()
        self._beams.clear()

    def update(self, readings: Sequence[SonarReading]) -> None:
        """Take readings, each placed at its own pose; one that is faulty (NaN) is none."""
        for reading in readings:
            distance, pose = reading.range, reading.pose
            angle = pose.theta + reading.bearing
            if distance != distance:
                continue
            echoed = distance < self._sonar.max_range
            self._beams.append((pose.x, pose.y, angle, echoed))
            if echoed:
                reach = max(distance, 0.0) + self._sonar.mount_radius
                place = pose.x + reach * math.cos(angle), pose.y + reach * math.sin(angle)
                self._echoes.append(place)

    def deaf(self, seen: Points, open_space: bool) -> str:
        """Return why the sonars must be deaf, in words; empty if they need not be.

        Parameters
        ----------
        seen : ndarray of float64, shape (n, 2)
            Points (x, y) [m] that infrareds see now.
        open_space : bool
            Whether sonars that hear nothing may be in open space, whatever they heard before.
        """
        count = ROUNDS * len(self._sonar.frame_ids)
        if len(self._beams) < count or sum(b[3] for b in self._beams) > count // STRAY:
            return ""
        silence = "hardly any sonar hears an echo"
        beams = np.array(self._beams)
        close = CLOSE * self._sonar.max_range
        if (witnesses := self._in_beams(seen, beams, close)) >= WITNESSES:
            return f"{silence}, though infrareds see {witnesses} points that should echo"
        if open_space:
            return ""
        where = "where sonars may be in open space wider than their reach, set 'watch.open_space'"
        echoes = np.array(self._echoes).reshape(-1, 2)
        if (witnesses := self._in_beams(echoes, beams, close)) >= WITNESSES:
            told = f"though {witnesses} came from less than {close:.1f} m away before"
            return f"{silence}, {told}; {where}"
        if not self._echoes and self._all_around(beams):
            return f"{silence}, as if all were deaf; {where}"
        return ""

    def _in_beams(self, points: Points, beams: Points, close: float) -> int:
        """Return how many points lie in beams, no farther than a distance [m]."""
        x, y = points[:, None, 0] - beams[:, 0], points[:, None, 1] - beams[:, 1]
        inside = np.cos(np.arctan2(y, x) - beams[:, 2]) >= math.cos(
            0.5 * self._sonar.field_of_view
        )
        return int((inside & (np.hypot(x, y) <= close)).any(axis=1).sum())

    def _all_around(self, beams: Points) -> bool:
        """Whether the beams leave no gap between them."""
        angles = np.sort(np.mod(beams[:, 2], math.tau))
        gaps = np.diff(angles, append=angles[0] + math.tau)
        return bool(gaps.max() <= self._sonar.field_of_view)
