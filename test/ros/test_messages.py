# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What messages call things: parameters by names that can be set."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import fuzzy_map_building
import fuzzy_navigation
import nomad_sim
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.parameter_schema import describe
from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.ros.explanations import explanations
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.params import MotionParameters, PlannerParameters
from nomad_sim.ros.params import SimulationParameters

KINDS = (MapperParameters, PlannerParameters, MotionParameters, SimulationParameters)
NAMES = {name for kind in KINDS for name in describe(kind)}
GROUPS = {name.partition(".")[0] for name in NAMES if "." in name}
#: Last parts of names that mean nothing alone, since several groups have them.
PARTS = {"frame_ids", "bearings", "mount_radius", "min_range", "max_range", "field_of_view"}


def texts() -> Iterator[tuple[str, str]]:
    """Yield every text in the sources that is no docstring, with where it stands."""
    for package in (fuzzy_map_building, fuzzy_navigation, nomad_sim):
        for file in sorted(Path(package.__path__[0]).rglob("*.py")):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Constant) and isinstance(node.value, str):
                    yield f"{file.name}:{node.lineno}", node.value


def test_a_parameter_that_a_message_names_exists() -> None:
    quoted = re.compile(rf"'((?:{'|'.join(sorted(GROUPS))})\.[a-z_]+)'")
    found = {name: where for where, text in texts() for name in quoted.findall(text)}
    assert len(found) > 10
    assert {name: where for name, where in found.items() if name not in NAMES} == {}


def test_no_message_calls_a_parameter_by_its_last_part() -> None:
    bare = re.compile(rf"parameters? '?(?:{'|'.join(PARTS)})\b")
    assert [where for where, text in texts() if bare.search(text)] == []


def test_everything_that_is_given_up_is_told_with_its_sensor_and_its_times() -> None:
    p = mapper_parameters()
    assembler = ReadingAssembler(p)
    assembler.add_pose(10.0, Pose2(0.0, 0.0), 10.0)
    assembler.add_pose(10.0, Pose2(0.0, 0.0), 10.0)
    assembler.add_pose(9.0, Pose2(0.0, 0.0), 10.0)
    assembler.add_pose(12.0, Pose2(0.0, 0.0), 10.0)
    assembler.add_turret(12.0, 0.0, 10.0)
    for stamp in (10.0, 10.0, 9.9, 11.0):
        assembler.add_range(3, stamp, 1.0, 10.0)
    assembler.add_range(4, 8.0, 1.0, 10.0)
    assembler.add_range(5, 10.05, 1.0, 10.0)
    assembler.release(10.6)
    told = {**assembler.examples, **{f"pose.{k}": v for k, v in assembler.poses.examples.items()}}
    assert told == {
        "duplicate": "sonar 3 stamped 10.000 s, after 10.000 s",
        "out_of_order": "sonar 3 stamped 9.900 s, after 10.000 s",
        "future": "sonar 3 stamped 11.000 s, 1.000 s ahead of the clock",
        "before_pose": "sonar 4 stamped 8.000 s, the clock being at 10.600 s, the newest of them "
        "at 10.000 s",
        "no_pose": "sonar 5 stamped 10.050 s, the clock being at 10.600 s, the newest of them "
        "at 10.000 s",
        "no_turret": "sonar 3 stamped 10.000 s, the clock being at 10.600 s, none has come",
        "pose.duplicate": "stamped 10.000 s, after 10.000 s",
        "pose.out_of_order": "stamped 9.000 s, after 10.000 s",
        "pose.future": "stamped 12.000 s, 2.000 s ahead of the clock",
    }
    assert assembler.rejected.keys() == assembler.examples.keys()
    words = {**assembler.rejected, **assembler.poses.rejected, **assembler.turret.rejected}
    for named in (True, False):
        explained = explanations(p.perception, named=named)
        assert words.keys() <= explained.keys()
        # The motion has no such parameters.
        assert any("perception." in text for text in explained.values()) == named
        assert "0.5 s" in explained["future"]


def test_messages_name_no_classes() -> None:
    inner = re.compile(r"\b(GridGeometry|MapState|MapWindow|Window|PlanRequest)[.(]|Errno")
    told = [(where, text) for where, text in texts() if ">>>" not in text]  # but in examples
    assert [where for where, text in told if inner.search(text)] == []
