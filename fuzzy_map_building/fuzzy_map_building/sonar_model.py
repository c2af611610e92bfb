# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sonar readings into evidence of empty and occupied cells, equations (1)-(5).

Only the cells of each cone's bounding box are looked at, so that the cost follows the
cones' areas and not the map's size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.boxes import put_box, window_of_boxes
from fuzzy_map_building.cone_consistency import consistency, find_vetoes, greatest_rest
from fuzzy_map_building.directivity import Lobe, lobe_at
from fuzzy_map_building.evidence.protocols import LocalEvidence
from fuzzy_map_building.fuzzy_sets import dombi_t, dombi_t_inverse
from fuzzy_map_building.grid import (
    GridGeometry,
    Window,
    cells_between,
    centre_along,
    where_both,
)
from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.params import (
    ConsistencyParameters,
    EvidenceParameters,
    SonarParameters,
)
from fuzzy_map_building.sonar_packet import (
    APEX_X,
    APEX_Y,
    AXIS_X,
    AXIS_Y,
    EMPTY,
    OCCUPIED,
    SonarPacket,
)
from fuzzy_map_building.types import RangeReading

__all__ = ["SonarModel", "empty_certainty", "occupied_certainty"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Slack of the comparison rho <= rho_v [m], so that cells at exactly that distance do not
#: depend on rounding.
_SLACK = 1e-9


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
        self._lobe = Lobe.of(sonar)
        self._table = for_kernel(self._lobe.table)
        self._reach = evidence.visibility_radius + _SLACK
        self._margin = float(evidence.range_margin)
        self._certainty = (float(evidence.k_empty), float(evidence.k_occupied))
        self._lambda = float(evidence.dombi_lambda)
        rule = consistency if consistency is not None else ConsistencyParameters(enabled=False)
        self._agree = rule.enabled
        self._rule = (
            float(rule.half_width),
            float(rule.threshold),
            float(rule.ramp),
            float(rule.max_offset),
            float(rule.floor),
        )

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
        cones = for_kernel(packet.cones)
        boxes = np.empty((len(packet), 4), dtype=np.int64)
        grid = (*geometry.origin, geometry.resolution)
        half = self._lobe.half_angle
        inside, *corners = _find_boxes(
            cones, half, self._reach, self._margin, *grid, *geometry.shape, for_kernel(boxes)
        )
        rejected = dict(packet.rejected)
        if inside < len(packet):
            rejected["outside_map"] = len(packet) - inside
        window = Window(*corners)
        empty, occupied = np.zeros((2, *window.shape))
        if inside > 0:
            _unite(
                cones,
                packet.forward,
                for_kernel(boxes),
                window.row0,
                window.col0,
                *grid,
                half,
                self._table,
                self._lobe.fineness,
                self._reach,
                self._margin,
                *self._certainty,
                self._lambda,
                self._agree,
                *self._rule,
                for_kernel(np.empty(2 * len(packet))),
                for_kernel(empty),
                for_kernel(occupied),
            )
        return LocalEvidence(window, empty, occupied, inside, rejected)


@njit
def empty_certainty(rho: float, r: float, k: float, margin: float) -> float:
    """Return f_E, equation (2): what a range `r` [m] says of emptiness at distance `rho` [m]."""
    short = (r - rho) / margin
    short = 0.0 if short < 0.0 else 1.0 if short > 1.0 else short
    return k * short * short


@njit
def occupied_certainty(rho: float, r: float, k: float, margin: float) -> float:
    """Return f_O, equation (3): what a range `r` [m] says of an obstacle at `rho` [m]."""
    off = (r - rho) / margin
    return k * (1.0 - off * off) if -1.0 < off < 1.0 else 0.0


@njit
def _find_boxes(
    cones: FloatArray,
    half_angle: float,
    reach: float,
    margin: float,
    origin_x: float,
    origin_y: float,
    resolution: float,
    height: int,
    width: int,
    boxes: IntArray,
) -> tuple[int, int, int, int, int]:
    """Find the cells around each cone.

    Parameters
    ----------
    cones : ndarray of float64, shape (n, 7)
        Of a `SonarPacket`.
    half_angle, reach, margin : float
        Half of a cone's angle [rad], rho_v and Delta r [m].
    origin_x, origin_y, resolution, height, width
        Of the grid.
    boxes : ndarray of int64, shape (n, 4)
        Where the boxes go: rows [0, 1) and columns [2, 3); no row where the cone is outside
        the grid.

    Returns
    -------
    tuple of int
        Number of cones in the grid; rows and columns of the window that holds their boxes.
    """
    cosine = math.cos(half_angle)
    sine = math.sin(half_angle)
    for i in range(len(cones)):
        # Nothing is said beyond rho_v, beyond the arc, or beyond the empty range.
        far = min(max(cones[i, EMPTY], cones[i, OCCUPIED] + margin), reach)
        ux = cones[i, AXIS_X]
        uy = cones[i, AXIS_Y]
        # The ends of the arc lie left and right of the axis; where the cone holds the
        # direction of an axis of the world, the arc bulges there.
        aside_x = sine * abs(uy)
        aside_y = sine * abs(ux)
        high_x = 1.0 if ux >= cosine else max(cosine * ux + aside_x, 0.0)
        high_y = 1.0 if uy >= cosine else max(cosine * uy + aside_y, 0.0)
        low_x = 1.0 if -ux >= cosine else max(aside_x - cosine * ux, 0.0)
        low_y = 1.0 if -uy >= cosine else max(aside_y - cosine * uy, 0.0)
        x = cones[i, APEX_X]
        y = cones[i, APEX_Y]
        rows = cells_between(y - far * low_y, y + far * high_y, origin_y, resolution, height)
        columns = cells_between(x - far * low_x, x + far * high_x, origin_x, resolution, width)
        put_box(boxes, i, rows, columns)
    return window_of_boxes(boxes)


@njit
def _unite(
    cones: FloatArray,
    forward: float,
    boxes: IntArray,
    row0: int,
    col0: int,
    origin_x: float,
    origin_y: float,
    resolution: float,
    half_angle: float,
    table: FloatArray,
    fineness: float,
    reach: float,
    margin: float,
    k_empty: float,
    k_occupied: float,
    lam: float,
    agree: bool,
    half_width: float,
    threshold: float,
    ramp: float,
    max_offset: float,
    floor: float,
    vetoes: FloatArray,
    empty: FloatArray,
    occupied: FloatArray,
) -> None:
    """Unite what the readings of a packet say of the cells of a window.

    Parameters
    ----------
    cones, forward
        Of the `SonarPacket`.
    boxes : ndarray of int64, shape (n, 4)
        Cells around each cone.
    row0, col0 : int
        First row and column of the window.
    origin_x, origin_y, resolution : float
        Of the grid [m].
    half_angle, table, fineness
        Of the `Lobe`.
    reach, margin, k_empty, k_occupied, lam : float
        rho_v and Delta r [m], k_E, k_O, lambda.
    agree : bool
        Whether vetoes count; the rule follows, see `ConsistencyParameters`.
    vetoes : ndarray of float64, shape (2 n,)
        Room for the vetoes against a reading.
    empty, occupied : ndarray of float64, shape of the window
        Zero; where E^k and O^k go.
    """
    sine_squared = math.sin(half_angle) ** 2
    tangent = math.tan(half_angle)
    for i in range(len(cones)):
        ux = cones[i, AXIS_X]
        uy = cones[i, AXIS_Y]
        apex_x = cones[i, APEX_X]
        apex_y = cones[i, APEX_Y]
        empty_range = cones[i, EMPTY]
        occupied_range = cones[i, OCCUPIED]
        count = 0
        rest = 1.0
        if agree and occupied_range > 0.0 and boxes[i, 1] > boxes[i, 0]:
            count = find_vetoes(
                i, cones, forward, half_angle, half_width, threshold, ramp, max_offset, vetoes
            )
            rest = greatest_rest(vetoes, count, half_width, half_angle, table, fineness)
        # Left of its right border and right of its left one is what lies in the cone.
        left, left_y = tangent * ux + uy, ux - tangent * uy
        right, right_y = tangent * ux - uy, -(ux + tangent * uy)
        for row in range(boxes[i, 0], boxes[i, 1]):
            y = centre_along(origin_y, row, resolution) - apex_y
            # The part of the row between the borders of the cone, and a cell more on either
            # side; what is the same for all of its cells is reckoned once.
            low, high = where_both(left, left_y * y, right, right_y * y)
            low += apex_x - resolution
            high += apex_x + resolution
            first, last = cells_between(low, high, origin_x, resolution, boxes[i, 3])
            squared_y = y * y
            along_y = uy * y
            across_y = ux * y
            for column in range(max(first, boxes[i, 2]), last):
                x = centre_along(origin_x, column, resolution) - apex_x
                squared = x * x + squared_y
                along = ux * x + along_y
                across = across_y - uy * x
                if (
                    across * across > sine_squared * squared
                    or along < 0.0
                    or squared > reach * reach
                ):
                    continue
                # At the apex itself theta counts as 0.
                sine = across * across / squared if squared > 0.0 else 0.0
                modulation = lobe_at(table, fineness, sine)
                rho = math.sqrt(squared)
                if rho < empty_range:
                    belief = empty_certainty(rho, empty_range, k_empty, margin) * modulation
                    empty[row - row0, column - col0] += dombi_t(belief, lam)
                if abs(rho - occupied_range) < margin:
                    if agree and rest > floor:
                        part = consistency(math.atan2(across, along), vetoes, count, half_width)
                        modulation = min(math.sqrt(modulation) * part / rest, 1.0)
                    belief = modulation * occupied_certainty(
                        rho, occupied_range, k_occupied, margin
                    )
                    occupied[row - row0, column - col0] += dombi_t(belief, lam)
    for row in range(empty.shape[0]):
        for column in range(empty.shape[1]):
            # Of most cells nothing is said.
            if empty[row, column] > 0.0:
                empty[row, column] = dombi_t_inverse(empty[row, column], lam)
            if occupied[row, column] > 0.0:
                occupied[row, column] = dombi_t_inverse(occupied[row, column], lam)
