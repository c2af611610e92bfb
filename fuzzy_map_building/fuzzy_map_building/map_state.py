# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""All that a mapper remembers, as one checked value: what is saved and restored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.plain_yaml import shown
from fuzzy_map_building.wording import counted

__all__ = ["MAX_PERCEPTIONS", "MapState"]

#: More perceptions than a robot makes in a lifetime, and far from where counters overflow.
MAX_PERCEPTIONS = 1_000_000_000


@dataclass(frozen=True, eq=False)
class MapState:
    """The beliefs of a map and how they came about.

    Parameters
    ----------
    geometry : GridGeometry
        Where the cells lie.
    empty, occupied : ndarray of float64, shape (height, width)
        Beliefs E and O in [0, 1].
    count : ndarray of int32, shape (height, width)
        N: perceptions that spoke of each cell.
    perceptions : int
        Number of perceptions fused.

    Raises
    ------
    ValueError
        If a shape, type or value does not fit, naming the array.
    """

    geometry: GridGeometry
    empty: NDArray[np.float64]
    occupied: NDArray[np.float64]
    count: NDArray[np.int32]
    perceptions: int

    def __post_init__(self) -> None:
        for name, kind in (("empty", np.float64), ("occupied", np.float64), ("count", np.int32)):
            array = getattr(self, name)
            if not isinstance(array, np.ndarray) or array.dtype != kind:
                raise ValueError(
                    f"the array '{name}' must be of {np.dtype(kind)}, "
                    f"got {getattr(array, 'dtype', type(array).__name__)}"
                )
            if array.shape != self.geometry.shape:
                raise ValueError(
                    f"the array '{name}' has shape {array.shape}, its map (rows, columns) "
                    f"{self.geometry.shape}"
                )
        for name in ("empty", "occupied"):
            array = getattr(self, name)
            # Written so that NaN fails, too.
            if not (array.min() >= 0.0 and array.max() <= 1.0):
                raise ValueError(f"the beliefs '{name}' are not all in [0, 1]")
        if self.count.min() < 0:
            raise ValueError("a cell counts a negative number of perceptions")
        if isinstance(self.perceptions, bool) or not isinstance(self.perceptions, int):
            raise ValueError(
                f"the number of perceptions must be whole, got {shown(self.perceptions)}"
            )
        if self.perceptions > MAX_PERCEPTIONS:
            raise ValueError(
                f"at most {MAX_PERCEPTIONS} perceptions are counted, got {self.perceptions}"
            )
        if self.perceptions < int(self.count.max()):
            raise ValueError(
                f"a cell counts {counted(int(self.count.max()), 'perception')}, more than the "
                f"{self.perceptions} of the map"
            )
