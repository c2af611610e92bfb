# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worlds from YAML files, checked to the last key.

Lengths are metres, times seconds, angles degrees (their keys end in ``_deg``). All keys::

    name: hall
    description: what it is for             # optional, like all keys marked so
    area: {origin: [0.0, 0.0], size: [6.0, 4.0]}
    start: {position: [1.0, 1.0], heading_deg: 90.0}    # heading: optional
    goal: {position: [5.0, 3.0]}
    expected: reached                       # or unreachable: the true verdict
    materials:                              # optional: more than `world.MATERIALS`, or others
      felt: {critical_angle_deg: 55.0, infrared: true}  # infrared: optional
    walls:                                  # thin lines of wall
      - {points: [[0, 0], [6, 0], [6, 4], [0, 4]], material: painted_wall, closed: true}
    polygons:                               # optional: solid obstacles
      - {points: [[3, 1], [4, 1], [3.5, 2]], material: wood}
    circles:                                # optional: solid cylinders
      - {center: [4.5, 3.5], radius: 0.2, material: glass}
    moving:                                 # optional
      - name: person
        material: clothes
        radius: 0.25                        # or points: a polygon about its waypoints
        waypoints: [[0, 1, 3], [10, 5, 3]]  # time, x, y; one: it stands there
        times: [2, 8]                       # optional: it is there from ... until
        perceptions: [0, 16]                # optional: the same in perceptions taken
    parameters:                             # optional: parameters of the simulator
      sonar: {beam_half_angle: 0.218}
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.types import Pose2
from nomad_sim.params import simulator_parameters
from nomad_sim.places import check_places
from nomad_sim.world import MATERIALS, Circle, Material, MovingObstacle, Polygon, Wall, World
from nomad_sim.yaml_document import (
    MAX_BYTES,
    MAX_ENTRIES,
    SHORTEST,
    Node,
    WorldError,
    read_document,
)

__all__ = [
    "MAX_CORNERS",
    "WorldError",
    "load_world",
    "parse_world",
    "world_names",
    "worlds_folder",
]

T = TypeVar("T")
FloatArray = NDArray[np.float64]

#: Most corners of all shapes together.
MAX_CORNERS = 4_000


def _check_sides(node: Node, segments: FloatArray) -> None:
    length = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])
    short = np.flatnonzero(length < SHORTEST)
    if len(short):
        node.fail(f"the side from point {short[0]} is shorter than {SHORTEST:g} m")


def _check_simple(node: Node, points: FloatArray) -> None:
    """Refuse a polygon whose sides cross, touch or fold back on each other."""
    start, end = points, np.roll(points, -1, axis=0)
    along = end - start
    count = len(points)

    def side(i: int, p: FloatArray) -> FloatArray:
        """On which side of the line through side i the points p lie: the sign."""
        offset = p - start[i]
        signs: FloatArray = np.sign(along[i, 0] * offset[:, 1] - along[i, 1] * offset[:, 0])
        return signs

    for i in range(count):
        after = (i + 1) % count
        turn = along[i, 0] * along[after, 1] - along[i, 1] * along[after, 0]
        if turn == 0.0 and along[i] @ along[after] < 0.0:
            node.fail(f"the polygon folds back on itself at point {after}")
        others = np.array([j for j in range(i + 2, count) if (j + 1) % count != i], dtype=int)
        if not len(others):
            continue
        offset_start, offset_end = start[i] - start[others], end[i] - start[others]
        e = along[others]
        own = np.sign(e[:, 0] * offset_start[:, 1] - e[:, 1] * offset_start[:, 0]) * np.sign(
            e[:, 0] * offset_end[:, 1] - e[:, 1] * offset_end[:, 0]
        )
        apart = (
            (np.maximum(start[i], end[i]) < np.minimum(start[others], end[others]))
            | (np.minimum(start[i], end[i]) > np.maximum(start[others], end[others]))
        ).any(axis=1)
        met = (side(i, start[others]) * side(i, end[others]) <= 0) & (own <= 0) & ~apart
        if met.any():
            other = int(others[np.flatnonzero(met)[0]])
            node.fail(
                f"the polygon crosses or touches itself: its sides from points {i} and {other}"
            )


def _material(fields: dict[str, Node], materials: Mapping[str, Material]) -> str:
    return fields["material"].choice(sorted(materials))


def _materials(node: Node) -> dict[str, Material]:
    materials = dict(MATERIALS)
    if not isinstance(node.value, Mapping):
        node.refuse("a mapping of names to materials")
    if len(node.value) > MAX_ENTRIES:
        node.fail(f"{len(node.value)} materials are more than the {MAX_ENTRIES} allowed")
    for name, value in node.value.items():
        entry = Node(value, f"{node.where}.{name[:100]}")
        fields = entry.mapping(["critical_angle_deg"], ["infrared"])
        materials[name] = Material(
            math.radians(fields["critical_angle_deg"].number(0.1, 90.0)),
            fields["infrared"].truth() if "infrared" in fields else True,
        )
    return materials


def _wall(node: Node, materials: Mapping[str, Material]) -> Wall:
    fields = node.mapping(["points", "material"], ["closed"])
    closed = fields["closed"].truth() if "closed" in fields else False
    wall = Wall(fields["points"].points(3 if closed else 2), _material(fields, materials), closed)
    _check_sides(node, wall.segments)
    return wall


def _polygon(node: Node, materials: Mapping[str, Material]) -> Polygon:
    fields = node.mapping(["points", "material"])
    polygon = Polygon(fields["points"].points(3), _material(fields, materials))
    _check_sides(node, polygon.segments)
    _check_simple(node, polygon.points)
    return polygon


def _circle(node: Node, materials: Mapping[str, Material]) -> Circle:
    fields = node.mapping(["center", "radius", "material"])
    x, y = fields["center"].pair()
    return Circle(x, y, fields["radius"].length(), _material(fields, materials))


def _interval(node: Node) -> tuple[float, float]:
    entries = node.items()
    if len(entries) != 2:
        node.refuse("[from, until]")
    first, last = (entry.number(0.0, 1e9) for entry in entries)
    if last <= first:
        node.fail(f"until ({last:g}) must be after from ({first:g})")
    return first, last


def _moving(node: Node, materials: Mapping[str, Material]) -> MovingObstacle:
    fields = node.mapping(
        ["name", "material", "waypoints"], ["radius", "points", "times", "perceptions"]
    )
    if ("radius" in fields) == ("points" in fields):
        node.fail("give its shape by either 'radius' or 'points', relative to its waypoints")
    material = _material(fields, materials)
    shape: Circle | Polygon
    if "radius" in fields:
        shape = Circle(0.0, 0.0, fields["radius"].length(), material)
    else:
        shape = Polygon(fields["points"].points(3), material)
        _check_sides(node, shape.segments)
        _check_simple(node, shape.points)
    waypoints = []
    for entry in fields["waypoints"].items():
        if not isinstance(entry.value, list) or len(entry.value) != 3:
            entry.refuse("[time, x, y]")
        time, x, y = entry.items()
        waypoints.append([time.number(0.0, 1e9), x.number(), y.number()])
        if len(waypoints) > 1 and waypoints[-1][0] <= waypoints[-2][0]:
            entry.fail("the times of waypoints must increase")
    if not waypoints:
        fields["waypoints"].refuse("at least one waypoint [time, x, y]")
    always = (0.0, math.inf)
    return MovingObstacle(
        name=fields["name"].text(100),
        shape=shape,
        waypoints=np.array(waypoints),
        times=_interval(fields["times"]) if "times" in fields else always,
        perceptions=_interval(fields["perceptions"]) if "perceptions" in fields else always,
    )


def _parameters(node: Node) -> Mapping[str, Any]:
    if not isinstance(node.value, Mapping):
        node.refuse("a mapping of simulator parameters")
    try:
        simulator_parameters(world_overrides=node.value)
    except ValueError as error:
        node.fail(str(error))
    values: Mapping[str, Any] = node.value
    return values


def _place(
    node: Node, origin: tuple[float, float], size: tuple[float, float]
) -> tuple[float, float]:
    x, y = node.pair()
    if not (origin[0] <= x < origin[0] + size[0] and origin[1] <= y < origin[1] + size[1]):
        node.fail(
            f"({x:g}, {y:g}) m lies outside the area of {size[0]:g} x {size[1]:g} m "
            f"from ({origin[0]:g}, {origin[1]:g}) m on"
        )
    return x, y


def _world(document: Node) -> World:
    fields = document.mapping(
        ["name", "area", "walls", "start", "goal", "expected"],
        ["description", "materials", "polygons", "circles", "moving", "parameters"],
    )
    area = fields["area"].mapping(["origin", "size"])
    origin = area["origin"].pair()
    size = area["size"].pair()
    if min(size) < SHORTEST:
        area["size"].refuse(f"[width, height] of at least {SHORTEST:g} m")
    start = fields["start"].mapping(["position"], ["heading_deg"])
    heading = start["heading_deg"].number(-360.0, 360.0) if "heading_deg" in start else 0.0
    materials = _materials(fields["materials"]) if "materials" in fields else dict(MATERIALS)

    def shapes(key: str, parse: Callable[[Node, Mapping[str, Material]], T]) -> tuple[T, ...]:
        if key not in fields:
            return ()
        return tuple(parse(node, materials) for node in fields[key].items())

    world = World(
        name=fields["name"].text(100),
        origin=origin,
        size=size,
        start=Pose2(*_place(start["position"], origin, size), math.radians(heading)),
        goal=_place(fields["goal"].mapping(["position"])["position"], origin, size),
        expected=fields["expected"].choice(["reached", "unreachable"]),
        walls=shapes("walls", _wall),
        polygons=shapes("polygons", _polygon),
        circles=shapes("circles", _circle),
        moving=shapes("moving", _moving),
        materials=materials,
        parameters=_parameters(fields["parameters"]) if "parameters" in fields else {},
        description=fields["description"].text() if "description" in fields else "",
    )
    outlines = (*world.walls, *world.polygons, *(m.shape for m in world.moving))
    corners = sum(len(o.points) for o in outlines if not isinstance(o, Circle))
    if corners > MAX_CORNERS:
        raise WorldError(f"the world: {corners} corners are more than the {MAX_CORNERS} allowed")
    # Refuses also what crosses too often.
    check_places(world, simulator_parameters(world_overrides=world.parameters).robot.radius)
    return world


def parse_world(text: str) -> World:
    """Return the world that a YAML text describes.

    Raises
    ------
    WorldError
        Naming the place in the text, what is wrong there and what is expected.
    """
    try:
        return _world(read_document(text))
    except RecursionError as error:
        raise WorldError("the parameters are nested too deeply") from error
    except WorldError:
        raise
    except ValueError as error:
        raise WorldError(str(error)) from error


def worlds_folder() -> Path:
    """Return the folder with the worlds that come with the package.

    Raises
    ------
    FileNotFoundError
        If the package was installed without them.
    """
    here = Path(__file__).resolve()
    # Beside the sources, or under the prefix that the package is installed in.
    places = [here.parents[1] / "worlds"]
    places += [parent / "share" / "nomad_sim" / "worlds" for parent in here.parents]
    for place in places:
        if place.is_dir():
            return place
    raise FileNotFoundError("the worlds of nomad_sim are not installed; build the package again")


def world_names() -> list[str]:
    """Return the names of the worlds that come with the package, sorted."""
    return sorted(path.stem for path in worlds_folder().glob("*.yaml"))


def load_world(name_or_path: str | os.PathLike[str]) -> World:
    """Return a world by name, or from a file.

    Parameters
    ----------
    name_or_path : str or path
        One of `world_names`, or the path of a YAML file (with a folder or ``.yaml`` in it).

    Raises
    ------
    WorldError
        For an unknown name, a file that cannot be read, or one that is not a world.
    """
    text = os.fspath(name_or_path)
    if os.sep in text or text.endswith((".yaml", ".yml")):
        path = Path(text)
    elif text in world_names():
        path = worlds_folder() / f"{text}.yaml"
    else:
        raise WorldError(f"unknown world '{text[:100]}'{suggest(text[:100], world_names())}")
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
        return parse_world(content.decode())
    except OSError as error:
        raise WorldError(f"cannot read world '{path}': {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise WorldError(
            f"cannot read world '{path}': byte {error.start} is no UTF-8; save it as UTF-8"
        ) from error
    except WorldError as error:
        raise WorldError(f"{path}: {error}") from error
