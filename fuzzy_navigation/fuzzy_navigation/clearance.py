# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the infrared ring sees, and the clearance that it leaves to the body."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.types import InfraredReading, RangeReading
from fuzzy_navigation.params import InfraredParameters

__all__ = [
    "InfraredRing",
    "approach_speed",
    "clearance_at",
    "hit_points",
    "nearest_square",
]

Points = NDArray[np.float64]


def hit_points(
    readings: Sequence[RangeReading],
    mount_radius: float,
    min_range: float = 0.0,
    max_range: float = math.inf,
) -> Points:
    """Return where readings along a ray met a surface.

    Parameters
    ----------
    readings : sequence of RangeReading
        Each is placed at its own pose.
    mount_radius : float
        Distance of the sensors' faces from the robot's centre [m].
    min_range, max_range : float
        Bounds of a range that counts [m].

    Returns
    -------
    ndarray of float64, shape (n, 2)
        Hit points (x, y) [m] in the frame of the poses. REP 117: ``-inf`` is a hit at
        `min_range`; ``+inf``, ``nan`` and what lies beyond the bounds is none.
    """
    hits = []
    for reading in readings:
        distance = min_range if reading.range == -math.inf else reading.range
        if not min_range <= distance <= max_range or distance == math.inf:
            continue
        direction = reading.pose.theta + reading.bearing
        rho = mount_radius + distance
        hits.append(
            (
                reading.pose.x + rho * math.cos(direction),
                reading.pose.y + rho * math.sin(direction),
            )
        )
    return np.array(hits, dtype=np.float64).reshape(-1, 2)


def clearance_at(points: ArrayLike, hits: Points, robot_radius: float) -> NDArray[np.float64]:
    """Return the clearance that the body would have at each of some points.

    Parameters
    ----------
    points : array_like, shape (m, 2)
        Positions (x, y) of the robot's centre [m].
    hits : ndarray of float64, shape (n, 2)
        Hit points [m].
    robot_radius : float
        Radius of the body [m].

    Returns
    -------
    ndarray of float64, shape (m,)
        Distance from the body to the nearest hit point [m]; +inf without any.
    """
    positions = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    clearances = np.empty(len(positions))
    _clearances(for_kernel(positions), for_kernel(hits), robot_radius, for_kernel(clearances))
    return clearances


@njit
def nearest_square(x: float, y: float, hits: Points) -> float:
    """Return the squared distance [m^2] from (x, y) [m] to the nearest hit point."""
    square = math.inf
    for k in range(len(hits)):
        dx = x - hits[k, 0]
        dy = y - hits[k, 1]
        square = min(square, dx * dx + dy * dy)
    return square


@njit
def _clearances(
    places: Points, hits: Points, robot_radius: float, clearances: NDArray[np.float64]
) -> None:
    """Fill in the clearances at some places, as `clearance_at` says."""
    for i in range(len(places)):
        square = nearest_square(places[i, 0], places[i, 1], hits)
        clearances[i] = math.sqrt(square) - robot_radius


def approach_speed(clearance: float, deceleration: float, latency: float) -> float:
    """Return the speed [m/s] from which the robot still stands within its clearance.

    Solves ``v latency + v^2 / (2 deceleration) = clearance`` for v.

    Parameters
    ----------
    clearance : float
        Distance from the body to the nearest hit point [m]; below 0 counts as 0.
    deceleration : float
        With which the robot brakes [m/s^2].
    latency : float
        Time from the reading to the braking [s].
    """
    if clearance == math.inf:
        return math.inf
    lag = deceleration * latency
    return math.sqrt(lag * lag + 2.0 * deceleration * max(clearance, 0.0)) - lag


class InfraredRing:
    """The newest reading of each infrared sensor, and how old they are.

    Parameters
    ----------
    parameters : InfraredParameters
        The ring.
    """

    def __init__(self, parameters: InfraredParameters) -> None:
        self._newest: dict[int, InfraredReading] = {}
        self.adopt(parameters)

    def adopt(self, parameters: InfraredParameters) -> None:
        """Go by other parameters of the same sensors; their readings stay."""
        self._parameters = parameters
        # Asked for several times a tick.
        self._hits: tuple[float, float, Points] | None = None

    def update(self, readings: Sequence[InfraredReading]) -> None:
        """Take readings; one that is faulty (NaN) or older than its sensor's newest is none.

        Raises
        ------
        ValueError
            If a reading's sensor is not one of the ring's; then none is taken.
        """
        count = len(self._parameters.frame_ids)
        for reading in readings:
            if not 0 <= reading.sensor < count:
                raise ValueError(
                    f"infrared reading of sensor {reading.sensor}: the ring has sensors 0 to "
                    f"{count - 1}; see parameter 'infrared.frame_ids'"
                )
        self._hits = None
        for reading in readings:
            held = self._newest.get(reading.sensor)
            faulty = reading.range != reading.range
            if not faulty and (held is None or reading.stamp >= held.stamp):
                self._newest[reading.sensor] = reading

    def clear(self) -> None:
        """Forget all readings."""
        self._newest.clear()
        self._hits = None

    def hits(self, now: float, limit: float) -> Points:
        """Return the hit points (x, y) [m] of the last `limit` [s], shape (n, 2)."""
        if self._hits is None or self._hits[:2] != (now, limit):
            p = self._parameters
            points = hit_points(self.present(now, limit), p.mount_radius, p.min_range, p.max_range)
            self._hits = now, limit, points
        return self._hits[2]

    def present(self, now: float, limit: float) -> list[InfraredReading]:
        """Return the newest reading of each sensor, of the last `limit` [s]."""
        return [r for r in self._newest.values() if now - r.stamp <= limit]
