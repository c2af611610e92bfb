# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The truth about a world, to compare maps and verdicts with."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from fuzzy_map_building.grid import GridGeometry
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.surfaces import Surfaces
from nomad_sim.world import World

__all__ = [
    "MARGINAL_CLEARANCE",
    "Reachability",
    "WayClearance",
    "occupancy",
    "reachability",
    "reachable",
    "way_clearance",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

#: Clearance of the best way below which a goal is marginal [m].
MARGINAL_CLEARANCE = 0.05

# Coarsest and finest cells of the search for a way [m].
_COARSEST = 0.04
_FINEST = 0.005
# Step of clearance to which the widest way through the cells is found [m].
_STEP = 1e-4
# Share of a cell [m] by which "on its border" is told from "in it".
_BORDER = 1e-6


def _crosses_box(segment: FloatArray, x: FloatArray, y: FloatArray, half: float) -> BoolArray:
    """Whether a segment meets each of the square cells with centres `x`, `y`, shape (H, W)."""
    centre_x, centre_y = 0.5 * (segment[0] + segment[2]), 0.5 * (segment[1] + segment[3])
    reach_x, reach_y = 0.5 * abs(segment[2] - segment[0]), 0.5 * abs(segment[3] - segment[1])
    dx, dy = np.abs(x - centre_x)[None, :], np.abs(y - centre_y)[:, None]
    # Separating axes of a box and a segment: x, y, and the segment's normal.
    normal_x, normal_y = segment[3] - segment[1], segment[0] - segment[2]
    along = (x - centre_x)[None, :] * normal_x + (y - centre_y)[:, None] * normal_y
    near = np.abs(along) <= half * (abs(normal_x) + abs(normal_y))
    met: BoolArray = (dx <= reach_x + half) & (dy <= reach_y + half) & near
    return met


def _span(centres: FloatArray, low: float, high: float) -> slice:
    return slice(int(np.searchsorted(centres, low)), int(np.searchsorted(centres, high, "right")))


def occupancy(surfaces: Surfaces, geometry: GridGeometry) -> BoolArray:
    """Return which cells hold part of an obstacle.

    An obstacle that ends on the border of a cell leaves the cell free; a thin wall on the
    border occupies the cells on both sides.

    Parameters
    ----------
    surfaces : Surfaces
        What is there.
    geometry : GridGeometry
        The cells.

    Returns
    -------
    ndarray of bool, shape (H, W)
    """
    x, y = geometry.centres()
    occupied: BoolArray = surfaces.distances(x, y) <= 0.0
    solid = np.zeros(len(surfaces.segments), dtype=bool)
    for start, stop in surfaces.solids:
        solid[start:stop] = True
    for segment, of_solid in zip(surfaces.segments, solid, strict=True):
        half = 0.5 * geometry.resolution + (-_BORDER if of_solid else _BORDER)
        columns = _span(x, min(segment[0::2]) - half, max(segment[0::2]) + half)
        rows = _span(y, min(segment[1::2]) - half, max(segment[1::2]) + half)
        occupied[rows, columns] |= _crosses_box(segment, x[columns], y[rows], half)
    half = 0.5 * geometry.resolution - _BORDER
    for cx, cy, radius in surfaces.circles:
        columns = _span(x, cx - radius - half, cx + radius + half)
        rows = _span(y, cy - radius - half, cy + radius + half)
        dx = np.maximum(np.abs(x[columns] - cx) - half, 0.0)[None, :]
        dy = np.maximum(np.abs(y[rows] - cy) - half, 0.0)[:, None]
        occupied[rows, columns] |= np.hypot(dx, dy) < radius
    return occupied


def _leads(
    clearance: FloatArray, least: float, start: tuple[int, int], goal: BoolArray, diagonal: bool
) -> bool:
    """Whether a chain of cells with no less than some clearance leads from one cell to a goal.

    Parameters
    ----------
    clearance : ndarray of float64, shape (H, W)
        Of the cells [m].
    least : float
        What the cells of the chain must have [m].
    start : tuple of int
        Its first cell (row, column).
    goal : ndarray of bool, shape (H, W)
        The cells that it may end in.
    diagonal : bool
        Whether cells that touch by corners are neighbours.
    """
    if not clearance[start] >= least:
        return False
    parts, _ = ndimage.label(clearance >= least, np.ones((3, 3)) if diagonal else None)
    return bool((parts[goal] == parts[start]).any())


class Reachability(Enum):
    """What is true of a goal."""

    REACHABLE = "reachable"
    #: The body fits through, but by less than `MARGINAL_CLEARANCE`; also what cells of 5 mm
    #: cannot tell from either neighbour.
    MARGINAL = "marginal"
    UNREACHABLE = "unreachable"

    @property
    def expected(self) -> str:
        """The true outcome of a mission there, as `World.expected` has it."""
        return "unreachable" if self is Reachability.UNREACHABLE else "reached"


@dataclass(frozen=True)
class WayClearance:
    """Bounds of the clearance of the best way: the widest one at its narrowest point.

    Parameters
    ----------
    low, high : float
        Distance [m] between the body and the nearest surface; below 0 the body would have to
        be smaller by that much. ``low`` is minus infinity where no way was found.
    """

    low: float
    high: float

    def decides(self, limit: float) -> bool:
        """Whether it is certain on which side of a limit [m] the clearance lies."""
        return self.low >= limit or self.high < limit

    @property
    def reachability(self) -> Reachability:
        """What follows for the goal."""
        if self.high < 0.0:
            return Reachability.UNREACHABLE
        if self.low >= MARGINAL_CLEARANCE:
            return Reachability.REACHABLE
        return Reachability.MARGINAL


def _widest(
    clearance: FloatArray, start: tuple[int, int], goal: BoolArray, diagonal: bool
) -> tuple[float, float]:
    """Return the least clearance on the widest chain of cells, as what is and what is not.

    Chains exist down to the first value [m] and none does from the second on; both are minus
    infinity if none exists at all.
    """
    ends = clearance[goal]
    if not ends.size:
        return -math.inf, -math.inf
    low = float(clearance.min())
    high = float(min(clearance[start], ends.max()))
    if _leads(clearance, high, start, goal, diagonal):
        return high, high + _STEP
    if not _leads(clearance, low, start, goal, diagonal):
        return -math.inf, -math.inf
    while high - low > _STEP:
        middle = 0.5 * (low + high)
        if _leads(clearance, middle, start, goal, diagonal):
            low = middle
        else:
            high = middle
    return low, high


def _bounds(
    surfaces: Surfaces, world: World, robot_radius: float, tolerance: float, resolution: float
) -> WayClearance:
    """Return proven bounds of the best way's clearance from cells of one size."""
    geometry = world.geometry(resolution)
    start = geometry.cell_of(world.start.x, world.start.y)
    geometry.cell_of(*world.goal)
    x, y = geometry.centres()
    clearance = surfaces.distances(x, y) - robot_radius
    margin = 0.5 * math.sqrt(2.0) * resolution
    far = np.hypot((x - world.goal[0])[None, :], (y - world.goal[1])[:, None])
    there, _ = _widest(clearance, start, far <= max(tolerance, margin), False)
    _, not_there = _widest(clearance, start, far <= tolerance + margin, True)
    return WayClearance(there - margin, not_there + margin)


def way_clearance(
    world: World,
    robot_radius: float = ROBOT_RADIUS,
    tolerance: float = 0.0,
    limits: tuple[float, ...] = (0.0, MARGINAL_CLEARANCE),
) -> WayClearance:
    """Return how much room a disc has on the best way from the world's start to its goal.

    Obstacles that move, come or go count as out of the way: the answer is for their best
    schedule. Both bounds are proven. Clearance changes by no more than the way between two
    points, so along a chain of cells with common sides the disc has all the room that the
    centres have but for half a cell's diagonal; and no way has more room than the centres of
    the cells that it leads through, which touch at least by corners, and that half diagonal.
    Cells are halved from 4 cm until no limit lies between the bounds, or down to 5 mm, where
    the bounds are 7 mm apart if one chain serves for both.

    Parameters
    ----------
    world : World
        The world.
    robot_radius : float
        Radius of the disc [m].
    tolerance : float
        Distance from the goal at which the disc's centre has arrived [m].
    limits : tuple of float
        Clearances [m] with which the result is to be compared.

    Raises
    ------
    ValueError
        If start or goal lie outside the area.
    """
    lasting = tuple(m for m in world.moving if m.lasting)
    surfaces = replace(world, moving=lasting).surfaces()
    resolution = _COARSEST
    while True:
        bounds = _bounds(surfaces, world, robot_radius, tolerance, resolution)
        resolution *= 0.5
        if resolution < _FINEST or all(bounds.decides(limit) for limit in limits):
            return bounds


def reachability(
    world: World, robot_radius: float = ROBOT_RADIUS, tolerance: float = 0.0
) -> Reachability:
    """Return what is true of the world's goal; see `way_clearance` for how and the errors."""
    return way_clearance(world, robot_radius, tolerance).reachability


def reachable(world: World, robot_radius: float = ROBOT_RADIUS, tolerance: float = 0.0) -> bool:
    """Whether a disc can get from the world's start to its goal.

    Parameters
    ----------
    world : World
        The world.
    robot_radius : float
        Radius of the disc [m].
    tolerance : float
        Distance from the goal at which the disc's centre has arrived [m].

    Raises
    ------
    ValueError
        If start or goal lie outside the area, or a passage is so close to the disc's
        diameter that cells of 5 mm do not decide.
    """
    bounds = way_clearance(world, robot_radius, tolerance, limits=(0.0,))
    if bounds.decides(0.0):
        return bounds.low >= 0.0
    raise ValueError(
        f"world '{world.name}': cells of {_FINEST} m do not decide whether the goal can be "
        f"reached; a passage is too close to the robot's diameter of {2 * robot_radius:g} m"
    )
