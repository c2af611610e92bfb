# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the demonstration says while it runs."""

from __future__ import annotations

from collections.abc import Mapping

from fuzzy_map_building.ros.discovery import DISCOVERY_RANGE
from fuzzy_map_building.wording import counted
from fuzzy_navigation.mission_types import LogEntry, Phase
from nomad_sim.mission_report import entry_line
from nomad_sim.ros.demo_options import DemoOptions
from nomad_sim.ros.mission_record import MissionRecord

__all__ = ["print_end", "print_perception", "print_start"]


def print_start(options: DemoOptions, domain: int, discovery_range: str) -> None:
    """Say what is going to happen, and how to watch it with other tools."""
    world = options.world
    rate = f"{options.rate:g} times real time" if options.rate > 0.0 else "as fast as possible"
    print(
        f"world '{world.name}' from ({world.start.x:g}, {world.start.y:g}) to "
        f"({world.goal[0]:g}, {world.goal[1]:g}) m, seed {options.seed}, "
        f"preset {options.preset}{', mapping while moving' if options.concurrent else ''}, "
        f"{rate}{', in lockstep' if options.lockstep else ''}\n"
        f"to watch: export ROS_DOMAIN_ID={domain} {DISCOVERY_RANGE}={discovery_range}",
        flush=True,
    )


def print_perception(entry: LogEntry, phase: Phase, started: float) -> None:
    """Write a line for a perception of a mission that began at `started` [s], and what follows."""
    print(f"{entry_line(entry, started)}; {phase.name.lower()}", flush=True)


def print_end(
    record: MissionRecord, options: DemoOptions, problem: str, durations: Mapping[str, float]
) -> None:
    """Write the verdict and what it has taken; `problem` is why there is none."""
    verdict = record.verdict
    if verdict is None:
        print(f"no verdict: {problem}")
    else:
        print(
            f"{verdict.outcome.name} (true: {' or '.join(options.expected)}): {verdict.message}\n"
            f"{counted(verdict.perceptions, 'perception')}, {verdict.path_length:.2f} m, "
            f"{verdict.duration:.1f} s simulated in {durations['mission']:.1f} s"
        )
    print(
        f"least clearance {record.simulator['least_clearance']} m, "
        f"contacts: {record.simulator['contacts']}",
        flush=True,
    )
