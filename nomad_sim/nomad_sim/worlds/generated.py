# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worlds drawn by kind and seed, with start, goal and the truth about them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.types import Pose2
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.world import Polygon, World
from nomad_sim.worlds.draws import Finish, draw_finish, with_truth
from nomad_sim.worlds.open_space import clutter, hall, slalom
from nomad_sim.worlds.people import people
from nomad_sim.worlds.rooms import corridor, maze, office
from nomad_sim.worlds.shapes import Draft, rectangle

__all__ = ["KINDS", "RECIPE", "generate"]

#: Raised whenever the same kind and seed give another world than before.
RECIPE = 2

_LAYOUTS: Mapping[str, Callable[[np.random.Generator], Draft]] = {
    "office": office,
    "corridor": corridor,
    "clutter": clutter,
    "slalom": slalom,
    "maze": maze,
    "hall": hall,
}
#: Kinds of worlds; in ``people`` somebody stands in one of the others.
KINDS = (*_LAYOUTS, "people")

# Least clearance of the body at start and goal [m], and spacing of the points drawn from [m].
_ROOM = 0.1
_SPACING = 0.1
# Least distance of start and goal: at least the first [m], and this share of the diagonal.
_FAR = (3.0, 0.4)
# Share of the goals that are walled in: half of them on all sides, a quarter behind a slit [m]
# that is too narrow for the body, a quarter behind one that makes the goal marginal.
_WALLED_IN = 0.15
_TOO_NARROW = (0.25, 0.4)
_JUST_WIDE_ENOUGH = (0.48, 0.55)
# Boxes narrower than this are left out [m].
_SLIVER = 1e-3
_TRIES = 100


def generate(kind: str, seed: int) -> World:
    """Return the world of a kind and a seed, always the same.

    Its ``properties`` say what was drawn: ``kind``; ``material``, a class of
    `draws.MATERIAL_CLASSES`; ``beam``, the sonars' half angle [deg]; ``door``, the width of the
    narrowest door or opening [m] or None; ``glass``: ``none``, ``seen`` or ``unseen`` by the
    infrared sensors; ``walled_in``, whether the goal was shut off, if but for a slit;
    ``people``; and what is true: ``truth``, a value of `ground_truth.Reachability` for the body
    and the goal's tolerance of 0.3 m, and ``way_clearance``, the room on the best way [m] (a
    proven lower bound).

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    seed : int
        From 0 on.

    Raises
    ------
    ValueError
        For an unknown kind, or a seed that is no whole number from 0 on.

    Examples
    --------
    >>> world = generate("office", 4)
    >>> world.properties["kind"], world.properties["truth"]
    ('office', 'reachable')
    """
    if kind not in KINDS:
        raise ValueError(f"unknown kind of world '{kind}'{suggest(str(kind), KINDS)}")
    if not isinstance(seed, (int, np.integer)) or seed < 0:
        raise ValueError(f"the seed of a world must be a whole number from 0 on, got {seed!r}")
    generator = np.random.default_rng([seed, KINDS.index(kind), RECIPE])
    finish = draw_finish(generator)
    for _ in range(_TRIES):
        world = _drawn(generator, kind, f"{kind}_{seed}", finish)
        if world is not None:
            return with_truth(world)
    raise AssertionError(f"no room for start and goal in {_TRIES} worlds of kind '{kind}'")


def _drawn(generator: np.random.Generator, kind: str, name: str, finish: Finish) -> World | None:
    """Return a world whose truth is not known yet, or None if start or goal find no room."""
    layout = str(generator.choice(list(_LAYOUTS))) if kind == "people" else kind
    draft = _LAYOUTS[layout](generator)
    glass = "none"
    if draft.has_glass:
        glass = "seen" if finish.properties["sees_glass"] else "unseen"
    walled_in = bool(generator.random() < _WALLED_IN)
    world = World(
        name=name,
        origin=(0.0, 0.0),
        size=draft.size,
        start=Pose2(0.0, 0.0),
        goal=(0.0, 0.0),
        expected="reached",
        walls=draft.walls,
        polygons=draft.polygons,
        circles=draft.circles,
        materials=finish.materials,
        parameters=finish.parameters,
        description=f"drawn: {layout}" + (" with people" if kind == "people" else ""),
        properties={
            "kind": kind,
            **finish.properties,
            "door": draft.door,
            "glass": glass,
            "walled_in": walled_in,
        },
    )
    ends = _ends(generator, world)
    if ends is None:
        return None
    start, goal = ends
    world = replace(world, start=start, goal=goal)
    if walled_in:
        world = replace(world, polygons=(*world.polygons, *_chamber(generator, goal)))
    if kind == "people":
        count = int(generator.integers(1, 4))
        moving = people(generator, world.still, world.size, start, count)
        world = replace(world, moving=moving)
    return replace(world, properties={**world.properties, "people": len(world.moving)})


def _ends(
    generator: np.random.Generator, world: World
) -> tuple[Pose2, tuple[float, float]] | None:
    """Draw start and goal where the body has room, far from each other."""
    columns, rows = (np.arange(0.5 * _SPACING, length, _SPACING) for length in world.size)
    roomy = world.still.distances(columns, rows) >= ROBOT_RADIUS + _ROOM
    points = np.array([(columns[c], rows[r]) for r, c in np.argwhere(roomy)]).reshape(-1, 2)
    if not len(points):
        return None
    x, y = points[generator.integers(len(points))]
    heading = float(generator.uniform(-math.pi, math.pi))
    least = max(_FAR[0], _FAR[1] * math.hypot(*world.size))
    goals = points[np.hypot(points[:, 0] - x, points[:, 1] - y) >= least]
    if not len(goals):
        return None
    goal = goals[generator.integers(len(goals))]
    return Pose2(float(x), float(y), heading), (float(goal[0]), float(goal[1]))


def _chamber(generator: np.random.Generator, goal: tuple[float, float]) -> tuple[Polygon, ...]:
    """Return four walls about the goal: closed, or with a slit that is too narrow, or just not."""
    half, thick = generator.uniform(0.6, 0.9), generator.uniform(0.08, 0.15)
    slit = (0.0, 0.0, generator.uniform(*_TOO_NARROW), generator.uniform(*_JUST_WIDE_ENOUGH))[
        int(generator.integers(4))
    ]
    middle = generator.uniform(-half + 0.5 * slit, half - 0.5 * slit)
    (x, y), out = goal, half + thick
    low, high = middle - 0.5 * slit, middle + 0.5 * slit
    boxes = [
        (x - out, y - out, x - half, y + out),
        (x + half, y - out, x + out, y + out),
        (x - half, y - out, x + half, y - half),
        (x - half, y + half, x + low, y + out),
        (x + high, y + half, x + half, y + out),
    ]
    return tuple(rectangle(*box, "cardboard") for box in boxes if box[2] - box[0] > _SLIVER)
