# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the simulator: what is refused, and the file with the defaults."""

import math
from pathlib import Path

import pytest
import yaml

from fuzzy_map_building.parameter_schema import ParameterError, describe, flatten, from_mapping
from nomad_sim.params import SimulatorParameters, simulator_parameters
from nomad_sim.ros.params import SimulationParameters

CONFIG = Path(__file__).resolve().parents[3] / "nomad_sim" / "config" / "sim.yaml"


def test_overrides_have_the_last_word():
    world = {"sonar": {"beam_half_angle": 0.2, "reflections": 0}}
    parameters = simulator_parameters({"sonar.reflections": 2}, world)
    assert parameters.sonar.beam_half_angle == 0.2
    assert parameters.sonar.reflections == 2
    assert simulator_parameters() == SimulatorParameters()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("sonar.beam_half_angel", 0.1, "did you mean 'sonar.beam_half_angle'"),
        ("sonar.range_noise", -0.1, "at least 0.0"),
        ("sonar.max_range", math.nan, "finite"),
        ("sonar.min_range", 7.0, "below 'sonar.max_range'"),
        ("sonar.firing_slots", (0, 1), "2 slots for 16 sonars"),
        ("sonar.firing_slots", (-1,) * 16, "at least 0"),
        ("sonar.frame_ids", ("a",) * 16, "twice"),
        ("sonar.frame_ids", (), "must name at least one sensor"),
        ("sonar.frame_ids", ("a", "b"), "2 sensors but 'sonar.bearings' gives 16"),
        ("sonar.short_outliers", 1.5, "at most 1.0"),
        ("infrared.min_range", 0.6, "below 'infrared.max_range'"),
        ("infrared.bearings", (), "16 sensors but 'infrared.bearings' gives 0"),
        ("robot.radius", 0.0, "at least 0.01"),
        ("seed", -1, "at least 0"),
        ("seed", 1.5, "must be a whole number"),
        ("noise", 1, "must be true or false"),
    ],
)
def test_bad_values_are_refused_by_name(name, value, message):
    with pytest.raises(ParameterError, match=message) as refused:
        simulator_parameters({name: value})
    assert name.split(".")[-1].split("_")[0] in str(refused.value)


def test_outlier_probabilities_exclude_each_other():
    with pytest.raises(ParameterError, match="must not exceed 1"):
        simulator_parameters({"sonar.short_outliers": 0.6, "sonar.lost_outliers": 0.6})


def test_every_parameter_says_what_it_is():
    for name, info in describe(SimulatorParameters).items():
        assert info.doc, name


def test_the_configuration_file_holds_all_defaults():
    (node, content), *others = yaml.safe_load(CONFIG.read_text()).items()
    assert node == "/**/nomad_sim"
    assert not others
    from_file = from_mapping(SimulationParameters(), content["ros__parameters"])
    assert from_file == SimulationParameters()
    keys = set()

    def collect(mapping, prefix=""):
        for key, value in mapping.items():
            if isinstance(value, dict):
                collect(value, f"{prefix}{key}.")
            else:
                keys.add(prefix + key)

    collect(content["ros__parameters"])
    assert keys == set(flatten(SimulationParameters()))
