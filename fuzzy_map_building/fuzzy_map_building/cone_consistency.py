# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which part of a sonar's arc the other readings of the packet leave.

A range says that something is on the arc, not where. A longer reading that looks along part
of the arc vetoes that part: there its own sound went on. What remains is rescaled, since the
echo came from somewhere, so that the belief of occupied gathers where the readings agree.

Reading i has the direction b_i and the range r_i from the robot's centre. In the direction
phi within its cone

    c_i(phi) = 1 - max_j clip((r_j - r_i - threshold) / ramp, 0, 1)
    w_i(phi) = sqrt(D(phi - b_i)) c_i(phi) / max over phi of the same

over the readings j with ``|phi - b_j| <= half_width``. Where nothing of the arc remains
(maximum not above the floor), w_i is D. A lost echo vetoes with the range out to which it is
believed empty. Of a reading taken elsewhere r_j is what it reaches along b_i, seen from where
reading i was taken.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.directivity import lobe_at
from fuzzy_map_building.jit import njit
from fuzzy_map_building.sonar_packet import (
    APEX_X,
    APEX_Y,
    AXIS_X,
    AXIS_Y,
    DIRECTION,
    EMPTY,
    OCCUPIED,
)

__all__ = ["consistency", "find_vetoes", "greatest_rest"]

FloatArray = NDArray[np.float64]

#: Slack of a comparison of angles [rad], so that equal ones do not depend on rounding.
_ROUNDING = 1e-9


@njit
def find_vetoes(
    i: int,
    cones: FloatArray,
    forward: float,
    half_angle: float,
    half_width: float,
    threshold: float,
    ramp: float,
    max_offset: float,
    vetoes: FloatArray,
) -> int:
    """Collect the vetoes of a packet's readings against one of them.

    Parameters
    ----------
    i : int
        Number of the vetoed reading, which speaks of an arc.
    cones, forward
        Of the `SonarPacket`, with all of its readings, also those that do not see the map.
    half_angle : float
        Half of a cone's angle [rad].
    half_width, threshold, ramp, max_offset : float
        The rule, see `ConsistencyParameters`.
    vetoes : ndarray of float64, shape (2 n,)
        Where they go: direction [rad] from the axis of the vetoed reading, and strength in
        ]0, 1], of one veto after the other.

    Returns
    -------
    int
        Number of vetoes.
    """
    ux = cones[i, AXIS_X]
    uy = cones[i, AXIS_Y]
    own = cones[i, OCCUPIED] + forward + threshold
    meet = half_angle + half_width + 2.0 * _ROUNDING
    # Most readings look elsewhere, and the product of two axes tells so at once.
    least_cosine = math.cos(min(meet, math.pi)) - _ROUNDING
    # The robot's centre when the reading was taken.
    x = cones[i, APEX_X] - forward * ux
    y = cones[i, APEX_Y] - forward * uy
    count = 0
    for j in range(len(cones)):
        vx = cones[j, AXIS_X]
        vy = cones[j, AXIS_Y]
        if not ux * vx + uy * vy >= least_cosine:
            continue
        away_x = cones[j, APEX_X] - forward * vx - x
        away_y = cones[j, APEX_Y] - forward * vy - y
        reach = max(cones[j, EMPTY], cones[j, OCCUPIED]) + forward
        strength = (reach + away_x * ux + away_y * uy - own) / ramp
        # Too far away for a float is no veto, either.
        if not (strength > 0.0 and abs(away_y * ux - away_x * uy) <= max_offset):
            continue
        turn = (cones[j, DIRECTION] - cones[i, DIRECTION] + math.pi) % (2.0 * math.pi) - math.pi
        if abs(turn) <= meet:
            vetoes[2 * count] = turn
            vetoes[2 * count + 1] = min(strength, 1.0)
            count += 1
    return count


@njit
def consistency(theta: float, vetoes: FloatArray, count: int, half_width: float) -> float:
    """Return c at an angle [rad] from the axis of a reading with some vetoes."""
    veto = 0.0
    for k in range(count):
        if vetoes[2 * k + 1] > veto and abs(theta - vetoes[2 * k]) <= half_width + _ROUNDING:
            veto = vetoes[2 * k + 1]
    return 1.0 - veto


@njit
def greatest_rest(
    vetoes: FloatArray,
    count: int,
    half_width: float,
    half_angle: float,
    table: FloatArray,
    fineness: float,
) -> float:
    """Return the maximum of ``sqrt(D) c`` over the cone of a reading with some vetoes.

    c is constant between the borders of where readings look, and D falls from the axis
    on: the maximum lies on the axis, or where a veto ends.
    """
    most = consistency(0.0, vetoes, count, half_width)
    for k in range(count):
        for side in (-1.0, 1.0):
            border = vetoes[2 * k] + side * half_width
            if abs(border) > half_angle:
                continue
            arc = math.sqrt(lobe_at(table, fineness, math.sin(border) ** 2))
            if arc > most:
                # Just beyond the border, where this veto is over and others may have begun.
                beyond = border + side * 2.0 * _ROUNDING
                most = max(most, arc * consistency(beyond, vetoes, count, half_width))
    return most
