# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the robot was, and how its turret stood, at the stamp of a reading.

Samples are kept for a while in the order of their stamps; between two of them, not too
far apart in time, the value is interpolated. Nothing is extrapolated: a stamp after the
newest sample has to wait, one before the oldest has no answer any more.
"""

from __future__ import annotations

import bisect
import math
from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from fuzzy_map_building.types import Pose2, wrap_angle

__all__ = ["MOST_SAMPLES", "AngleBuffer", "PoseBuffer", "StampedBuffer"]

T = TypeVar("T")

#: Most samples that are kept: a flood with stamps close together must not take all memory.
MOST_SAMPLES = 20_000


class StampedBuffer(ABC, Generic[T]):
    """Samples of a value that changes with time.

    Parameters
    ----------
    max_gap : float
        Samples farther apart than this [s] are not joined by interpolation.
    horizon : float
        Samples older than the newest by more than this [s] are forgotten, and the oldest where
        there are more than `MOST_SAMPLES`.
    """

    def __init__(self, max_gap: float, horizon: float) -> None:
        for name, value in (("max_gap", max_gap), ("horizon", horizon)):
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} must be positive and finite [s], got {value}")
        self._max_gap = max_gap
        self._horizon = horizon
        self._stamps: list[float] = []
        self._values: list[T] = []
        self._first: float | None = None
        #: Samples refused, by reason: ``not_finite``, ``duplicate``, ``out_of_order``.
        self.rejected: dict[str, int] = {}
        #: The sample refused last, in words, by reason.
        self.examples: dict[str, str] = {}

    def __len__(self) -> int:
        """Return the number of samples kept."""
        return len(self._stamps)

    @property
    def newest(self) -> float | None:
        """Stamp of the newest sample [s], None when there is none."""
        return self._stamps[-1] if self._stamps else None

    def clear(self) -> None:
        """Forget all samples, e.g. after the clock was set back; counts stay."""
        self._first = None
        self._stamps.clear()
        self._values.clear()

    def add(self, stamp: float, value: T) -> bool:
        """Keep a sample; stamps must increase.

        Returns
        -------
        bool
            False if it was refused, which is counted in `rejected`.
        """
        if not (math.isfinite(stamp) and self._finite(value)):
            return self.refuse("not_finite", f"stamped {stamp} s with {value}")
        newest = self.newest
        if newest is not None and stamp <= newest:
            reason = "duplicate" if stamp == newest else "out_of_order"
            return self.refuse(reason, f"stamped {stamp:.3f} s, after {newest:.3f} s")
        if self._first is None:
            self._first = stamp
        self._stamps.append(stamp)
        self._values.append(value)
        # Dropped half by half, so that a sample costs constant time on average.
        count, oldest = len(self._stamps), stamp - self._horizon
        if count > MOST_SAMPLES or self._stamps[count // 2] < oldest:
            old = bisect.bisect_left(self._stamps, oldest)
            if count > MOST_SAMPLES:
                old = max(old, count // 2 + 1)
            del self._stamps[:old], self._values[:old]
        return True

    def at(self, stamp: float) -> T | None:
        """Return the value at `stamp` [s], None where it is not known (yet)."""
        after = bisect.bisect_left(self._stamps, stamp)
        if after == len(self._stamps):
            return None
        if self._stamps[after] == stamp:
            return self._values[after]
        if after == 0:
            return None
        start, end = self._stamps[after - 1], self._stamps[after]
        if end - start > self._max_gap:
            return None
        fraction = (stamp - start) / (end - start)
        return self._between(self._values[after - 1], self._values[after], fraction)

    def missed(self, stamp: float) -> bool:
        """Whether `stamp` [s] has no value and no later sample can give it one."""
        newest = self.newest
        return newest is not None and stamp <= newest and self.at(stamp) is None

    def precedes(self, stamp: float) -> bool:
        """Whether `stamp` [s] lies a little before the first sample of all, within the horizon."""
        first = self._first
        return first is not None and first - self._horizon <= stamp < first

    def refuse(self, reason: str, example: str) -> bool:
        """Count a sample that cannot be taken, for which `example` stands, and return False."""
        self.rejected[reason] = self.rejected.get(reason, 0) + 1
        self.examples[reason] = example
        return False

    @abstractmethod
    def _finite(self, value: T) -> bool:
        """Return whether a sample can be used."""

    @abstractmethod
    def _between(self, start: T, end: T, fraction: float) -> T:
        """Return the value at a fraction of the way from one sample to the next."""


class PoseBuffer(StampedBuffer[Pose2]):
    """Poses of the robot; the heading turns the short way.

    Examples
    --------
    >>> poses = PoseBuffer(max_gap=0.5, horizon=10.0)
    >>> poses.add(1.0, Pose2(0.0, 0.0, 3.0)), poses.add(1.2, Pose2(0.2, 0.0, -3.0))
    (True, True)
    >>> round(poses.at(1.1).x, 6), round(abs(poses.at(1.1).theta), 3)
    (0.1, 3.142)
    """

    def _finite(self, value: Pose2) -> bool:
        return True  # Pose2 holds nothing else

    def _between(self, start: Pose2, end: Pose2, fraction: float) -> Pose2:
        return Pose2(
            start.x + fraction * (end.x - start.x),
            start.y + fraction * (end.y - start.y),
            wrap_angle(start.theta + fraction * wrap_angle(end.theta - start.theta)),
        )


class AngleBuffer(StampedBuffer[float]):
    """Angles [rad], e.g. of the turret, interpolated the short way."""

    def _finite(self, value: float) -> bool:
        return math.isfinite(value)

    def _between(self, start: float, end: float, fraction: float) -> float:
        return start + fraction * wrap_angle(end - start)
