# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Memory of how often the robot has looked closely at the border of what it knows.

The frontier are the cells that the robot may not enter beside those that it may and that it can
get to: the border of unexplored ground, and everything along walls. Where something is open the
first or second look from close by opens it: of the cells that 20 missions drove through, none
had been frontier at more than two perceptions from within 1.2 m. Only a beam so wide that the
edges of an opening are heard on its axis takes more: through two openings of 0.7 m 1 of 4
missions came with 5 looks, 4 of 4 with 8. Further looks at what stayed closed tell nothing new,
and a planner that admits cells believed occupied, or takes a smooth wall for open, sends the
robot for them all the same, to another cell of the same wall each time. Frontier that has been
looked at often enough is therefore barred, wall by wall: the robot goes where a look still tells
something, and where there is no such place left the goal is unreachable.

A sonar's arc is vague, an infrared's hit is not: where one keeps the body out, half as many looks
tell as much.
"""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.clearance import clearance_at

__all__ = ["FrontierLooks", "frontier_in_sight"]

_ALL_AROUND = np.ones((3, 3), dtype=np.bool_)
_NOTHING = np.empty((0, 2))
#: Spacing of the points at which a line of sight is looked at, in cells.
_SAMPLE = 0.5
#: How deep the frontier is, in cells: what is open moves to and fro by as much from look to look.
DEPTH = 3
#: Looks that one counts as, of those that are enough, where an infrared sees what is in the way:
#: two are needed, for one may be of noise or of somebody who passes.
_SURE = 0.5
#: Cells that are so near to the one looked at do not hide it, in cells.
_BESIDE = math.sqrt(2.0) * DEPTH + 0.5


def frontier_in_sight(
    enterable: NDArray[np.bool_], geometry: GridGeometry, pose: Pose2, reach: float
) -> NDArray[np.int64]:
    """Return the cells of the frontier that the robot sees from where it stands.

    Parameters
    ----------
    enterable : ndarray of bool, shape (H, W)
        Cells that the robot's centre may enter.
    geometry : GridGeometry
        Where the cells lie.
    pose : Pose2
        Where the robot is; its cell counts as enterable.
    reach : float
        Distance [m] beyond which it does not look closely.

    Returns
    -------
    ndarray of int64, shape (n, 2)
        Cells (row, column) that may not be entered and are no more than `DEPTH` steps away from
        one that may, that is connected with the robot's within its reach; to each the straight
        line leads through such cells.
    """
    side = geometry.resolution
    seen = geometry.window(pose.x, pose.y, reach + side)
    row, column = geometry.cell_of(pose.x, pose.y)
    here = (row - seen.row0, column - seen.col0)
    free = enterable[seen.slices].copy()
    free[here] = True
    closed = ~free
    labels, _ = ndimage.label(free, _ALL_AROUND)
    free = labels == labels[here]
    rows, columns = np.nonzero(
        ndimage.binary_dilation(free, _ALL_AROUND, iterations=DEPTH) & closed
    )
    x, y = geometry.centre_coordinates(rows + seen.row0, columns + seen.col0)
    dx, dy = x - pose.x, y - pose.y
    distance = np.hypot(dx, dy)
    samples = np.arange(_SAMPLE, math.ceil(reach / side) + 1.0, _SAMPLE) * side
    shares = samples / np.maximum(distance, side)[:, None]
    before = samples < distance[:, None] - _BESIDE * side
    shares = np.where(before, shares, 0.0)
    way = np.column_stack(
        ((pose.x + shares * dx[:, None]).reshape(-1), (pose.y + shares * dy[:, None]).reshape(-1))
    )
    cells, _ = geometry.cells_of(way)
    clear = free[cells[:, 0] - seen.row0, cells[:, 1] - seen.col0].reshape(shares.shape)
    visible = clear.all(axis=1) & (distance <= reach)
    out: NDArray[np.int64] = np.column_stack((rows + seen.row0, columns + seen.col0))[visible]
    return out


class FrontierLooks:
    """How often each cell of the frontier has been looked at, and which are not worth another.

    Parameters
    ----------
    enough : int
        Looks after which a cell that is still frontier is barred; 0: never.
    reach : float
        Distance [m] from which a look counts.
    keep_out : float
        Distance [m] from a hit point within which the robot's centre cannot come.
    """

    def __init__(self, enough: int, reach: float, keep_out: float = 0.0) -> None:
        self._enough = enough
        self._reach = reach
        self._keep_out = keep_out
        self.forget()

    def forget(self) -> None:
        """Forget all looks: a mission begins."""
        self._looks: Counter[tuple[int, int]] = Counter()
        self._geometry: GridGeometry | None = None

    def look(
        self,
        enterable: NDArray[np.bool_],
        geometry: GridGeometry,
        pose: Pose2,
        hits: NDArray[np.float64] = _NOTHING,
    ) -> None:
        """Take note of a perception.

        Parameters
        ----------
        enterable, geometry, pose
            As `frontier_in_sight` takes them, of the map after the perception.
        hits : ndarray of float64, shape (n, 2)
            Points (x, y) [m] that the infrareds hit at the perception.
        """
        if self._enough == 0 or not geometry.contains(pose.x, pose.y):
            return
        if geometry != self._geometry:
            self.forget()
            self._geometry = geometry
        # What has been open for once is no wall, though it may not be open now.
        for cell in [cell for cell in self._looks if enterable[cell]]:
            del self._looks[cell]
        cells = frontier_in_sight(enterable, geometry, pose, self._reach)
        self._looks.update(map(tuple, cells.tolist()))
        x, y = geometry.centre_coordinates(cells[:, 0], cells[:, 1])
        near = clearance_at(np.column_stack((x, y)), hits, self._keep_out) < 0.0
        more = math.ceil(_SURE * self._enough) - 1
        for row, column in cells[near].tolist():
            self._looks[row, column] += more

    def again(self) -> bool:
        """Have everything looked at once more, for what was in the way may have gone.

        Returns
        -------
        bool
            Whether there was something that is barred no longer.
        """
        spent = [cell for cell, looks in self._looks.items() if looks >= self._enough > 0]
        for cell in spent:
            self._looks[cell] = self._enough - 1
        return bool(spent)

    def barred(self, enterable: NDArray[np.bool_]) -> tuple[tuple[float, float], ...]:
        """Return the centres (x, y) [m] of the cells that are not worth another look.

        Parameters
        ----------
        enterable : ndarray of bool, shape (H, W)
            Cells that the robot's centre may enter now: they are frontier no longer.
        """
        if self._geometry is None:
            return ()
        return tuple(
            self._geometry.centre_of(*cell)
            for cell, looks in self._looks.items()
            if looks >= self._enough and not enterable[cell]
        )
