# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Grids kept by windows against grids made of the whole maps."""

import math

import numpy as np
import pytest

from fuzzy_map_building import map_grids
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_grids import MapGrids
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.occupancy import belief_to_int8, risk_to_int8
from fuzzy_map_building.types import Pose2, SonarReading

GRID = GridGeometry(76, 63, 0.1)


def ring(pose: Pose2, seed: int) -> list[SonarReading]:
    ranges = np.random.default_rng(seed).uniform(0.2, 2.0, 48).tolist()
    return [SonarReading(pose, math.radians(7.5 * i), r) for i, r in enumerate(ranges)]


def assert_up_to_date(grids: MapGrids, mapper: FuzzyMapper) -> None:
    np.testing.assert_array_equal(grids.motion, risk_to_int8(mapper.motion_risk))
    np.testing.assert_array_equal(grids.planning, risk_to_int8(mapper.planning_risk))
    whole = belief_to_int8(mapper.empty, mapper.occupied)
    np.testing.assert_array_equal(grids.occupancy, whole)


@pytest.mark.parametrize("cells", [1, 500, 1 << 18])
def test_windows_keep_the_grids_up_to_date(cells: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(map_grids, "_CELLS_A_BAND", cells)
    mapper = FuzzyMapper(GRID)
    grids = MapGrids(mapper)
    assert_up_to_date(grids, mapper)
    assert (grids.motion == 100).all()
    assert (grids.occupancy == -1).all()
    for seed in range(4):
        report = mapper.update(ring(Pose2(0.5 + 2.0 * seed, 3.0), seed))
        grids.refresh(mapper, report.window)
        assert_up_to_date(grids, mapper)
    assert (grids.occupancy >= 0).any()
    mapper.reset()
    grids.refresh(mapper)
    assert_up_to_date(grids, mapper)


def test_a_window_leaves_the_rest_alone() -> None:
    mapper = FuzzyMapper(GRID)
    grids = MapGrids(mapper)
    grids.motion[0, 0] = 7
    report = mapper.update(ring(Pose2(5.0, 4.0), 1))
    grids.refresh(mapper, report.window)
    assert grids.motion[0, 0] == 7
