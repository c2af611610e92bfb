# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How long a packet and a plan take in the laboratory.

``python test/benchmarks/latency.py [--repeats N] [--preset NAME]`` runs the laboratory's mission
once, then takes each of its packets into beliefs and both risks and plans from each of its
perceptions again, and prints medians.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.mapper import FuzzyMapper, UpdateReport
from fuzzy_map_building.params import DEFAULT_PRESET
from fuzzy_map_building.types import Pose2, RangeReading
from fuzzy_navigation.planner import Planner
from nomad_sim.headless import HeadlessMission


class Recorder(FuzzyMapper):
    """A mapper that keeps the packets it is given."""

    packets: list[list[RangeReading]]

    def update(self, readings: Sequence[RangeReading]) -> UpdateReport:
        """Keep a packet and fuse it."""
        self.packets.append(list(readings))
        return super().update(readings)


def milliseconds(calls: Sequence[Callable[[], object]], repeats: int) -> list[float]:
    """Return how long each call took, `repeats` times over all of them [ms]."""
    times = []
    for _ in range(repeats):
        for call in calls:
            began = time.perf_counter()
            call()
            times.append(1e3 * (time.perf_counter() - began))
    return times


def main(argv: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Time of a packet and of a plan.")
    parser.add_argument("--repeats", type=int, default=20, help="repetitions of the mission")
    parser.add_argument("--preset", default=DEFAULT_PRESET, help="rules of mapper and planner")
    options = parser.parse_args(argv)
    repeats = options.repeats
    run = HeadlessMission("lab", seed=1, preset=options.preset)
    recorder = Recorder(run.mapper.geometry, run.mapper.parameters)
    recorder.packets = []
    run.mapper = recorder
    maps: list[tuple[Pose2, NDArray[np.float64]]] = []
    run.run(lambda r: maps.append((r.simulator.pose, r.mapper.planning_risk.copy())))

    mapper = FuzzyMapper(recorder.geometry, recorder.parameters)

    def fuse(packet: list[RangeReading]) -> None:
        mapper.risks(mapper.update(packet).window)

    packets = milliseconds([lambda p=p: fuse(p) for p in recorder.packets], repeats)
    planner = Planner(recorder.geometry, run.planner.parameters)

    def plan(pose: Pose2, risk: NDArray[np.float64]) -> None:
        planner.set_map(risk)
        planner.plan(pose, run.goal)

    plans = milliseconds([lambda m=m: plan(*m) for m in maps], repeats)
    readings = round(statistics.mean(map(len, recorder.packets)))
    for name, times in ((f"packet of {readings} readings", packets), ("map and plan", plans)):
        rank = sorted(times)
        print(
            f"{name:22s} median {statistics.median(times):6.2f} ms, "
            f"95 % below {rank[int(0.95 * len(rank))]:6.2f} ms, {len(times)} calls"
        )


if __name__ == "__main__":
    main()
