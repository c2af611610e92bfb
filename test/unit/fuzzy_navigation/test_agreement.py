# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What planner and motion have to agree on, and how a difference is told."""

import pytest

from fuzzy_navigation.agreement import disagreement, shared_parameters
from fuzzy_navigation.params import PLANNER_PRESETS, motion_parameters, planner_parameters


def compared(motion: dict[str, object], planner: dict[str, object]) -> str:
    return disagreement(
        shared_parameters(motion_parameters(overrides=motion)),
        shared_parameters(planner_parameters(overrides=planner)),
    )


@pytest.mark.parametrize("preset", PLANNER_PRESETS)
def test_planner_and_motion_of_one_preset_agree(preset: str) -> None:
    here, there = motion_parameters(preset), planner_parameters(preset)
    assert disagreement(shared_parameters(here), shared_parameters(there)) == ""
    (other,) = set(PLANNER_PRESETS) - {preset}
    told = disagreement(shared_parameters(here), shared_parameters(planner_parameters(other)))
    assert "augmentation is" in told
    assert "layer.enabled is" in told


@pytest.mark.parametrize(
    ("name", "here", "there"),
    [
        ("robot_radius", 0.23, 0.2),
        ("augmentation", "disc", "square"),
        ("layer.closed", 0.05, 0.04),
        ("layer.limit", 0.12, 0.1200000001),
        ("layer.free", 0.2, 0.3),
        ("layer.shift", 0.045, 0.0),
    ],
)
def test_each_difference_is_named_with_both_values(name: str, here: object, there: object) -> None:
    assert compared({name: here}, {name: here}) == ""
    told = compared({name: here}, {name: there})
    assert told == (
        f"planner and motion do not agree: {name} is {there} in the planner and {here} in the "
        "motion; give both the same"
    )


def test_what_one_of_them_has_no_use_for_may_differ() -> None:
    assert compared({"layer.slack": 0.0}, {"layer.cost": 1.0}) == ""
    off = {"layer.enabled": False}
    assert compared({**off, "layer.free": 0.3}, off) == ""


def test_a_planner_that_tells_nothing_or_nonsense_is_believed() -> None:
    motion = shared_parameters(motion_parameters())
    assert disagreement(motion, ()) == ""
    assert disagreement(motion, ["", "=", "a=b=c", "robot_radius"]) != ""  # told, as nothing
    assert disagreement(motion, ["colour=blue"]) == ""
    assert len(disagreement(motion, ["robot_radius=" + "9" * 10_000])) < 300
