# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The shortest way that the robot's body could take if it knew the world."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from fuzzy_navigation.search import find_path
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.ray_casting import nearest_distance
from nomad_sim.surfaces import Surfaces
from nomad_sim.world import World

__all__ = ["length_of", "shortest_way"]

FloatArray = NDArray[np.float64]

# Side of the cells in which the way is sought [m], and spacing of the points at which it is
# made sure that a straight piece is free [m].
_CELL = 0.04
_SAMPLE = 0.02
# Points of the cells' way that the straight pieces may run between.
_KNOTS = 80


def length_of(way: FloatArray) -> float:
    """Return the length [m] of a polyline, shape (n, 2)."""
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def shortest_way(world: World, robot_radius: float = ROBOT_RADIUS) -> FloatArray | None:
    """Return a way from start to goal that is as short as can be, but for a percent or two.

    Obstacles that move, come or go count as out of the way. The way is the shortest chain
    of free cells, pulled straight where the body fits through. Where it comes close to something
    it is looked at every two centimetres (every four where it bends) whether the body is free.

    Parameters
    ----------
    world : World
        The world.
    robot_radius : float
        Radius of the body [m].

    Returns
    -------
    ndarray of float64, shape (n, 2), or None
        Its corners [m], start and goal included; None if there is none in cells of 4 cm.

    Raises
    ------
    ValueError
        If start or goal lie outside the area.
    """
    lasting = tuple(m for m in world.moving if m.lasting)
    surfaces = replace(world, moving=lasting).surfaces()
    geometry = world.geometry(_CELL)
    start = geometry.cell_of(world.start.x, world.start.y)
    goal = geometry.cell_of(*world.goal)
    free = surfaces.distances(*geometry.centres()) >= robot_radius
    found = find_path(
        np.zeros(geometry.shape),
        start,
        goal,
        "g1",
        1.0,
        8,
        epsilon=1.0,
        diagonal="sqrt2",
        corner_cutting=False,
        barred=~free,
    )
    if not found.found:
        return None
    x, y = geometry.centre_coordinates(found.path[:, 0], found.path[:, 1])
    chain = np.column_stack([x, y])
    chain = np.vstack([(world.start.x, world.start.y), chain[1:-1], world.goal])
    return _straightened(chain, surfaces, robot_radius)


def _straightened(chain: FloatArray, surfaces: Surfaces, robot_radius: float) -> FloatArray:
    """Return the shortest way along free straight pieces between points of a chain."""
    count = min(_KNOTS, len(chain))
    # The chain itself, between two neighbouring knots, is the way where no piece is free.
    knots = np.unique(np.linspace(0, len(chain) - 1, count).round().astype(int))
    best: list[tuple[float, FloatArray]] = [(0.0, chain[:1])]
    for j in range(1, len(knots)):
        piece = chain[knots[j - 1] + 1 : knots[j] + 1]
        options = [(best[j - 1][0] + length_of(chain[knots[j - 1] : knots[j] + 1]), j - 1, piece)]
        end = chain[knots[j] : knots[j] + 1]
        for i in range(j):
            length = best[i][0] + math.dist(chain[knots[i]], end[0])
            if length < options[-1][0] and _free(chain[knots[i]], end[0], surfaces, robot_radius):
                options.append((length, i, end))
        length, i, piece = options[-1]
        best.append((length, np.vstack([best[i][1], piece])))
    return best[-1][1]


def _free(a: FloatArray, b: FloatArray, surfaces: Surfaces, robot_radius: float) -> bool:
    """Whether the body can go straight from a to b."""
    length = math.dist(a, b)
    ux, uy = ((b - a) / length).tolist() if length > 0.0 else (0.0, 0.0)
    there = surfaces.segments, surfaces.circles, surfaces.solids
    return _passes(float(a[0]), float(a[1]), ux, uy, length, robot_radius, *there)


@njit
def _passes(
    x: float,
    y: float,
    ux: float,
    uy: float,
    length: float,
    radius: float,
    segments: FloatArray,
    circles: FloatArray,
    solids: NDArray[np.int64],
) -> bool:
    """Whether the body can go straight on from a place.

    Parameters
    ----------
    x, y, ux, uy, length : float
        The place [m], the direction, of length 1, and the way [m].
    radius : float
        Of the body [m].
    segments, circles, solids : ndarray
        Surfaces, as for `ray_casting.nearest_distance`.
    """
    along = 0.0
    while True:
        place_x, place_y = x + along * ux, y + along * uy
        room = nearest_distance(place_x, place_y, segments, circles, solids) - radius
        if room < 0.0:
            return False
        if along == length:
            return True
        # Nothing is nearer than that room: the body is free until it has been used up.
        along = min(along + max(room, _SAMPLE), length)
