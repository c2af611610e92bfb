# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What drawn worlds are put together from, and the rules by which pieces keep apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nomad_sim.world import Circle, Polygon, Wall

__all__ = [
    "OUTSIDE",
    "Draft",
    "Rectangle",
    "apart",
    "outer_walls",
    "pillars",
    "rectangle",
    "scatter",
]

#: How far outside the area the outer walls stand [m]: no cell of the map is cut by them.
OUTSIDE = 0.05
#: Draws before the pieces placed so far are taken away again.
_DRAWS = 2000

#: Sides x0, y0, x1, y1 [m].
Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Draft:
    """The layout of a drawn world, before its materials, start and goal are drawn.

    Parameters
    ----------
    size : tuple of float
        Extent of the area from (0, 0) on [m].
    walls, polygons, circles : tuple
        What is there.
    door : float or None
        Width of the narrowest door or opening drawn [m], None if there is none.
    """

    size: tuple[float, float]
    walls: tuple[Wall, ...]
    polygons: tuple[Polygon, ...] = ()
    circles: tuple[Circle, ...] = ()
    door: float | None = None

    @property
    def has_glass(self) -> bool:
        """Whether anything is of glass."""
        shapes: tuple[Wall | Polygon | Circle, ...] = (*self.walls, *self.polygons, *self.circles)
        return any(shape.material == "glass" for shape in shapes)


def rectangle(x0: float, y0: float, x1: float, y1: float, material: str) -> Polygon:
    """Return a box with these sides [m]."""
    return Polygon(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), material)


def outer_walls(size: tuple[float, float], materials: Sequence[str]) -> tuple[Wall, ...]:
    """Return the walls around an area: bottom, right, top and left, each of its material.

    Parameters
    ----------
    size : tuple of float
        Extent of the area from (0, 0) on [m].
    materials : sequence of str
        One name for all sides, or one for each.
    """
    x, y = size[0] + OUTSIDE, size[1] + OUTSIDE
    corners = np.array([[-OUTSIDE, -OUTSIDE], [x, -OUTSIDE], [x, y], [-OUTSIDE, y]])
    if len(materials) == 1:
        return (Wall(corners, materials[0], closed=True),)
    return tuple(
        Wall(np.array([corners[i], corners[(i + 1) % 4]]), material)
        for i, material in enumerate(materials)
    )


def apart(a: Rectangle, b: Rectangle) -> float:
    """Return the distance [m] between two rectangles, 0 where they overlap."""
    dx = max(a[0] - b[2], b[0] - a[2], 0.0)
    dy = max(a[1] - b[3], b[1] - a[3], 0.0)
    return math.hypot(dx, dy)


def scatter(
    generator: np.random.Generator,
    size: tuple[float, float],
    count: int,
    radii: tuple[float, float],
    distance: float,
    ends: Sequence[tuple[float, float]] = (),
    ends_free: float = 0.0,
) -> list[tuple[float, float, float]]:
    """Return discs (x, y, radius) [m] at random places that keep apart.

    Parameters
    ----------
    generator : numpy.random.Generator
        What is drawn from.
    size : tuple of float
        Extent of the area from (0, 0) on [m].
    count : int
        Discs wanted.
    radii : tuple of float
        Smallest and largest radius [m].
    distance : float
        Least free space between two of them [m].
    ends : sequence of tuple of float
        Points (x, y) [m] that are to stay free.
    ends_free : float
        Least distance of the discs' faces from them [m].
    """
    placed: list[tuple[float, float, float]] = []
    draws = 0
    while len(placed) < count:
        draws += 1
        if draws % _DRAWS == 0:  # no room is left for another one
            placed.clear()
        x, y = generator.uniform(0.0, size[0]), generator.uniform(0.0, size[1])
        radius = generator.uniform(*radii)
        free = all(math.hypot(x - u, y - v) >= radius + r + distance for u, v, r in placed)
        if free and all(math.hypot(x - u, y - v) >= radius + ends_free for u, v in ends):
            placed.append((x, y, radius))
    return placed


def pillars(
    generator: np.random.Generator, discs: Sequence[tuple[float, float, float]], material: str
) -> tuple[tuple[Circle, ...], tuple[Polygon, ...]]:
    """Return cylinders and, for every other disc, a square at any angle whose corners lie on it.

    Parameters
    ----------
    generator : numpy.random.Generator
        What the squares' angles are drawn from.
    discs : sequence of tuple of float
        Centres and radii (x, y, radius) [m].
    material : str
        Of all of them.
    """
    circles, polygons = [], []
    for number, (x, y, radius) in enumerate(discs):
        if number % 2 == 0:
            circles.append(Circle(x, y, radius, material))
        else:
            turn = generator.uniform(0.0, 0.5 * math.pi) + 0.5 * math.pi * np.arange(4)
            corners = np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])
            polygons.append(Polygon(corners, material))
    return tuple(circles), tuple(polygons)
