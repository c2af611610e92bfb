# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What sensors, messages, poses and clocks that fail do to missions: slower, or it stands.

``python test/studies/faults.py [--quick] [--seed N] [--seeds N] [--worlds W] [--output DIR]``
"""

from __future__ import annotations

import re
import statistics
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import quiet_end  # noqa: F401  before all that takes time

# isort: split

from matplotlib.figure import Figure
from study import Study, parse_options

from nomad_sim.missions import MissionResult, MissionSpec, run_spec
from nomad_sim.reference import ROWS
from nomad_sim.workers import run_in_parallel

RUNS = 10
#: Robot's time at which lasting faults begin [s]: it is on its way.
BEGIN = 8
WORLDS = ("lab_40_25_8_beam_10", "gaps_0.75")


@dataclass(frozen=True)
class Case:
    """Something that fails: faults of the simulator, or other parameters of it."""

    name: str
    faults: str = ""
    simulator: Mapping[str, Any] = field(default_factory=dict)


def _lasting(*faults: str) -> str:
    return "; ".join(f"{fault} start={BEGIN}" for fault in faults)


def _of_all(kind: str, *settings: str) -> str:
    return "; ".join(
        " ".join((kind, target, *settings)) for target in ("sonar", "infrared", "turret", "pose")
    )


HEALTHY = Case("nothing fails")
CASES = (
    Case("sonar ahead dead", _lasting("dead sonar sensors=0")),
    Case("all sonars dead", _lasting("dead sonar")),
    Case("all sonars report NaN", _lasting("faulty sonar")),
    Case("sonar ahead stuck", _lasting("stuck sonar sensors=0")),
    Case("all sonars stuck", _lasting("stuck sonar")),
    Case("sonars half deaf", _lasting("deaf sonar share=0.5")),
    Case("sonars deaf", _lasting("deaf sonar")),
    Case("sonars 0.1 m too long", _lasting("biased sonar offset=0.1")),
    Case("sonars 0.1 m too short", _lasting("biased sonar offset=-0.1")),
    # Sonars of one ring that fire together look too far apart to hear each other in these rooms.
    Case("crosstalk of other robots' sonars", _lasting("noisy sonar share=0.1")),
    Case("bursts of noise, sonars", "noisy sonar share=0.5 start=5 end=7 every=10"),
    Case("infrareds blind to glass", simulator={"infrared.sees_glass": False}),
    Case("infrared ahead blind", _lasting("deaf infrared sensors=0")),
    Case("infrareds blind", _lasting("deaf infrared")),
    Case("infrared ahead dead", _lasting("dead infrared sensors=0")),
    Case("infrared ahead stuck", _lasting("stuck infrared sensors=0")),
    Case("infrareds stuck", _lasting("stuck infrared")),
    Case("infrared dazzled", _lasting("dazzled infrared sensors=3")),
    Case("infrareds 0.05 m too long", _lasting("biased infrared offset=0.05")),
    Case(
        "bursts of noise, infrareds", "noisy infrared range=0.6 share=0.3 start=5 end=7 every=10"
    ),
    Case("ranges 0.3 s late", _lasting("late sonar delay=0.3", "late infrared delay=0.3")),
    Case("poses 0.3 s late", _lasting("late pose delay=0.3")),
    Case("poses 1 s late", _lasting("late pose delay=1")),
    Case("all 0.3 s late", _of_all("late", "delay=0.3", f"start={BEGIN}")),
    Case("30 % of all lost", _of_all("lost")),
    Case("all lost for 0.4 s every 3 s", _of_all("lost", "share=1 start=5 end=5.4 every=3")),
    Case("30 % of all twice", _of_all("duplicated")),
    Case("30 % of all out of order", _of_all("reordered")),
    Case("pose drifts, 2 cm after 1 m", _lasting("drifting pose distance=0.02 theta=0.01")),
    Case("pose drifts, 5 cm after 1 m", _lasting("drifting pose distance=0.05 theta=0.02")),
    Case("pose jumps by 0.15 m", _lasting("jumping pose x=0.15")),
    Case("pose jumps by 0.5 m", _lasting("jumping pose x=0.5")),
    Case("pose jumps by 0.5 rad", _lasting("jumping pose x=0 theta=0.5")),
    Case("pose jumps to and fro", "jumping pose x=0.5 start=8 end=9 every=5"),
    Case("poses stop", _lasting("lost pose share=1")),
    Case("pose stays where it is", _lasting("stuck pose")),
    Case("turret's angle stays as it is", _lasting("stuck turret")),
    Case("clock set back by 0.4 s", _lasting("set_back clock by=0.4")),
    Case("clock set back by 5 s", _lasting("set_back clock by=5")),
)
#: The quick ones: two where it stands, each within a few seconds.
QUICK = ("all sonars dead", "infrared ahead dead")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    options = parse_options("What faults do to missions.", argv, RUNS, WORLDS)
    header = ("fault", "world", "reached", "else", "perceptions", "time", "contacts", "clearance")
    study = Study("faults", "Faults, with the preset 'consistent'", options, header)
    cases = [HEALTHY, *(c for c in CASES if not options.quick or c.name in QUICK)]
    worlds = options.worlds[:1] if options.quick else options.worlds
    seeds = range(options.seed, options.seed + (1 if options.quick else options.seeds))
    tried = [(case, world) for world in worlds for case in cases]
    # Seed by seed, so that a run that is broken off has told of each.
    specs = [_spec(case, world, seed) for seed in seeds for case, world in tried]
    results: dict[int, MissionResult] = {}
    for index, result in run_in_parallel(run_spec, specs, options.jobs):
        results[index] = result
        case, world = tried[index % len(tried)]
        print(f"{len(results)} of {len(specs)}: {case.name}, {world}, {_told(result)}", flush=True)

    found: dict[tuple[str, str], list[MissionResult]] = {}
    for number, (case, world) in enumerate(tried):
        missions = [results[number + i * len(tried)] for i in range(len(seeds))]
        found[case.name, world] = missions
        study.row(*_cells(case, world, missions, found[HEALTHY.name, world]))
    study.note("perceptions and time of the missions that arrived, in those without a fault.")
    study.note("These rules go beyond the paper, which says nothing of faults.")

    missions = [mission for some in found.values() for mission in some]
    touched = {name: sum(m.contacts for m in some) for (name, _), some in found.items()}
    contacts = {name: number for name, number in touched.items() if number}
    study.claim(
        "contact", "nothing is touched, whatever fails", not contacts,
        f"{sum(contacts.values())} contacts in {len(missions)} missions"
        + "".join(f"; {name}: {number}" for name, number in contacts.items()),
    )  # fmt: skip
    mute = [m for m in missions if not m.reached and not m.message]
    study.claim("verdict", "what does not arrive says why", not mute, f"{len(mute)} did not")
    return study.finish(_figure(found, worlds))


def _spec(case: Case, world: str, seed: int) -> MissionSpec:
    row = ROWS[world]
    simulator = {**row.simulator, "faults": case.faults, **case.simulator}
    return MissionSpec(row.world(seed), seed, "consistent", simulator=simulator)


def _told(result: MissionResult) -> str:
    touched = f", {result.contacts} CONTACTS" if result.contacts else ""
    numbers = f"{result.perceptions} perceptions, {result.duration:.0f} s"
    clearance = f"clearance {result.min_clearance:.3f} m"
    told = f"{result.outcome}, {numbers}, {clearance}, {result.message}{touched}"
    return f"seed {result.seed}: {told}"


def _reason(mission: MissionResult) -> str:
    """Return verdict and reason of a mission that did not arrive, without its numbers."""
    why = re.search(r"in vain: ([^;]*)|CLEARANCE: ([^,;]*)", mission.message)
    if why is None:
        return mission.outcome.lower()
    text = why[1] or why[2]
    return f"{mission.outcome.lower()}: {re.sub(r'_?[0-9]+([.][0-9]+)?', '_', text)[:60]}"


def _ratio(mine: Sequence[float], others: Sequence[float]) -> str:
    return f"{statistics.fmean(mine) / statistics.fmean(others):.2f}" if mine and others else "-"


def _cells(
    case: Case, world: str, missions: Sequence[MissionResult], healthy: Sequence[MissionResult]
) -> tuple[str, ...]:
    arrived = [m for m in missions if m.reached]
    reference = [m for m in healthy if m.reached]
    others = Counter(_reason(m) for m in missions if not m.reached)
    return (
        case.name,
        world,
        f"{len(arrived)} of {len(missions)}",
        "; ".join(f"{count} {reason}" for reason, count in others.most_common()) or "-",
        _ratio([float(m.perceptions) for m in arrived], [float(m.perceptions) for m in reference]),
        _ratio([m.duration for m in arrived], [m.duration for m in reference]),
        f"{sum(m.contacts for m in missions)}",
        f"{min(m.min_clearance for m in missions):.3f} m",
    )


def _figure(
    found: Mapping[tuple[str, str], Sequence[MissionResult]], worlds: Sequence[str]
) -> Figure:
    """Return the shares that arrived and the least clearances, a line for each fault."""
    names = list(dict.fromkeys(name for name, _ in found))
    figure = Figure(figsize=(11.0, max(5.0, 0.25 * len(names))), layout="constrained")
    shares, clearances = figure.subplots(1, 2, sharey=True)
    height = 0.8 / len(worlds)
    for k, world in enumerate(worlds):
        some = [found[name, world] for name in names]
        at = [i - 0.4 + (k + 0.5) * height for i in range(len(names))]
        shares.barh(at, [sum(m.reached for m in ms) / len(ms) for ms in some], height, label=world)
        clearances.barh(at, [min(m.min_clearance for m in ms) for ms in some], height)
    shares.set_yticks(range(len(names)), names)
    shares.invert_yaxis()
    shares.set_xlabel("share of missions that arrived")
    clearances.set_xlabel("least clearance [m]")
    shares.legend(loc="lower right", fontsize="small")
    return figure


if __name__ == "__main__":
    sys.exit(main())
