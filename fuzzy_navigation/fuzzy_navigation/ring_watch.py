# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which sensors of a ring cannot be trusted: those that fell silent, and those that are stuck."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fuzzy_map_building.types import RangeReading, wrap_angle

__all__ = ["RingWatch"]


@dataclass
class _Heard:
    """The newest reading of a sensor, and what it has turned by since its range was another."""

    stamp: float
    range: float
    direction: float
    turned: float = 0.0


class RingWatch:
    """Watches over the readings of a ring.

    A sensor that measures tells another range once it has turned; one that goes on telling
    exactly the same is stuck. What is no distance, or at a limit of the sensor, may well stay
    the same: nothing follows from it.

    Parameters
    ----------
    frames : sequence of str
        Frames of the sensors, by which they are named.
    min_range, max_range : float
        Limits between which a range is a distance [m].
    """

    def __init__(self, frames: Sequence[str], min_range: float, max_range: float) -> None:
        self._frames = tuple(frames)
        self.adopt(min_range, max_range)
        self._heard: dict[int, _Heard] = {}

    def adopt(self, min_range: float, max_range: float) -> None:
        """Go by other limits, those of the constructor."""
        self._limits = min_range, max_range

    def clear(self) -> None:
        """Forget all readings."""
        self._heard.clear()

    def update(self, readings: Sequence[RangeReading]) -> None:
        """Take readings; one that is faulty (NaN) or older than its sensor's newest is none."""
        low, high = self._limits
        for reading in readings:
            distance = reading.range
            if distance != distance:
                continue
            heard = self._heard.get(reading.sensor)
            if heard is None or distance != heard.range:
                if heard is None or reading.stamp >= heard.stamp:
                    direction = reading.pose.theta + reading.bearing
                    self._heard[reading.sensor] = _Heard(reading.stamp, distance, direction)
            elif reading.stamp >= heard.stamp:
                heard.stamp = reading.stamp
                if low < distance < high:
                    direction = reading.pose.theta + reading.bearing
                    turned = abs(wrap_angle(direction - heard.direction))
                    heard.turned = max(heard.turned, turned)

    def silent(self, now: float, limit: float) -> list[str]:
        """Return the frames of the sensors without a reading of the last `limit` [s]."""
        return [
            frame
            for sensor, frame in enumerate(self._frames)
            if sensor not in self._heard or now - self._heard[sensor].stamp > limit
        ]

    def stuck(self, turn: float) -> list[str]:
        """Return the frames of the sensors that have told one range while they turned by `turn`.

        Parameters
        ----------
        turn : float
            Angle [rad].
        """
        low, high = self._limits
        sensors = [
            sensor
            for sensor, heard in self._heard.items()
            if heard.turned >= turn and low < heard.range < high
        ]
        return [self._frames[s] for s in sorted(sensors) if 0 <= s < len(self._frames)]
