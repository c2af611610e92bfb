# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Layouts with inner walls: offices, corridors and mazes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nomad_sim.world import Polygon, Wall
from nomad_sim.worlds.shapes import OUTSIDE, Draft, Rectangle, apart, outer_walls, rectangle

__all__ = ["corridor", "maze", "office"]

_DOORS = (0.65, 1.0)
_THICKNESS = (0.08, 0.2)
# Rooms that are not divided any more [m], and least distance of a door from a corner [m].
_SMALLEST_ROOM = 2.1
_CORNER = 0.25
# How far no wall may end beside a door, and no furniture may stand before one [m].
_BESIDE_DOOR = 0.4
_BEFORE_DOOR = 0.9
# Free space between furniture at a wall and the wall across, and around all other [m].
_PASSAGE = 0.7
_ROUND_FURNITURE = 0.85
_TRIES = 20


@dataclass(frozen=True)
class _Partition:
    """A wall across a room with one door, along x or along y.

    Parameters
    ----------
    along : int
        0: the wall runs along x, 1: along y.
    low, high : float
        Its two faces [m].
    begin, end : float
        Where it begins and ends [m].
    door : tuple of float
        Where its door begins and ends [m].
    """

    along: int
    low: float
    high: float
    begin: float
    end: float
    door: tuple[float, float]

    def _oriented(self, begin: float, end: float, margin: float = 0.0) -> Rectangle:
        low, high = self.low - margin, self.high + margin
        return (begin, low, end, high) if self.along == 0 else (low, begin, high, end)

    @property
    def pieces(self) -> tuple[Polygon, Polygon]:
        """The wall on both sides of the door, a little way into what it ends at."""
        return (
            rectangle(*self._oriented(self.begin - OUTSIDE, self.door[0]), "painted_wall"),
            rectangle(*self._oriented(self.door[1], self.end + OUTSIDE), "painted_wall"),
        )

    @property
    def way_through(self) -> Rectangle:
        """What has to stay free for the door to be one."""
        return self._oriented(*self.door, _BEFORE_DOOR)

    def holds(self, room: Rectangle, axis: int) -> bool:
        """Whether a wall along the other axis than `axis` in this room could end at it."""
        faces = (room[1 - axis], room[3 - axis])
        return self.along == axis and (self.high in faces or self.low in faces)


def _door(generator: np.random.Generator, begin: float, end: float) -> tuple[float, float]:
    width = generator.uniform(*_DOORS)
    first = generator.uniform(begin + _CORNER, end - _CORNER - width)
    return first, first + width


def _divided(
    generator: np.random.Generator, room: Rectangle, partitions: list[_Partition]
) -> list[Rectangle]:
    """Divide a room again and again; the walls made are added to `partitions`."""
    width, height = room[2] - room[0], room[3] - room[1]
    axis = 0 if width >= height else 1  # along which the room is divided
    thickness = generator.uniform(*_THICKNESS)
    low, high = room[axis] + _SMALLEST_ROOM, room[axis + 2] - _SMALLEST_ROOM - thickness
    if high < low:
        return [room]
    # Walls along the axis that bound the room: none may get the new wall before its door.
    bounding = [p for p in partitions if p.holds(room, axis)]
    for _ in range(_TRIES):
        face = generator.uniform(low, high)
        if all(
            face + thickness < p.door[0] - _BESIDE_DOOR or face > p.door[1] + _BESIDE_DOOR
            for p in bounding
        ):
            break
    else:
        return [room]
    begin, end = room[1 - axis], room[3 - axis]
    door = _door(generator, begin, end)
    partitions.append(_Partition(1 - axis, face, face + thickness, begin, end, door))
    x0, y0, x1, y1 = room
    halves: tuple[Rectangle, Rectangle] = (
        ((x0, y0, face, y1), (face + thickness, y0, x1, y1))
        if axis == 0
        else ((x0, y0, x1, face), (x0, face + thickness, x1, y1))
    )
    return [r for half in halves for r in _divided(generator, half, partitions)]


def _piece(generator: np.random.Generator, room: Rectangle) -> Rectangle | None:
    """Draw a piece of furniture in a room, at one of its walls or well away from all."""
    sizes = [float(generator.uniform(0.4, 1.2)), float(generator.uniform(0.3, 0.8))]
    if generator.random() < 0.5:
        sizes.reverse()
    side = int(generator.integers(0, 5))  # left, bottom, right, top; 4: none of them
    low, high = [0.0, 0.0], [0.0, 0.0]
    for axis in (0, 1):
        share = float(generator.uniform())
        first, last = room[axis], room[axis + 2]
        space = last - first - sizes[axis]
        margin = _ROUND_FURNITURE if side == 4 else 0.0
        if space < 2.0 * margin or (side in (axis, axis + 2) and space < _PASSAGE):
            return None
        low[axis] = first + margin + share * (space - 2.0 * margin)
        # At a wall, it reaches a little way into it, so that no slit is left.
        if side == axis:
            low[axis] = first
        elif side == axis + 2:
            low[axis] = last - sizes[axis]
        high[axis] = low[axis] + sizes[axis] + (OUTSIDE if side == axis + 2 else 0.0)
        low[axis] -= OUTSIDE if side == axis else 0.0
    return low[0], low[1], high[0], high[1]


def _furniture(
    generator: np.random.Generator, room: Rectangle, kept_free: Sequence[Rectangle]
) -> list[Rectangle]:
    """Return up to three pieces in a room that leave ways between them."""
    pieces: list[Rectangle] = []
    for _ in range(generator.integers(0, 4)):
        for _ in range(_TRIES):
            piece = _piece(generator, room)
            if (
                piece is not None
                and all(apart(piece, other) >= _ROUND_FURNITURE for other in pieces)
                and all(apart(piece, free) > 0.0 for free in kept_free)
            ):
                pieces.append(piece)
                break
    return pieces


def _furnished(
    generator: np.random.Generator,
    size: tuple[float, float],
    rooms: Sequence[Rectangle],
    partitions: Sequence[_Partition],
) -> Draft:
    kept_free = [p.way_through for p in partitions]
    return Draft(
        size,
        outer_walls(size, ["painted_wall"]),
        (
            *(piece for p in partitions for piece in p.pieces),
            *(
                rectangle(*box, "wood")
                for room in rooms
                for box in _furniture(generator, room, kept_free)
            ),
        ),
        door=min((p.door[1] - p.door[0] for p in partitions), default=None),
    )


def office(generator: np.random.Generator) -> Draft:
    """Return rooms of all sizes, with a door in every wall between two, and furniture."""
    size = (round(generator.uniform(6.5, 10.0), 1), round(generator.uniform(5.5, 8.0), 1))
    partitions: list[_Partition] = []
    rooms = _divided(generator, (0.0, 0.0, *size), partitions)
    return _furnished(generator, size, rooms, partitions)


def corridor(generator: np.random.Generator) -> Draft:
    """Return a corridor between two rows of rooms, each with a door to it."""
    length, width = round(generator.uniform(10.0, 15.0), 1), generator.uniform(1.2, 2.0)
    thickness = generator.uniform(*_THICKNESS)
    depths = generator.uniform(2.2, 3.2, 2)
    low = depths[0] + thickness
    size = (length, round(float(low + width + thickness + depths[1]), 1))
    rooms: list[Rectangle] = [(0.0, low, length, low + width)]
    partitions: list[_Partition] = []
    boxes: list[Polygon] = []
    # Both rows of rooms: their depth, the lower face of the corridor's wall before them, and
    # what the walls between them reach from and to.
    rows = (
        (0.0, depths[0], depths[0], -OUTSIDE, low),
        (low + width + thickness, size[1], low + width, low + width, size[1] + OUTSIDE),
    )
    for y0, y1, face, bottom, top in rows:
        x = 0.0
        while x < length:
            end = x + generator.uniform(2.4, 3.6)
            if length - end < 2.4 + thickness:
                end = length
            # The corridor's wall along this room, and the wall to the next room.
            door = _door(generator, x, end)
            partitions.append(_Partition(0, face, face + thickness, x, end, door))
            rooms.append((x, y0, end, y1))
            if end < length:
                boxes.append(rectangle(end, bottom, end + thickness, top, "painted_wall"))
                end += thickness
            x = end
    draft = _furnished(generator, size, rooms, partitions)
    return Draft(size, draft.walls, (*boxes, *draft.polygons), door=draft.door)


def maze(generator: np.random.Generator) -> Draft:
    """Return a maze on a grid of passages with a few more openings than it needs."""
    cell = generator.uniform(1.05, 1.5)
    columns, rows = int(generator.integers(4, 7)), int(generator.integers(4, 6))
    # Thin walls are lines without thickness.
    thickness = generator.uniform(0.03, 0.12) if generator.random() < 0.7 else 0.0
    size = (round(columns * cell, 1), round(rows * cell, 1))
    passage = min(size[0] / columns, size[1] / rows)
    # Lines between the cells along x and y; the first and the last are the outer walls.
    lines = [np.linspace(0.0, size[i], n + 1) for i, n in enumerate((columns, rows))]
    for line in lines:
        line[[0, -1]] += -OUTSIDE, OUTSIDE
    walls, polygons = list(outer_walls(size, ["painted_wall"])), []
    half = 0.5 * thickness
    for along, at, first, last in _runs(_closed_sides(generator, columns, rows)):
        begin, end, across = lines[along][first], lines[along][last], lines[1 - along][at]
        ends = (across, begin, across, end) if along == 1 else (begin, across, end, across)
        if thickness == 0.0:
            walls.append(Wall(np.array([ends[:2], ends[2:]]), "painted_wall"))
        else:
            x0, y0, x1, y1 = ends
            box = (x0 - half, y0 - half, x1 + half, y1 + half)
            polygons.append(rectangle(*box, "painted_wall"))
    return Draft(size, tuple(walls), tuple(polygons), door=passage - thickness)


#: A side between two cells of a maze: along which axis it runs, its line, its place in it.
_Side = tuple[int, int, int]


def _closed_sides(generator: np.random.Generator, columns: int, rows: int) -> set[_Side]:
    """Return the sides of a maze's cells that are walls; every cell can be reached."""
    closed = {(1, c, r) for c in range(1, columns) for r in range(rows)}
    closed |= {(0, r, c) for r in range(1, rows) for c in range(columns)}
    seen, stack = {(0, 0)}, [(0, 0)]
    while stack:
        column, row = stack[-1]
        options: list[tuple[tuple[int, int], _Side]] = [
            ((column + 1, row), (1, column + 1, row)),
            ((column - 1, row), (1, column, row)),
            ((column, row + 1), (0, row + 1, column)),
            ((column, row - 1), (0, row, column)),
        ]
        options = [o for o in options if o[1] in closed and o[0] not in seen]
        if not options:
            stack.pop()
            continue
        cell, side = options[int(generator.integers(len(options)))]
        closed.remove(side)
        seen.add(cell)
        stack.append(cell)
    return {side for side in sorted(closed) if generator.random() >= 0.12}


def _runs(closed: set[_Side]) -> list[tuple[int, int, int, int]]:
    """Return walls (axis, line, first, past the last) that join sides in one line."""
    runs: list[tuple[int, int, int, int]] = []
    for along, line, place in sorted(closed):
        if runs and runs[-1][:2] == (along, line) and runs[-1][3] == place:
            runs[-1] = (along, line, runs[-1][2], place + 1)
        else:
            runs.append((along, line, place, place + 1))
    return runs
