# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters as they are written on a command line."""

import math
from typing import Any

import pytest

from nomad_sim.overrides import GROUPS, critical_angles, parameter_overrides


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.3", 0.3),
        ("3", 3),
        ("-2", -2),
        ("1e-3", 0.001),
        ("12.5deg", math.radians(12.5)),
        ("-90 deg", -0.5 * math.pi),
        ("true", True),
        ("disc", "disc"),
        ("''", ""),
        ("[0deg, 7.5deg, 1e1]", [0.0, math.radians(7.5), 10.0]),
        ("[sonar_0, sonar_1]", ["sonar_0", "sonar_1"]),
    ],
)
def test_values_are_what_they_look_like(text: str, value: Any) -> None:
    read = parameter_overrides([f"mapper.a.b={text}"])["mapper"]["a.b"]
    assert type(read) is type(value)
    assert read == pytest.approx(value) if isinstance(value, float) else read == value


def test_each_goes_to_its_part_and_the_last_word_counts() -> None:
    values = parameter_overrides(
        ["planner.epsilon=0.1", "motion.clearance.rule=strict", "planner.epsilon=0.2"]
    )
    assert values == {
        "mapper": {},
        "planner": {"epsilon": 0.2},
        "motion": {"clearance.rule": "strict"},
        "simulator": {},
    }
    assert set(values) == set(GROUPS)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mapper", "NAME=VALUE expected"),
        ("mapper.a=", "NAME=VALUE expected"),
        ("=3", "NAME=VALUE expected"),
        ("maper.a=3", "unknown part 'maper'; did you mean 'mapper'"),
        ("mapper=3", "'mapper.PARAMETER=VALUE' expected"),
        ("simulator.seed=3", "seed of its own"),
        ("mapper.a=[1, 2", "not a value that can be read"),
        ("mapper.a=!!python/object:os.system {}", "not a value that can be read"),
    ],
)
def test_what_cannot_be_read_is_refused_in_one_line(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message) as raised:
        parameter_overrides([text])
    assert "\n" not in str(raised.value)


def test_critical_angles_are_degrees() -> None:
    angles = critical_angles(["painted_wall=25", "glass=8deg"])
    assert angles == {"painted_wall": math.radians(25.0), "glass": math.radians(8.0)}


@pytest.mark.parametrize("text", ["glass", "glass=wide", "glass=[8]", "glass="])
def test_a_critical_angle_is_a_number(text: str) -> None:
    with pytest.raises(ValueError, match=r"--critical-angle .*expected"):
        critical_angles([text])
