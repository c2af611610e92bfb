# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""People who stand in the way for a while, some of whom come walking."""

from __future__ import annotations

import math

import numpy as np

from fuzzy_map_building.types import Pose2
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.surfaces import Surfaces
from nomad_sim.world import Circle, MovingObstacle

__all__ = ["people"]

# Largest speed of the robot, with which nobody who walks can be run into [m/s].
_ROBOT_SPEED = 0.6
_WALK_SPEED = (0.4, 1.2)
_WALK_TIME = 4.0
# Least free space between robot and person where they stand or walk [m].
_APART = 0.4
_RADII = (0.2, 0.3)
# Perceptions until a person leaves.
_PERCEPTIONS = (4, 20)
_TRIES = 200


def people(
    generator: np.random.Generator,
    surfaces: Surfaces,
    size: tuple[float, float],
    start: Pose2,
    count: int,
) -> tuple[MovingObstacle, ...]:
    """Return people at random places, as many as find room.

    They stand there until the robot has perceived so many times, and are gone then. Some come
    walking in a straight line first, at a distance that the robot could not cover meanwhile:
    whoever touches somebody has run into somebody who stands still.

    Parameters
    ----------
    generator : numpy.random.Generator
        What is drawn from.
    surfaces : Surfaces
        What stands there.
    size : tuple of float
        Extent of the area from (0, 0) on [m].
    start : Pose2
        Where the robot starts.
    count : int
        People wanted.
    """
    found: list[MovingObstacle] = []
    for _ in range(_TRIES):
        if len(found) == count:
            break
        radius = float(generator.uniform(*_RADII))
        end = generator.uniform((0.0, 0.0), size)
        time = float(generator.uniform(1.0, _WALK_TIME)) if generator.random() < 0.5 else 0.0
        heading, speed = generator.uniform(-math.pi, math.pi), generator.uniform(*_WALK_SPEED)
        step = speed * np.array([math.cos(heading), math.sin(heading)])
        times = np.linspace(0.0, time, 20)
        way = end + (times - time)[:, None] * step
        until = int(generator.integers(*_PERCEPTIONS))
        reach = ROBOT_RADIUS + radius + _APART + _ROBOT_SPEED * times
        far = np.hypot(way[:, 0] - start.x, way[:, 1] - start.y) >= reach
        if not far.all() or any(surfaces.distance(x, y) < radius for x, y in way):
            continue
        waypoints = np.column_stack([times[[0, -1]], way[[0, -1]]])
        found.append(
            MovingObstacle(
                name=f"person {len(found) + 1}",
                shape=Circle(0.0, 0.0, radius, "clothes"),
                waypoints=waypoints if time > 0.0 else waypoints[:1],
                perceptions=(0, until),
            )
        )
    return tuple(found)
