# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sonar readings into evidence of empty and occupied cells, equations (1)-(5).

Only the cells of each cone's bounding box are looked at, so that the cost follows the
cones' areas and neither the map's size nor the distance between the readings' poses.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.cone_consistency import ConeConsistency
from fuzzy_map_building.evidence.protocols import LocalEvidence
from fuzzy_map_building.fuzzy_sets import dombi_t, dombi_t_inverse
from fuzzy_map_building.grid import GridGeometry, Window, box_cells
from fuzzy_map_building.params import (
    ConsistencyParameters,
    EvidenceParameters,
    SonarParameters,
)
from fuzzy_map_building.sonar_packet import SonarPacket
from fuzzy_map_building.types import RangeReading

__all__ = ["SonarModel", "directivity", "empty_certainty", "occupied_certainty"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: First positive zero of the Bessel function J1: the border of the main lobe, in z.
_FIRST_ZERO = 3.831705970207512
#: Terms of the power series of 2 J1(z)/z; at the first zero the next one is below 1e-20.
_SERIES = tuple(
    (-1.0) ** k / (math.factorial(k) * math.factorial(k + 1)) for k in reversed(range(18))
)
#: Cells looked at in one pass; bounds the memory of a packet of huge cones.
_CELLS_A_PASS = 1_000_000
#: Slack of the comparison rho <= rho_v [m], so that cells at exactly that distance do not
#: depend on rounding.
_SLACK = 1e-9


def _lobe(quarter_z_squared: FloatArray) -> FloatArray:
    """Return ``2 J1(z)/z`` for ``z <= 3.83`` from ``(z/2)^2``, exact to rounding."""
    out = np.full_like(quarter_z_squared, _SERIES[0])
    for coefficient in _SERIES[1:]:
        out *= quarter_z_squared
        out += coefficient
    return out


def directivity(theta: ArrayLike, sonar: SonarParameters | None = None) -> FloatArray:
    """Return the radiation directivity of the transducer in its main lobe, equation (1).

    Parameters
    ----------
    theta : array_like
        Angle from the axis [rad].
    sonar : SonarParameters, optional
        Gives piston radius, frequency and speed of sound.

    Returns
    -------
    ndarray of float64
        D in [0, 1]; 0 beyond the main lobe.

    Examples
    --------
    >>> [round(float(directivity(math.radians(t))), 3) for t in (0.0, 7.5, 11.25, 12.5)]
    [1.0, 0.48, 0.108, 0.015]
    """
    angle = np.abs(np.asarray(theta, dtype=np.float64))
    z = _wave_number_radius(sonar or SonarParameters()) * np.sin(angle)
    inside = (z < _FIRST_ZERO) & (angle < 0.5 * math.pi)
    return np.where(inside, _lobe(np.where(inside, 0.5 * z, 0.0) ** 2), 0.0)


def _wave_number_radius(sonar: SonarParameters) -> float:
    """Return the factor of sin(theta) in z, equation (1)."""
    return 2.0 * math.pi * sonar.frequency / sonar.speed_of_sound * sonar.piston_radius


def empty_certainty(rho: ArrayLike, r: ArrayLike, evidence: EvidenceParameters) -> FloatArray:
    """Return f_E, equation (2): what a range `r` [m] says of emptiness at distance `rho` [m]."""
    short = (np.asarray(r, dtype=np.float64) - np.asarray(rho)) / evidence.range_margin
    out: FloatArray = evidence.k_empty * np.clip(short, 0.0, 1.0) ** 2
    return out


def occupied_certainty(rho: ArrayLike, r: ArrayLike, evidence: EvidenceParameters) -> FloatArray:
    """Return f_O, equation (3): what a range `r` [m] says of an obstacle at `rho` [m]."""
    off = (np.asarray(r, dtype=np.float64) - np.asarray(rho)) / evidence.range_margin
    out: FloatArray = evidence.k_occupied * (1.0 - np.clip(off, -1.0, 1.0) ** 2)
    return out


class SonarModel:
    """The sensor model of a ring of sonars.

    Parameters
    ----------
    sonar : SonarParameters
        The sonars and where they sit.
    evidence : EvidenceParameters
        What their readings say.
    consistency : ConsistencyParameters, optional
        Which part of an arc the other readings leave; none given: all of it.
    """

    def __init__(
        self,
        sonar: SonarParameters,
        evidence: EvidenceParameters,
        consistency: ConsistencyParameters | None = None,
    ) -> None:
        self._sonar = sonar
        self._evidence = evidence
        self._consistency = consistency if consistency and consistency.enabled else None
        factor = _wave_number_radius(sonar)
        # m(theta) is D within the cone, and only the main lobe of D is used (section III-A).
        lobe = math.asin(_FIRST_ZERO / factor) if factor > _FIRST_ZERO else 0.5 * math.pi
        half = min(0.5 * sonar.field_of_view, lobe)
        self._cos_half = math.cos(half)
        self._sin_half = math.sin(half)
        self._quarter_factor_squared = (0.5 * factor) ** 2

    def evidence(self, readings: Sequence[RangeReading], geometry: GridGeometry) -> LocalEvidence:
        """Return what a packet of readings says, merged by the Dombi union, (4) and (5).

        Parameters
        ----------
        readings : sequence of RangeReading
            The packet; what a lost echo says depends on the others.
        geometry : GridGeometry
            The cells to judge, at their centres.

        Returns
        -------
        LocalEvidence
            Readings are rejected as ``nan``, ``out_of_range``, ``lost_echo`` or
            ``outside_map`` (no part of the cone's box lies in the grid).
        """
        packet = SonarPacket.from_readings(readings, self._sonar)
        cones = self._agreement(packet)
        low, high = self._boxes(packet)
        first, last = geometry.boxes(low, high)
        inside: NDArray[np.bool_] = np.all(last > first, axis=1)
        rejected = dict(packet.rejected)
        if not inside.all():
            rejected["outside_map"] = int((~inside).sum())
            packet, first, last = packet.select(inside), first[inside], last[inside]
            cones = cones.select(inside) if cones is not None else None
        if len(packet) == 0:
            nothing = np.zeros((0, 0))
            return LocalEvidence(Window(0, 0, 0, 0), nothing, nothing, 0, rejected)

        row0, col0 = (int(v) for v in first.min(axis=0))
        row1, col1 = (int(v) for v in last.max(axis=0))
        window = Window(row0, row1, col0, col1)
        lam = self._evidence.dombi_lambda
        cells = window.shape[0] * window.shape[1]
        sums = np.zeros((2, cells))
        for cell, empty, occupied in self._cones(packet, cones, first, last, window, geometry):
            sums[0] += np.bincount(cell, dombi_t(empty, lam), cells)
            sums[1] += np.bincount(cell, dombi_t(occupied, lam), cells)
        empty, occupied = dombi_t_inverse(sums, lam).reshape(2, *window.shape)
        return LocalEvidence(window, empty, occupied, len(packet), rejected)

    def _agreement(self, packet: SonarPacket) -> ConeConsistency | None:
        if self._consistency is None:
            return None
        half = math.asin(self._sin_half)
        return ConeConsistency.of_packet(packet, half, self._modulation, self._consistency)

    def _modulation(self, theta: FloatArray) -> FloatArray:
        """Return D of angles from the axis [rad] within the cone, equation (1)."""
        return _lobe(self._quarter_factor_squared * np.sin(theta) ** 2)

    def _boxes(self, packet: SonarPacket) -> tuple[FloatArray, FloatArray]:
        """Return the corners (x, y) [m], shape (n, 2), of the boxes around the cones."""
        # Nothing is said beyond rho_v, beyond the arc, or beyond the empty range.
        reach = np.maximum(packet.empty_range, packet.occupied_range + self._evidence.range_margin)
        reach = np.minimum(reach, self._evidence.visibility_radius + _SLACK)[:, None]
        axis = packet.axis
        across = np.column_stack((-axis[:, 1], axis[:, 0]))
        left = self._cos_half * axis + self._sin_half * across
        right = self._cos_half * axis - self._sin_half * across
        # Where the cone holds the direction of an axis of the world, its arc bulges there.
        highest = np.where(axis >= self._cos_half, 1.0, np.maximum(left, right))
        lowest = np.where(-axis >= self._cos_half, -1.0, np.minimum(left, right))
        high = packet.apex + reach * np.maximum(highest, 0.0)
        low = packet.apex + reach * np.minimum(lowest, 0.0)
        return low, high

    def _cones(
        self,
        packet: SonarPacket,
        cones: ConeConsistency | None,
        first: IntArray,
        last: IntArray,
        window: Window,
        geometry: GridGeometry,
    ) -> Iterator[tuple[IntArray, FloatArray, FloatArray]]:
        """Yield (cell of the window, E_i, O_i) of every cell in a cone, pass by pass."""
        size = last - first
        passes = np.cumsum(size[:, 0] * size[:, 1]) // _CELLS_A_PASS
        for number in np.unique(passes):
            chosen: NDArray[np.bool_] = passes == number
            yield self._judge(
                packet.select(chosen),
                cones.select(chosen) if cones is not None else None,
                first[chosen],
                last[chosen],
                window,
                geometry,
            )

    def _judge(
        self,
        packet: SonarPacket,
        cones: ConeConsistency | None,
        first: IntArray,
        last: IntArray,
        window: Window,
        geometry: GridGeometry,
    ) -> tuple[IntArray, FloatArray, FloatArray]:
        """Return (cell of the window, E_i, O_i) of those cells of the boxes in a cone."""
        evidence = self._evidence
        reading, row, column = box_cells(first, last)
        x, y = geometry.centre_coordinates(row, column)
        dx = x - packet.apex[reading, 0]
        dy = y - packet.apex[reading, 1]
        ux, uy = packet.axis[reading, 0], packet.axis[reading, 1]
        along = ux * dx + uy * dy
        across = ux * dy - uy * dx
        squared = dx * dx + dy * dy
        limit = (evidence.visibility_radius + _SLACK) ** 2
        inside = np.flatnonzero(
            (along >= 0.0) & (squared <= limit) & (across * across <= self._sin_half**2 * squared)
        )
        squared = squared[inside]
        # sin(theta) without trigonometry; at the apex itself theta counts as 0.
        sine_squared = across[inside] ** 2 / np.where(squared > 0.0, squared, 1.0)
        modulation = _lobe(self._quarter_factor_squared * sine_squared)
        rho = np.sqrt(squared)
        source = reading[inside]
        empty = empty_certainty(rho, packet.empty_range[source], evidence) * modulation
        occupied = occupied_certainty(rho, packet.occupied_range[source], evidence)
        if cones is None:
            occupied *= modulation
        else:
            arc = np.flatnonzero(occupied)
            cell = inside[arc]
            theta = np.arctan2(across[cell], along[cell])
            occupied[arc] *= cones.weights(source[arc], theta, modulation[arc])
        cell = (row[inside] - window.row0) * window.shape[1] + (column[inside] - window.col0)
        return cell, empty, occupied
