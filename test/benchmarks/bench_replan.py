# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a new window of the map and a plan near it take on maps from 500 x 500 to 4000 x 4000."""

import functools
import time

import numpy as np
import pytest
from aside import first_call
from maps import rooms

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_navigation.layer_params import LayerParameters
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.planner import Planner, PlanStatus

SIZES = [500, 2000, 4000]
WINDOW = Window(120, 180, 120, 180)
START, GOAL = (12.5, 12.5), (17.5, 17.0)
#: A window on 2000 x 2000 cells is to be taken in so many seconds.
LIMIT = 1e-3
# Largest share of the time on the smallest map that a window and a plan may take on the largest.
GROWTH = 2.0


@functools.lru_cache(maxsize=2 * len(SIZES))
def replanning(size, layer):
    """Return what takes in a window, and what plans near it, with hit points or without."""
    parameters = PlannerParameters(layer=LayerParameters(enabled=layer))
    planner = Planner(GridGeometry(size, size, 0.1), parameters)
    risk = rooms(size).risk
    risk[WINDOW.slices] = 0.0
    planner.set_map(risk)
    hits = np.random.default_rng(0).uniform(12.0, 18.0, (40 if layer else 0, 2))
    values = np.random.default_rng(1).integers(0, 8, (2, *WINDOW.shape)) / 100.0

    def take(k):
        planner.update_map(values[k % 2], WINDOW)

    def plan():
        answer = planner.plan(START, GOAL, hits=hits)
        assert answer.status is PlanStatus.FOUND
        return answer

    take(0), plan()
    return take, plan


@pytest.mark.parametrize("layer", [False, True], ids=["map", "map and hit points"])
@pytest.mark.parametrize("size", SIZES)
def test_replan(benchmark, size, layer):
    take, plan = replanning(size, layer)
    benchmark.group = "window of 60x60 and plan, " + ("map and hit points" if layer else "map")
    cold, memory = first_call(lambda: (take(0), plan()))
    numbers = iter(range(10_000))
    benchmark.pedantic(lambda: (take(next(numbers)), plan()), rounds=200, warmup_rounds=5)
    benchmark.extra_info.update(
        contender=f"{size}x{size}",
        cells=size**2,
        cold=cold,
        bytes_per_cell=memory / size**2,
        excess=0.0,
    )


@pytest.mark.parametrize("layer", [False, True], ids=["map", "map and hit points"])
def test_a_replan_costs_the_same_on_a_map_of_any_size(layer):
    least = {size: [float("inf")] * 2 for size in SIZES}
    for k in range(40):
        for size in SIZES:
            for part, call in enumerate(replanning(size, layer)):
                began = time.process_time()
                call(k) if part == 0 else call()
                least[size][part] = min(least[size][part], time.process_time() - began)
    for size in SIZES:
        window, plan = (1e3 * seconds for seconds in least[size])
        print(f"{size}x{size}: window {window:.2f} ms, plan {plan:.2f} ms")
    assert least[2000][0] <= LIMIT
    assert sum(least[4000]) <= GROWTH * sum(least[500])
