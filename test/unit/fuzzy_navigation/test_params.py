# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Defaults, cross-checks and the files that users edit."""

import math
from pathlib import Path

import pytest
import yaml

from fuzzy_map_building.parameter_schema import ParameterError, describe, flatten
from fuzzy_navigation.params import (
    DEFAULT_PRESET,
    MOTION_PRESETS,
    PAPER_PRESET,
    PLANNER_PRESETS,
    MotionParameters,
    PlannerParameters,
    motion_parameters,
    planner_parameters,
)

CONFIG = Path(__file__).parents[3] / "fuzzy_navigation" / "config"


def test_defaults_are_those_of_the_default_preset():
    planner = planner_parameters()
    assert planner == PlannerParameters() == planner_parameters(DEFAULT_PRESET)
    assert DEFAULT_PRESET == "consistent"
    assert (planner.diagonal, planner.augmentation) == ("sqrt2", "disc")
    assert (planner.rung_choice, planner.layer.enabled) == ("cheapest", True)
    motion = motion_parameters()
    assert motion == MotionParameters() == motion_parameters(DEFAULT_PRESET)
    assert (motion.augmentation, motion.clearance.rule) == ("disc", "layer")
    assert motion.layer == planner.layer
    assert (motion.sonar_guard.enabled, motion.sonar_guard.spread) == (True, 0.0)
    assert motion.subcell_target


def test_the_paper_s_preset_holds_its_rules():
    assert PAPER_PRESET == "oriolo1998"
    planner = planner_parameters(PAPER_PRESET)
    assert (planner.rung_choice, planner.layer.enabled) == ("first", False)
    assert (planner.cost, planner.epsilon, planner.tolerance) == ("g2", 0.2, 0.3)
    assert planner.alpha_ladder == (0.6, 0.7, 0.8, 0.9, 1.0)
    assert (planner.diagonal, planner.augmentation, planner.robot_radius) == (
        "unit",
        "square",
        0.23,
    )
    motion = motion_parameters(PAPER_PRESET)
    switches = (motion.layer.enabled, motion.sonar_guard.enabled, motion.subcell_target)
    assert switches == (False, False, False)
    assert motion.augmentation == "square"
    assert (motion.beta, motion.perception_cap, motion.livelock_limit) == (0.9, 80, 6)
    assert (motion.clearance.rule, motion.clearance.limit, motion.clearance.override) == (
        "closing",
        0.12,
        0.05,
    )
    assert motion.follower.max_angular == pytest.approx(math.radians(60))
    assert motion.infrared.frame_ids[3] == "infrared_3"
    assert motion.infrared.bearings[3] == pytest.approx(math.radians(67.5))
    assert len(motion.infrared.bearings) == 16


def test_both_have_the_same_presets():
    assert set(PLANNER_PRESETS) == set(MOTION_PRESETS)
    for preset in PLANNER_PRESETS:
        planner_parameters(preset)
        motion_parameters(preset)


def test_overrides_come_on_top():
    assert planner_parameters(PAPER_PRESET, {"alpha_ladder": [0.5, 1]}).alpha_ladder == (0.5, 1.0)
    nested = motion_parameters(overrides={"clearance": {"limit": 0.2, "override": 0.2}})
    dotted = motion_parameters(overrides={"clearance.limit": 0.2, "clearance.override": 0.2})
    assert nested == dotted
    assert nested.clearance.override == 0.2


@pytest.mark.parametrize(
    ("make", "overrides", "words"),
    [
        (planner_parameters, {"epsilonn": 0.1}, "epsilonn.*did you mean 'epsilon'"),
        (planner_parameters, {"cost": "g4"}, "cost.*g1, g2, g3"),
        (planner_parameters, {"adjacency": 6}, "adjacency.*0, 4, 8"),
        (planner_parameters, {"epsilon": math.nan}, "epsilon.*finite"),
        (planner_parameters, {"epsilon": 0.0}, "epsilon"),
        (planner_parameters, {"robot_radius": -0.1}, "robot_radius.*at least"),
        (planner_parameters, {"tolerance": "far"}, "tolerance.*must be a number"),
        (planner_parameters, {"alpha_ladder": []}, "alpha_ladder.*at least one"),
        (planner_parameters, {"alpha_ladder": [0.6, 0.6]}, "alpha_ladder.*rise"),
        (planner_parameters, {"alpha_ladder": [0.0, 0.6]}, "alpha_ladder.*above 0"),
        (planner_parameters, {"alpha_ladder": [0.6, 1.1]}, "alpha_ladder.*at most"),
        (motion_parameters, {"clearance.override": 0.2}, "override.*must not exceed.*limit"),
        (motion_parameters, {"clearance.rule": "closed"}, "did you mean 'closing'"),
        (motion_parameters, {"infrared.bearings": [0.0]}, "frame_ids.*16.*bearings.*1"),
        (motion_parameters, {"infrared.frame_ids": ["a"] * 16}, "names a frame twice"),
        (
            motion_parameters,
            {"infrared.frame_ids": [], "infrared.bearings": [], "sonar_guard.enabled": False},
            "without infrareds.*'sonar_guard.enabled' must be true",
        ),
        (motion_parameters, {"infrared.min_range": 0.7}, "min_range.*below.*max_range"),
        (motion_parameters, {"follower.max_linear": 0.0}, "max_linear"),
        (motion_parameters, {"perception_cap": 2.5}, "perception_cap.*must be a whole number"),
        (motion_parameters, {"timeout.pose": -1.0}, "timeout|pose"),
    ],
)
def test_bad_values_are_refused(make, overrides, words):
    with pytest.raises(ParameterError, match=words):
        make(overrides=overrides)


@pytest.mark.parametrize("make", [planner_parameters, motion_parameters])
def test_unknown_presets_are_refused(make):
    with pytest.raises(ParameterError, match=r"oriolo1999.*did you mean 'oriolo1998'"):
        make("oriolo1999")


def test_the_example_for_narrow_openings_lets_planner_and_motion_agree():
    nodes = yaml.safe_load((CONFIG / "narrow.yaml").read_text())
    values = {name.removeprefix("/**/"): node["ros__parameters"] for name, node in nodes.items()}
    assert {node.pop("preset") for node in values.values()} == {"consistent"}
    planner = planner_parameters("consistent", values["fuzzy_planner"])
    motion = motion_parameters("consistent", values["fuzzy_motion"])
    assert planner.layer == motion.layer
    # Less than what an opening of 0.60 m leaves to the body, for its memory of hits as well.
    assert motion.layer.closed == motion.clearance.override < 0.5 * 0.60 - motion.robot_radius


@pytest.mark.parametrize("cls", [PlannerParameters, MotionParameters])
def test_every_parameter_says_what_it_means(cls):
    for name, info in describe(cls).items():
        assert info.doc, name
        if info.type is float:
            assert info.minimum is not None, name
            assert info.maximum is not None, name


@pytest.mark.parametrize(
    ("file", "node", "parameters"),
    [
        ("planner.yaml", "fuzzy_planner", PlannerParameters()),
        ("motion.yaml", "fuzzy_motion", MotionParameters()),
    ],
)
def test_configuration_files_hold_the_defaults(file, node, parameters):
    """Every parameter and no other, with the default's exact value and type."""
    text = (CONFIG / file).read_text()
    values = yaml.safe_load(text)[f"/**/{node}"]["ros__parameters"]
    assert values.pop("preset") == DEFAULT_PRESET
    defaults = flatten(parameters)

    def flat(mapping, prefix=""):
        for key, value in mapping.items():
            if isinstance(value, dict):
                yield from flat(value, f"{prefix}{key}.")
            else:
                yield prefix + key, value

    written = dict(flat(values))
    assert set(written) == set(defaults)
    for name, default in defaults.items():
        value = written[name]
        if isinstance(default, tuple):
            assert all(type(a) is type(b) for a, b in zip(value, default, strict=True)), name
            value = tuple(value)
        assert type(value) is type(default), name
        assert value == default, name
