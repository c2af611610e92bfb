# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where cells are large, walls between two of them stop the robot all the same."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.clear_way import clear_until
from fuzzy_navigation.follower import Follower
from fuzzy_navigation.params import FollowerParameters
from fuzzy_navigation.stop_rules import ClosingClearance
from nomad_sim.missions import MissionSpec, run_spec
from nomad_sim.world_io import load_world

RULE = ClosingClearance(0.12, 0.05)
RADIUS = 0.23


@pytest.mark.parametrize(
    ("wall", "horizon", "until"),
    [
        # From 0.35 m before the wall the body leaves 0.12 m: the last tenth short of that.
        (1.0, 3.0, 0.6),
        (1.06, 3.0, 0.7),
        (1.0, 0.5, math.inf),  # farther on than is looked at
        (0.4, 3.0, 0.0),  # at once
        (3.5, 3.0, math.inf),
    ],
)
def test_the_way_ends_before_what_lies_between_its_ends(
    wall: float, horizon: float, until: float
) -> None:
    follower = Follower(FollowerParameters())
    follower.follow(np.array([(0.0, 0.0), (4.0, 0.0)]))
    hits = np.array([(wall, 0.0)])
    found = clear_until(RULE, follower, Pose2(0.0, 0.0), hits, RADIUS, 0.6, 0, horizon)
    assert found == pytest.approx(until)


@pytest.mark.parametrize("preset", ["consistent", "oriolo1998"])
@pytest.mark.parametrize("side", [0.3, 0.5, 1.0, 10.0])
def test_cells_of_any_size_lead_the_robot_into_nothing(side: float, preset: str) -> None:
    """It may not arrive: the goal's cell, or all, may be believed occupied."""
    lab = load_world("lab")
    for seed in (1, 2, 3):
        area = {"area.resolution": side}
        mission = run_spec(MissionSpec(lab, seed, preset, start_spread=0.3, mapper=area))
        assert mission.contacts == 0, f"seed {seed}"
        assert mission.min_clearance > 0.0
