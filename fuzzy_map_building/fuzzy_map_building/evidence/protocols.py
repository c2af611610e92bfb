# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the mapper asks of a sensor model and of a fusion rule.

A sensor model turns the readings of one kind into local evidence (perception and
processing); a fusion rule lets evidence enter the map and derives the two risk maps
(aggregation and map update). A new sensor or a new theory of evidence is one class that
satisfies one of these protocols.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.types import RangeReading

__all__ = ["EvidenceSource", "FusionRule", "LocalEvidence"]

FloatArray = NDArray[np.float64]
Reading = TypeVar("Reading", bound=RangeReading, contravariant=True)


@dataclass(frozen=True)
class LocalEvidence:
    """What one packet of readings says of the cells of a window.

    Attributes
    ----------
    window : Window
        The cells spoken of; all others keep what they have.
    empty, occupied : ndarray of float64, shape of the window
        Memberships E^k and O^k in [0, 1], equations (4) and (5); both 0: nothing said.
    accepted : int
        Number of readings that count.
    rejected : dict of str to int
        Number of those that do not, by reason.
    """

    window: Window
    empty: FloatArray
    occupied: FloatArray
    accepted: int
    rejected: dict[str, int]


class EvidenceSource(Protocol[Reading]):
    """A model of one kind of sensor."""

    def evidence(self, readings: Sequence[Reading], geometry: GridGeometry) -> LocalEvidence:
        """Return what a packet of readings says of the cells of a grid."""
        ...


class FusionRule(Protocol):
    """A theory of evidence: two beliefs a cell in, two beliefs and two risks out.

    All arrays have the same shape, one element a cell; `count` is the number of
    perceptions that spoke of the cell, the present one included. Where the new evidence is
    0 on both sides the beliefs stay as they are. No argument is changed.
    """

    def fuse(
        self,
        empty: FloatArray,
        occupied: FloatArray,
        count: NDArray[np.int32],
        new_empty: FloatArray,
        new_occupied: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Return the beliefs (empty, occupied) after new evidence."""
        ...

    def risks(self, empty: FloatArray, occupied: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the (motion, planning) risks in [0, 1] that the beliefs stand for."""
        ...
