# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a snapshot costs the mapper on a large map: copying what changed, and a write beside it.

The write runs in a thread of its own; told is how much longer packets take beside it, in
processor time and in wall time. On a machine that does other work as well only the first counts.

    python3 test/benchmarks/snapshots.py --side 1000
"""

from __future__ import annotations

import argparse
import random
import statistics
import tempfile
import threading
import time
from pathlib import Path

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.snapshot import Snapshot, rules_of
from fuzzy_map_building.types import Pose2, SonarReading


def packet(rng: random.Random, size: float) -> list[SonarReading]:
    """Return a ring of readings from anywhere in the map."""
    pose = Pose2(rng.uniform(2.0, size - 2.0), rng.uniform(2.0, size - 2.0))
    return [SonarReading(pose, 0.1309 * i, rng.uniform(0.5, 3.0)) for i in range(48)]


def timed(label: str, times: list[tuple[float, float]]) -> None:
    processor, wall = ([1e3 * t[i] for t in times] for i in (0, 1))
    print(
        f"{label}: processor {statistics.median(processor):.3f} ms (most {max(processor):.3f}), "
        f"wall {statistics.median(wall):.3f} ms (most {max(wall):.3f}), {len(times)} times"
    )


class Clock:
    """Times of a piece of work: this thread's processor time, and wall time [s]."""

    def __init__(self) -> None:
        self.times: list[tuple[float, float]] = []

    def __enter__(self) -> None:
        self._began = time.thread_time(), time.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.times.append(
            (time.thread_time() - self._began[0], time.perf_counter() - self._began[1])
        )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--side", type=int, default=1000, help="of the map [cells]")
    parser.add_argument("--preset", default="consistent")
    options = parser.parse_args()
    parameters, rng = mapper_parameters(options.preset), random.Random(0)
    size = 0.1 * options.side
    mapper = FuzzyMapper(GridGeometry(options.side, options.side, 0.1), parameters)
    for _ in range(options.side):
        mapper.update(packet(rng, size))
    alone, whole, part, beside, writes = (Clock() for _ in range(5))
    for _ in range(100):
        readings = packet(rng, size)
        with alone:
            mapper.update(readings)
    with tempfile.TemporaryDirectory() as folder:
        snapshot = Snapshot(Path(folder) / "s.map", rules_of(parameters))

        def write() -> None:
            with writes:
                snapshot.write()

        for number in range(6):
            if number < 2:
                snapshot.changed()
            with whole if number < 2 else part:
                snapshot.take(mapper)
            thread = threading.Thread(target=write)
            thread.start()
            while thread.is_alive():
                readings = packet(rng, size)
                with beside:
                    window = mapper.update(readings).window
            thread.join()
            snapshot.changed(window)
        file = snapshot.path.stat().st_size
    print(f"{options.side} x {options.side} cells, {file / 1e6:.1f} MB on disk")
    timed("a packet alone", alone.times)
    timed("a packet beside a write", beside.times)
    timed("copying the whole map", whole.times)
    timed("copying what a packet changed", part.times)
    timed("a write", writes.times)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
