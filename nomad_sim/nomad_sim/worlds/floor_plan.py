# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worlds out of real floor plans, as map_server keeps them."""

from __future__ import annotations

import hashlib
import math
import os
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_server import import_map_server
from fuzzy_map_building.types import Pose2
from fuzzy_map_building.wording import counted
from nomad_sim.ground_truth import Reachability
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.ray_casting import nearest_distance
from nomad_sim.world import Wall, World
from nomad_sim.worlds.draws import Finish, draw_finish, with_truth
from nomad_sim.worlds.outlines import enclosed, outlines, simplified

__all__ = [
    "PLAN_KIND",
    "PLAN_RECIPE",
    "SIMPLIFIED",
    "FloorPlan",
    "load_floor_plan",
    "plan_world",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

#: What is told as the kind of these worlds.
PLAN_KIND = "floor_plan"
#: Raised whenever the same plan and seed give another world than before.
PLAN_RECIPE = 1
#: Largest distance between the raster's outline and the walls made of it, in cells: a wall at
#: any angle is a staircase whose corners lie within 0.71 cells of a straight line.
SIMPLIFIED = 0.75
# Distance of start and goal [m], and least clearance of the body there [m].
_DISTANCE = (4.0, 12.0)
_ROOM = 0.1
# How far the mapped area reaches beyond start and goal, and the walls beyond that [m]: no
# sonar hears farther.
_MARGIN = 4.0
_HEARD = 7.0
# Draws of a start, and of goals for each.
_STARTS = 200
_GOALS = 20
# Most pairs of them between which a way is looked for, about 0.1 s each: in plans of buildings
# up to 19 were looked at.
_PAIRS = 200


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """A floor plan as walls.

    Parameters
    ----------
    name : str
        Short name.
    geometry : GridGeometry
        Where its cells lie.
    free : ndarray of bool, shape (H, W)
        The cells that are known to be free.
    walls : tuple of Wall
        Their outlines.
    """

    name: str
    geometry: GridGeometry
    free: BoolArray
    walls: tuple[Wall, ...]

    @cached_property
    def segments(self) -> FloatArray:
        """End points x0, y0, x1, y1 [m] of all walls, shape (S, 4)."""
        return np.concatenate([wall.segments for wall in self.walls])

    @property
    def digest(self) -> str:
        """What tells it from other plans."""
        g = self.geometry
        place = repr((g.width, g.height, g.resolution, g.origin)).encode()
        return hashlib.sha256(place + np.packbits(self.free).tobytes()).hexdigest()


def load_floor_plan(path: str | os.PathLike[str]) -> FloorPlan:
    """Read a map_server YAML file with its image; what is not free in it becomes walls.

    What is unknown counts as occupied: nobody is to leave a plan through a gap of it.

    Parameters
    ----------
    path : str or path
        The YAML file.

    Raises
    ------
    MapFileError
        A ValueError, if a file cannot be read, does not follow the format, or has no free cell.
    """
    file = Path(path)
    try:
        return _loaded(file, file.stat().st_mtime_ns)
    except FileNotFoundError as error:
        raise ValueError(f"cannot read floor plan '{file}': {error.strerror}") from error


@lru_cache(maxsize=4)
def _loaded(path: Path, _changed: int) -> FloorPlan:
    occupancy, geometry = import_map_server(path)
    free: BoolArray = (occupancy >= 0) & (occupancy < 50)
    if not free.any():
        raise ValueError(f"floor plan '{path}' has no free cell")
    walls = []
    least = math.pi * (ROBOT_RADIUS / geometry.resolution) ** 2
    for line in outlines(~free):
        # Clockwise runs the border of a free spot. One too small for the robot cannot be seen
        # from anywhere else.
        if -least < enclosed(line) < 0.0:
            continue
        corners = np.array(geometry.origin) + geometry.resolution * simplified(line, SIMPLIFIED)
        walls.append(Wall(corners, "painted_wall", closed=len(corners) > 2))
    if not walls:
        raise ValueError(f"floor plan '{path}' has no room for the robot")
    return FloorPlan(path.stem, geometry, free, tuple(walls))


def plan_world(plan: FloorPlan, seed: int) -> World:
    """Return a part of a floor plan with a start and a goal 4-12 m apart, drawn by seed.

    The goal can be reached, with `ground_truth.MARGINAL_CLEARANCE` at least all the way, within
    the area, which reaches 4 m beyond both ends but not beyond the plan. The properties are
    those of `worlds.generate`; the kind is `PLAN_KIND`.

    Parameters
    ----------
    plan : FloorPlan
        The plan.
    seed : int
        From 0 on.

    Raises
    ------
    ValueError
        If no such pair is found among those that are looked at.
    """
    generator = np.random.default_rng([seed, 4, PLAN_RECIPE])
    finish = draw_finish(generator)
    rows, columns = np.nonzero(plan.free)
    x, y = plan.geometry.centre_coordinates(rows, columns)
    pairs = 0
    for _ in range(_STARTS):
        i = int(generator.integers(len(x)))
        if not _roomy(plan, x[i], y[i]):
            continue
        far = np.hypot(x - x[i], y - y[i])
        goals = np.flatnonzero((far >= _DISTANCE[0]) & (far <= _DISTANCE[1]))
        for j in generator.choice(goals, min(_GOALS, len(goals))).tolist() if len(goals) else ():
            if pairs < _PAIRS and _roomy(plan, x[j], y[j]):
                pairs += 1
                heading = float(generator.uniform(-math.pi, math.pi))
                start = Pose2(float(x[i]), float(y[i]), heading)
                world = with_truth(
                    _part(plan, f"{plan.name}_{seed}", start, (float(x[j]), float(y[j])), finish)
                )
                if world.properties["truth"] == Reachability.REACHABLE.value:
                    return world
    raise ValueError(
        f"floor plan '{plan.name}': found no start and goal {_DISTANCE[0]:g} to "
        f"{_DISTANCE[1]:g} m apart between which the robot has room, in {counted(pairs, 'pair')} "
        "of free places; is it a floor plan, and its resolution right?"
    )


def _roomy(plan: FloorPlan, x: float, y: float) -> bool:
    none = np.empty((0, 3)), np.empty((0, 2), dtype=np.int64)
    return nearest_distance(float(x), float(y), plan.segments, *none) >= ROBOT_RADIUS + _ROOM


def _part(
    plan: FloorPlan, name: str, start: Pose2, goal: tuple[float, float], finish: Finish
) -> World:
    """Return what lies around start and goal."""
    x0, y0, x1, y1 = plan.geometry.bounds
    cell = plan.geometry.resolution
    # Whole cells of the plan, so that the area ends where one of its cells does.
    low = [
        edge + cell * math.floor((max(edge, min(ends) - _MARGIN) - edge) / cell)
        for edge, ends in ((x0, (start.x, goal[0])), (y0, (start.y, goal[1])))
    ]
    high = [
        min(edge, max(ends) + _MARGIN)
        for edge, ends in ((x1, (start.x, goal[0])), (y1, (start.y, goal[1])))
    ]
    return World(
        name=name,
        origin=(low[0], low[1]),
        size=(high[0] - low[0], high[1] - low[1]),
        start=start,
        goal=goal,
        expected="reached",
        walls=_near(plan.walls, (*low, *high)),
        materials=finish.materials,
        parameters=finish.parameters,
        description=f"drawn out of the floor plan {plan.name}",
        properties={
            "kind": PLAN_KIND,
            **finish.properties,
            "door": None,
            "glass": "none",
            "people": 0,
        },
    )


def _near(walls: tuple[Wall, ...], area: tuple[float, ...]) -> tuple[Wall, ...]:
    """Return the parts of walls that can be heard from an area."""
    near: list[Wall] = []
    for wall in walls:
        s = wall.segments
        x, y = np.sort(s[:, 0::2]), np.sort(s[:, 1::2])
        heard = (x[:, 1] >= area[0] - _HEARD) & (x[:, 0] <= area[2] + _HEARD)
        heard &= (y[:, 1] >= area[1] - _HEARD) & (y[:, 0] <= area[3] + _HEARD)
        if heard.all():
            near.append(wall)
            continue
        starts = np.flatnonzero(heard & ~np.concatenate([[False], heard[:-1]]))
        stops = np.flatnonzero(heard & ~np.concatenate([heard[1:], [False]]))
        for first, last in zip(starts, stops, strict=True):
            points = np.vstack([s[first : last + 1, :2], s[last : last + 1, 2:]])
            near.append(Wall(points, wall.material))
    return tuple(near)
