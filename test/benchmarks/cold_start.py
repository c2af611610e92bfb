# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How long the planner's process takes from its start to the answer of the first plan.

``.ci/in_environment python3 test/benchmarks/cold_start.py [--runs N] [--stranger]`` keeps a map
waiting, starts the process, asks until a path comes, and prints the time and the processor time
that the process had taken by then. Who asks announces itself as the nodes of these packages do, or
as any other does. The first run, which may have to compile, does not count.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzzy_msgs.srv import PlanPath
from nav_msgs.msg import OccupancyGrid

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.discovery import set_discovery
from nomad_sim.ros.domain import reserved_domain
from ros.harness import START_DEADLINE, NodeProcess, Probe
from ros.planner_driver import map_message, request, world


def processor_time(pid: int) -> float:
    """Return the processor time that a process has taken [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def first_answer(probe: Probe, log: Path) -> tuple[float, float]:
    """Return time and processor time [s] to the first path of a planner that is started."""
    began = time.monotonic()
    process = NodeProcess("planner", log)
    try:
        while True:
            response = probe.call(PlanPath, names.PLAN_PATH, request(), START_DEADLINE)
            if response.status == PlanPath.Response.FOUND:
                return time.monotonic() - began, processor_time(process.pid)
    finally:
        process.close()


def main(argv: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description="Time from the planner's start to its first path."
    )
    parser.add_argument("--runs", type=int, default=5, help="starts that count")
    parser.add_argument(
        "--stranger", action="store_true", help="asked by a node of other packages"
    )
    options = parser.parse_args(argv)
    if not options.stranger:
        set_discovery()
    with tempfile.TemporaryDirectory() as folder, reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        probe = Probe()
        maps = probe.publisher(OccupancyGrid, names.PLANNING_MAP, qos.LATCHED, subscribers=0)
        maps.publish(map_message(world()))
        times = [first_answer(probe, Path(folder, str(k))) for k in range(options.runs + 1)][1:]
        probe.close()
    print("each:", " ".join(f"{wall:.2f}" for wall, _ in times))
    wall, own = (statistics.median(part) for part in zip(*times, strict=True))
    print(
        f"planner to its first path: median {wall:.2f} s, least {min(times)[0]:.2f} s; "
        f"processor time of the process {own:.2f} s, load {os.getloadavg()[0]:.1f}"
    )


if __name__ == "__main__":
    main()
