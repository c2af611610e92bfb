# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How much of a processor's core the four nodes take while the robot crosses a world in real time.

``.ci/in_environment python3 test/benchmarks/stack_load.py [--world NAME] [--rate R]`` runs the
demonstration at that many simulated seconds a second and prints the processor time of each node
from the goal to the verdict, divided by the wall time of this mission.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from nomad_sim.ros.demo import MODULES

#: Time between two looks at the processes [s].
STEP = 0.2
TICKS = os.sysconf("SC_CLK_TCK")


def children(parent: int) -> dict[str, int]:
    """Return the process id of each node among the descendants of a process."""
    found = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            command = (folder / "cmdline").read_bytes().decode(errors="replace").split("\0")
            above = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        except (OSError, IndexError):
            continue  # it has ended
        for name, module in MODULES.items():
            if module in command and above == parent:
                found[name] = int(folder.name)
    return found


def processor_time(process: int) -> float:
    """Return the processor time of a process and all its threads [s]."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def measure(world: str, rate: float, folder: Path) -> tuple[dict[str, float], float]:
    """Return the processor time of each node over a mission, and its wall time [s]."""
    command = [
        sys.executable,
        "-c",
        "import sys; from nomad_sim.ros.demo import main; sys.exit(main())",
    ]
    command += ["--world", world, "--rate", str(rate), "--output", str(folder)]
    times: list[float] = []
    used: dict[str, list[float]] = {name: [] for name in MODULES}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as demo:
        assert demo.stdout is not None
        demo.stdout.readline()  # printed as the processes are started
        began = time.monotonic()
        nodes: dict[str, int] = {}
        while demo.poll() is None:
            time.sleep(STEP)
            if len(nodes) < len(MODULES):
                nodes = children(demo.pid)
                continue
            try:
                now = {name: processor_time(process) for name, process in nodes.items()}
            except OSError:
                break  # they are being stopped
            times.append(time.monotonic() - began)
            for name, value in now.items():
                used[name].append(value)
        demo.stdout.read()
    summary = json.loads((folder / "summary.json").read_text())
    start, wall = (summary["wall_durations_s"][name] for name in ("start", "mission"))
    ends = start, start + wall
    return {
        name: float(np.diff(np.interp(ends, times, values))[0]) for name, values in used.items()
    }, wall


def main(argv: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Load of the four nodes in real time.")
    parser.add_argument("--world", default="lab", help="a world of the simulator")
    parser.add_argument("--rate", type=float, default=1.0, help="simulated seconds a second")
    options = parser.parse_args(argv)
    with tempfile.TemporaryDirectory() as folder:
        used, wall = measure(options.world, options.rate, Path(folder))
    load = os.getloadavg()[0]
    print(f"{options.world} at rate {options.rate:g}: {wall:.0f} s, load average {load:.1f}")
    for name, seconds in [*used.items(), ("all", sum(used.values()))]:
        print(f"{name:8s} {100.0 * seconds / wall:5.1f} % of a core")


if __name__ == "__main__":
    main()
