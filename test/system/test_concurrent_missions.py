# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A whole mission that maps while it moves, beside one that stands for each perception."""

import numpy as np

from fuzzy_navigation.concurrent_mission import SETTINGS
from fuzzy_navigation.mission_types import Phase
from nomad_sim.headless import CONTROL_PERIOD, HeadlessMission, run_mission
from nomad_sim.world_io import load_world


def test_mapping_while_moving_takes_less_time_and_is_as_safe() -> None:
    mission = HeadlessMission("lab", seed=1, **SETTINGS)
    speeds, stood, standing = [], 0, False
    while mission.verdict is None:
        before = mission.simulator.pose
        mission.tick()
        after = mission.simulator.pose
        perceives = mission.mission.phase is Phase.PERCEIVING
        stood += perceives and not standing
        standing = perceives
        speeds.append(after.distance_to(before.x, before.y) / CONTROL_PERIOD)
    simulator, verdict = mission.simulator, mission.verdict
    goal = load_world("lab").goal
    assert simulator.pose.distance_to(*goal) <= 0.3 + 0.02
    assert simulator.contacts == 0
    assert simulator.least_clearance > 0.08
    # It stood for few of its maps, and drove most of the time.
    assert stood < 8
    assert mission.mapper.perceptions > 5 * stood
    assert np.mean(np.array(speeds) > 0.1) > 0.6
    alternating = run_mission("lab", seed=1)
    assert alternating.reached
    assert verdict.duration < 0.7 * alternating.duration
    # Ways are counted alike: about as many perceptions to a metre.
    assert verdict.perceptions < 2 * alternating.perceptions
    # The simulator counts as the mission does, by the way and the turret.
    assert abs(simulator.perceptions - verdict.perceptions) <= 0.3 * verdict.perceptions
