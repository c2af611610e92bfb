# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fig. 8 (section III-C3): the map of a corridor and a room from 43 guided perceptions.

``python test/studies/figure8.py [--quick] [--seed N] [--output DIR]``
"""

from __future__ import annotations

import math
import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import quiet_end  # noqa: F401  before all that takes time

# isort: split

import numpy as np
from guided_run import PERCEPTIONS, GuidedRun, guided_run
from matplotlib.figure import Figure
from scipy import ndimage
from study import NOT_GIVEN, Study, parse_options

from nomad_sim.ground_truth import occupancy
from nomad_sim.render import Panel, Scene, draw_panels
from nomad_sim.world import MATERIALS

RUNS = 10
#: Values of M_m from which on a cell counts as dark, of M_p from which on as occupied.
BETA, OCCUPIED = 0.9, 0.5
#: Distance from a true surface within which a cell judged occupied is right [m].
ACCURACY = 0.2
#: Distance from the way within which, and from surfaces beyond which, a cell has to be light [m].
NEAR_WAY, OFF_SURFACE = 1.0, 0.25
#: What lies farther behind the walls than this is "beyond" them [m].
BEYOND = 0.15


@dataclass(frozen=True)
class Quality:
    """How a map compares with the truth.

    Parameters
    ----------
    accurate : float
        Share of the cells judged occupied that lie at a true surface [%].
    light : float
        Share of the open space near the way that is light [%].
    beyond : int
        Cells beyond the walls that are not quite dark.
    open : int
        Cells of the open space.
    """

    accurate: float
    light: float
    beyond: int
    open: int


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study."""
    options = parse_options("Fig. 8: the map of a corridor and a room.", argv)
    study = Study("figure8", "Fig. 8: the map of a corridor and a room", options)
    seeds = range(options.seed, options.seed + (1 if options.quick else RUNS))
    runs = [guided_run(seed) for seed in seeds]
    # The same runs where every surface sends the sound back: no false reflections.
    rough = dict.fromkeys(MATERIALS, 0.5 * math.pi)
    rough_runs = [guided_run(seed, rough) for seed in seeds]
    quality = [_quality(run) for run in runs]
    rough_quality = [_quality(run) for run in rough_runs]

    geometry = runs[0].mapper.geometry
    evidence = runs[0].mapper.parameters.evidence
    update = statistics.median(t for run in runs for t in run.update_times)
    accurate = statistics.fmean(q.accurate for q in quality)
    light = statistics.fmean(q.light for q in quality)
    beyond = 100.0 * statistics.fmean(q.beyond / q.open for q in quality)
    rough_beyond = 100.0 * statistics.fmean(q.beyond / q.open for q in rough_quality)
    study.row("runs", "1", f"{len(runs)} (seeds {seeds[0]} to {seeds[-1]})")
    study.row("cells", "180 x 120", f"{geometry.width} x {geometry.height}")
    study.row("cell", "0.1 m", f"{geometry.resolution:g} m")
    study.row("k_E, k_O", "0.1, 0.25", f"{evidence.k_empty:g}, {evidence.k_occupied:g}")
    study.row("aggregation", "Dombi union", runs[0].mapper.parameters.fusion.aggregation)
    study.row("perceptions", f"{PERCEPTIONS}", f"{runs[0].mapper.perceptions}")
    study.row("readings", f"{PERCEPTIONS * 48}", f"{runs[0].readings}")
    study.row("update of the map", "about 0.2 s", f"{1000.0 * update:.1f} ms")
    study.row("occupied cells at a true surface", "satisfactory", f"{accurate:.1f} %")
    study.row("open space near the way that is light", "satisfactory", f"{light:.1f} %")
    study.row("not quite dark beyond walls, of open", "small areas", f"{beyond:.1f} %")
    study.row("the same without false reflections", NOT_GIVEN, f"{rough_beyond:.1f} %")

    contacts = sum(run.contacts for run in runs)
    study.claim(
        "perceptions",
        f"{PERCEPTIONS} perceptions of 48 readings each go into the map, without contact",
        all(
            run.mapper.perceptions == PERCEPTIONS and run.readings == PERCEPTIONS * 48
            for run in runs
        )
        and contacts == 0,
        f"{runs[0].mapper.perceptions} of {runs[0].readings} readings, {contacts} contacts",
    )
    worst = min(q.accurate for q in quality)
    study.claim(
        "walls",
        f"the walls are where they are: of the cells with M_p above {OCCUPIED:g} at least 95 % "
        f"lie within {ACCURACY:g} m of a true surface",
        worst >= 95.0,
        f"{worst:.1f} % at least",
    )
    worst = min(q.light for q in quality)
    study.claim(
        "open",
        f"the open space is light: of its cells up to {NEAR_WAY:g} m from the way and more than "
        f"{OFF_SURFACE:g} m from a surface at least 95 % have M_m up to {BETA:g}",
        worst >= 95.0,
        f"{worst:.1f} % at least",
    )
    study.claim(
        "grey",
        "small grey areas extend beyond the walls: some, but at most 5 % of the open space",
        all(0 < q.beyond <= 0.05 * q.open for q in quality),
        f"{beyond:.1f} %",
    )
    study.claim(
        "reflections",
        "they are due to false reflections: without these less than half as much",
        rough_beyond < 0.5 * beyond,
        f"{rough_beyond:.1f} % against {beyond:.1f} %",
    )
    study.claim(
        "time",
        "an update takes no longer than the paper's 0.2 s",
        update <= 0.2,
        f"{1000.0 * update:.1f} ms",
    )
    return study.finish(_figure(runs[0], options.seed))


def _quality(run: GuidedRun) -> Quality:
    """Compare a map with the world."""
    mapper, surfaces = run.mapper, run.world.surfaces()
    geometry = mapper.geometry
    x, y = geometry.centres()
    to_surface = np.abs(surfaces.distances(x, y))
    # What can be come to from the way; all else is behind walls or in cabinets.
    labels, _ = ndimage.label(~occupancy(surfaces, geometry))
    inside = labels == labels[geometry.cell_of(*run.places[0].tolist())]
    way = np.ones(geometry.shape, dtype=bool)
    cells, _ = geometry.cells_of(run.way)
    way[cells[:, 0], cells[:, 1]] = False
    to_way = geometry.resolution * ndimage.distance_transform_edt(way)
    behind = geometry.resolution * ndimage.distance_transform_edt(~inside) > BEYOND
    occupied = mapper.planning_risk > OCCUPIED
    near = inside & (to_way <= NEAR_WAY) & (to_surface > OFF_SURFACE)
    return Quality(
        accurate=100.0 * float((to_surface[occupied] <= ACCURACY).mean()),
        light=100.0 * float((mapper.motion_risk[near] <= BETA).mean()),
        beyond=int((behind & (to_surface > BEYOND) & (mapper.motion_risk < 1.0)).sum()),
        open=int(inside.sum()),
    )


def _figure(run: GuidedRun, seed: int) -> Figure:
    """Return both maps as the paper shows the first: with the true walls and the places."""
    surfaces = run.world.surfaces()
    scene = Scene(
        segments=surfaces.segments,
        circles=surfaces.circles,
        travelled=run.way,
        perceptions=run.places,
    )
    mapper = run.mapper
    panels = [
        [Panel(mapper.geometry, mapper.motion_risk, scene, "motion map $M_m$")],
        [
            Panel(
                mapper.geometry,
                mapper.planning_risk,
                Scene(segments=surfaces.segments, circles=surfaces.circles),
                "planning map $M_p$",
            )
        ],
    ]
    return draw_panels(panels, f"Fig. 8 with {mapper.perceptions} perceptions, seed {seed}")


if __name__ == "__main__":
    sys.exit(main())
