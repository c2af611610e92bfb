# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Infrared readings into evidence of empty and occupied cells.

An infrared ray is narrow and its range is good to a few centimetres, so that a single reading
says much of few cells. At the distance rho from the robot's centre, within half the ray's
width of its axis, a hit at the distance r (from the centre, too) gives

    E_I = k_I for rho < r - dr_I, then k_I ((r - rho) / dr_I)^2 up to r
    O_I = k_I (1 - ((r - rho) / dr_I)^2) for |r - rho| < dr_I

and a reading without a hit gives E_I out to the sensor's greatest range. The readings of a
packet are united by the maximum: they see the same surface, and none of them is vague.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.boxes import put_box, window_of_boxes
from fuzzy_map_building.evidence.protocols import LocalEvidence
from fuzzy_map_building.grid import (
    GridGeometry,
    Window,
    cells_between,
    centre_along,
)
from fuzzy_map_building.infrared_packet import (
    CENTRE_X,
    CENTRE_Y,
    HIT,
    LIMIT,
    RAY_X,
    RAY_Y,
    InfraredPacket,
)
from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.params import InfraredEvidenceParameters, InfraredParameters
from fuzzy_map_building.types import InfraredReading

__all__ = ["InfraredModel"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Slack of comparisons of lengths [m], so that equal ones do not depend on rounding.
_SLACK = 1e-9


class InfraredModel:
    """The sensor model of a ring of infrared sensors.

    Parameters
    ----------
    infrared : InfraredParameters
        The sensors and where they sit.
    evidence : InfraredEvidenceParameters
        What their readings say.
    """

    def __init__(self, infrared: InfraredParameters, evidence: InfraredEvidenceParameters) -> None:
        self._infrared = infrared
        self._farthest = float(infrared.mount_radius + infrared.max_range)
        self._certainty = float(evidence.certainty)
        self._margin = float(evidence.range_margin)
        self._widening = float(evidence.widening)

    def evidence(
        self, readings: Sequence[InfraredReading], geometry: GridGeometry
    ) -> LocalEvidence:
        """Return what some readings say, merged by the maximum.

        Parameters
        ----------
        readings : sequence of InfraredReading
            Each at its own pose; beyond its `limit` none is believed to be free.
        geometry : GridGeometry
            The cells to judge, at their centres.

        Returns
        -------
        LocalEvidence
            Readings are rejected as ``nan``, ``out_of_range`` or ``outside_map`` (no part of
            the ray's box lies in the grid).
        """
        return self.evidence_of(InfraredPacket.from_readings(readings, self._infrared), geometry)

    def evidence_of(self, packet: InfraredPacket, geometry: GridGeometry) -> LocalEvidence:
        """Return what a packet says, as `evidence` does."""
        rays = for_kernel(packet.rays)
        boxes = np.empty((len(packet), 4), dtype=np.int64)
        model = (self._farthest, self._margin, self._widening)
        grid = (*geometry.origin, geometry.resolution)
        inside, *corners = _find_boxes(rays, *model, *grid, *geometry.shape, for_kernel(boxes))
        rejected = dict(packet.rejected)
        if inside < len(packet):
            rejected["outside_map"] = len(packet) - inside
        window = Window(*corners)
        empty, occupied = np.zeros((2, *window.shape))
        if inside > 0:
            _unite(
                rays,
                for_kernel(boxes),
                window.row0,
                window.col0,
                *grid,
                *model,
                self._certainty,
                for_kernel(empty),
                for_kernel(occupied),
            )
        return LocalEvidence(window, empty, occupied, inside, rejected)


@njit
def _reach(hit: float, limit: float, farthest: float, margin: float) -> tuple[float, float]:
    """Return how far from the centre [m] a ray speaks of empty, and of anything."""
    seen = hit < math.inf
    empty = min(hit if seen else farthest, limit)
    return empty, max(empty, hit + margin if seen else 0.0, 0.0)


@njit
def _find_boxes(
    rays: FloatArray,
    farthest: float,
    margin: float,
    widening: float,
    origin_x: float,
    origin_y: float,
    resolution: float,
    height: int,
    width: int,
    boxes: IntArray,
) -> tuple[int, int, int, int, int]:
    """Find the cells around each ray.

    Parameters
    ----------
    rays : ndarray of float64, shape (n, 7)
        Of an `InfraredPacket`.
    farthest, margin, widening : float
        Greatest distance that is seen from the robot's centre, Delta r_I [m], and the half
        width of a ray as a share of the distance.
    origin_x, origin_y, resolution, height, width
        Of the grid.
    boxes : ndarray of int64, shape (n, 4)
        Where the boxes go: rows [0, 1) and columns [2, 3); no row where the ray is outside
        the grid.

    Returns
    -------
    tuple of int
        Number of rays in the grid; rows and columns of the window that holds their boxes.
    """
    for i in range(len(rays)):
        _, reach = _reach(rays[i, HIT], rays[i, LIMIT], farthest, margin)
        wide = max(widening * reach, 0.5 * resolution) + _SLACK
        x = rays[i, CENTRE_X]
        y = rays[i, CENTRE_Y]
        end_x = x + reach * rays[i, RAY_X]
        end_y = y + reach * rays[i, RAY_Y]
        rows = cells_between(
            min(y, end_y) - wide, max(y, end_y) + wide, origin_y, resolution, height
        )
        columns = cells_between(
            min(x, end_x) - wide, max(x, end_x) + wide, origin_x, resolution, width
        )
        put_box(boxes, i, rows, columns)
    return window_of_boxes(boxes)


@njit
def _unite(
    rays: FloatArray,
    boxes: IntArray,
    row0: int,
    col0: int,
    origin_x: float,
    origin_y: float,
    resolution: float,
    farthest: float,
    margin: float,
    widening: float,
    certainty: float,
    empty: FloatArray,
    occupied: FloatArray,
) -> None:
    """Unite what rays say of the cells of a window.

    Parameters
    ----------
    rays, boxes, origin_x, origin_y, resolution, farthest, margin, widening
        As `_find_boxes` takes and fills them.
    row0, col0 : int
        First row and column of the window.
    certainty : float
        k_I.
    empty, occupied : ndarray of float64, shape of the window
        Zero; where E_I and O_I go.
    """
    for i in range(len(rays)):
        ux = rays[i, RAY_X]
        uy = rays[i, RAY_Y]
        centre_x = rays[i, CENTRE_X]
        centre_y = rays[i, CENTRE_Y]
        hit = rays[i, HIT]
        free, reach = _reach(hit, rays[i, LIMIT], farthest, margin)
        widest = max(widening * reach, 0.5 * resolution) + _SLACK
        for row in range(boxes[i, 0], boxes[i, 1]):
            y = centre_along(origin_y, row, resolution) - centre_y
            # What is the same for all cells of the row is reckoned once.
            across_y = ux * y
            along_y = uy * y
            for column in range(boxes[i, 2], boxes[i, 3]):
                x = centre_along(origin_x, column, resolution) - centre_x
                across = abs(across_y - uy * x)
                if across > widest or ux * x + along_y < 0.0:
                    continue
                rho = math.sqrt(x * x + y * y)
                if rho > reach or across > max(widening * rho, 0.5 * resolution) + _SLACK:
                    continue
                if rho < free:
                    short = min((free - rho) / margin, 1.0)
                    belief = certainty * short * short
                    if belief > empty[row - row0, column - col0]:
                        empty[row - row0, column - col0] = belief
                off = (hit - rho) / margin
                if abs(off) < 1.0:
                    belief = certainty * (1.0 - off * off)
                    if belief > occupied[row - row0, column - col0]:
                        occupied[row - row0, column - col0] = belief
