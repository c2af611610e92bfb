# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a mapper remembers at one moment, copied by another thread while the mapper goes on.

Copying a large map takes seconds. So nothing is copied at the moment itself: the mapper tells
which cells it is about to change, whose values are put aside, and whoever copies the map later
puts them back in the copy.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_state import MapState

__all__ = ["FrozenState"]

#: Cells copied at a time; other threads may run in between.
_CELLS_A_BAND: Final = 1 << 20

Arrays = Mapping[str, NDArray[Any]]


class FrozenState:
    """The state of a mapper at the moment at which this was made.

    Parameters
    ----------
    geometry : GridGeometry
        Where the cells lie.
    empty, occupied, count : ndarray
        As of a `MapState`; those that the mapper works on.
    perceptions : int
        Number of perceptions fused.

    Attributes
    ----------
    copied : bool
        Whether `state` has been called: nothing has to be put aside any more.
    """

    def __init__(
        self,
        geometry: GridGeometry,
        empty: NDArray[np.float64],
        occupied: NDArray[np.float64],
        count: NDArray[np.int32],
        perceptions: int,
    ) -> None:
        self.copied = False
        self._geometry = geometry
        self._arrays: Arrays = {"empty": empty, "occupied": occupied, "count": count}
        self._perceptions = perceptions
        self._aside: list[tuple[Window, Arrays]] = []
        self._lock = threading.Lock()

    def keep(self, window: Window) -> None:
        """Put the cells of a window aside, which the mapper is about to change."""
        with self._lock:
            if not self.copied:
                cells = window.slices
                before = {name: array[cells].copy() for name, array in self._arrays.items()}
                self._aside.append((window, before))

    def state(self) -> MapState:
        """Return a copy of the state; once, by any thread."""
        try:
            arrays = self._copied()
        finally:
            with self._lock:
                self.copied = True
        # Of cells that changed more than once the first values that were put aside count.
        for window, before in reversed(self._aside):
            for name, values in before.items():
                arrays[name][window.slices] = values
        self._aside.clear()
        return MapState(self._geometry, **arrays, perceptions=self._perceptions)

    def _copied(self) -> dict[str, NDArray[Any]]:
        """Return copies of the arrays, with what has changed since and while they were made."""
        arrays = {name: np.empty_like(array) for name, array in self._arrays.items()}
        height, width = self._geometry.shape
        rows = max(1, _CELLS_A_BAND // width)
        for first in range(0, height, rows):
            for name, array in self._arrays.items():
                # What changes while it is copied has been put aside before.
                arrays[name][first : first + rows] = array[first : first + rows]
        return arrays
