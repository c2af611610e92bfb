# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is drawn for every world whatever its layout: surfaces, sensors, truth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from nomad_sim.ground_truth import way_clearance
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.world import MATERIALS, Material, World

__all__ = ["GOAL_TOLERANCE", "MATERIAL_CLASSES", "Finish", "draw_finish", "with_truth"]

#: Distance from the goal [m] at which it counts as reached: the mission's default.
GOAL_TOLERANCE = 0.3
#: Critical angles [deg] of walls and of all other things, from and to, by class.
MATERIAL_CLASSES: Mapping[str, tuple[tuple[float, float], tuple[float, float]]] = {
    "smooth": ((8.0, 15.0), (10.0, 20.0)),
    "plain": ((20.0, 30.0), (35.0, 45.0)),
    "rough": ((55.0, 70.0), (55.0, 70.0)),
}
#: Half angles of the sonars' beam [deg].
_BEAMS = (9.0, 10.0, 11.0, 12.5)


@dataclass(frozen=True)
class Finish:
    """How the surfaces of a world answer, and what the sensors make of it.

    Parameters
    ----------
    materials : mapping of str to Material
        By name.
    parameters : mapping
        Parameters of the simulator.
    properties : mapping
        What was drawn: ``material`` (class), ``beam`` [deg], ``sees_glass``.
    """

    materials: Mapping[str, Material]
    parameters: Mapping[str, Any]
    properties: Mapping[str, Any]


def draw_finish(generator: np.random.Generator) -> Finish:
    """Draw materials from smooth to rough, the sonars' beam, and whether infrared sees glass."""
    name = str(generator.choice(list(MATERIAL_CLASSES)))
    of_walls, of_things = MATERIAL_CLASSES[name]
    wall, things = math.radians(generator.uniform(*of_walls)), generator.uniform(*of_things)
    materials = dict(MATERIALS)
    materials["painted_wall"] = Material(wall)
    materials |= {thing: Material(math.radians(things)) for thing in ("wood", "cardboard")}
    beam, sees_glass = float(generator.choice(_BEAMS)), bool(generator.random() < 0.5)
    return Finish(
        materials,
        {
            "sonar": {"beam_half_angle": math.radians(beam)},
            "infrared": {"sees_glass": sees_glass},
        },
        {"material": name, "beam": beam, "sees_glass": sees_glass},
    )


def with_truth(world: World) -> World:
    """Return the world with its true outcome, and how sure it is among its properties."""
    clearance = way_clearance(world, ROBOT_RADIUS, GOAL_TOLERANCE)
    truth = clearance.reachability
    return replace(
        world,
        expected=truth.expected,
        properties={
            **world.properties,
            "truth": truth.value,
            "way_clearance": clearance.low,
        },
    )
