# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The worlds that the method was measured in, each with what it achieved there.

The layouts are those of the laboratory, the office and the slalom that come with the package,
with other materials or narrower openings. Outer walls stand 5 cm outside the mapped area; the
width of an opening beside one is counted to the area's edge, as in the laboratory, whose cabinet
ends 0.9 m from it.

One thing differs. The method was measured with obstacle edges chamfered by 4 cm, each chamfer
a face that echoes up to 80 deg; here obstacles have sharp edges that send an echo back from
the very point, in every direction (``sonar.edge_echo``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any

import numpy as np

from fuzzy_map_building.params import DEFAULT_PRESET, PAPER_PRESET
from fuzzy_map_building.types import Pose2
from nomad_sim.world import World
from nomad_sim.world_io import load_world
from nomad_sim.worlds.shapes import OUTSIDE, outer_walls, pillars, rectangle, scatter

__all__ = [
    "MISSIONS",
    "ROWS",
    "Row",
    "clutter",
    "lab_with_gaps",
    "slalom_with_openings",
    "with_materials",
]

#: Missions behind each number of the method's table.
MISSIONS = 20

#: Clutter: obstacles, limits of their radius, their least distance from each other and the
#: least distance of their faces from start and goal [m].
_PILLARS = 9
_RADII = (0.12, 0.35)
_APART = 0.85
_ENDS_FREE = 0.6


@dataclass(frozen=True)
class Row:
    """One number of the method's table.

    Parameters
    ----------
    name : str
        Short name.
    description : str
        What is special about it.
    world : callable
        Gives the world for a seed.
    reached : mapping
        Missions of `MISSIONS` that the method reached, by preset.
    simulator : mapping
        Parameters of the simulator.
    """

    name: str
    description: str
    world: Callable[[int], World]
    reached: Mapping[str, int]
    simulator: Mapping[str, Any] = field(default_factory=dict)


def with_materials(world: World, box: float, wall: float, glass: float) -> World:
    """Return the world with other critical angles [deg] of boxes, walls and glass."""
    boxes = {"cardboard": box, "wood": box}
    angles = {**boxes, "painted_wall": wall, "glass": glass}
    return world.with_critical_angles({m: math.radians(a) for m, a in angles.items()})


def lab_with_gaps(gap: float) -> World:
    """Return the laboratory with both of its openings `gap` [m] wide.

    The first is centred at y = 2.65 m as it was; the second lies between the end of the
    cabinet and the edge of the area.
    """
    lab = load_world("lab")
    bottom, top = -OUTSIDE, lab.size[1] + OUTSIDE
    right = lab.size[0] - gap
    below, above, _cabinet, *others = lab.polygons
    return replace(
        lab,
        name=f"lab_gaps_{gap:.2f}",
        polygons=(
            rectangle(3.2, bottom, 4.2, 2.65 - 0.5 * gap, below.material),
            rectangle(3.2, 2.65 + 0.5 * gap, 4.2, top, above.material),
            rectangle(4.2, 4.1, right, 4.4, _cabinet.material),
            *others,
        ),
    )


def slalom_with_openings(width: float) -> World:
    """Return the slalom with openings `width` [m] wide at the top, bottom, top and bottom."""
    slalom = load_world("slalom")
    bottom, top = -OUTSIDE, slalom.size[1] + OUTSIDE
    screens = []
    for number, x in enumerate((1.8, 3.3, 4.8, 6.3)):
        low, high = (bottom, slalom.size[1] - width) if number % 2 == 0 else (width, top)
        screens.append(rectangle(x - 0.05, low, x + 0.05, high, "cardboard"))
    return replace(slalom, name=f"slalom_{width:.2f}", polygons=tuple(screens))


def clutter(seed: int) -> World:
    """Return a room of 7 x 6 m with nine pillars and boxes at random places.

    Boxes are squares at any angle whose corners lie on the circle of their radius, so that
    all distances are those of circles.

    Parameters
    ----------
    seed : int
        The same seed gives the same room.
    """
    generator = np.random.default_rng([seed, 2])
    size = (7.0, 6.0)
    start, goal = (0.8, 0.8), (6.2, 5.2)
    placed = scatter(generator, size, _PILLARS, _RADII, _APART, (start, goal), _ENDS_FREE)
    circles, polygons = pillars(generator, placed, "cardboard")
    return World(
        name=f"clutter_{seed}",
        origin=(0.0, 0.0),
        size=size,
        start=Pose2(*start, 0.0),
        goal=goal,
        expected="reached",
        walls=outer_walls(size, ["painted_wall"]),
        polygons=polygons,
        circles=circles,
        description="nine pillars and boxes at random places",
    )


def _lab_of(box: float, wall: float, glass: float) -> World:
    return with_materials(load_world("lab"), box, wall, glass)


def _rough(world: Callable[[], World]) -> World:
    return with_materials(world(), 70.0, 70.0, 70.0)


def _fixed(world: Callable[[], World]) -> Callable[[int], World]:
    """Return the same world for every seed."""
    once = cache(world)
    return lambda _seed: once()


def _row(
    name: str,
    description: str,
    world: Callable[[int], World],
    reached: int,
    beam: float = 10.0,
    beyond: int = MISSIONS,
) -> Row:
    """Return a row with a beam of a half angle [deg].

    The rules of the paper reached the goal so often, those beyond it so often.
    """
    simulator = {
        "sonar.beam_half_angle": math.radians(beam),
        # The infrared sensors are this rule set's only guard against glass.
        "infrared.sees_glass": True,
    }
    by_preset = {PAPER_PRESET: reached, DEFAULT_PRESET: beyond}
    return Row(name, f"{description}, half beam {beam:g} deg", world, by_preset, simulator)


def _rows() -> dict[str, Row]:
    rows: list[Row] = []
    for (box, wall, glass), by_beam in (
        ((40.0, 25.0, 8.0), {10.0: 20, 12.5: 20}),
        ((60.0, 45.0, 30.0), {10.0: 20, 12.5: 19}),
        ((15.0, 10.0, 8.0), {10.0: 20, 12.5: 20}),
        ((70.0, 70.0, 70.0), {9.0: 20, 10.5: 16, 12.5: 4}),
    ):
        for beam, reached in by_beam.items():
            rows.append(
                _row(
                    f"lab_{box:g}_{wall:g}_{glass:g}_beam_{beam:g}",
                    f"lab, boxes {box:g}, walls {wall:g}, glass {glass:g} deg",
                    _fixed(partial(_lab_of, box, wall, glass)),
                    reached,
                    beam,
                )
            )
    for gap, reached in ((0.8, 20), (0.75, 17), (0.7, 5), (0.65, 0), (0.6, 0)):
        rows.append(
            _row(
                f"gaps_{gap:.2f}",
                f"lab, both openings {gap:.2f} m",
                _fixed(partial(lab_with_gaps, gap)),
                reached,
                beyond=0 if gap == 0.6 else MISSIONS,  # with the parameters as they are
            )
        )
    for gap in (0.75, 0.7):
        rows.append(
            _row(
                f"gaps_{gap:.2f}_rough_beam_12.5",
                f"lab, both openings {gap:.2f} m, all 70 deg",
                _fixed(partial(_rough, partial(lab_with_gaps, gap))),
                0,
                12.5,
            )
        )
    rows += [
        _row(
            "experiment_2", "lab, a person at first", _fixed(partial(load_world, "lab_person")), 20
        ),
        _row("office", "office, doors of 0.8 m", _fixed(partial(load_world, "office")), 20),
        _row(
            "office_rough_beam_12.5",
            "office, all 70 deg",
            _fixed(partial(_rough, partial(load_world, "office"))),
            14,
            12.5,
        ),
        _row("slalom_0.90", "slalom, 0.9 m", _fixed(partial(slalom_with_openings, 0.9)), 20),
        _row("slalom_0.70", "slalom, 0.7 m", _fixed(partial(slalom_with_openings, 0.7)), 5),
        _row("clutter", "nine pillars and boxes at random", clutter, 20),
    ]
    return {row.name: row for row in rows}


#: The rows of the method's table by name, in its order.
ROWS: Mapping[str, Row] = _rows()
