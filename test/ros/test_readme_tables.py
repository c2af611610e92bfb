# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""README.md: what its tables, links and names say is so."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from fuzzy_msgs.action import BuildMap, Navigate
from fuzzy_msgs.srv import MapFile, PlanPath

from fuzzy_map_building.parameter_schema import markdown_table
from fuzzy_map_building.params import PRESETS, MapperParameters
from fuzzy_map_building.ros import names
from fuzzy_navigation.params import MotionParameters, PlannerParameters
from nomad_sim.headless import run_mission
from nomad_sim.ros.params import SimulationParameters
from nomad_sim.world import MATERIALS
from nomad_sim.world_io import parse_world, world_names
from ros.harness import EXECUTABLES
from ros.test_readme import README, ROOT, blocks


def test_every_field_of_our_types_is_told() -> None:
    table = README.partition("| type | field | meaning |")[2].partition("\n\n")[0]
    told: dict[str, set[str]] = {}
    part = ""
    for row in table.splitlines()[2:]:
        kind, fields, _ = (cell.strip() for cell in row.strip("|").split("|"))
        part = kind or part
        told.setdefault(part, set()).update(re.findall(r"`(\w+)`", fields))
    parts = {
        "`PlanPath`, request": [PlanPath.Request],
        "`PlanPath`, response": [PlanPath.Response],
        "`Navigate`, goal": [Navigate.Goal],
        "`Navigate`, feedback": [Navigate.Feedback],
        "`Navigate`, result": [Navigate.Result],
        "`BuildMap`, goal": [BuildMap.Goal],
        "`BuildMap`, feedback": [BuildMap.Feedback],
        "`BuildMap`, result": [BuildMap.Result],
        "`MapFile`": [MapFile.Request, MapFile.Response],
    }
    assert told == {
        part: {field for kind in kinds for field in kind.get_fields_and_field_types()}
        for part, kinds in parts.items()
    }
    for kind in (kind for kinds in parts.values() for kind in kinds):
        for name, value in re.findall(r"`([A-Z_\d]+)` (\d)", table):
            assert getattr(kind, name, int(value)) == int(value)


def test_the_room_is_as_told() -> None:
    (text,) = (text for text in blocks("yaml") if "ros__parameters" not in text)
    world = parse_world(text)
    log = run_mission(world, seed=1)
    assert log.outcome.name.lower() == world.expected
    assert log.contacts == 0


PARAMETERS = {
    "Mapper": MapperParameters,
    "Planner": PlannerParameters,
    "Motion": MotionParameters,
    "Simulator": SimulationParameters,
}


@pytest.mark.parametrize("title", PARAMETERS)
def test_a_parameter_table_is_up_to_date(title: str) -> None:
    kind = PARAMETERS[title]
    found = re.search(
        rf"<details><summary>{title}</summary>\n\n(.*?)\n\n</details>", README, re.DOTALL
    )
    assert found, f"README.md has no table '{title}'"
    wanted = markdown_table(kind())
    assert found[1] == wanted, (
        f"the table '{title}' in README.md is out of date; replace it by what this prints: "
        f"python3 -c 'from fuzzy_map_building.parameter_schema import markdown_table; "
        f"from {kind.__module__} import {kind.__name__}; "
        f"print(markdown_table({kind.__name__}()))'"
    )


def test_links_and_files_exist() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    words = [word for span in re.findall(r"`([^`\n]+)`", README) for word in span.split()]
    top = {entry.name for entry in ROOT.iterdir()} - {"build", "install", "log"}
    files = [w for w in words if w.split("/")[0] in top and (ROOT / w.split("/")[0]).is_dir()]
    files += [word for word in words if word == "LICENSE"]
    missing = [name for name in [*links, *files] if not (ROOT / name).exists()]
    assert missing == []
    scripts = {Path(word).name for word in words if word.endswith(".py")}
    sources = {file.name for file in ROOT.glob("*/**/*.py")}
    assert scripts <= sources


def test_names_are_the_nodes() -> None:
    cells = set(re.findall(r"`([^`\n]+)`", README))
    own = {value for name, value in vars(names).items() if name.isupper()}
    own -= {names.CLOCK, names.MAP_FRAME, names.ODOM_FRAME, names.BASE_FRAME, names.TURRET_FRAME}
    assert own - cells == set()
    for executable, (package, _) in EXECUTABLES.items():
        assert f"{package} {executable}" in cells
    assert set(world_names()) <= cells
    assert set(PRESETS) <= cells


def test_materials_are_the_simulators() -> None:
    told = README.partition("does not come back:")[2].partition("`nomad_sim/worlds`")[0]
    angles: dict[str, float] = {}
    waiting: list[str] = []
    for name, angle in re.findall(r"`(\w+)`|(\d+)", told):
        if name:
            waiting.append(name)
        else:
            angles |= dict.fromkeys(waiting, float(angle))
            waiting = []
    real = {n: round(math.degrees(m.critical_angle), 6) for n, m in MATERIALS.items()}
    assert angles == real
