# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Experiment 2 (section V, Figs. 17-20): a person stands in the opening, and leaves.

``python test/studies/experiment2.py [--quick] [--seed N] [--output DIR]``
"""

from __future__ import annotations

import statistics
import sys
from collections import Counter
from collections.abc import Sequence

import quiet_end  # noqa: F401  before all that takes time

# isort: split

from matplotlib.figure import Figure
from mission_study import PERSON, PERSON_STAYS, Run, Watched, crosses_opening, spread, watch_all
from study import NOT_GIVEN, Study, parse_options

from nomad_sim.render import Panel, draw_panels

DURATION = 120.0
RUNS = 20
#: First rung of the ladder, and the one that the paper goes to.
FIRST_RUNG, NEXT_RUNG = 0.6, 0.7
#: Visibility radius rho_v [m].
VISIBILITY = 1.5


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    options = parse_options("Experiment 2: a person who stands in the way, and leaves.", argv)
    study = Study("experiment2", "Experiment 2: a person who stands in the way", options)
    runs = watch_all("lab_person", options.seed, 1 if options.quick else RUNS, options.jobs)
    logs = [run.log for run in runs]
    reached = [log.reached for log in logs]
    rungs = [_first_higher_rung(run) for run in runs]
    turned = [any(not crosses_opening(w.plan) for w in _obstructed(run)) for run in runs]
    seen = [max(w.person for w in run.watched) for run in runs]
    left = [run.watched[-1].person for run in runs]
    passed = [crosses_opening(log.travelled) for log in logs]
    duration = [log.duration for log in logs]

    study.row("runs", "1", f"{len(runs)} (seeds {options.seed} to {logs[-1].seed})")
    study.row("goal reached", "1", f"{sum(reached)}")
    study.row("perceptions", NOT_GIVEN, spread([float(log.perceptions) for log in logs]))
    study.row("time", "about 2 min", spread(duration, 0, " s"))
    study.row("path", NOT_GIVEN, spread([log.path_length for log in logs], 1, " m"))
    study.row("contacts", NOT_GIVEN, f"{sum(log.contacts for log in logs)}")
    study.row("planner fails at alpha 0.6", "yes", f"{sum(r > 0.0 for r in rungs)}")
    study.row("first rung above with a path", "0.7", _counted(rungs))
    study.row("belief of occupied where it stands: most", "high", spread(seen, 2))
    study.row("the same at the end", "slight trace", spread(left, 2))
    higher = [sum(w.rung > FIRST_RUNG for w in run.watched) for run in runs]
    study.row("paths above 0.6 in a run", "1 or more", spread([float(n) for n in higher], 1))

    study.claim(
        "reached",
        "the robot reaches its goal, every time",
        all(reached),
        f"{sum(reached)} of {len(runs)}",
    )
    contacts = sum(log.contacts for log in logs)
    study.claim("contact", "it touches nothing", contacts == 0, f"{contacts} contacts")
    study.claim(
        "alternative",
        "while the person stands in the opening, it looks for another way",
        all(turned),
        f"{sum(turned)} of {len(runs)}",
    )
    study.claim(
        "fails",
        "the planner finds no path at alpha 0.6",
        all(rung > 0.0 for rung in rungs),
        f"{sum(rung > 0.0 for rung in rungs)} of {len(runs)}",
    )
    study.claim(
        "rung",
        "and then finds one at 0.7",
        all(rung == NEXT_RUNG for rung in rungs),
        f"first rung with a path: {_counted(rungs)}",
    )
    study.claim(
        "passes",
        "it comes back when the person has left, and passes through the opening",
        all(passed),
        f"{sum(passed)} of {len(runs)}",
    )
    erased = [end <= 0.5 * most for most, end in zip(seen, left, strict=True)]
    study.claim(
        "erased",
        "the person's trace is erased: the belief of occupied falls to less than half",
        all(erased),
        f"{sum(erased)} of {len(runs)}",
    )
    study.claim(
        "trace",
        "a slight trace is left all the same: a belief of occupied of 0.01 or more",
        all(end >= 0.01 for end in left),
        f"{min(left):.3f} to {max(left):.3f}",
    )
    mean = statistics.fmean(duration)
    study.claim(
        "time",
        "about 2 min of robot time: 80 s to 180 s on average",
        DURATION / 1.5 <= mean <= 1.5 * DURATION,
        f"{mean:.0f} s",
    )
    return study.finish(_figure(runs[0]))


def _obstructed(run: Run) -> tuple[Watched, ...]:
    """Return what came while the person stood there, from when the robot was near enough."""
    there = run.watched[:PERSON_STAYS]
    near = (i for i, w in enumerate(there) if _near_person(w))
    return there[next(near, len(there)) :]


def _near_person(watched: Watched) -> bool:
    """Whether the perception's circle of visibility reached the person."""
    robot = watched.moment.scene.robot
    return robot is not None and robot.distance_to(*PERSON) <= VISIBILITY


def _first_higher_rung(run: Run) -> float:
    """Return the first rung above 0.6 on which a path was found; 0 if none was needed."""
    return next((w.rung for w in run.watched if w.rung > FIRST_RUNG), 0.0)


def _counted(rungs: Sequence[float]) -> str:
    """Return how often which rung came first."""
    return ", ".join(f"{rung:g}: {n}" for rung, n in sorted(Counter(rungs).items()))


def _figure(run: Run) -> Figure:
    """Return M_m at the moments of the paper's Figs. 17-20, as far as the run had them."""
    watched = run.watched
    failed = next((i for i, w in enumerate(watched) if w.rung > FIRST_RUNG), None)
    back = [i for i, w in enumerate(watched) if i >= PERSON_STAYS and crosses_opening(w.plan)]
    moments = [
        ("the opening is obstructed", next(iter(_obstructed(run)), watched[0]).moment),
        ("no path at 0.6", watched[-1 if failed is None else failed].moment),
        ("the opening is free", watched[back[0] if back else -1].moment),
        ("the end", run.end),
    ]
    panels = [
        Panel(
            m.geometry,
            m.motion_risk,
            m.scene,
            f"$M_m$ after perception {m.perceptions}: {text}",
        )
        for text, m in moments
    ]
    title = f"Experiment 2, seed {run.log.seed}: {run.log.outcome.name.lower()}"
    return draw_panels([panels[:2], panels[2:]], title)


if __name__ == "__main__":
    sys.exit(main())
