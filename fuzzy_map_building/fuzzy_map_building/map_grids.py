# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The maps of a mapper in the whole numbers that are published, kept up to date by windows."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.occupancy import belief_to_int8, risk_to_int8

__all__ = ["MapGrids"]

#: Cells worked on at a time; bounds the memory beside the grids.
_CELLS_A_BAND = 1 << 18


class MapGrids:
    """Motion map, planning map and occupancy of a mapper, three bytes a cell.

    Parameters
    ----------
    mapper : FuzzyMapper
        Whose maps they are.

    Attributes
    ----------
    motion, planning, occupancy : ndarray of int8, shape (height, width)
        As `risk_to_int8` and `belief_to_int8` make them.

    Examples
    --------
    >>> from fuzzy_map_building.types import Pose2, SonarReading
    >>> mapper = FuzzyMapper(GridGeometry(76, 63, 0.1))
    >>> grids = MapGrids(mapper)
    >>> report = mapper.update([SonarReading(Pose2(1.25, 5.25), 0.0, 2.0)])
    >>> grids.refresh(mapper, report.window)
    >>> [int(grid[52, 15]) for grid in (grids.motion, grids.planning, grids.occupancy)]
    [100, 21, -1]
    """

    def __init__(self, mapper: FuzzyMapper) -> None:
        self.motion, self.planning, self.occupancy = np.zeros(
            (3, *mapper.geometry.shape), dtype=np.int8
        )
        self.refresh(mapper)

    def refresh(self, mapper: FuzzyMapper, window: Window | None = None) -> None:
        """Take over what a mapper believes now.

        Parameters
        ----------
        mapper : FuzzyMapper
            A mapper of the same grid.
        window : Window, optional
            The cells that may have changed; all if not given.
        """
        for part in _bands(mapper.geometry) if window is None else (window,):
            cells = part.slices
            motion, planning = mapper.risks(part)
            self.motion[cells] = risk_to_int8(motion)
            self.planning[cells] = risk_to_int8(planning)
            self.occupancy[cells] = belief_to_int8(mapper.empty[cells], mapper.occupied[cells])


def _bands(geometry: GridGeometry) -> Iterator[Window]:
    """Yield windows of whole rows that cover a grid."""
    rows = max(1, _CELLS_A_BAND // geometry.width)
    for row in range(0, geometry.height, rows):
        yield Window(row, min(row + rows, geometry.height), 0, geometry.width)
