# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulation 2 (section IV-A3, Fig. 11, Table II): a point robot round the small obstacle.

``python test/studies/simulation2.py [--quick] [--seed N] [--output DIR]``
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import quiet_end  # noqa: F401  before all that takes time

# isort: split

import numpy as np
from guided_run import OBSTACLE, GuidedRun, guided_run
from planning_study import (
    EPSILON,
    HEADER,
    MAPS,
    OTHER_EPSILONS,
    ROUNDING,
    Found,
    PathClaim,
    Paths,
    add_claims,
    add_rows,
    draw_paths,
    each,
    find_paths,
    finished_planner,
    note_others,
)
from study import Study, parse_options

from fuzzy_map_building.types import wrap_angle

#: Table II: g1, g2, g3, cells in the path, expanded cells, computing time [s].
PAPER = {
    "A1": (3.11, 1.43, 0.60, 9, 108, 0.09),
    "A2": (3.71, 0.69, 0.50, 25, 168, 0.16),
    "A3": (5.81, 1.22, 0.50, 35, 65, 0.01),
}
#: Risk of the start cell in the paper.
START_RISK = 0.5
#: Where the start is looked for, left of the obstacle: x0, y0, x1, y1 [m].
LEFT = (8.3, 5.8, 8.9, 6.3)
#: Part of the map that is shown: x0, y0, x1, y1 [m].
VIEW = (7.4, 4.8, 10.7, 7.6)
#: How much slimmer the obstacle is in the map that is tried besides [m].
SLIMMER = 0.1


def _turn(path: Found) -> float:
    """Return the angle [rad] by which a path turns about the obstacle, counterclockwise > 0."""
    x, y = (path.xy - OBSTACLE).T
    return math.fsum(wrap_angle(float(step)) for step in np.diff(np.arctan2(y, x)))


def _sense(path: Found) -> str:
    return "counterclockwise" if _turn(path) > 0.0 else "clockwise"


CLAIMS = (
    PathClaim(
        "shortest",
        "A1's path is the shortest",
        lambda p: p["A1"].cells < min(p["A2"].cells, p["A3"].cells),
        lambda p: each(p, "cells", 0),
    ),
    PathClaim(
        "longest",
        "A3's path is the longest",
        lambda p: p["A3"].cells > max(p["A1"].cells, p["A2"].cells),
        lambda p: each(p, "cells", 0),
    ),
    PathClaim(
        "between",
        "A2's path is longer than A1's and shorter than A3's",
        lambda p: p["A1"].cells < p["A2"].cells < p["A3"].cells,
        lambda p: each(p, "cells", 0),
    ),
    PathClaim(
        "sum",
        "the sum of risks rises from A1 to A2 to A3",
        lambda p: p["A1"].g1 < p["A2"].g1 - ROUNDING and p["A2"].g1 < p["A3"].g1 - ROUNDING,
        lambda p: each(p, "g1"),
    ),
    PathClaim(
        "squares",
        "the sum of squares rises from A2 to A3 to A1",
        lambda p: p["A2"].g2 < p["A3"].g2 - ROUNDING and p["A3"].g2 < p["A1"].g2 - ROUNDING,
        lambda p: each(p, "g2"),
    ),
    PathClaim(
        "maximum",
        "A1's path has the highest maximum",
        lambda p: p["A1"].g3 > max(p["A2"].g3, p["A3"].g3) + ROUNDING,
        lambda p: each(p, "g3"),
    ),
    PathClaim(
        "start",
        "on A2's and A3's path the risk never rises beyond that of the start",
        lambda p: all(p[n].g3 <= p[n].risks[0] for n in ("A2", "A3")),
        lambda p: f"{each(p, 'g3')}, start {p['A1'].risks[0]:.2f}",
    ),
    PathClaim(
        "sides",
        "A1 takes one side of the obstacle, A2 and A3 the other",
        lambda p: _sense(p["A2"]) == _sense(p["A3"]) != _sense(p["A1"]),
        lambda p: ", ".join(f"{name} {_sense(path)}" for name, path in p.items()),
    ),
    PathClaim(
        "fewest",
        "A3 expands the fewest cells",
        lambda p: p["A3"].expanded < min(p["A1"].expanded, p["A2"].expanded),
        lambda p: each(p, "expanded", 0),
    ),
    PathClaim(
        "most",
        "A2 expands the most cells",
        lambda p: p["A2"].expanded > max(p["A1"].expanded, p["A3"].expanded),
        lambda p: each(p, "expanded", 0),
    ),
    PathClaim(
        "fastest",
        "A3 is the fastest",
        lambda p: p["A3"].seconds < min(p["A1"].seconds, p["A2"].seconds),
        lambda p: each(p, "seconds", 5),
    ),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    options = parse_options("Simulation 2: round the small obstacle of Fig. 8.", argv)
    study = Study(
        "simulation2", "Simulation 2 (Table II): round the small obstacle", options, HEADER
    )
    seeds = range(options.seed, options.seed + (1 if options.quick else MAPS))
    runs = [guided_run(seed) for seed in seeds]
    found = [_paths(run, EPSILON) for run in runs]
    maps = [paths for paths in found if paths is not None]
    if found[0] is None:
        raise RuntimeError(f"no path round the obstacle with seed {options.seed}; try another")
    add_rows(study, maps[0], PAPER)
    study.note(
        f"Risk of the start cell {maps[0]['A1'].risks[0]:.2f} (paper: {START_RISK:g}), epsilon "
        f"{EPSILON:g}; the start is the cell left of the obstacle whose risk is the nearest to "
        "the paper's, the goal the cell point-symmetric to it."
    )
    add_claims(study, CLAIMS, maps)
    if not options.quick:
        for epsilon in OTHER_EPSILONS:
            note_others(study, CLAIMS, f"With epsilon {epsilon:g}", _paths(runs[0], epsilon))
        slim = guided_run(options.seed, widening=SLIMMER)
        condition = f"With an obstacle that is {SLIMMER:g} m slimmer"
        note_others(study, CLAIMS, condition, _paths(slim, EPSILON))
    title = f"Simulation 2, seed {options.seed}: a point"
    return study.finish(draw_paths(runs[0], maps[0], title, VIEW))


def _paths(run: GuidedRun, epsilon: float) -> Paths | None:
    """Plan for a point from one side of the obstacle to the other."""
    planner = finished_planner(run, epsilon, robot_radius=0.0)
    return find_paths(planner, *_ends(run))


def _ends(run: GuidedRun) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return start and goal (x, y) [m] on opposite sides of the obstacle."""
    geometry = run.mapper.geometry
    x, y = geometry.centres()
    x0, y0, x1, y1 = LEFT
    left = ((x0 <= x) & (x <= x1))[None, :] & ((y0 <= y) & (y <= y1))[:, None]
    risk = run.mapper.planning_risk + EPSILON
    off = np.where(left, np.abs(risk - START_RISK), np.inf)
    row, column = divmod(int(np.argmin(off)), geometry.width)
    start = geometry.centre_of(row, column)
    return start, (2.0 * OBSTACLE[0] - start[0], 2.0 * OBSTACLE[1] - start[1])


if __name__ == "__main__":
    sys.exit(main())
