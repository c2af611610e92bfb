# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""World files: read, they are worlds that a robot can be simulated in, or refused."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import yaml

from fuzz.draw import Draw, spoilt
from fuzz.surface import Surface, check_words, of_function
from nomad_sim.simulator import Simulator
from nomad_sim.world_io import WorldError, parse_world, worlds_folder

__all__ = ["SURFACES"]

#: A world with one of everything.
TREE = {
    "name": "hall",
    "description": "all keys",
    "area": {"origin": [0.0, 0.0], "size": [4.0, 3.0]},
    "start": {"position": [0.6, 0.6], "heading_deg": 90.0},
    "goal": {"position": [3.4, 2.4]},
    "expected": "reached",
    "materials": {"felt": {"critical_angle_deg": 55.0, "infrared": True}},
    "walls": [
        {"points": [[0, 0], [4, 0], [4, 3], [0, 3]], "material": "painted_wall", "closed": True}
    ],
    "polygons": [{"points": [[2, 1], [2.5, 1], [2.2, 1.5]], "material": "felt"}],
    "circles": [{"center": [3.2, 0.8], "radius": 0.2, "material": "glass"}],
    "moving": [
        {
            "name": "person",
            "material": "clothes",
            "radius": 0.25,
            "waypoints": [[0, 1, 2.5], [10, 3, 2.5]],
            "times": [2, 8],
            "perceptions": [0, 16],
        }
    ],
    "parameters": {"sonar": {"beam_half_angle": 0.218}, "noise": False},
}


def _text(data: bytes) -> str:
    """The first byte says whether the others are a text, or how to spoil a good one."""
    if data[:1] < b"\x60":
        return data[1:].decode("utf-8", "replace")
    draw = Draw(data[1:])
    tree = spoilt(draw, TREE)
    try:
        return yaml.safe_dump(tree, default_flow_style=draw.byte() % 2 == 0)
    except ValueError:  # a number too long to print
        return ""


def target(data: bytes) -> None:
    """Read a world, ask it what a simulator asks, and drive a step in it."""
    try:
        world = parse_world(_text(data))
    except WorldError as error:
        check_words(error)
        return
    assert all(map(math.isfinite, (*world.origin, *world.size, *world.goal)))
    world.check_inside(world.start.x, world.start.y, "the start")
    for time, perceptions in ((0.0, 0), (5.0, 3), (1e9, 1_000_000)):
        surfaces = world.surfaces(time, perceptions)
        assert np.isfinite(surfaces.segments).all()
        assert not math.isnan(surfaces.distance(world.start.x, world.start.y))
    if data[-1:] > b"\x10":  # a simulator takes a hundred times as long as a file
        return
    try:
        simulator = Simulator(world)
    except ValueError as error:
        check_words(error)
        return
    simulator.step(0.3, 0.1)
    assert math.isfinite(simulator.pose.x)
    assert math.isfinite(simulator.pose.y)


def _seeds() -> Sequence[bytes]:
    worlds = [b"\0" + file.read_bytes() for file in sorted(worlds_folder().glob("*.yaml"))]
    hostile = (
        b"a: &a [1]\nb: *a\n",
        b"<<: {a: 1}\n",
        b"x: 1" + b":0" * 200,
        b"name: 1_0\n",
        b"name: 2001-01-01\n",
        b"name: 2001-99-99\n",
        b"name: !!python/object/apply:os.system [x]\n",
        b"name: !!binary x\n",
        b"[" * 900,
        b"- " * 900,
        b"\xef\xbb\xbfname: a\n",
        b"%YAML 9.9\n---\n",
    )
    return [
        *worlds,
        *(b"\0" + text for text in hostile),
        b"\xff",
        b"\xff" + bytes(range(256)),
        b"\0" + yaml.safe_dump(TREE).encode(),
    ]


SURFACES = (
    Surface(
        "world",
        of_function(target),
        _seeds,
        (
            *(b"walls", b"points", b"material", b"area", b"size", b"waypoints", b"glass"),
            *(b"- ", b": ", b"[", b"]", b"{", b"}", b"\n  ", b"&a ", b"*a", b"!!", b"|\n", b"? "),
            *(b".nan", b".inf", b"1e400", b"0x", b"-0", b"9" * 60, b"1:1", b"~", b"#", b"radius"),
        ),
        longest=2048,
    ),
)
