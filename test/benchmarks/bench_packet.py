# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A mission's packets into beliefs and both risks, in a laboratory and in an area of 400 m."""

import functools
import statistics
import time

import pytest
from aside import first_call
from latency import Recorder

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from nomad_sim.headless import HeadlessMission

PRESETS = ["oriolo1998", "consistent"]
MAPS = {
    "map 63x76": GridGeometry(76, 63, 0.1),
    "map 4000x4000": GridGeometry(4000, 4000, 0.1, (-200.0, -200.0)),
}
# Largest share of the time on the small map that a packet may take on the large one.
GROWTH = 1.2


@functools.cache
def mission(preset):
    """Return the packets of a mission in the laboratory and the parameters of its mapper."""
    run = HeadlessMission("lab", seed=1, preset=preset)
    recorder = Recorder(run.mapper.geometry, run.mapper.parameters)
    recorder.packets = []
    run.mapper = recorder
    run.run()
    return recorder.packets, recorder.parameters


def fusing(preset, name):
    """Return what takes a packet, by its number, into a map that has seen all of them."""
    packets, parameters = mission(preset)
    mapper = FuzzyMapper(MAPS[name], parameters)

    def fuse(number):
        report = mapper.update(packets[number % len(packets)])
        return mapper.risks(report.window)

    for number in range(len(packets)):
        fuse(number)
    return fuse, len(packets)


@pytest.mark.parametrize("name", MAPS)
@pytest.mark.parametrize("preset", PRESETS)
def test_packet(benchmark, preset, name):
    fuse, number = fusing(preset, name)
    benchmark.group = f"packet, {preset}"
    cells = MAPS[name].width * MAPS[name].height
    cold, memory = first_call(lambda: fuse(0))
    numbers = iter(range(10_000))
    benchmark.pedantic(lambda: fuse(next(numbers)), rounds=20 * number)
    benchmark.extra_info.update(
        contender=name, cells=cells, cold=cold, bytes_per_cell=memory / cells, excess=0.0
    )


@pytest.mark.parametrize("preset", PRESETS)
def test_a_packet_costs_the_same_on_a_map_of_any_size(preset):
    fuses = [fusing(preset, name)[0] for name in MAPS]
    number = fusing(preset, "map 63x76")[1]
    least = [[float("inf")] * number for _ in MAPS]
    for _ in range(20):
        for k in range(number):
            for fuse, times in zip(fuses, least, strict=True):
                began = time.process_time()
                fuse(k)
                times[k] = min(times[k], time.process_time() - began)
    # The least: what other processes did to the caches is in neither.
    small, large = map(statistics.median, least)
    print(f"{preset}: {1e3 * small:.3f} ms, on 4000 x 4000 cells {large / small:.2f} times that")
    assert large <= GROWTH * small
