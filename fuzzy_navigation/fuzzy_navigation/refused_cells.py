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

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.clearance_layer import best_clearance, shift_within
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.mission_types import Stop

__all__ = ["RefusedCells"]

Points = NDArray[np.float64]

#: Perceptions for which an unexplored cell is barred the first time. Nothing is known to be
#: there: long enough to look from elsewhere, too short to close a passage (in openings of 0.8 m
#: 8 of 8 missions came through with 4, 4 of 8 with 40).
UNEXPLORED_MEMORY = 4
#: Visits to a place that does not open from which on it is barred at once, and for longer each
#: time (2 bar narrow openings as well; without it 3 of 60 missions went to and fro in the
#: laboratory of rough walls until their perceptions were used up).
TRIES = 3
#: On a path that leads through cells believed occupied, a try at one cell is one at those that
#: are not farther [m]: such a path finds another cell of the same wall each time (0.15 m: 26 of
#: 40 missions through the rough office; 0.25 m bars openings of 0.8 m).
RISKY_RADIUS = 0.15
#: Distances that differ by less are the same [m].
SAME = 1e-6


class RefusedCells:
    """Cells that no path may enter for the time being, by their centres.

    Parameters
    ----------
    memory : int
        Perceptions after which an obstacle is forgotten; 0: nothing is remembered.
    keep_out : float
        Distance [m] from a hit point within which the robot's centre cannot come.
    believed_free_alpha : float
        Rung up to which a path leads through no cell that is believed occupied.
    shift : float
        How far off its centre the robot may drive through a cell, in x and in y [m]; see
        `shift_within`.
    """

    def __init__(
        self, memory: int, keep_out: float, believed_free_alpha: float, shift: float = 0.0
    ) -> None:
        self._memory = memory
        self._keep_out = keep_out
        self._shift = shift
        self._believed_free_alpha = believed_free_alpha
        self.forget()

    def forget(self) -> None:
        """Forget all cells: a mission begins."""
        self._until: dict[tuple[float, float], int] = {}
        self._visits: list[tuple[float, float, bool]] = []

    def release(self) -> bool:
        """Give all cells free, for what was in the way may have gone.

        Earlier visits count no more, either: they may have been to somebody who stood there.

        Returns
        -------
        bool
            Whether there was something to give free.
        """
        useful = bool(self._until)
        self._until.clear()
        self._visits.clear()
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
            Centre (x, y) [m] of the path's cell that the robot stopped before.
        """
        if record.last_stop is Stop.CLEARANCE:
            self.add_obstacle(record.perceptions, hits, geometry)
        elif record.last_stop is Stop.UNEXPLORED:
            self.add_unexplored(
                record.perceptions, ahead, record.alpha, record.without_progress, geometry
            )

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
        cells: set[tuple[float, float]] = set()
        for x, y in hits.tolist():
            columns, rows = geometry.centres(geometry.window(x, y, self._keep_out))
            cells.update((column, row) for column in columns.tolist() for row in rows.tolist())
        if not cells:
            return
        centres = np.array(sorted(cells))
        # As planner and motion judge them: a cell counts by its best place.
        shift = shift_within(self._shift, geometry.resolution)
        distance = best_clearance(centres, hits, 0.0, shift)
        for column, row in centres[distance < self._keep_out].tolist():
            self._until[column, row] = perception + self._memory

    def add_unexplored(
        self,
        perception: int,
        ahead: tuple[float, float],
        alpha: float,
        looks: int,
        geometry: GridGeometry,
    ) -> None:
        """Take note that the motion ended before a cell that is not known to be free.

        Once is the rule: the robot looks and goes on. What is still not free after two looks
        from beside it is barred, and so is a place that stops the robot visit after visit.

        Parameters
        ----------
        perception : int
            Number of perceptions made so far.
        ahead : tuple of float
            Centre (x, y) [m] of the cell.
        alpha : float
            Rung that the path was found on.
        looks : int
            Perceptions in a row that did not bring the robot on.
        geometry : GridGeometry
            The cells.
        """
        risky = alpha > self._believed_free_alpha
        visit = (*ahead, risky)
        if looks == 0 or visit not in self._visits:
            self._visits.append(visit)
        radius = RISKY_RADIUS if risky else 0.0
        near = (
            math.dist(ahead, (x, y)) <= radius + SAME for x, y, r in self._visits if r is risky
        )
        tries = sum(near)
        if tries >= TRIES:
            self._bar(
                ahead, radius, perception, UNEXPLORED_MEMORY << min(tries - TRIES, 20), geometry
            )
        elif looks > 1:
            self._bar(ahead, 0.0, perception, UNEXPLORED_MEMORY, geometry)

    def add_impasse(
        self,
        perception: int,
        ahead: tuple[float, float],
        radius: float,
        geometry: GridGeometry,
    ) -> None:
        """Bar a place where look after look leaves the body no room.

        Each look explains what the one before has seen, and sees something else: hit points by
        themselves would hold the robot there for good.

        Parameters
        ----------
        perception : int
            Number of perceptions made so far.
        ahead : tuple of float
            Centre (x, y) [m] of the cell that the robot stopped before.
        radius : float
            Distance from it [m] within which cells are barred.
        geometry : GridGeometry
            The cells.
        """
        self._bar(ahead, radius, perception, self._memory, geometry)

    def _bar(
        self,
        centre: tuple[float, float],
        radius: float,
        perception: int,
        perceptions: int,
        geometry: GridGeometry,
    ) -> None:
        """Bar the cells within a radius [m] for some perceptions, but not beyond the memory."""
        until = perception + min(perceptions, self._memory)
        columns, rows = geometry.centres(geometry.window(*centre, radius + SAME))
        for x in columns:
            for y in rows:
                if math.dist(centre, (x, y)) <= radius + SAME:
                    cell = (float(x), float(y))
                    self._until[cell] = max(until, self._until.get(cell, until))

    def barred(self, perception: int) -> tuple[tuple[float, float], ...]:
        """Return the centres (x, y) [m] of the cells that are remembered at a perception."""
        self._until = {cell: end for cell, end in self._until.items() if end > perception}
        return tuple(self._until)
