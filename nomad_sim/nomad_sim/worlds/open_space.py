# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Layouts of one room: clutter, slaloms and halls with glass."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from nomad_sim.world import Circle, Polygon
from nomad_sim.worlds.shapes import OUTSIDE, Draft, outer_walls, pillars, rectangle, scatter

__all__ = ["clutter", "hall", "slalom"]

FloatArray = NDArray[np.float64]

_OPENINGS = (0.65, 1.0)
# Free space between two things in a hall [m].
_HALL_APART = 0.95
_TRIES = 60


def clutter(generator: np.random.Generator) -> Draft:
    """Return a room with pillars and boxes at random places."""
    size = (round(generator.uniform(6.0, 9.0), 1), round(generator.uniform(5.0, 7.0), 1))
    count = int(generator.integers(6, max(7, int(size[0] * size[1] / 4.5))))
    distance = generator.uniform(0.65, 0.95)
    discs = scatter(generator, size, count, (0.1, 0.38), distance)
    circles, polygons = pillars(generator, discs, "cardboard")
    return Draft(size, outer_walls(size, ["painted_wall"]), polygons, circles)


def slalom(generator: np.random.Generator) -> Draft:
    """Return screens across a room, each with an opening at an end or somewhere between."""
    count = int(generator.integers(3, 6))
    spacing = generator.uniform(1.3, 1.8, count + 1)
    size = (round(float(spacing.sum()), 1), round(generator.uniform(3.2, 4.8), 1))
    bottom, top = -OUTSIDE, size[1] + OUTSIDE
    polygons, widths = [], []
    for number, x in enumerate(np.cumsum(spacing)[:-1]):
        half = 0.5 * generator.uniform(0.02, 0.2)
        width = generator.uniform(*_OPENINGS)
        widths.append(width)
        if generator.random() < 0.7:  # at the two ends in turn
            low = bottom if number % 2 else top - width
        else:
            low = generator.uniform(bottom + 0.4, top - 0.4 - width)
        for y0, y1 in ((bottom, low), (low + width, top)):
            if y1 - y0 > 0.01:
                polygons.append(rectangle(x - half, y0, x + half, y1, "cardboard"))
    return Draft(size, outer_walls(size, ["painted_wall"]), tuple(polygons), door=min(widths))


def hall(generator: np.random.Generator) -> Draft:
    """Return a large room with panes, cabinets and perhaps outer walls of glass, and pillars."""
    size = (round(generator.uniform(7.5, 11.0), 1), round(generator.uniform(6.5, 9.0), 1))
    sides = [("glass" if generator.random() < 0.35 else "painted_wall") for _ in range(4)]
    placed: list[tuple[FloatArray, FloatArray, float]] = []
    polygons: list[Polygon] = []
    circles: list[Circle] = []
    for number in range(int(generator.integers(4, 9))):
        # The first is a pane, so that no hall is without glass.
        kind = 0 if number == 0 else int(generator.integers(0, 3))
        for _ in range(_TRIES):
            centre = generator.uniform((0.6, 0.6), (size[0] - 0.6, size[1] - 0.6))
            angle = generator.choice([0.0, 0.5 * math.pi, generator.uniform(0.0, math.pi)])
            length, half = (
                (generator.uniform(1.0, 3.0), generator.uniform(0.02, 0.08)),
                (generator.uniform(0.8, 2.0), generator.uniform(0.15, 0.3)),
                (0.0, generator.uniform(0.1, 0.3)),
            )[kind]
            along = 0.5 * length * np.array([math.cos(angle), math.sin(angle)])
            a, b = centre - along, centre + along
            if all(
                _distance(a, b, *other[:2]) >= half + other[2] + _HALL_APART for other in placed
            ):
                break
        else:
            continue
        placed.append((a, b, half))
        if kind == 2:
            circles.append(Circle(float(centre[0]), float(centre[1]), half, "painted_wall"))
        else:
            across = half * np.array([-math.sin(angle), math.cos(angle)])
            corners = np.array([a - across, b - across, b + across, a + across])
            polygons.append(Polygon(corners, "glass"))
    return Draft(size, outer_walls(size, sides), tuple(polygons), tuple(circles))


def _distance(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float:
    """Return the distance [m] between the lines from a to b and from c to d, any a point."""

    def side(p: FloatArray, q: FloatArray, r: FloatArray) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    if side(a, b, c) * side(a, b, d) < 0.0 and side(c, d, a) * side(c, d, b) < 0.0:
        return 0.0

    def to_line(p: FloatArray, q: FloatArray, r: FloatArray) -> float:
        square = float((r - q) @ (r - q))
        share = min(max(float((p - q) @ (r - q)) / square, 0.0), 1.0) if square > 0.0 else 0.0
        return math.dist(p, q + share * (r - q))

    return min(to_line(a, c, d), to_line(b, c, d), to_line(c, a, b), to_line(d, a, b))
