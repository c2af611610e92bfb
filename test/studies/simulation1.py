# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulation 1 (section IV-A3, Fig. 10, Table I): from the room to the end of the corridor.

``python test/studies/simulation1.py [--quick] [--seed N] [--output DIR]``
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import quiet_end  # noqa: F401  before all that takes time

# isort: split

import numpy as np
from guided_run import GuidedRun, guided_run
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

#: Table I: g1, g2, g3, cells in the path, expanded cells, computing time [s].
PAPER = {
    "A1": (21.80, 5.34, 0.50, 121, 2066, 3.13),
    "A2": (21.80, 5.34, 0.50, 121, 2394, 6.21),
    "A3": (45.50, 17.13, 0.50, 145, 378, 0.08),
}
START, GOAL = (13.0, 2.5), (1.55, 5.95)
ROBOT_RADIUS = 0.23
#: How much the narrow places of the world `corridor` are widened, until there is a path [m].
WIDENINGS = (0.0, 0.1, 0.2, 0.3, 0.4)
#: The narrow crossing between room and corridor: x0, y0, x1, y1 [m].
CROSSING = (10.6, 4.5, 12.25, 5.35)


def _spot(path: Found) -> tuple[float, float]:
    """Return where the highest risk of a path is met first (x, y) [m]."""
    x, y = path.xy[int(np.argmax(path.risks))].tolist()
    return x, y


def _in_crossing(path: Found) -> bool:
    (x, y), (x0, y0, x1, y1) = _spot(path), CROSSING
    return x0 <= x <= x1 and y0 <= y <= y1


CLAIMS = (
    PathClaim(
        "coincide",
        "the paths of A1 and A2 coincide",
        lambda p: np.array_equal(p["A1"].xy, p["A2"].xy),
        lambda p: f"{_shared(p)} of {p['A1'].cells} cells in common",
    ),
    PathClaim(
        "longer",
        "A3's path has more cells (1.2 times in the paper)",
        lambda p: p["A3"].cells > max(p["A1"].cells, p["A2"].cells),
        lambda p: f"{p['A3'].cells / p['A1'].cells:.2f} times",
    ),
    PathClaim(
        "riskier",
        "A3's path is riskier in sum: g1 and g2 are higher (2.1 and 3.2 times in the paper)",
        lambda p: p["A3"].g1 > p["A1"].g1 and p["A3"].g2 > p["A2"].g2,
        lambda p: f"{p['A3'].g1 / p['A1'].g1:.2f} and {p['A3'].g2 / p['A2'].g2:.2f} times",
    ),
    PathClaim(
        "maximum",
        "the maximum risk of all three is the same",
        lambda p: max(f.g3 for f in p.values()) - min(f.g3 for f in p.values()) < ROUNDING,
        lambda p: each(p, "g3"),
    ),
    PathClaim(
        "crossing",
        "it is met in the narrow crossing between room and corridor",
        lambda p: all(_in_crossing(path) for path in p.values()),
        lambda p: ", ".join("{} at ({:.2f}, {:.2f}) m".format(n, *_spot(p[n])) for n in p),
    ),
    PathClaim(
        "fewest",
        "A3 expands the fewest cells (0.18 times A1's in the paper)",
        lambda p: p["A3"].expanded < min(p["A1"].expanded, p["A2"].expanded),
        lambda p: f"{p['A3'].expanded / p['A1'].expanded:.2f} times",
    ),
    PathClaim(
        "most",
        "A2 expands more cells than A1 (1.16 times in the paper)",
        lambda p: p["A2"].expanded > p["A1"].expanded,
        lambda p: f"{p['A2'].expanded / p['A1'].expanded:.2f} times",
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
    options = parse_options("Simulation 1: planning on the finished map of Fig. 8.", argv)
    study = Study(
        "simulation1", "Simulation 1 (Table I): from the room to the corridor", options, HEADER
    )
    run, widening, paths = _first_passable(options.seed)
    maps = [paths]
    for seed in range(options.seed + 1, options.seed + (1 if options.quick else MAPS)):
        maps.append(_first_passable(seed)[2])
    add_rows(study, paths, PAPER)
    study.note(
        f"Straight distance {math.dist(START, GOAL):.1f} m (paper: about 12 m), epsilon "
        f"{EPSILON:g}, narrow places widened by {widening:g} m."
    )
    study.claim(
        "passable",
        f"a robot of {ROBOT_RADIUS:g} m, 5 x 5 cells, has a way at alpha 0.6 through the door of "
        "0.85 m and past the obstacle of 0.3 m",
        widening == 0.0,
        "as they are"
        if widening == 0.0
        else f"only when door and gap are {widening:g} m wider; all else is judged there",
    )
    add_claims(study, CLAIMS, maps)
    for epsilon in () if options.quick else OTHER_EPSILONS:
        others = find_paths(finished_planner(run, epsilon, ROBOT_RADIUS), START, GOAL)
        note_others(study, CLAIMS, f"With epsilon {epsilon:g}", others)
    title = f"Simulation 1, seed {options.seed}: robot of {ROBOT_RADIUS:g} m"
    if widening > 0.0:
        title += f", narrow places widened by {widening:g} m"
    return study.finish(draw_paths(run, paths, title))


def _first_passable(seed: int) -> tuple[GuidedRun, float, Paths]:
    """Widen the narrow places until there are paths; the paper does not give its widths."""
    for widening in WIDENINGS:
        run = guided_run(seed, widening=widening)
        paths = find_paths(finished_planner(run, EPSILON, ROBOT_RADIUS), START, GOAL)
        if paths is not None:
            return run, widening, paths
    raise RuntimeError(f"no path even where all is {WIDENINGS[-1]:g} m wider; try another seed")


def _shared(paths: Paths) -> int:
    """Return how many cells of A1's path belong to A2's as well."""
    one, other = ({tuple(c) for c in paths[n].xy.tolist()} for n in ("A1", "A2"))
    return len(one & other)


if __name__ == "__main__":
    sys.exit(main())
