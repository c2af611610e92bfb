# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper against equations (1)-(13) read one by one, in scalar loops."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import PAPER_PRESET, MapperParameters, mapper_parameters
from fuzzy_map_building.types import Pose2, SonarReading
from unit.fuzzy_map_building.scalar_mapper import ScalarMapper

TOLERANCE = 1e-9


def random_packet(rng: np.random.Generator, p: MapperParameters, moving: bool) -> list:
    pose = Pose2(*rng.uniform(0.2, 2.8, 2), rng.uniform(-7, 7))
    readings = []
    for _ in range(14):
        if moving:
            pose = Pose2(*rng.uniform(-0.3, 3.3, 2), rng.uniform(-7, 7))
        value = rng.choice(
            [rng.uniform(0.12, 2.2), math.inf, -math.inf, math.nan, 0.05, 7.0],
            p=[0.62, 0.2, 0.06, 0.04, 0.04, 0.04],
        )
        # A few directions more than once.
        bearing = rng.choice([rng.uniform(-7, 7), math.radians(22.5 * rng.integers(16))])
        readings.append(SonarReading(pose, float(bearing), float(value)))
    return readings


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("apex", ["center", "mount"])
@pytest.mark.parametrize("aggregation", ["mean", "dombi", "max"])
def test_equals_the_equations_cell_by_cell(aggregation: str, apex: str, seed: int) -> None:
    rng = np.random.default_rng([seed, len(aggregation), len(apex)])
    parameters = mapper_parameters(
        PAPER_PRESET,
        {
            "sonar.apex": apex,
            "sonar.lost_echo": ("neighbours", "full", "ignore")[int(rng.integers(3))],
            "sonar.field_of_view": float(rng.uniform(0.2, 0.44)),
            "sonar.mount_radius": float(rng.uniform(0.0, 0.3)),
            "evidence.k_empty": float(rng.uniform(0.05, 0.95)),
            "evidence.k_occupied": float(rng.uniform(0.05, 0.95)),
            "evidence.range_margin": float(rng.uniform(0.05, 0.4)),
            "evidence.visibility_radius": float(rng.uniform(0.5, 2.5)),
            "evidence.dombi_lambda": float(rng.uniform(0.2, 2.0)),
            "fusion.aggregation": aggregation,
            "fusion.max_count": int(rng.integers(1, 4)),
        },
    )
    geometry = GridGeometry(24, 21, 0.137, (-0.11, 0.05))
    mapper = FuzzyMapper(geometry, parameters)
    scalar = ScalarMapper(geometry, parameters)
    for packet in range(4):
        readings = random_packet(rng, parameters, moving=packet % 2 == 1)
        report = mapper.update(readings)
        scalar.update(readings)
        for name, truth in (
            ("empty", scalar.e),
            ("occupied", scalar.o),
            ("motion_risk", scalar.m_m),
            ("planning_risk", scalar.m_p),
        ):
            error = np.abs(getattr(mapper, name) - truth)
            assert error.max() < TOLERANCE, f"{name}: {error.max()} at {error.argmax()}"
        np.testing.assert_array_equal(mapper.count, scalar.n)
        assert report.accepted + sum(report.rejected.values()) == len(readings)
        assert report.rejected.get("nan", 0) == sum(math.isnan(r.range) for r in readings)
    assert (mapper.count > 1).any()
    assert (mapper.occupied > 0).any()


def test_a_packet_of_the_paper_s_ring_equals_the_equations() -> None:
    rng = np.random.default_rng(5)
    parameters = mapper_parameters(PAPER_PRESET)
    geometry = parameters.area.geometry()
    mapper = FuzzyMapper(geometry, parameters)
    scalar = ScalarMapper(geometry, parameters)
    # On a corner of cells and along the axes: the most that rounding could ask for.
    for pose in (Pose2(3.8, 3.1, 0.0), Pose2(4.25, 3.15, math.pi / 2)):
        readings = [
            SonarReading(
                pose,
                math.radians(22.5 * i + 7.5 * j),
                float(rng.choice([rng.uniform(0.12, 6.5), math.inf], p=[0.8, 0.2])),
            )
            for j in range(3)
            for i in range(16)
        ]
        mapper.update(readings)
        scalar.update(readings)
    assert np.abs(mapper.empty - scalar.e).max() < TOLERANCE
    assert np.abs(mapper.occupied - scalar.o).max() < TOLERANCE
    assert np.abs(mapper.motion_risk - scalar.m_m).max() < TOLERANCE
    assert np.abs(mapper.planning_risk - scalar.m_p).max() < TOLERANCE
    # Redundancy (section III-A): every direction around the robot lies in three cones or more.
    assert Counter(mapper.count.ravel().tolist())[2] > 300
