# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A soak: missions to and fro for hours, in which memory and work must stay what they were.

Two runs, each for so many simulated hours: the loop in one process, and the four nodes as
processes in lockstep at the highest rate that the machine has. The robot never begins anew: one
map and one mission object serve all missions. Sampled are the resident memory of each process,
the processor time that it takes a control tick, and, through the nodes, the wall time from a
pose to the command that answers it. Reported is what each was in the first and in the last
third, and its slope an hour with the 95 % interval of a least squares line. The first tenth,
in which buffers fill and loops are compiled, does not count.

    .ci/in_environment python3 test/endurance/soak.py --hours 24 --parts core
    .ci/in_environment python3 test/endurance/soak.py --hours 24 --parts nodes
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzzy_navigation.mission_types import Outcome
from nomad_sim.headless import CONTROL_PERIOD, HeadlessMission

WORLD = "lab"
#: Simulated time from sample to sample [h].
PERIOD = 30.0 / 3600.0
#: Share of the samples at the beginning that do not count.
WARM = 0.1
PAGE = os.sysconf("SC_PAGE_SIZE")
CLOCK_TICK = os.sysconf("SC_CLK_TCK")


@dataclass
class Series:
    """Samples of one quantity over simulated hours."""

    unit: str
    hours: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)

    def add(self, hours: float, value: float) -> None:
        self.hours.append(hours)
        self.values.append(value)

    def row(self, name: str) -> str:
        first = int(WARM * len(self.values))
        t, y = np.array(self.hours[first:]), np.array(self.values[first:])
        if len(y) < 9:
            return f"| {name} | too few samples ({len(y)}) | | |"
        third = len(y) // 3
        centred = t - t.mean()
        slope = float(centred @ y / (centred @ centred))
        rest = y - y.mean() - slope * centred
        error = float(np.sqrt(rest @ rest / (len(y) - 2) / (centred @ centred)))
        return (
            f"| {name} | {np.median(y[:third]):.3f} {self.unit} | "
            f"{np.median(y[-third:]):.3f} {self.unit} | {slope:+.4f} +- {1.96 * error:.4f} |"
        )


class Soak:
    """What was sampled, and how the missions ended."""

    def __init__(self) -> None:
        self.series: dict[str, Series] = {}
        self.outcomes: Counter[str] = Counter()
        self.failures: list[str] = []
        self.contacts = 0
        self._due = 0.0

    def ended(self, hours: float, outcome: Outcome, message: str) -> None:
        """Take note of the end of a mission, and why one went wrong."""
        self.outcomes[outcome.name.lower()] += 1
        if outcome is not Outcome.REACHED:
            self.failures.append(f"after {hours:.2f} h {outcome.name}: {message}")

    def due(self, hours: float) -> bool:
        """Whether it is time for samples."""
        if hours < self._due:
            return False
        self._due += PERIOD
        return True

    def add(self, name: str, unit: str, hours: float, value: float) -> None:
        self.series.setdefault(name, Series(unit)).add(hours, value)

    def report(self, title: str, hours: float, wall: float) -> None:
        ends = ", ".join(f"{n} {name}" for name, n in sorted(self.outcomes.items()))
        print(f"\n{title}: {hours:.2f} simulated hours in {wall / 60:.1f} min; missions: {ends}; ")
        print(f"contacts: {self.contacts}")
        for failure in self.failures:
            print(f"- {failure}")
        print("\n| quantity | first third | last third | an hour |")
        print("|---|---|---|---|")
        for name, series in self.series.items():
            print(series.row(name))
        sys.stdout.flush()


def resident(pid: int) -> float:
    """Return the resident memory of a process [MB]."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE / 1e6


def processor_time(pid: int) -> float:
    """Return the processor time that a process has taken [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / CLOCK_TICK


def soak_core(hours: float, preset: str, limit: float) -> None:
    """Run the loop in this process."""
    robot, soak, began = (
        HeadlessMission(WORLD, seed=1, preset=preset),
        Soak(),
        time.monotonic(),
    )
    ends = (robot.goal, (robot.start.x, robot.start.y))
    number = 0
    ticks: list[float] = []
    while (now := robot.simulator.time / 3600.0) < hours and time.monotonic() - began < limit:
        if robot.verdict is not None:
            number += 1
            soak.ended(now, robot.verdict.outcome, robot.verdict.message)
            robot.send(ends[number % 2])
        before = time.thread_time()
        robot.tick()
        ticks.append(time.thread_time() - before)
        if soak.due(now):
            soak.add("memory", "MB", now, resident(os.getpid()))
            soak.add("a tick, mean", "ms", now, 1e3 * statistics.fmean(ticks))
            soak.add("a tick, 99th percentile", "ms", now, 1e3 * float(np.percentile(ticks, 99)))
            ticks.clear()
    soak.contacts = robot.simulator.contacts
    soak.report(f"core, {preset}", now, time.monotonic() - began)


def soak_nodes(hours: float, preset: str, limit: float) -> None:
    """Run the four nodes; imported here, so that the core is soaked without ROS as well."""
    from fuzzy_msgs.action import Navigate
    from geometry_msgs.msg import PoseStamped, Twist

    from fuzzy_map_building.ros import names, qos
    from ros.harness import NodeProcess, Probe, wait_until
    from ros.motion_scene import goal_at
    from ros.room import stamp
    from ros.stack import Status

    soak, began = Soak(), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="soak_") as folder:
        clock = {"use_sim_time": True, "preset": preset}
        given = {"mapper": clock, "planner": clock, "motion": clock}
        given["mapper"] = {**clock, "snapshot.file": f"{folder}/mapper.map"}
        given["sim"] = {"world": WORLD, "rate": 0.0, "lockstep": True, "seed": 1}
        nodes = {
            name: NodeProcess(name, Path(folder) / f"{name}.log", parameters=parameters)
            for name, parameters in given.items()
        }
        probe = Probe()
        try:
            status = Status(probe, names.SIMULATOR_NODE)
            latencies: list[float] = []
            last = [0.0, 0.0]  # wall time and stamp of the newest pose

            def on_pose(message: PoseStamped) -> None:
                last[:] = time.perf_counter(), stamp(message)

            def on_command(_: Twist) -> None:
                latencies.append(time.perf_counter() - last[0])

            probe.node.create_subscription(PoseStamped, names.POSE, on_pose, qos.RELIABLE)
            probe.node.create_subscription(Twist, names.CMD_VEL, on_command, qos.RELIABLE)
            client = probe.action_client(Navigate, names.NAVIGATE, 600.0)
            wait_until(lambda: last[1] > 0.0, "the robot", 600.0)
            start, now, number, result = last[1], 0.0, 0, None
            used: dict[str, float] = {}
            while now < hours and time.monotonic() - began < limit:
                if result is None or result.done():
                    if result is not None:
                        told = result.result().result
                        soak.ended(now, Outcome(told.outcome), told.message)
                    goal = ((5.35, 5.45), (1.25, 5.25))[number % 2]
                    number += 1
                    handle = probe.send_goal(client, Navigate.Goal(goal=goal_at(*goal)))
                    result = handle.get_result_async()
                time.sleep(0.05)
                now = (last[1] - start) / 3600.0
                if len(latencies) < 100 or not soak.due(now):
                    continue
                times = np.array(latencies)
                latencies.clear()
                soak.add("pose to command, median", "ms", now, 1e3 * float(np.median(times)))
                for name, process in nodes.items():
                    soak.add(f"{name}, memory", "MB", now, resident(process.pid))
                    total = processor_time(process.pid)
                    before, used[name] = used.get(name, total), total
                    series = soak.series[f"{name}, memory"].hours
                    if len(series) > 1:
                        ticks = (series[-1] - series[-2]) * 3600.0 / CONTROL_PERIOD
                        soak.add(f"{name}, a tick", "ms", now, 1e3 * (total - before) / ticks)
            soak.contacts = int(status.wait(lambda _: True, "the simulator")["contacts"])
        finally:
            for process in nodes.values():
                process.close()
            probe.close()
    soak.report(f"nodes, {preset}", now, time.monotonic() - began)


PARTS: dict[str, Callable[[float, str, float], None]] = {"core": soak_core, "nodes": soak_nodes}


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hours", type=float, default=24.0, help="simulated (default: 24)")
    parser.add_argument("--quick", action="store_true", help="a tenth of an hour")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--preset", default="consistent")
    parser.add_argument(
        "--limit", type=float, default=float("inf"), help="wall time after which a part ends [s]"
    )
    options = parser.parse_args(argv)
    for part in options.parts:
        PARTS[part](0.1 if options.quick else options.hours, options.preset, options.limit)
    return 0


if __name__ == "__main__":
    sys.exit(main())
