# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a mission has tried in vain, and when it is worth another try."""

from __future__ import annotations

import numpy as np

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.frontier_looks import FrontierLooks
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.refused_cells import Points, RefusedCells

__all__ = ["TriedPlaces"]

_NOTHING = np.empty((0, 2))


class TriedPlaces:
    """The memories of a mission that keep the planner from places, as one.

    Parameters
    ----------
    parameters : MotionParameters
        How long and after what a place is barred.
    """

    def __init__(self, parameters: MotionParameters) -> None:
        p = parameters
        keep_out = p.robot_radius + p.clearance.override
        self._p = p
        shift = p.layer.shift if p.subcell_target else 0.0
        self._refused = RefusedCells(p.refusal_memory, keep_out, p.believed_free_alpha, shift)
        self._looks = FrontierLooks(p.frontier_looks, p.frontier_reach, keep_out)
        self.forget()

    def forget(self) -> None:
        """Forget everything: a mission begins."""
        self._refused.forget()
        self._looks.forget()
        self._given_free: set[bool] = set()  # before the patience was over, and after

    def perceived(self, area: ExploredArea, pose: Pose2, hits: Points = _NOTHING) -> None:
        """Take note of a perception: the map after it, where it was made, what infrareds hit."""
        self._looks.look(area.cells, area.geometry, pose, hits)

    def stopped(
        self, record: MissionRecord, hits: Points, ahead: tuple[float, float], area: ExploredArea
    ) -> bool:
        """Take note of where the motion has just not gone on.

        Parameters
        ----------
        record, hits, ahead
            As `RefusedCells.take_note` takes them.
        area : ExploredArea
            The cells.

        Returns
        -------
        bool
            Whether the place itself is barred now, since look after look found no room there
            on what seemed to be a way: the next path leads elsewhere.
        """
        self._refused.take_note(record, hits, ahead, area.geometry)
        p, radius = self._p, self._p.clearance.impasse
        impasse = radius > 0.0 and p.refusal_memory > 0
        impasse &= record.alpha <= p.believed_free_alpha
        impasse &= record.looked_in_vain >= p.livelock_limit
        if impasse:
            self._refused.add_impasse(record.perceptions, ahead, radius, area.geometry)
        return impasse

    def barred(self, perception: int, area: ExploredArea) -> tuple[tuple[float, float], ...]:
        """Return the centres (x, y) [m] of the cells that no path may enter now."""
        return self._refused.barred(perception) + self._looks.barred(area.cells)

    def try_again(self, perceptions: int) -> bool:
        """Give places free, for what was in the way may have gone.

        Parameters
        ----------
        perceptions : int
            Perceptions made so far: while they are fewer than the patience everything is looked at
            again each time, and obstacles are tried once more; after that both once.

        Returns
        -------
        bool
            Whether there was something to give free.
        """
        late = perceptions >= self._p.patience
        first = late not in self._given_free
        self._given_free.add(late)
        released = self._refused.release() and first
        if first or not late:
            released |= self._looks.again()
        return released
