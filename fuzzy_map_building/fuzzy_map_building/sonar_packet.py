# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A packet of sonar readings as arrays: which count, where the cones stand, what they say.

REP 117 decides on the ranges: ``+inf`` is a lost echo, ``-inf`` an obstacle closer than
the sonar can measure, NaN a fault; any other value outside the sonar's limits is a fault
of the driver. What is refused is counted by its reason, never silently dropped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.params import SonarParameters
from fuzzy_map_building.types import RangeReading

__all__ = ["SAME_DIRECTION", "SonarPacket", "neighbour_limits"]

FloatArray = NDArray[np.float64]

#: Axes closer than this point the same way [rad]: above the play of a turret, below the
#: spacing of any ring.
SAME_DIRECTION = math.radians(1.0)


@dataclass(frozen=True)
class SonarPacket:
    """The readings of a packet that count, one row each.

    Attributes
    ----------
    apex : ndarray of float64, shape (n, 2)
        Apex (x, y) [m] of each cone in ``map``.
    axis : ndarray of float64, shape (n, 2)
        Unit vector along each cone's axis in ``map``.
    direction : ndarray of float64, shape (n,)
        Direction of each cone's axis [rad] in ``map``.
    empty_range : ndarray of float64, shape (n,)
        Distance [m] from the apex below which the reading speaks of empty space;
        0: it does not.
    occupied_range : ndarray of float64, shape (n,)
        Distance [m] from the apex of the arc that is believed occupied;
        ``-inf``: the reading speaks of none.
    forward : float
        Distance [m] of every apex from the robot's centre, along the axis.
    rejected : dict of str to int
        Readings that do not count, by reason: ``nan``, ``out_of_range``, ``lost_echo``
        (only where lost echoes are ignored).
    """

    apex: FloatArray
    axis: FloatArray
    direction: FloatArray
    empty_range: FloatArray
    occupied_range: FloatArray
    forward: float
    rejected: dict[str, int]

    @classmethod
    def from_readings(
        cls, readings: Sequence[RangeReading], sonar: SonarParameters
    ) -> SonarPacket:
        """Place the cones of a packet and decide what each reading says."""
        table = np.array(
            [(r.pose.x, r.pose.y, r.pose.theta + r.bearing, r.range) for r in readings],
            dtype=np.float64,
        ).reshape(-1, 4)
        ranges = table[:, 3]
        lost = ranges == np.inf
        close = ranges == -np.inf
        echo = (ranges >= sonar.min_range) & (ranges <= sonar.max_range)
        faulty = np.isnan(ranges)
        counts = {
            "nan": int(faulty.sum()),
            "out_of_range": int((~(faulty | lost | close | echo)).sum()),
            "lost_echo": int(lost.sum()) if sonar.lost_echo == "ignore" else 0,
        }
        kept = lost | close | echo
        returned = np.where(close, sonar.min_range, np.where(echo, ranges, np.inf))[kept]
        table = table[kept]

        reach = np.minimum(returned, sonar.max_range)
        if sonar.lost_echo == "neighbours":
            limits = neighbour_limits(table[:, 2], returned)
            reach = np.minimum(reach, limits)
        empty = np.where(close[kept], 0.0, reach)
        occupied = np.where(np.isinf(returned), -np.inf, returned)
        if sonar.lost_echo == "ignore":
            heard = ~np.isinf(returned)
            table, empty, occupied = table[heard], empty[heard], occupied[heard]

        axis = np.column_stack((np.cos(table[:, 2]), np.sin(table[:, 2])))
        apex = table[:, :2].copy()
        forward = 0.0
        if sonar.apex == "mount":
            forward = sonar.mount_radius
            apex += forward * axis
        else:
            empty = np.where(empty > 0.0, empty + sonar.mount_radius, 0.0)
            occupied = occupied + sonar.mount_radius
        rejected = {reason: count for reason, count in counts.items() if count}
        return cls(apex, axis, table[:, 2], empty, occupied, forward, rejected)

    def __len__(self) -> int:
        """Return the number of readings that count."""
        return len(self.empty_range)

    def select(self, chosen: NDArray[np.bool_]) -> SonarPacket:
        """Return the packet of the readings where `chosen`, shape (n,), is True."""
        return SonarPacket(
            self.apex[chosen],
            self.axis[chosen],
            self.direction[chosen],
            self.empty_range[chosen],
            self.occupied_range[chosen],
            self.forward,
            dict(self.rejected),
        )


def neighbour_limits(direction: FloatArray, returned: FloatArray) -> FloatArray:
    """Return how far the neighbours of each lost echo let it speak of empty space.

    A smooth wall under a slant sends no echo back. What is seen next to it tells how far
    away it may stand, so a lost echo is believed no farther than the shorter return among
    the readings of the same direction and the nearest ones on either side. Neighbours
    that lost their echo as well set no limit.

    Parameters
    ----------
    direction : ndarray of float64, shape (n,)
        Direction of each reading's axis [rad], around the circle.
    returned : ndarray of float64, shape (n,)
        Return of each reading [m], ``inf`` for a lost echo.

    Returns
    -------
    ndarray of float64, shape (n,)
        Limits [m] of the lost echoes; ``inf`` where there is none, and for readings that
        have their own return.
    """
    limits = np.full(len(returned), np.inf)
    lost = np.flatnonzero(np.isinf(returned))
    if not len(lost) or len(lost) == len(returned):
        return limits
    # Difference of every reading from every lost one, in [0, 2 pi) counter-clockwise.
    ahead = np.mod(direction[None, :] - direction[lost, None], 2.0 * math.pi)
    behind = np.mod(-ahead, 2.0 * math.pi)
    same = np.minimum(ahead, behind) <= SAME_DIRECTION
    counted = same.copy()
    for difference in (ahead, behind):
        side = np.where(same, np.inf, difference)
        # Readings of the neighbour's own direction are neighbours, too.
        counted |= side <= side.min(axis=1, keepdims=True) + SAME_DIRECTION
    limits[lost] = np.where(counted, returned[None, :], np.inf).min(axis=1)
    return limits
