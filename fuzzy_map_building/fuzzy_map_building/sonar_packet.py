# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A packet of sonar readings as cones: which count, where they stand, what they say.

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

from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.params import SonarParameters
from fuzzy_map_building.types import RangeReading

__all__ = ["SAME_DIRECTION", "SonarPacket", "neighbour_limits"]

FloatArray = NDArray[np.float64]

#: Axes closer than this point the same way [rad]: above the play of a turret, below the
#: spacing of any ring.
SAME_DIRECTION = math.radians(1.0)

#: Columns of a cone: apex and axis as (x, y), direction, and the two ranges.
APEX_X, APEX_Y, AXIS_X, AXIS_Y, DIRECTION, EMPTY, OCCUPIED = range(7)

_TURN = 2.0 * math.pi
#: Why readings do not count, in the order that `_place` counts them in.
_REASONS = ("nan", "out_of_range", "lost_echo")


@dataclass(frozen=True, eq=False)
class SonarPacket:
    """The readings of a packet that count, one row each.

    Attributes
    ----------
    cones : ndarray of float64, shape (n, 7)
        What the properties below name.
    forward : float
        Distance [m] of every apex from the robot's centre, along the axis.
    rejected : dict of str to int
        Readings that do not count, by reason: ``nan``, ``out_of_range``, ``lost_echo``
        (only where lost echoes are ignored).
    """

    cones: FloatArray
    forward: float
    rejected: dict[str, int]

    @classmethod
    def from_readings(
        cls, readings: Sequence[RangeReading], sonar: SonarParameters
    ) -> SonarPacket:
        """Place the cones of a packet and decide what each reading says."""
        table = np.array(
            [v for r in readings for v in (r.pose.x, r.pose.y, r.pose.theta + r.bearing, r.range)],
            dtype=np.float64,
        )
        number = len(table) // 4
        cones = np.empty((number, 7))
        direction, returned = np.empty((2, number))
        counts = np.zeros(len(_REASONS), dtype=np.int64)
        forward = sonar.mount_radius if sonar.apex == "mount" else 0.0
        kept = _place(
            for_kernel(table),
            float(sonar.min_range),
            float(sonar.max_range),
            float(forward),
            float(sonar.mount_radius - forward),
            sonar.lost_echo == "ignore",
            sonar.lost_echo == "neighbours",
            for_kernel(direction),
            for_kernel(returned),
            for_kernel(cones),
            for_kernel(counts),
        )
        rejected = {r: n for r, n in zip(_REASONS, counts.tolist(), strict=True) if n}
        return cls(cones[:kept], forward, rejected)

    @property
    def apex(self) -> FloatArray:
        """Apex (x, y) [m] of each cone in ``map``, shape (n, 2)."""
        return self.cones[:, APEX_X : APEX_Y + 1]

    @property
    def axis(self) -> FloatArray:
        """Unit vector along each cone's axis in ``map``, shape (n, 2)."""
        return self.cones[:, AXIS_X : AXIS_Y + 1]

    @property
    def direction(self) -> FloatArray:
        """Direction of each cone's axis [rad] in ``map``, shape (n,)."""
        return self.cones[:, DIRECTION]

    @property
    def empty_range(self) -> FloatArray:
        """Distance [m] from each apex out to which the reading speaks of empty space.

        Shape (n,); 0: it does not.
        """
        return self.cones[:, EMPTY]

    @property
    def occupied_range(self) -> FloatArray:
        """Distance [m] from each apex of the arc that is believed occupied.

        Shape (n,); ``-inf``: the reading speaks of none.
        """
        return self.cones[:, OCCUPIED]

    def __len__(self) -> int:
        """Return the number of readings that count."""
        return len(self.cones)


@njit
def _place(
    table: FloatArray,
    min_range: float,
    max_range: float,
    forward: float,
    longer: float,
    ignore_lost: bool,
    ask_neighbours: bool,
    direction: FloatArray,
    returned: FloatArray,
    cones: FloatArray,
    counts: NDArray[np.int64],
) -> int:
    """Fill in the cones of a packet; return how many readings count.

    Parameters
    ----------
    table : ndarray of float64, shape (4 n,)
        x, y [m], direction [rad] and range [m] of each reading.
    min_range, max_range : float
        What the sonar can measure [m].
    forward, longer : float
        How far the apex lies ahead of the robot's centre, and the sonar's face ahead of the
        apex [m].
    ignore_lost, ask_neighbours : bool
        Whether a lost echo says nothing, and whether its neighbours limit what it says.
    direction, returned : ndarray of float64, shape (n,)
        Room for what the readings that count measured.
    cones : ndarray of float64, shape (n, 7)
        Where the cones go.
    counts : ndarray of int64, shape (3,)
        Refused readings by reason.
    """
    kept = 0
    lost = 0
    for i in range(len(table) // 4):
        value = table[4 * i + 3]
        if value != value:
            counts[0] += 1
            continue
        if value == -math.inf:
            value = min_range
            cones[kept, EMPTY] = 0.0
        elif value == math.inf:
            if ignore_lost:
                counts[2] += 1
                continue
            lost += 1
            cones[kept, EMPTY] = max_range
        elif min_range <= value <= max_range:
            cones[kept, EMPTY] = value
        else:
            counts[1] += 1
            continue
        angle = table[4 * i + 2]
        direction[kept] = angle
        returned[kept] = value
        # An angle beyond the floats has no direction; such a cone lies in no map.
        known = abs(angle) < math.inf
        cones[kept, AXIS_X] = math.cos(angle) if known else math.nan
        cones[kept, AXIS_Y] = math.sin(angle) if known else math.nan
        cones[kept, APEX_X] = table[4 * i] + forward * cones[kept, AXIS_X]
        cones[kept, APEX_Y] = table[4 * i + 1] + forward * cones[kept, AXIS_Y]
        cones[kept, DIRECTION] = angle
        kept += 1
    if ask_neighbours and 0 < lost < kept:
        limits = neighbour_limits(direction[:kept], returned[:kept])
        for i in range(kept):
            if cones[i, EMPTY] > limits[i]:
                cones[i, EMPTY] = limits[i]
    for i in range(kept):
        if cones[i, EMPTY] > 0.0:
            cones[i, EMPTY] += longer
        cones[i, OCCUPIED] = returned[i] + longer if returned[i] < math.inf else -math.inf
    return kept


@njit
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
    number = len(returned)
    limits = np.full(number, np.inf)
    for i in range(number):
        if returned[i] < math.inf:
            continue
        # Counter-clockwise and clockwise to the nearest reading of another direction.
        nearest_ahead = nearest_behind = _TURN
        for j in range(number):
            ahead = (direction[j] - direction[i]) % _TURN
            if SAME_DIRECTION < ahead < _TURN - SAME_DIRECTION:
                nearest_ahead = min(nearest_ahead, ahead)
                nearest_behind = min(nearest_behind, _TURN - ahead)
        limit = math.inf
        for j in range(number):
            if returned[j] < limit:
                ahead = (direction[j] - direction[i]) % _TURN
                if (
                    ahead <= SAME_DIRECTION
                    or ahead >= _TURN - SAME_DIRECTION
                    # Readings of the neighbour's own direction are neighbours, too.
                    or ahead <= nearest_ahead + SAME_DIRECTION
                    or _TURN - ahead <= nearest_behind + SAME_DIRECTION
                ):
                    limit = returned[j]
        limits[i] = limit
    return limits
