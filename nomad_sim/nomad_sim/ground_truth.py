# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The truth about a world, to compare maps and verdicts with."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.jit import njit
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.surfaces import Surfaces
from nomad_sim.world import World

__all__ = ["occupancy", "reachable"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# Coarsest and finest cells of the search for a way [m].
_COARSEST = 0.04
_FINEST = 0.005
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


@njit
def _flood(free: BoolArray, row: int, column: int, diagonal: bool) -> BoolArray:
    """Return the cells connected with one cell, shape (H, W)."""
    height, width = free.shape
    reached = np.zeros((height, width), dtype=np.bool_)
    stack = np.empty((height * width, 2), dtype=np.int64)
    count = 0
    if free[row, column]:
        reached[row, column] = True
        stack[0, 0] = row
        stack[0, 1] = column
        count = 1
    while count > 0:
        count -= 1
        row = stack[count, 0]
        column = stack[count, 1]
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                if dr != 0 and dc != 0 and not diagonal:
                    continue
                r = row + dr
                c = column + dc
                if 0 <= r < height and 0 <= c < width and free[r, c] and not reached[r, c]:
                    reached[r, c] = True
                    stack[count, 0] = r
                    stack[count, 1] = c
                    count += 1
    return reached


def reachable(world: World, robot_radius: float = ROBOT_RADIUS, tolerance: float = 0.0) -> bool:
    """Whether a disc can get from the world's start to its goal.

    Obstacles that move, come or go count as out of the way: the answer is for their best
    schedule. Both answers are proven. Clearance changes by no more than the way between two
    points, so a chain of neighbouring cells whose centres are clear by half a cell's
    diagonal holds a free path; and if none leads to the goal even through all cells whose
    centres are no farther inside obstacles than that, there is no free path.

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
    lasting = tuple(m for m in world.moving if m.lasting)
    surfaces = replace(world, moving=lasting).surfaces()
    resolution = _COARSEST
    while resolution >= _FINEST:
        geometry = world.geometry(resolution)
        start = geometry.cell_of(world.start.x, world.start.y)
        geometry.cell_of(*world.goal)
        x, y = geometry.centres()
        clearance = surfaces.distances(x, y) - robot_radius
        margin = 0.5 * math.sqrt(2.0) * resolution
        far = np.hypot((x - world.goal[0])[None, :], (y - world.goal[1])[:, None])
        at_goal = far <= max(tolerance, margin)
        if (_flood(clearance >= margin, *start, False) & at_goal).any():
            return True
        if not (_flood(clearance >= -margin, *start, True) & (far <= tolerance + margin)).any():
            return False
        resolution *= 0.5
    raise ValueError(
        f"world '{world.name}': cells of {_FINEST} m do not decide whether the goal can be "
        f"reached; a passage is too close to the robot's diameter of {2 * robot_radius:g} m"
    )
