# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A world: what stands in it, what moves when, and where a mission begins and ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.types import Pose2
from nomad_sim.surfaces import Outline, Surfaces

__all__ = ["MATERIALS", "Circle", "Material", "MovingObstacle", "Polygon", "Wall", "World"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Material:
    """How a surface answers sound and infrared light.

    Parameters
    ----------
    critical_angle : float
        Angle of incidence from which on sound is reflected like light and does not
        come back straight (paper, section III-A) [rad].
    infrared : bool
        Whether the infrared sensors see it.

    Raises
    ------
    ValueError
        If the angle is not within (0, pi/2].
    """

    critical_angle: float
    infrared: bool = True

    def __post_init__(self) -> None:
        if not 0.0 < self.critical_angle <= 0.5 * math.pi:
            raise ValueError(
                f"the critical angle of a material must be above 0 and at most 90 deg, "
                f"got {math.degrees(self.critical_angle):g} deg"
            )


#: Materials that every world knows (paper, section III-A: 7-8 deg for smooth glass, almost
#: 90 deg for very rough materials; the others assumed).
MATERIALS: Mapping[str, Material] = {
    "glass": Material(math.radians(8.0), infrared=False),
    "painted_wall": Material(math.radians(25.0)),
    "cardboard": Material(math.radians(40.0)),
    "wood": Material(math.radians(40.0)),
    "rough": Material(math.radians(65.0)),
    "clothes": Material(math.radians(70.0)),
}


@dataclass(frozen=True, eq=False)
class Wall:
    """A line of thin wall segments; the last point joins the first where it is closed.

    Parameters
    ----------
    points : ndarray of float64, shape (N, 2)
        Its corners [m].
    material : str
        Name of its material.
    closed : bool
        Whether the line is closed.
    """

    points: FloatArray
    material: str
    closed: bool = False

    @property
    def segments(self) -> FloatArray:
        """End points x0, y0, x1, y1 [m] of its segments, shape (S, 4)."""
        ends = np.roll(self.points, -1, axis=0)
        segments = np.hstack([self.points, ends])
        return segments if self.closed else segments[:-1]


@dataclass(frozen=True, eq=False)
class Polygon:
    """A solid obstacle.

    Parameters
    ----------
    points : ndarray of float64, shape (N, 2)
        Its corners in either sense [m].
    material : str
        Name of its material.
    """

    points: FloatArray
    material: str

    @property
    def segments(self) -> FloatArray:
        """End points x0, y0, x1, y1 [m] of its sides, shape (N, 4)."""
        return np.hstack([self.points, np.roll(self.points, -1, axis=0)])


@dataclass(frozen=True)
class Circle:
    """A solid cylinder.

    Parameters
    ----------
    x, y, radius : float
        Centre and radius [m].
    material : str
        Name of its material.
    """

    x: float
    y: float
    radius: float
    material: str


@dataclass(frozen=True, eq=False)
class MovingObstacle:
    """An obstacle that moves, or that is there for a while only.

    Parameters
    ----------
    name : str
        What it is.
    shape : Polygon or Circle
        Its outline, relative to where it stands.
    waypoints : ndarray of float64, shape (K, 3)
        Time [s] and place (x, y) [m]; straight on in between, at rest before and after.
    times : tuple of float
        It is there from the first time on and before the second [s].
    perceptions : tuple of float
        It is there from when the first number of perceptions has been taken and until the
        second has: (0, 16) is seen by the first 16 perceptions (`PerceptionCount`).
    """

    name: str
    shape: Polygon | Circle
    waypoints: FloatArray
    times: tuple[float, float] = (0.0, math.inf)
    perceptions: tuple[float, float] = (0.0, math.inf)

    def place(self, time: float, perceptions: int) -> tuple[float, float] | None:
        """Return where it stands (x, y) [m], None when it is not there.

        Parameters
        ----------
        time : float
            Simulated time [s].
        perceptions : int
            Perceptions taken so far.
        """
        if not self.times[0] <= time < self.times[1]:
            return None
        if not self.perceptions[0] <= perceptions < self.perceptions[1]:
            return None
        last, x, y = self.waypoints[-1].tolist()
        if time >= last:  # as nearly always
            return x, y
        t, x, y = self.waypoints.T
        return float(np.interp(time, t, x)), float(np.interp(time, t, y))

    @property
    def lasting(self) -> bool:
        """Whether it stands at one place for ever."""
        still = bool((self.waypoints[:, 1:] == self.waypoints[0, 1:]).all())
        always = (0.0, math.inf)
        return still and self.times == always and self.perceptions == always


@dataclass(frozen=True, eq=False)
class World:
    """Everything that a mission takes place in.

    Parameters
    ----------
    name : str
        Short name.
    origin, size : tuple of float
        Lower left corner and extent of the area that maps cover [m].
    start : Pose2
        Where the robot starts.
    goal : tuple of float
        Where it has to go (x, y) [m].
    expected : {'reached', 'unreachable'}
        The true outcome of the mission.
    walls, polygons, circles, moving : tuple
        What is there.
    materials : mapping of str to Material
        By name.
    parameters : mapping
        Parameters of the simulator that this world sets.
    description : str
        What it is for and where it comes from.
    properties : mapping of str
        What a drawn world was drawn with, for reports; nothing depends on it.

    Raises
    ------
    ValueError
        For a shape with an unknown material, or surfaces that cross too often.
    """

    name: str
    origin: tuple[float, float]
    size: tuple[float, float]
    start: Pose2
    goal: tuple[float, float]
    expected: str
    walls: tuple[Wall, ...] = ()
    polygons: tuple[Polygon, ...] = ()
    circles: tuple[Circle, ...] = ()
    moving: tuple[MovingObstacle, ...] = ()
    materials: Mapping[str, Material] = field(default_factory=lambda: dict(MATERIALS))
    parameters: Mapping[str, Any] = field(default_factory=dict)
    description: str = ""
    properties: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.expected not in ("reached", "unreachable"):
            raise ValueError(
                f"the expected outcome is 'reached' or 'unreachable', got {self.expected!r}"
            )
        object.__setattr__(self, "_memory", None)

    def geometry(self, resolution: float) -> GridGeometry:
        """Return a grid over the area with cells of `resolution` [m]."""
        return GridGeometry.from_size(*self.size, resolution, self.origin)

    @cached_property
    def still(self) -> Surfaces:
        """What never moves."""
        shapes: list[Wall | Polygon | Circle] = [*self.walls, *self.polygons, *self.circles]
        return Surfaces.of([self._outline(shape) for shape in shapes])

    @cached_property
    def _moving(self) -> tuple[Surfaces, ...]:
        return tuple(Surfaces.of([self._outline(m.shape)]) for m in self.moving)

    def surfaces(self, time: float = 0.0, perceptions: int = 0) -> Surfaces:
        """Return all surfaces at one moment.

        Parameters
        ----------
        time : float
            Simulated time [s].
        perceptions : int
            Perceptions taken so far.
        """
        if not self.moving:
            return self.still
        places = tuple(m.place(time, perceptions) for m in self.moving)
        # What stands still between two calls is not put together anew.
        memory: tuple[Any, Surfaces] | None = self._memory  # type: ignore[attr-defined]
        if memory is None or memory[0] != places:
            moving = zip(self._moving, places, strict=True)
            there = [s.shifted(*place) for s, place in moving if place is not None]
            memory = (places, self.still.joined(there))
            object.__setattr__(self, "_memory", memory)
        return memory[1]

    def check_inside(self, x: float, y: float, what: str) -> None:
        """Raise ValueError, naming the place `what`, if (x, y) [m] is not in the area."""
        x0, y0 = self.origin
        x1, y1 = x0 + self.size[0], y0 + self.size[1]
        if not (x0 <= x < x1 and y0 <= y < y1):  # a NaN is nowhere
            raise ValueError(
                f"{what} ({x:g}, {y:g}) m lies outside the area of world '{self.name}', "
                f"x from {x0:g} to {x1:g} m and y from {y0:g} to {y1:g} m"
            )

    def check_free(self, x: float, y: float, what: str) -> None:
        """Raise ValueError, naming the place `what`, if (x, y) [m] lies in an obstacle.

        Obstacles that move, come or go do not count.
        """
        lasting = replace(self, moving=tuple(m for m in self.moving if m.lasting))
        depth = -lasting.surfaces().distance(x, y)
        if depth > 0.0:
            raise ValueError(
                f"{what} ({x:g}, {y:g}) m lies in an obstacle of world '{self.name}', "
                f"{depth:.2f} m from its surface; choose another"
            )

    def with_critical_angles(self, angles: Mapping[str, float]) -> World:
        """Return the world with other critical angles [rad] of some materials, by name.

        Raises
        ------
        ValueError
            For an unknown material or an angle that no material has.
        """
        materials = dict(self.materials)
        for name, angle in angles.items():
            self._known(name)
            materials[name] = replace(materials[name], critical_angle=angle)
        return replace(self, materials=materials)

    def _known(self, name: str) -> Material:
        if name not in self.materials:
            raise ValueError(
                f"world '{self.name}': unknown material '{name}'{suggest(name, self.materials)}"
            )
        return self.materials[name]

    def _outline(self, shape: Wall | Polygon | Circle) -> Outline:
        material = self._known(shape.material)
        if isinstance(shape, Circle):
            segments = np.empty((0, 4))
            circles = np.array([[shape.x, shape.y, shape.radius]])
        else:
            segments = shape.segments
            circles = np.empty((0, 3))
        return Outline(
            segments=segments,
            circles=circles,
            critical_angle=material.critical_angle,
            opaque=material.infrared,
            solid=isinstance(shape, Polygon),
        )
