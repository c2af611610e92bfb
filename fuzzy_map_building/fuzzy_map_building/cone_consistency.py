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

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.evidence_params import ConsistencyParameters
from fuzzy_map_building.sonar_packet import SonarPacket

__all__ = ["ConeConsistency"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Slack of a comparison of angles [rad], so that equal ones do not depend on rounding.
_ROUNDING = 1e-9
#: Pairs of readings compared at a time; bounds the memory of a packet of many readings.
_PAIRS_A_PASS = 1_000_000


@dataclass(frozen=True)
class ConeConsistency:
    """The vetoes against each reading of a packet, one row each.

    Attributes
    ----------
    offset : ndarray of float64, shape (n, k)
        Direction [rad] of each vetoing reading from the axis of the vetoed one.
    strength : ndarray of float64, shape (n, k)
        How much it vetoes, in [0, 1]; 0 fills up the rows.
    scale : ndarray of float64, shape (n,)
        Maximum of ``sqrt(D) c`` over the cone.
    parameters : ConsistencyParameters
    """

    offset: FloatArray
    strength: FloatArray
    scale: FloatArray
    parameters: ConsistencyParameters

    @classmethod
    def of_packet(
        cls,
        packet: SonarPacket,
        half_angle: float,
        directivity: Callable[[FloatArray], FloatArray],
        parameters: ConsistencyParameters,
    ) -> ConeConsistency:
        """Let the readings of a packet judge one another.

        Parameters
        ----------
        packet : SonarPacket
            All of its readings, also those that do not see the map.
        half_angle : float
            Half of the cone's angle [rad].
        directivity : callable
            D of angles from the axis [rad] within the cone, equation (1).
        parameters : ConsistencyParameters
            The rule.
        """
        offset, strength = _vetoes(packet, half_angle, parameters)
        undecided = cls(offset, strength, np.ones(len(packet)), parameters)
        return cls(offset, strength, undecided._scale(half_angle, directivity), parameters)

    def select(self, chosen: NDArray[np.bool_]) -> ConeConsistency:
        """Return the vetoes against the readings where `chosen`, shape (n,), is True."""
        return ConeConsistency(
            self.offset[chosen], self.strength[chosen], self.scale[chosen], self.parameters
        )

    def weights(self, reading: IntArray, theta: FloatArray, modulation: FloatArray) -> FloatArray:
        """Return w of directions in the cones of readings.

        Parameters
        ----------
        reading : ndarray of int64, shape (m,)
            Number of the reading.
        theta : ndarray of float64, shape (m,)
            Angle [rad] from the reading's axis, counter-clockwise.
        modulation : ndarray of float64, shape (m,)
            D of these angles.

        Returns
        -------
        ndarray of float64, shape (m,)
            In [0, 1]; it stands in place of D.
        """
        scale = self.scale[reading]
        remaining = np.sqrt(modulation) * self._consistency(reading, theta)
        remains = scale > self.parameters.floor
        scaled = np.minimum(remaining / np.where(remains, scale, 1.0), 1.0)
        return np.where(remains, scaled, modulation)

    def _consistency(self, reading: IntArray, theta: FloatArray) -> FloatArray:
        """Return c at angles from the axes of readings, shape (m,)."""
        width = self.parameters.half_width + _ROUNDING
        veto = np.zeros(len(reading))
        for offset, strength in zip(self.offset.T, self.strength.T, strict=True):
            looks = np.abs(theta - offset[reading]) <= width
            np.maximum(veto, np.where(looks, strength[reading], 0.0), out=veto)
        return 1.0 - veto

    def _scale(
        self, half_angle: float, directivity: Callable[[FloatArray], FloatArray]
    ) -> FloatArray:
        """Return the maximum of ``sqrt(D) c`` over each cone, shape (n,).

        c is constant between the borders of where readings look, and D falls from the axis
        on: the maximum lies on the axis, or where a veto ends.
        """
        count, vetoes = self.offset.shape
        scale = self._consistency(np.arange(count), np.zeros(count))
        sides = np.array([-1.0, 1.0])
        width = self.parameters.half_width + _ROUNDING
        for number in range(vetoes):
            border = self.offset[:, number, None] + sides * self.parameters.half_width
            # Just beyond the border, where this veto is over and others may have begun.
            beyond = border + sides * 2.0 * _ROUNDING
            looks = np.abs(beyond[:, :, None] - self.offset[:, None, :]) <= width
            veto = np.where(looks, self.strength[:, None, :], 0.0).max(axis=2)
            arc = np.sqrt(directivity(np.clip(border, -half_angle, half_angle)))
            ends = (self.strength[:, number, None] > 0.0) & (np.abs(border) <= half_angle)
            remaining = np.where(ends, arc * (1.0 - veto), 0.0)
            np.maximum(scale, remaining.max(axis=1), out=scale)
        return scale


def _vetoes(
    packet: SonarPacket, half_angle: float, parameters: ConsistencyParameters
) -> tuple[FloatArray, FloatArray]:
    """Return offset [rad] and strength of the vetoes against each reading, shape (n, k)."""
    n = len(packet)
    centre = packet.apex - packet.forward * packet.axis
    reach = np.maximum(packet.empty_range, packet.occupied_range) + packet.forward
    rows = max(1, _PAIRS_A_PASS // max(n, 1))
    offsets, strengths = [], []
    for start in range(0, n, rows):
        part = slice(start, start + rows)
        turn = packet.direction[None, :] - packet.direction[part, None]
        turn = np.mod(turn + np.pi, 2.0 * np.pi) - np.pi
        ux, uy = packet.axis[part, 0, None], packet.axis[part, 1, None]
        # A reading that speaks of no arc has nothing to veto.
        own = np.where(np.isfinite(packet.occupied_range[part]), reach[part], np.inf)
        meet = half_angle + parameters.half_width + 2.0 * _ROUNDING
        with np.errstate(over="ignore", invalid="ignore"):  # from too far away: no veto
            apart = centre[None, :, :] - centre[part, None, :]
            along = apart[..., 0] * ux + apart[..., 1] * uy
            across = apart[..., 1] * ux - apart[..., 0] * uy
            beside = (np.abs(across) <= parameters.max_offset) & (np.abs(turn) <= meet)
            longer = reach[None, :] + along - own[:, None] - parameters.threshold
            strength = np.where(beside, np.clip(longer / parameters.ramp, 0.0, 1.0), 0.0)
        most = int(np.count_nonzero(strength, axis=1).max())
        order = np.argsort(-strength, axis=1, kind="stable")[:, :most]
        offsets.append(np.take_along_axis(turn, order, axis=1))
        strengths.append(np.take_along_axis(strength, order, axis=1))
    most = max((part.shape[1] for part in offsets), default=0)
    return _stacked(offsets, most), _stacked(strengths, most)


def _stacked(parts: list[FloatArray], columns: int) -> FloatArray:
    """Return the parts below one another, filled up with 0 to a number of columns."""
    out = np.zeros((sum(len(part) for part in parts), columns))
    row = 0
    for part in parts:
        out[row : row + len(part), : part.shape[1]] = part
        row += len(part)
    return out
