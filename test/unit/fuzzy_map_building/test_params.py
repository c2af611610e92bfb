# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper's parameters, presets and the file that users edit."""

import dataclasses
import math
from pathlib import Path

import pytest
import yaml

from fuzzy_map_building.parameter_schema import ParameterError, describe, flatten
from fuzzy_map_building.params import (
    DEFAULT_PRESET,
    PAPER_PRESET,
    PRESETS,
    AreaParameters,
    MapperParameters,
    SonarParameters,
    TurretParameters,
    mapper_parameters,
)

#: The rules that go beyond the paper.
BEYOND = ["consistency", "infrared_evidence", "sonar_guard"]
FILE = Path(__file__).resolve().parents[3] / "fuzzy_map_building" / "config" / "mapper.yaml"


def test_the_parameter_file_holds_every_default() -> None:
    (node,) = yaml.safe_load(FILE.read_text(encoding="utf-8")).items()
    assert node[0] == "/**/fuzzy_mapper"
    found: dict[str, object] = {}

    def walk(values: dict, prefix: str) -> None:
        for key, value in values.items():
            if isinstance(value, dict):
                walk(value, f"{prefix}{key}.")
            else:
                found[prefix + key] = tuple(value) if isinstance(value, list) else value

    walk(node[1]["ros__parameters"], "")
    defaults = flatten(mapper_parameters())
    assert found == defaults
    # ROS 2 tells 1 from 1.0.
    for name, value in defaults.items():
        kinds = {type(v) for v in (value if isinstance(value, tuple) else (value,))}
        in_file = found[name] if isinstance(found[name], tuple) else (found[name],)
        assert {type(v) for v in in_file} == kinds, name


def test_the_parameter_file_names_every_preset() -> None:
    text = FILE.read_text(encoding="utf-8")
    assert all(name in text for name in PRESETS)


def test_the_robot_is_the_paper_s_whatever_the_rules() -> None:
    p = mapper_parameters()
    assert p == MapperParameters() == mapper_parameters(DEFAULT_PRESET)
    assert DEFAULT_PRESET == "consistent"
    paper = mapper_parameters(PAPER_PRESET)
    assert (p.sonar, p.infrared, p.area, p.turret) == (
        paper.sonar,
        paper.infrared,
        paper.area,
        paper.turret,
    )
    assert p.area.geometry().shape == (63, 76)
    assert p.packet_size == len(p.sonar.bearings) * len(p.turret.angles) == 48
    assert math.degrees(p.sonar.bearings[3]) == pytest.approx(67.5)
    assert [round(math.degrees(a), 6) for a in p.turret.angles] == [0.0, 7.5, 15.0]


def test_the_paper_s_preset_holds_its_values_and_nothing_beyond_it() -> None:
    p = mapper_parameters(PAPER_PRESET)
    assert PAPER_PRESET == "oriolo1998"
    assert (p.evidence.k_empty, p.evidence.k_occupied) == (0.4, 0.4)
    assert (p.evidence.range_margin, p.evidence.visibility_radius) == (0.15, 1.5)
    assert (p.evidence.dombi_lambda, p.fusion.aggregation, p.fusion.max_count) == (0.4, "mean", 3)
    for name, values in PRESETS.items():
        beyond = [group for group in BEYOND if getattr(mapper_parameters(name), group).enabled]
        assert beyond == (BEYOND if name == DEFAULT_PRESET else []), name
        assert values or name == DEFAULT_PRESET
    assert MapperParameters().evidence.range_margin == 0.1


@pytest.mark.parametrize("preset", PRESETS)
def test_a_preset_is_valid_and_is_what_it_names(preset: str) -> None:
    values = flatten(mapper_parameters(preset))
    for name, value in PRESETS[preset].items():
        assert values[name] == value
    for name in set(values) - set(PRESETS[preset]):
        assert values[name] == flatten(MapperParameters())[name]


def test_overrides_win_over_the_preset() -> None:
    p = mapper_parameters("map_building", {"evidence": {"k_empty": 0.2}, "packet_size": 16})
    assert (p.evidence.k_empty, p.evidence.k_occupied, p.packet_size) == (0.2, 0.25, 16)


def test_an_unknown_preset_or_parameter_is_refused() -> None:
    with pytest.raises(ParameterError, match="did you mean 'lachekhab'"):
        mapper_parameters("lachekab")
    with pytest.raises(ParameterError, match=r"did you mean 'evidence\.k_empty'"):
        mapper_parameters(overrides={"evidence.k_emtpy": 0.3})


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"frame_ids": ("a", "b"), "bearings": (0.0,)}, "names 2 sonars .* gives 1 directions"),
        ({"frame_ids": (), "bearings": ()}, "at least one sonar"),
        ({"frame_ids": ("a", "b", "a"), "bearings": (0.0, 1.0, 2.0)}, "repeats 'a'"),
        ({"min_range": 2.0, "max_range": 1.0}, "must be less than"),
        ({"min_range": 2.0, "max_range": 2.0}, "must be less than"),
        ({"bearings": (math.nan,) * 16}, "must be finite"),
        ({"apex": "centre"}, "did you mean 'center'"),
    ],
)
def test_sonars_are_checked_across_fields(values: dict, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        SonarParameters(**values)


def test_a_turret_needs_an_angle() -> None:
    with pytest.raises(ParameterError, match="at least one angle"):
        TurretParameters(angles=())


def test_an_area_of_too_many_cells_is_refused_before_it_is_allocated() -> None:
    with pytest.raises(ParameterError, match=r"area\.\*.*exceeds the limit"):
        AreaParameters(size_x=1e4, size_y=1e4, resolution=0.01)


def test_every_parameter_says_what_it_means() -> None:
    for name, info in describe(MapperParameters).items():
        assert len(info.doc) > 5, name
        if info.type in (float, int):
            assert info.minimum is not None, name
            assert info.maximum is not None, name
    for name in ("timeout", "settle", "pose_timeout", "max_pose_gap"):
        assert describe(MapperParameters)[f"perception.{name}"].unit == "s"


def test_parameters_are_values() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        mapper_parameters().packet_size = 3  # type: ignore[misc]
    assert hash(mapper_parameters()) == hash(mapper_parameters())
