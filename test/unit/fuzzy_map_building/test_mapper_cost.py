# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What FuzzyMapper costs: time, memory, and what is compiled when."""

import math
import statistics
import time
import tracemalloc

import numpy as np
import pytest

from fuzzy_map_building import (
    grid,
    infrared_model,
    infrared_packet,
    sonar_model,
    sonar_packet,
)
from fuzzy_map_building.evidence import fuzzy, union
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.jit import compiled
from fuzzy_map_building.map_grids import MapGrids
from fuzzy_map_building.mapper import FuzzyMapper, warm_up
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.sonar_guard import cut_rays, guard_points
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from unit.fuzzy_map_building.ring import LAB, perception


def test_a_mapper_that_is_asked_by_windows_takes_20_bytes_a_cell() -> None:
    geometry = GridGeometry(1500, 1500, 0.1)
    warm_up()
    tracemalloc.start()
    try:
        mapper = FuzzyMapper(geometry)
        grids = MapGrids(mapper)
        for seed in range(3):
            report = mapper.update(perception(Pose2(75.0 + seed, 75.0), seed))
            grids.refresh(mapper, report.window)
        kept, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    cells = 1500 * 1500
    assert kept < 20.1 * cells + 3.1 * cells  # with the grids to publish
    # What comes and goes does not grow with the map.
    assert most < kept + 20e6


def test_a_packet_costs_little_and_the_same_on_a_map_of_any_size() -> None:
    mappers = [FuzzyMapper(LAB), FuzzyMapper(GridGeometry(4000, 4000, 0.1))]
    medians: list[list[float]] = [[], []]
    for turn in range(8):
        packets = [perception(Pose2(3.8, 3.1, 0.1 * seed), 8 * turn + seed) for seed in range(8)]
        # In turn, so that whatever else the machine does meets both.
        for mapper, taken in zip(mappers, medians, strict=True):
            times = []
            for readings in packets:
                start = time.perf_counter()
                mapper.update(readings)
                times.append(time.perf_counter() - start)
            taken.append(statistics.median(times))
    # The quietest turn: a busy machine says nothing of the code.
    small, large = (min(taken) for taken in medians)
    assert small < (5e-3 if compiled() else 60e-3)
    assert large < 2.0 * small


@pytest.mark.skipif(not compiled(), reason="loops are compiled with numba only")
def test_nothing_is_compiled_after_warm_up() -> None:
    warm_up()
    modules = (fuzzy, grid, infrared_model, infrared_packet, sonar_model, sonar_packet, union)
    kernels = [k for m in modules for k in vars(m).values() if hasattr(k, "signatures")]
    assert len(kernels) > 10
    before = [len(kernel.signatures) for kernel in kernels]
    pose = Pose2(1.0, 1.0)
    rays = [InfraredReading(pose, 0.4 * i, 0.3) for i in range(16)]
    whole = [*perception(pose), *rays, SonarReading(pose, 0, -math.inf)]
    for overrides in (
        {"evidence.k_empty": 1, "fusion.aggregation": "dombi", "sonar.lost_echo": "full"},
        {"sonar.apex": "mount", "fusion.aggregation": "max", "consistency.enabled": False},
        {"sonar.lost_echo": "ignore", "sonar_guard.enabled": False},
    ):
        parameters = mapper_parameters("consistent", overrides)
        for geometry in (LAB, GridGeometry(2, 1, 1, (0, 0))):
            mapper = FuzzyMapper(geometry, parameters)
            for packet in (whole, rays, [], whole[:1], perception(pose, ranges=math.inf)):
                mapper.update(packet)
            mapper.restore(mapper.state())
        p = parameters
        guard_points(whole[:48], np.zeros((16, 2)), p.sonar, p.sonar_guard, 3.0, 0.23)
        cut_rays(whole[:48], rays, p.sonar, p.infrared, p.sonar_guard, 3.0, 0.23)
    assert [len(kernel.signatures) for kernel in kernels] == before
