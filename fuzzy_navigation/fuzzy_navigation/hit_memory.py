# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the sensors hit at the last perception and on the way since.

A ring of infrareds sees little from one place. What it saw from the places before tells of
the same surfaces, but not for ever: somebody may have moved. The memory reaches back to the
last perception, like the path that the robot follows. Of a robot that maps on its way it reaches
back a way, and a perception renews what can be seen from where it is made.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.sensor_params import InfraredParameters
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation.clearance import hit_points

__all__ = ["HitMemory"]

Points = NDArray[np.float64]

#: Distance between places whose hit points are kept: a cell of the paper's maps [m].
STEP = 0.1
#: Readings of one sensor, of a robot that stands, that its median is taken of.
SWEEPS = 21
#: Turret angles closer than this are one stand [rad].
STAND = math.radians(2.5)
#: Readings of a standing robot's sensor that differ by more than this [m] are not noise as usual,
#: and so often in a row they do where nothing comes and goes.
FLIP, FLIPS = 0.1, 4
#: Looks of a robot on its way after which it forgets what it has not seen since: about as long as
#: an infrared counts in the map of one that stands for each. Of walls that are forgotten sooner it
#: tries the way through once more.
LOOKS = 8
#: Points closer than this in x and y are one [m]; bounds the memory.
RASTER = 0.005


class HitMemory:
    """Hit points of one perception and of the cells passed since.

    While the robot stands each infrared counts by the median of its readings, whose noise
    would otherwise eat up the clearance; on the way one sweep of the ring counts for each cell.

    Parameters
    ----------
    infrared : InfraredParameters
        The ring.
    """

    def __init__(self, infrared: InfraredParameters) -> None:
        self.adopt(infrared)
        self.forget()

    def adopt(self, infrared: InfraredParameters) -> None:
        """Go by other parameters of the same ring; what is remembered stays."""
        self._infrared = infrared
        self._array: Points | None = None
        self._stood_array: Points | None = None

    def forget(self) -> None:
        """Forget everything: a perception begins."""
        self._standing: dict[int, deque[InfraredReading]] = {}
        self._echoes: dict[tuple[int, int], SonarReading] = {}
        self._points: dict[tuple[int, int], tuple[float, float]] = {}
        self._guesses: dict[tuple[int, int], tuple[float, float]] = {}
        # How many looks ago each was last seen.
        self._unseen: dict[tuple[int, int], int] = {}
        self._kept: set[tuple[int, int]] = set()
        self._stood_before = False
        self._last: Pose2 | None = None
        self._array = self._stood_array = None

    def forget_near(self, place: Pose2, reach: float) -> None:
        """Forget what lies within a distance [m] of a place where a perception begins."""
        points, guesses = (
            {key: point for key, point in hits.items() if place.distance_to(*point) > reach}
            for hits in (self._points, self._guesses)
        )
        stood, unseen = self.standing, self._unseen
        self.forget()
        self._points, self._guesses, self._unseen = points, guesses, unseen
        self.add(stood[np.hypot(stood[:, 0] - place.x, stood[:, 1] - place.y) > reach])
        self._kept = {*self._points, *self._guesses}

    def forget_kept(self) -> bool:
        """Forget what `forget_near` has kept; return whether there was anything."""
        kept = [key for key in self._kept if key in self._points or key in self._guesses]
        self._drop(kept)
        self._kept = set()
        return len(kept) > 0

    def outdate(self) -> None:
        """Take note of a look on the way: forget what was last seen `LOOKS` looks ago."""
        if self._stood_before:
            self.add(self.standing)
            self._standing.clear()
            self._echoes.clear()
        self._stood_before = True
        looks = self._unseen
        self._unseen = {key: looks.get(key, -1) + 1 for key in (*self._points, *self._guesses)}
        self._drop([key for key, unseen in self._unseen.items() if unseen >= LOOKS])
        self._stood_array = None

    def _drop(self, keys: Iterable[tuple[int, int]]) -> None:
        for key in keys:
            self._points.pop(key, None)
            self._guesses.pop(key, None)
        self._array = None

    @property
    def points(self) -> Points:
        """All hit points (x, y) [m], shape (n, 2)."""
        if self._array is None:
            self._array = np.vstack([self.standing, self.added])
        return self._array

    @property
    def standing(self) -> Points:
        """The hit points (x, y) [m] of the infrareds at the perception, shape (n, 2)."""
        if self._stood_array is None:
            p = self._infrared
            rays = self.infrared
            self._stood_array = hit_points(rays, p.mount_radius, p.min_range, p.max_range)
        return self._stood_array

    @property
    def added(self) -> Points:
        """The hit points (x, y) [m] that are not the infrareds' at the perception, (n, 2)."""
        added = [*self._points.values(), *self._guesses.values()]
        return np.array(added, dtype=np.float64).reshape(-1, 2)

    @property
    def measured(self) -> Points:
        """The hit points (x, y) [m] but for those whose distance is a guess, shape (n, 2)."""
        return self.points[: len(self.points) - self.guesses]

    @property
    def guesses(self) -> int:
        """How many points at the end of `points` and `added` are guesses."""
        return len(self._guesses)

    @property
    def infrared(self) -> list[InfraredReading]:
        """One reading of each sensor, of the perception: the median one."""
        return [
            sorted(readings, key=lambda reading: reading.range)[(len(readings) - 1) // 2]
            for readings in self._standing.values()
        ]

    @property
    def unsteady(self) -> int:
        """How many infrareds told of something that came and went again and again."""
        farthest = self._infrared.max_range
        count = 0
        for readings in self._standing.values():
            ranges = np.clip([reading.range for reading in readings], 0.0, farthest)
            count += int((np.abs(np.diff(ranges)) > FLIP).sum() >= FLIPS)
        return count

    @property
    def sonar(self) -> list[SonarReading]:
        """The newest reading of each sonar at each stand of the turret, of the perception."""
        return list(self._echoes.values())

    def stand(
        self, infrared: Sequence[InfraredReading], sonar: Sequence[SonarReading] = ()
    ) -> None:
        """Take readings of a robot that stands at its perception."""
        self._array = self._stood_array = None
        for reading in infrared:
            if not math.isnan(reading.range):
                kept = self._standing.setdefault(reading.sensor, deque(maxlen=SWEEPS))
                kept.append(reading)
                self._last = reading.pose
        for echo in sonar:
            self._echoes[echo.sensor, round(echo.bearing / STAND)] = echo

    def pass_by(self, pose: Pose2, hits: Points) -> None:
        """Take the hit points of the ring at a pose, if it is a cell on from the last taken."""
        if self._last is None or pose.distance_to(self._last.x, self._last.y) >= STEP:
            self._last = pose
            self.add(hits)

    def add(self, points: Points, *, guessed: bool = False) -> None:
        """Take points (x, y) [m], shape (n, 2); their distance may be a guess."""
        kept = self._guesses if guessed else self._points
        for x, y in points.tolist():
            self._array = None
            key = round(x / RASTER), round(y / RASTER)
            self._unseen.pop(key, None)
            self._kept.discard(key)
            if key not in self._points:
                kept.setdefault(key, (x, y))
