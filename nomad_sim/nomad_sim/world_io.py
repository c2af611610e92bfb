# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worlds from YAML files, checked to the last key.

Lengths are metres, times seconds, angles degrees (their keys end in ``_deg``).
`worlds/README.md` describes every key.
"""

from __future__ import annotations

import math
import os
import reprlib
from collections.abc import Callable, Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import numpy as np
import yaml
from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.types import Pose2
from numpy.typing import NDArray

from nomad_sim.params import simulator_parameters
from nomad_sim.world import MATERIALS, Circle, Material, MovingObstacle, Polygon, Wall, World

__all__ = ["WorldError", "load_world", "parse_world", "world_names", "worlds_folder"]

T = TypeVar("T")
FloatArray = NDArray[np.float64]

#: Largest world file [bytes], most corners of all shapes, most entries of a list, farthest
#: coordinate [m]: they bound what a file can make the simulator do.
MAX_BYTES = 256_000
MAX_CORNERS = 4_000
MAX_ENTRIES = 4_000
MAX_COORDINATE = 1_000.0

# Shortest side of a shape [m].
_SHORTEST = 1e-3


class WorldError(ValueError):
    """A world file says something that cannot be understood or cannot be."""


class _Loader(yaml.SafeLoader):
    """YAML without what a world does not need: aliases, merged and repeated keys."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()
            raise WorldError(f"aliases (*{event.anchor}) are not allowed; write the value out")
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        keys: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                raise WorldError(f"line {key_node.start_mark.line + 1}: a key must be a text")
            if key in keys:
                raise WorldError(f"line {key_node.start_mark.line + 1}: key '{key}' is repeated")
            keys.add(key)
        return super().construct_mapping(node, deep)


class _Node:
    """A piece of the file and where it stands, for messages that say where to look."""

    def __init__(self, value: Any, where: str) -> None:
        self.value = value
        self.where = where

    def fail(self, problem: str) -> NoReturn:
        raise WorldError(f"{self.where or 'the world'}: {problem}")

    def refuse(self, wanted: str) -> NoReturn:
        try:
            got = reprlib.repr(self.value)  # its beginning: the whole value may be huge
        except ValueError:
            got = "a number too long to print"
        self.fail(f"{wanted} expected, got {got}")

    def mapping(self, required: Sequence[str], optional: Sequence[str] = ()) -> dict[str, _Node]:
        if not isinstance(self.value, Mapping):
            self.refuse(f"a mapping with the keys {', '.join([*required, *optional])}")
        known = [*required, *optional]
        for key in self.value:
            if key not in known:
                self.fail(f"unknown key '{key[:100]}'{suggest(key[:100], known)}")
        missing = [key for key in required if key not in self.value]
        if missing:
            self.fail(f"key '{missing[0]}' is missing")
        return {key: _Node(v, f"{self.where}.{key}".lstrip(".")) for key, v in self.value.items()}

    def items(self) -> list[_Node]:
        if not isinstance(self.value, list):
            self.refuse("a list")
        if len(self.value) > MAX_ENTRIES:
            self.fail(f"{len(self.value)} entries are more than the {MAX_ENTRIES} allowed")
        return [_Node(v, f"{self.where}[{i}]") for i, v in enumerate(self.value)]

    def number(self, low: float = -MAX_COORDINATE, high: float = MAX_COORDINATE) -> float:
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)):
            self.refuse("a number")
        # Comparing first: an int of any length is no float yet. NaN fails it too.
        if not low <= self.value <= high:
            self.refuse(f"a number from {low:g} to {high:g}")
        return float(self.value)

    def length(self) -> float:
        return self.number(_SHORTEST, MAX_COORDINATE)

    def numbers(self, count: int) -> list[float]:
        if not isinstance(self.value, list) or len(self.value) != count:
            self.refuse(f"a list of {count} numbers")
        return [node.number() for node in self.items()]

    def pair(self) -> tuple[float, float]:
        x, y = self.numbers(2)
        return x, y

    def text(self, longest: int = 10_000) -> str:
        if not isinstance(self.value, str) or not self.value or len(self.value) > longest:
            self.refuse(f"a text of at most {longest} characters")
        return self.value

    def truth(self) -> bool:
        if not isinstance(self.value, bool):
            self.refuse("true or false")
        return self.value

    def choice(self, choices: Sequence[str]) -> str:
        if self.value not in list(choices):
            hint = suggest(self.value, choices) if isinstance(self.value, str) else ""
            self.refuse(f"one of {', '.join(choices)}{hint},")
        chosen: str = self.value
        return chosen

    def points(self, least: int) -> FloatArray:
        nodes = self.items()
        if len(nodes) < least:
            self.refuse(f"at least {least} points [x, y]")
        return np.array([node.pair() for node in nodes])


def _check_sides(node: _Node, segments: FloatArray) -> None:
    length = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])
    short = np.flatnonzero(length < _SHORTEST)
    if len(short):
        node.fail(f"the side from point {short[0]} is shorter than {_SHORTEST:g} m")


def _check_simple(node: _Node, points: FloatArray) -> None:
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


def _material(fields: dict[str, _Node], materials: Mapping[str, Material]) -> str:
    return fields["material"].choice(sorted(materials))


def _materials(node: _Node) -> dict[str, Material]:
    materials = dict(MATERIALS)
    if not isinstance(node.value, Mapping):
        node.refuse("a mapping of names to materials")
    if len(node.value) > MAX_ENTRIES:
        node.fail(f"{len(node.value)} materials are more than the {MAX_ENTRIES} allowed")
    for name, value in node.value.items():
        entry = _Node(value, f"{node.where}.{name[:100]}")
        fields = entry.mapping(["critical_angle_deg"], ["infrared"])
        materials[name] = Material(
            math.radians(fields["critical_angle_deg"].number(0.1, 90.0)),
            fields["infrared"].truth() if "infrared" in fields else True,
        )
    return materials


def _wall(node: _Node, materials: Mapping[str, Material]) -> Wall:
    fields = node.mapping(["points", "material"], ["closed"])
    closed = fields["closed"].truth() if "closed" in fields else False
    wall = Wall(fields["points"].points(3 if closed else 2), _material(fields, materials), closed)
    _check_sides(node, wall.segments)
    return wall


def _polygon(node: _Node, materials: Mapping[str, Material]) -> Polygon:
    fields = node.mapping(["points", "material"])
    polygon = Polygon(fields["points"].points(3), _material(fields, materials))
    _check_sides(node, polygon.segments)
    _check_simple(node, polygon.points)
    return polygon


def _circle(node: _Node, materials: Mapping[str, Material]) -> Circle:
    fields = node.mapping(["center", "radius", "material"])
    x, y = fields["center"].pair()
    return Circle(x, y, fields["radius"].length(), _material(fields, materials))


def _interval(node: _Node) -> tuple[float, float]:
    entries = node.items()
    if len(entries) != 2:
        node.refuse("[from, until]")
    first, last = (entry.number(0.0, 1e9) for entry in entries)
    if last <= first:
        node.fail(f"until ({last:g}) must be after from ({first:g})")
    return first, last


def _moving(node: _Node, materials: Mapping[str, Material]) -> MovingObstacle:
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


def _parameters(node: _Node) -> Mapping[str, Any]:
    if not isinstance(node.value, Mapping):
        node.refuse("a mapping of simulator parameters")
    try:
        simulator_parameters(world_overrides=node.value)
    except ValueError as error:
        node.fail(str(error))
    values: Mapping[str, Any] = node.value
    return values


def _place(
    node: _Node, origin: tuple[float, float], size: tuple[float, float]
) -> tuple[float, float]:
    x, y = node.pair()
    if not (origin[0] <= x < origin[0] + size[0] and origin[1] <= y < origin[1] + size[1]):
        node.fail(
            f"({x:g}, {y:g}) m lies outside the area of {size[0]:g} x {size[1]:g} m "
            f"from ({origin[0]:g}, {origin[1]:g}) m on"
        )
    return x, y


def _world(document: Any) -> World:
    fields = _Node(document, "").mapping(
        ["name", "area", "walls", "start", "goal", "expected"],
        ["description", "materials", "polygons", "circles", "moving", "parameters"],
    )
    area = fields["area"].mapping(["origin", "size"])
    origin = area["origin"].pair()
    size = area["size"].pair()
    if min(size) < _SHORTEST:
        area["size"].refuse(f"[width, height] of at least {_SHORTEST:g} m")
    start = fields["start"].mapping(["position"], ["heading_deg"])
    heading = start["heading_deg"].number(-360.0, 360.0) if "heading_deg" in start else 0.0
    materials = _materials(fields["materials"]) if "materials" in fields else dict(MATERIALS)

    def shapes(key: str, parse: Callable[[_Node, Mapping[str, Material]], T]) -> tuple[T, ...]:
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
    return world


def parse_world(text: str) -> World:
    """Return the world that a YAML text describes.

    Raises
    ------
    WorldError
        Naming the place in the text, what is wrong there and what is expected.
    """
    if len(text) > MAX_BYTES:
        raise WorldError(f"{len(text)} characters are more than the {MAX_BYTES} allowed")
    try:
        document = yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError) as error:
        problem = "it is nested too deeply" if isinstance(error, RecursionError) else error
        raise WorldError(f"not a YAML document that can be read: {problem}") from error
    except WorldError:
        raise
    except ValueError as error:  # a number or date that Python refuses
        raise WorldError(f"a value that cannot be read: {error}") from error
    try:
        world = _world(document)
        world.surfaces()  # refuses what crosses too often
    except RecursionError as error:
        raise WorldError("the parameters are nested too deeply") from error
    except WorldError:
        raise
    except ValueError as error:
        raise WorldError(str(error)) from error
    return world


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
    except (OSError, UnicodeDecodeError) as error:
        raise WorldError(f"cannot read world '{path}': {error}") from error
    except WorldError as error:
        raise WorldError(f"{path}: {error}") from error
