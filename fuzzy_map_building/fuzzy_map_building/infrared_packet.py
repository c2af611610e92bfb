# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Infrared readings as rays: which count, where they start, where they end.

REP 117 decides on the ranges, as for the sonars: ``+inf`` saw nothing out to the sensor's
greatest range, ``-inf`` touched something closer than its least, NaN is a fault.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.sensor_params import InfraredParameters
from fuzzy_map_building.types import InfraredReading

__all__ = ["InfraredPacket"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Columns of a ray: centre (x, y), unit vector, direction, and the two distances.
CENTRE_X, CENTRE_Y, RAY_X, RAY_Y, DIRECTION, HIT, LIMIT = range(7)

#: Why readings do not count, in the order that `_place` counts them in.
_REASONS = ("nan", "out_of_range")


@dataclass(frozen=True, eq=False)
class InfraredPacket:
    """The infrared readings that count, one row each; distances are from the robot's centre.

    Attributes
    ----------
    rays : ndarray of float64, shape (n, 7)
        What the properties below name.
    number : ndarray of int64, shape (n,)
        Place of the reading in the sequence that it came in.
    rejected : dict of str to int
        Readings that do not count, by reason: ``nan``, ``out_of_range``.
    """

    rays: FloatArray
    number: IntArray
    rejected: dict[str, int]

    @classmethod
    def from_readings(
        cls, readings: Sequence[InfraredReading], infrared: InfraredParameters
    ) -> InfraredPacket:
        """Place the rays of some readings and decide what each of them saw."""
        table = np.array(
            [
                v
                for r in readings
                for v in (r.pose.x, r.pose.y, r.pose.theta + r.bearing, r.range, r.limit)
            ],
            dtype=np.float64,
        )
        rays = np.empty((len(table) // 5, 7))
        number = np.empty(len(rays), dtype=np.int64)
        counts = np.zeros(len(_REASONS), dtype=np.int64)
        kept = _place(
            for_kernel(table),
            float(infrared.min_range),
            float(infrared.max_range),
            float(infrared.mount_radius),
            for_kernel(rays),
            for_kernel(number),
            for_kernel(counts),
        )
        rejected = {r: n for r, n in zip(_REASONS, counts.tolist(), strict=True) if n}
        return cls(rays[:kept], number[:kept], rejected)

    @property
    def centre(self) -> FloatArray:
        """Robot's centre (x, y) [m] in ``map`` when each reading was taken, shape (n, 2)."""
        return self.rays[:, CENTRE_X : CENTRE_Y + 1]

    @property
    def direction(self) -> FloatArray:
        """Direction of each ray [rad] in ``map``, shape (n,)."""
        return self.rays[:, DIRECTION]

    @property
    def hit(self) -> FloatArray:
        """Distance [m] of the surface that was seen, shape (n,); ``inf``: none was."""
        return self.rays[:, HIT]

    @property
    def limit(self) -> FloatArray:
        """Distance [m] beyond which a ray is not believed to be free, shape (n,)."""
        return self.rays[:, LIMIT]

    def __len__(self) -> int:
        """Return the number of readings that count."""
        return len(self.rays)

    def limited(self, limit: FloatArray) -> InfraredPacket:
        """Return the packet with rays believed no farther than some distances [m], shape (n,)."""
        rays = self.rays.copy()
        np.minimum(rays[:, LIMIT], limit, out=rays[:, LIMIT])
        return InfraredPacket(rays, self.number, self.rejected)

    def hit_points(self) -> FloatArray:
        """Return where surfaces were seen (x, y) [m], shape (m, 2)."""
        seen = self.rays[np.isfinite(self.hit)]
        return seen[:, CENTRE_X : CENTRE_Y + 1] + seen[:, HIT, None] * seen[:, RAY_X : RAY_Y + 1]


@njit
def _place(
    table: FloatArray,
    min_range: float,
    max_range: float,
    mount_radius: float,
    rays: FloatArray,
    number: IntArray,
    counts: IntArray,
) -> int:
    """Fill in the rays of a packet; return how many readings count.

    Parameters
    ----------
    table : ndarray of float64, shape (5 n,)
        x, y [m], direction [rad], range and limit [m] of each reading.
    min_range, max_range : float
        What the sensor can measure [m].
    mount_radius : float
        Distance of the sensor's face from the robot's centre [m].
    rays : ndarray of float64, shape (n, 7)
        Where the rays go.
    number : ndarray of int64, shape (n,)
        Where the places of the readings that count go.
    counts : ndarray of int64, shape (2,)
        Refused readings by reason.
    """
    kept = 0
    for i in range(len(table) // 5):
        value = table[5 * i + 3]
        if value != value:
            counts[0] += 1
            continue
        if value == -math.inf:
            value = min_range
        elif not (min_range <= value <= max_range or value == math.inf):
            counts[1] += 1
            continue
        angle = table[5 * i + 2]
        # An angle beyond the floats has no direction; such a ray lies in no map.
        known = abs(angle) < math.inf
        rays[kept, RAY_X] = math.cos(angle) if known else math.nan
        rays[kept, RAY_Y] = math.sin(angle) if known else math.nan
        rays[kept, CENTRE_X] = table[5 * i]
        rays[kept, CENTRE_Y] = table[5 * i + 1]
        rays[kept, DIRECTION] = angle
        rays[kept, HIT] = value + mount_radius
        rays[kept, LIMIT] = table[5 * i + 4] + mount_radius
        number[kept] = i
        kept += 1
    return kept
