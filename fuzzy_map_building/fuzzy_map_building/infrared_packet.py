# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Infrared readings as arrays: which count, where their rays start, where they end.

REP 117 decides on the ranges, as for the sonars: ``+inf`` saw nothing out to the sensor's
greatest range, ``-inf`` touched something closer than its least, NaN is a fault.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.sensor_params import InfraredParameters
from fuzzy_map_building.types import InfraredReading

__all__ = ["InfraredPacket"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class InfraredPacket:
    """The infrared readings that count, one row each; distances are from the robot's centre.

    Attributes
    ----------
    centre : ndarray of float64, shape (n, 2)
        Robot's centre (x, y) [m] in ``map`` when the reading was taken.
    direction : ndarray of float64, shape (n,)
        Direction of the ray [rad] in ``map``.
    hit : ndarray of float64, shape (n,)
        Distance [m] of the surface that was seen; ``inf``: none was.
    limit : ndarray of float64, shape (n,)
        Distance [m] beyond which the ray is not believed to be free; ``inf``: none.
    number : ndarray of int64, shape (n,)
        Place of the reading in the sequence that it came in.
    rejected : dict of str to int
        Readings that do not count, by reason: ``nan``, ``out_of_range``.
    """

    centre: FloatArray
    direction: FloatArray
    hit: FloatArray
    limit: FloatArray
    number: NDArray[np.int64]
    rejected: dict[str, int]

    @classmethod
    def from_readings(
        cls, readings: Sequence[InfraredReading], infrared: InfraredParameters
    ) -> InfraredPacket:
        """Place the rays of some readings and decide what each of them saw."""
        table = np.array(
            [(r.pose.x, r.pose.y, r.pose.theta + r.bearing, r.range, r.limit) for r in readings],
            dtype=np.float64,
        ).reshape(-1, 5)
        ranges = np.where(table[:, 3] == -np.inf, infrared.min_range, table[:, 3])
        faulty = np.isnan(ranges)
        counts = (ranges >= infrared.min_range) & (ranges <= infrared.max_range)
        counts |= ranges == np.inf
        number = np.flatnonzero(counts)
        refused = {"nan": int(faulty.sum()), "out_of_range": int((~(faulty | counts)).sum())}
        return cls(
            table[number, :2],
            table[number, 2],
            ranges[number] + infrared.mount_radius,
            table[number, 4] + infrared.mount_radius,
            number,
            {reason: count for reason, count in refused.items() if count},
        )

    def __len__(self) -> int:
        """Return the number of readings that count."""
        return len(self.hit)

    def select(self, chosen: NDArray[np.bool_]) -> InfraredPacket:
        """Return the packet of the readings where `chosen`, shape (n,), is True."""
        return InfraredPacket(
            self.centre[chosen],
            self.direction[chosen],
            self.hit[chosen],
            self.limit[chosen],
            self.number[chosen],
            dict(self.rejected),
        )

    def hit_points(self) -> FloatArray:
        """Return where surfaces were seen (x, y) [m], shape (m, 2)."""
        seen = np.isfinite(self.hit)
        ray = np.column_stack((np.cos(self.direction[seen]), np.sin(self.direction[seen])))
        points: FloatArray = self.centre[seen] + self.hit[seen, None] * ray
        return points
