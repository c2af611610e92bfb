# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What each piece of the preset ``consistent`` buys: missions with one piece switched off.

``python test/studies/ablation.py [--quick] [--seed N] [--output DIR]``
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import quiet_end  # noqa: F401  before all that takes time

# isort: split

import numpy as np
from matplotlib.figure import Figure
from study import Study, parse_options

from fuzzy_map_building.params import DEFAULT_PRESET
from fuzzy_map_building.types import Pose2
from nomad_sim.missions import MissionResult, MissionSpec, run_spec
from nomad_sim.reference import ROWS, Row
from nomad_sim.workers import run_in_parallel
from nomad_sim.world import Wall, World
from nomad_sim.worlds.shapes import OUTSIDE, outer_walls

RUNS = 20
#: A way that is longer by this factor counts as worse.
WORSE = 1.05


@dataclass(frozen=True)
class Piece:
    """A rule that can be switched off, and the parameters that do so."""

    name: str
    mapper: Mapping[str, Any] = field(default_factory=dict)
    planner: Mapping[str, Any] = field(default_factory=dict)
    motion: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Case:
    """A world, with infrareds that see glass or do not."""

    row: Row
    sees_glass: bool = True

    def __str__(self) -> str:
        return self.row.name + ("" if self.sees_glass else ", infrareds blind to glass")


def _thin_walls(_: int) -> World:
    """Return a room with a wall without thickness across it, and an opening of 0.65 m in it."""
    size, x, low, high = (6.0, 4.0), 3.0, 1.675, 2.325
    ends = ((-OUTSIDE, low), (high, size[1] + OUTSIDE))
    across = tuple(Wall(np.array([(x, a), (x, b)]), "painted_wall") for a, b in ends)
    walls = (*outer_walls(size, ["painted_wall"]), *across)
    start = Pose2(1.0, 1.0, 0.0)
    return World("thin_0.65", (0.0, 0.0), size, start, (5.0, 3.0), "reached", walls)


NO_GUARD = {"sonar_guard.enabled": False}
SQUARE = {"augmentation": "square"}
COMPLETE = Piece("complete")
PIECES = (
    Piece("consistency", mapper={"consistency.enabled": False}),
    Piece("infrared", mapper={"infrared_evidence.enabled": False}),
    Piece("guard", mapper=NO_GUARD, motion=NO_GUARD),
    Piece(
        "layer",
        planner={"layer.enabled": False},
        motion={"layer.enabled": False, "clearance.rule": "closing"},
    ),
    Piece("subcell", motion={"subcell_target": False}),
    Piece("rung", planner={"rung_choice": "first"}),
    Piece("disc", mapper={"evidence.range_margin": 0.15}, planner=SQUARE, motion=SQUARE),
    Piece("diagonal", planner={"diagonal": "unit"}),
    Piece("memory", motion={"refusal_memory": 0}),
    Piece("looks", motion={"frontier_looks": 0}),
    Piece("turn", motion={"look_turn": 0.0}),
    Piece("least risk", planner={"least_risk": 0.0}),
    Piece("recall", motion={"clearance.recall": 0.0}),
)
CASES = (
    Case(ROWS["lab_70_70_70_beam_12.5"]),
    Case(ROWS["lab_40_25_8_beam_10"], sees_glass=False),
    Case(ROWS["gaps_0.70"]),
    Case(ROWS["gaps_0.65"]),
    Case(ROWS["office"]),
    Case(ROWS["slalom_0.70"]),
    Case(Row("thin_0.65", "walls without thickness 0.65 m apart", _thin_walls, reached={})),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    options = parse_options("What each piece of the preset 'consistent' buys.", argv)
    header = ("without", "world", "reached", "perceptions", "path", "clearance", "contacts")
    study = Study("ablation", "The preset 'consistent', piece by piece", options, header)
    cases = CASES[:1] if options.quick else CASES
    seeds = range(options.seed, options.seed + (1 if options.quick else RUNS))
    tried = [(piece, case) for piece in (COMPLETE, *PIECES) for case in cases]
    specs = [_spec(piece, case, seed) for piece, case in tried for seed in seeds]
    results: dict[int, MissionResult] = dict(run_in_parallel(run_spec, specs, options.jobs))

    found = {}
    for number, (piece, case) in enumerate(tried):
        first = number * len(seeds)
        found[piece.name, case] = [results[i] for i in range(first, first + len(seeds))]
        study.row(*_cells(piece, case, found[piece.name, case]))
    study.note("These rules go beyond the paper; its own are the preset 'oriolo1998'.")

    missions = [mission for case in cases for mission in found[COMPLETE.name, case]]
    arrived = sum(mission.reached for mission in missions)
    contacts = sum(mission.contacts for mission in missions)
    study.claim(
        "complete",
        "with all pieces every mission arrives without contact",
        arrived == len(missions) and contacts == 0,
        f"{arrived} of {len(missions)}, {contacts} contacts",
    )
    for piece in PIECES:
        losses = [
            loss
            for case in cases
            if (loss := _loss(found[COMPLETE.name, case], found[piece.name, case]))
        ]
        study.claim(
            piece.name,
            f"without it fewer arrive, something is touched, or the way is {WORSE} times as long",
            bool(losses),
            f"in {len(losses)} of {len(cases)} worlds" + "".join(f"; {loss}" for loss in losses),
        )
    return study.finish(_figure(found, cases))


def _spec(piece: Piece, case: Case, seed: int) -> MissionSpec:
    row = case.row
    return MissionSpec(
        row.world(seed),
        seed,
        DEFAULT_PRESET,
        mapper=piece.mapper,
        planner=piece.planner,
        motion=piece.motion,
        simulator={**row.simulator, "infrared.sees_glass": case.sees_glass},
    )


def _arrived(missions: Sequence[MissionResult]) -> list[MissionResult]:
    return [mission for mission in missions if mission.reached]


def _mean_path(missions: Sequence[MissionResult]) -> float:
    """Return the mean length of the ways that arrived [m]; 0 if none did."""
    lengths = [mission.path_length for mission in _arrived(missions)]
    return statistics.fmean(lengths) if lengths else 0.0


def _cells(piece: Piece, case: Case, missions: Sequence[MissionResult]) -> tuple[str, ...]:
    arrived = _arrived(missions)
    perceptions = [float(mission.perceptions) for mission in arrived]
    return (
        "nothing" if piece is COMPLETE else piece.name,
        str(case),
        f"{len(arrived)} of {len(missions)}",
        f"{statistics.fmean(perceptions):.1f}" if arrived else "-",
        f"{_mean_path(missions):.1f} m" if arrived else "-",
        f"{min(mission.min_clearance for mission in missions):.3f} m",
        f"{sum(mission.contacts for mission in missions)}",
    )


def _loss(complete: Sequence[MissionResult], without: Sequence[MissionResult]) -> str:
    """Return what got worse without a piece; empty if nothing did."""
    contacts = sum(mission.contacts for mission in without)
    fewer = len(_arrived(complete)) - len(_arrived(without))
    if contacts > sum(mission.contacts for mission in complete):
        return f"{contacts} contacts"
    if fewer > 0:
        return f"{fewer} fewer"
    longer = _mean_path(without) / max(_mean_path(complete), 1e-9)
    return f"{longer:.2f} times the way" if longer >= WORSE else ""


def _figure(
    found: Mapping[tuple[str, Case], Sequence[MissionResult]], cases: Sequence[Case]
) -> Figure:
    """Return the missions that arrived, a group of bars for each piece left out."""
    figure = Figure(figsize=(10.0, 5.0), layout="constrained")
    axes = figure.add_subplot()
    names = [COMPLETE.name, *(piece.name for piece in PIECES)]
    width = 0.8 / len(cases)
    for k, case in enumerate(cases):
        shares = [len(_arrived(found[name, case])) / len(found[name, case]) for name in names]
        places = [i - 0.4 + (k + 0.5) * width for i in range(len(names))]
        axes.bar(places, shares, width, label=str(case))
    axes.set_xticks(range(len(names)), [names[0], *(f"no {name}" for name in names[1:])])
    axes.set_ylabel("share of missions that arrived")
    axes.legend(loc="lower right", fontsize="small")
    return figure


if __name__ == "__main__":
    sys.exit(main())
