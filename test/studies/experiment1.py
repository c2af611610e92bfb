# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Experiment 1 (section V, Figs. 13-16): across an unknown, static laboratory to the goal.

``python test/studies/experiment1.py [--quick] [--seed N] [--output DIR]``
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Sequence

import quiet_end  # noqa: F401  before all that takes time

# isort: split

import numpy as np
from matplotlib.figure import Figure
from mission_study import Run, crosses_opening, length, spread, watch_all
from numpy.typing import NDArray
from study import NOT_GIVEN, Study, parse_options

from nomad_sim.render import Panel, draw_panels
from nomad_sim.world_io import load_world

PERCEPTIONS, DURATION = 22, 120.0
#: Perceptions after which the paper shows M_m, besides the last.
MOMENTS = (4, 5, 13)
RUNS = 20
BETA = 0.9
#: The opening and the passage beside the cabinet, with half a metre before and behind:
#: x0, y0, x1, y1 [m].
NARROW = ((2.7, 2.2, 4.7, 3.1), (6.7, 3.6, 7.6, 4.9))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    options = parse_options("Experiment 1: a static laboratory.", argv)
    study = Study("experiment1", "Experiment 1: a static laboratory", options)
    runs = watch_all("lab", options.seed, 1 if options.quick else RUNS, options.jobs)
    logs = [run.log for run in runs]
    count = [float(log.perceptions) for log in logs]
    duration = [log.duration for log in logs]
    share = [100.0 * run.perceiving / run.log.duration for run in runs]
    straight = np.hypot(logs[0].start.x - logs[0].goal[0], logs[0].start.y - logs[0].goal[1])
    first = [length(run.watched[0].plan) / straight for run in runs]
    retreat = [_retreat(run) for run in runs]
    crossed = [crosses_opening(log.travelled) for log in logs]
    narrow, wide = zip(*(_stops_per_metre(run) for run in runs), strict=True)
    wrong, known = zip(*(_accuracy(run) for run in runs), strict=True)
    reached = sum(log.reached for log in logs)

    study.row("runs", "1", f"{len(runs)} (seeds {options.seed} to {logs[-1].seed})")
    study.row("goal reached", "1", f"{reached}")
    study.row("perceptions", f"{PERCEPTIONS}", spread(count))
    study.row("time", "about 2 min", spread(duration, 0, " s"))
    study.row("of it perceiving", "about 70 %", spread(share, 0, " %"))
    study.row("path", NOT_GIVEN, spread([log.path_length for log in logs], 1, " m"))
    study.row("contacts", NOT_GIVEN, f"{sum(log.contacts for log in logs)}")
    clearance = [100.0 * log.min_clearance for log in logs]
    study.row("least true clearance", NOT_GIVEN, spread(clearance, 1, " cm"))
    study.row("stops per metre, narrow places", "more", spread(narrow, 2))
    study.row("stops per metre, elsewhere", "fewer", spread(wide, 2))
    study.row("safe on M_m, in truth occupied", "few", spread(wrong, 1, " %"))
    study.row("free in truth, safe on M_m", NOT_GIVEN, spread(known, 0, " %"))
    study.note(
        "The paper spends most of its perception time on a radio link, which the simulated "
        "robot does not have."
    )

    mean = statistics.fmean(count)
    study.claim(
        "reached",
        "the robot reaches its goal without contact, every time",
        all(log.reached and log.contacts == 0 for log in logs),
        f"{reached} of {len(runs)}",
    )
    study.claim(
        "perceptions",
        f"half to one and a half times the paper's {PERCEPTIONS} perceptions on average",
        0.5 * PERCEPTIONS <= mean <= 1.5 * PERCEPTIONS,
        f"{mean:.1f}",
    )
    mean = statistics.fmean(duration)
    study.claim(
        "time",
        "about 2 min of robot time: 80 s to 180 s on average",
        DURATION / 1.5 <= mean <= 1.5 * DURATION,
        f"{mean:.0f} s",
    )
    direct = [not crosses_opening(run.watched[0].plan) for run in runs]
    study.claim(
        "direct",
        "first it makes for the goal through the wall that it does not know yet",
        all(direct),
        f"{sum(direct)} of {len(runs)}",
    )
    study.claim(
        "straight",
        "that first path is a straight one: at most 1.1 times the distance",
        max(first) <= 1.1,
        f"{max(first):.2f} times at most; a diagonal step costs no more than a straight one",
    )
    detour = [any(crosses_opening(w.plan) for w in run.watched[1:]) for run in runs]
    study.claim(
        "detour",
        "once the wall is detected, a path leads round through the opening",
        all(detour),
        f"{sum(detour)} of {len(runs)}",
    )
    study.claim(
        "backtracks",
        "it backtracks: by a metre or more away from the goal",
        min(retreat) >= 1.0,
        f"{min(retreat):.1f} m at least",
    )
    study.claim(
        "opening",
        "it crosses the opening between the two large obstacles",
        all(crossed),
        f"{sum(crossed)} of {len(runs)}",
    )
    mean_narrow, mean_wide = statistics.fmean(narrow), statistics.fmean(wide)
    study.claim(
        "narrow",
        "it stops more often per metre in narrow places than elsewhere, on average",
        mean_narrow > mean_wide,
        f"{mean_narrow:.2f} against {mean_wide:.2f}",
    )
    study.claim(
        "accurate",
        "the final map is fairly accurate: of the cells in the beta-cut at most 5 % are occupied",
        max(wrong) <= 5.0,
        f"{max(wrong):.1f} % at most",
    )
    return study.finish(_figure(runs[0]))


def _retreat(run: Run) -> float:
    """Return the most that the robot went away from the goal after having been nearer [m]."""
    way = run.log.travelled
    distance = np.hypot(way[:, 0] - run.log.goal[0], way[:, 1] - run.log.goal[1])
    return float((distance - np.minimum.accumulate(distance)).max())


def _stops_per_metre(run: Run) -> tuple[float, float]:
    """Return how often the robot perceived per metre of way: in narrow places, and elsewhere."""
    way = run.log.travelled
    steps = np.hypot(*np.diff(way, axis=0).T)
    there = _in_narrow(way[1:])
    # The first perception is where the mission begins, not a stop.
    stops = _in_narrow(np.array([(e.pose.x, e.pose.y) for e in run.log.entries[1:]]))
    inside, outside = float(steps[there].sum()), float(steps[~there].sum())
    return (
        float(stops.sum()) / inside if inside else 0.0,
        float((~stops).sum()) / outside if outside else 0.0,
    )


def _in_narrow(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    x, y = points.reshape(-1, 2).T
    inside = np.zeros(x.shape, dtype=bool)
    for x0, y0, x1, y1 in NARROW:
        inside |= (x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1)
    return inside


def _accuracy(run: Run) -> tuple[float, float]:
    """Return the occupied share of the beta-cut, and the share of free space in it [%]."""
    geometry = run.end.geometry
    x, y = geometry.centres()
    surfaces = load_world(run.log.world).surfaces()
    free = surfaces.distances(x, y) > 0.0
    safe = run.log.motion_risk <= BETA
    return (
        100.0 * float((safe & ~free).sum()) / max(1, int(safe.sum())),
        100.0 * float((safe & free).sum()) / int(free.sum()),
    )


def _figure(run: Run) -> Figure:
    """Return M_m at the paper's moments; a run that was over earlier repeats its end."""
    shown = [
        run.watched[k - 1].moment if k < len(run.watched) else run.end
        for k in (*MOMENTS, len(run.watched))
    ]
    panels = [
        Panel(m.geometry, m.motion_risk, m.scene, f"$M_m$ after perception {m.perceptions}")
        for m in shown
    ]
    title = f"Experiment 1, seed {run.log.seed}: {run.log.outcome.name.lower()}"
    return draw_panels([panels[:2], panels[2:]], title)


if __name__ == "__main__":
    sys.exit(main())
