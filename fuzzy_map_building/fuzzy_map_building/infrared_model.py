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

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.evidence.protocols import LocalEvidence
from fuzzy_map_building.grid import GridGeometry, Window, box_cells
from fuzzy_map_building.infrared_packet import InfraredPacket
from fuzzy_map_building.params import InfraredEvidenceParameters, InfraredParameters
from fuzzy_map_building.types import InfraredReading

__all__ = ["InfraredModel"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Cells looked at in one pass; bounds the memory of a packet of many long rays.
_CELLS_A_PASS = 1_000_000
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
        self._evidence = evidence

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
        packet = InfraredPacket.from_readings(readings, self._infrared)
        first, last = geometry.boxes(*self._boxes(packet, geometry))
        inside: NDArray[np.bool_] = np.all(last > first, axis=1)
        rejected = dict(packet.rejected)
        if not inside.all():
            rejected["outside_map"] = int((~inside).sum())
            packet, first, last = packet.select(inside), first[inside], last[inside]
        if len(packet) == 0:
            nothing = np.zeros((0, 0))
            return LocalEvidence(Window(0, 0, 0, 0), nothing, nothing, 0, rejected)

        row0, col0 = (int(v) for v in first.min(axis=0))
        row1, col1 = (int(v) for v in last.max(axis=0))
        window = Window(row0, row1, col0, col1)
        empty, occupied = np.zeros((2, window.shape[0] * window.shape[1]))
        for cell, e, o in self._rays(packet, first, last, window, geometry):
            np.maximum.at(empty, cell, e)
            np.maximum.at(occupied, cell, o)
        return LocalEvidence(
            window,
            empty.reshape(window.shape),
            occupied.reshape(window.shape),
            len(packet),
            rejected,
        )

    def _reach(self, packet: InfraredPacket) -> tuple[FloatArray, FloatArray]:
        """Return how far from the centre [m] each ray speaks of empty, and of anything."""
        nothing_before = self._infrared.mount_radius + self._infrared.max_range
        seen = np.isfinite(packet.hit)
        empty = np.minimum(np.where(seen, packet.hit, nothing_before), packet.limit)
        surface = np.where(seen, packet.hit + self._evidence.range_margin, 0.0)
        return empty, np.maximum(np.maximum(empty, surface), 0.0)

    def _half_width(self, rho: FloatArray, geometry: GridGeometry) -> FloatArray:
        return np.maximum(self._evidence.widening * rho, 0.5 * geometry.resolution)

    def _boxes(
        self, packet: InfraredPacket, geometry: GridGeometry
    ) -> tuple[FloatArray, FloatArray]:
        """Return the corners (x, y) [m], shape (n, 2), of the boxes around the rays."""
        _, reach = self._reach(packet)
        ray = np.column_stack((np.cos(packet.direction), np.sin(packet.direction)))
        end = packet.centre + reach[:, None] * ray
        wide = (self._half_width(reach, geometry) + _SLACK)[:, None]
        return np.minimum(packet.centre, end) - wide, np.maximum(packet.centre, end) + wide

    def _rays(
        self,
        packet: InfraredPacket,
        first: IntArray,
        last: IntArray,
        window: Window,
        geometry: GridGeometry,
    ) -> Iterator[tuple[IntArray, FloatArray, FloatArray]]:
        """Yield (cell of the window, E_I, O_I) of every cell in a ray, pass by pass."""
        size = last - first
        passes = np.cumsum(size[:, 0] * size[:, 1]) // _CELLS_A_PASS
        for number in np.unique(passes):
            chosen: NDArray[np.bool_] = passes == number
            yield self._judge(packet.select(chosen), first[chosen], last[chosen], window, geometry)

    def _judge(
        self,
        packet: InfraredPacket,
        first: IntArray,
        last: IntArray,
        window: Window,
        geometry: GridGeometry,
    ) -> tuple[IntArray, FloatArray, FloatArray]:
        """Return (cell of the window, E_I, O_I) of those cells of the boxes in a ray."""
        k, margin = self._evidence.certainty, self._evidence.range_margin
        ray, row, column = box_cells(first, last)
        x, y = geometry.centre_coordinates(row, column)
        dx = x - packet.centre[ray, 0]
        dy = y - packet.centre[ray, 1]
        ux, uy = np.cos(packet.direction)[ray], np.sin(packet.direction)[ray]
        along = ux * dx + uy * dy
        across = np.abs(ux * dy - uy * dx)
        rho = np.hypot(dx, dy)
        empty, reach = self._reach(packet)
        inside = np.flatnonzero(
            (along >= 0.0)
            & (rho <= reach[ray])
            & (across <= self._half_width(rho, geometry) + _SLACK)
        )
        ray, rho = ray[inside], rho[inside]
        short = np.clip((empty[ray] - rho) / margin, 0.0, 1.0)
        off = np.clip((packet.hit[ray] - rho) / margin, -1.0, 1.0)
        cell = (row[inside] - window.row0) * window.shape[1] + (column[inside] - window.col0)
        return cell, k * short**2, k * (1.0 - off**2)
