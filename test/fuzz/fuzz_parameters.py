# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameter files and parameters of the command line: taken as a whole or refused."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fuzz.draw import Draw, spoilt
from fuzz.surface import Surface, Target, check_words, of_function, scratch_folder
from fuzzy_map_building.parameter_schema import describe, flatten
from fuzzy_map_building.params import PRESETS, mapper_parameters
from fuzzy_map_building.ros.addressed import section_parameters
from fuzzy_navigation.params import motion_parameters, planner_parameters
from nomad_sim.overrides import critical_angles, parameter_overrides
from nomad_sim.ros.params import simulation_parameters

__all__ = ["FACTORIES", "SURFACES", "drawn_overrides"]

#: What makes parameters out of overrides, by the name of the part.
FACTORIES: Mapping[str, Callable[[Mapping[str, Any]], Any]] = {
    "mapper": lambda given: mapper_parameters("consistent", given),
    "planner": lambda given: planner_parameters("consistent", given),
    "motion": lambda given: motion_parameters("consistent", given),
    "simulator": simulation_parameters,
}
DEFAULTS = {name: flatten(make({})) for name, make in FACTORIES.items()}


def drawn_overrides(draw: Draw, part: str) -> dict[str, Any]:
    """Return parameters with good and bad names and values, in any notation."""
    names = list(DEFAULTS[part])
    given: dict[str, Any] = {}
    for _ in range(1 + draw.below(4)):
        name = draw.choice(names) if draw.byte() % 8 else draw.text()
        value = DEFAULTS[part].get(name)
        good = list(value) if isinstance(value, tuple) else value
        if draw.one_in(6) and "." in name:  # as a YAML file nests them
            group, _, name = name.partition(".")
            given[group] = {name: spoilt(draw, good)}
        else:
            given[name] = spoilt(draw, good)
    return given


def schema(data: bytes) -> None:
    """Whatever the mapping, it gives parameters that keep their declared limits."""
    draw = Draw(data)
    part = draw.choice(tuple(FACTORIES))
    given = drawn_overrides(draw, part)
    try:
        parameters = FACTORIES[part](given)
    except ValueError as error:
        check_words(error)
        return
    infos = describe(type(parameters))
    for name, value in flatten(parameters).items():
        info = infos[name]
        for element in value if isinstance(value, tuple) else (value,):
            assert type(element) is info.type
            if info.type is float:
                assert math.isfinite(element)
            if info.minimum is not None:
                assert element >= info.minimum
            if info.maximum is not None:
                assert element <= info.maximum


def command_line(data: bytes) -> None:
    """``--set`` and ``--critical-angle`` are read or refused."""
    for text in data.decode("utf-8", "replace").split("\x1f")[:4]:
        for read in (parameter_overrides, critical_angles):
            try:
                read([text])
            except ValueError as error:
                check_words(error)


@contextlib.contextmanager
def _file_opened() -> Iterator[Target]:
    with scratch_folder() as folder:
        path = folder / "a.yaml"
        tree = {
            "/**/fuzzy_mapper": {"ros__parameters": {"mode": "on_demand", "sonar": {"a": [1]}}},
            "robot": {"fuzzy_motion": {"ros__parameters": {"robot_radius": 0.2}}},
        }

        def target(data: bytes) -> None:
            content = data[1:]
            if data[:1] >= b"\x60":
                content = json.dumps(spoilt(Draw(content), tree)).encode("utf-8", "replace")
            path.write_bytes(content)
            try:
                names = section_parameters(path)
            except ValueError as error:
                check_words(error)
                return
            assert all(name.startswith("/") for name in names)
            assert len(names) <= len(content)

        yield target


def _file_seeds() -> Sequence[bytes]:
    root = Path(__file__).resolve().parents[2]
    files = sorted(root.glob("*/config/*.yaml"))
    return [
        *(b"\0" + file.read_bytes()[:2000] for file in files),
        b"\0a: &a {ros__parameters: {}}\nb: *a\n",
        b"\0a: &a {x: 1}\nb: &b {<<: [*a,*a,*a]}\nc: {<<: [*b,*b,*b]}\n",
        b"\0" + b"{a: " * 300,
        b"\0? {a: b}\n: c\n",
        b"\0? [a]\n: c\n",
        b"\0a: 1" + b":0" * 300,
        b"\xff" + bytes(range(200)),
    ]


_YAML = (b": ", b"\n  ", b"{", b"}", b"[", b"]", b"&a ", b"*a", b"<<: ", b"? ", b"- ", b"!!", b"|")

SURFACES = (
    Surface(
        "parameters",
        of_function(schema),
        lambda: [bytes(range(256)), *(bytes([k]) * 40 for k in range(4))],
        longest=256,
    ),
    Surface(
        "command_line",
        of_function(command_line),
        lambda: [
            b"mapper.evidence.k_empty=0.3\x1fplanner.epsilon=1e-3",
            b"glass=90\x1fpainted_wall=25 deg",
            b"simulator.seed=1\x1fmotion.x=[1, 2 deg]",
            b"mapper.x={<<: [{a: 1}]}\x1fmapper.x=1:0:0:0",
        ],
        (
            *_YAML,
            b"mapper.",
            b"planner.",
            b"=",
            b"deg",
            b"1e999",
            b"\x1f",
            *map(str.encode, PRESETS),
        ),
        longest=256,
    ),
    Surface(
        "parameter_file",
        _file_opened,
        _file_seeds,
        (*_YAML, b"ros__parameters", b"fuzzy_mapper", b"/**", b"fuzzy_motion", b"nomad_sim"),
    ),
)
