# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A1, A2 and A3 on the finished map of Fig. 8, for simulations 1 and 2 (section IV-A3)."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from guided_run import GuidedRun
from matplotlib.figure import Figure
from numpy.typing import NDArray
from study import Study

from fuzzy_navigation.params import PAPER_PRESET, planner_parameters
from fuzzy_navigation.planner import Planner, PlanStatus
from nomad_sim.render import Panel, Scene, draw_panels

Floats = NDArray[np.float64]

#: Added to every risk. The paper only says "small"; its Table II gives it away: on the way of
#: A2 each of the 24 cells after the start costs 0.13 on average in g1 and as much in the root
#: of g2, which can only be a floor that free cells have.
EPSILON = 0.1
#: The others that are tried, to see what depends on it.
OTHER_EPSILONS = (0.01, 0.2)
#: Cost, adjacency and alpha of each algorithm (section IV-A3). The alpha-cut is for A1 and A2
#: alone (section IV-A2); its value is that of section V.
ALGORITHMS = {"A1": ("g1", 8, 0.6), "A2": ("g2", 8, 0.6), "A3": ("g3", 4, 1.0)}
HEADER = ("", *(f"{name} {where}" for name in ALGORITHMS for where in ("paper", "here")))
#: Differences of risks that the paper's two decimals do not show.
ROUNDING = 0.005
#: Maps, each of a seed of its own, that a study tries unless it has to be quick.
MAPS = 10
#: How often each search is timed.
REPEATS = 9
#: Style, colour and width of each path in figures; the styles are those of the paper.
STYLES = {"A1": ("-", "#1e90ff", 3.0), "A2": ("--", "#12a150", 2.0), "A3": (":", "#d62ad6", 2.4)}


@dataclass(frozen=True, eq=False)
class Found:
    """The path that an algorithm found.

    Parameters
    ----------
    xy : ndarray of float64, shape (n, 2)
        Centres of its cells [m].
    risks : ndarray of float64, shape (n,)
        Their mu, epsilon included.
    g1, g2, g3 : float
        Its costs.
    expanded : int
        Number of cells expanded.
    seconds : float
        Median time of a search [s].
    """

    xy: Floats
    risks: Floats
    g1: float
    g2: float
    g3: float
    expanded: int
    seconds: float

    @property
    def cells(self) -> int:
        """Number of cells of the path."""
        return len(self.xy)


Paths = Mapping[str, Found]


class PathClaim(NamedTuple):
    """What the paper tells of the paths, and how it is tested and told here."""

    name: str
    sentence: str
    test: Callable[[Paths], bool]
    found: Callable[[Paths], str]


def finished_planner(run: GuidedRun, epsilon: float, robot_radius: float) -> Planner:
    """Return a planner on the map of a run, unexplored cells barred."""
    parameters = planner_parameters(
        PAPER_PRESET, {"epsilon": epsilon, "robot_radius": robot_radius}
    )
    planner = Planner(run.mapper.geometry, parameters)
    planner.set_map(run.mapper.planning_risk, barred=run.mapper.count == 0)
    return planner


def find_paths(
    planner: Planner, start: tuple[float, float], goal: tuple[float, float]
) -> Paths | None:
    """Plan with A1, A2 and A3; None if one of them finds no path."""
    assert planner.augmented_risk is not None
    mu = planner.augmented_risk + planner.parameters.epsilon
    paths = {}
    tolerance = 0.5 * planner.geometry.resolution  # the goal's own cell
    for name, (cost, adjacency, alpha) in ALGORITHMS.items():
        times = []
        for _ in range(REPEATS):
            began = time.perf_counter()
            result = planner.plan(start, goal, cost, alpha, adjacency, tolerance)
            times.append(time.perf_counter() - began)
        if result.status is not PlanStatus.FOUND:
            return None
        row, column = result.path.T
        paths[name] = Found(
            xy=np.column_stack(planner.geometry.centre_coordinates(row, column)),
            risks=mu[row, column],
            g1=result.g1,
            g2=result.g2,
            g3=result.g3,
            expanded=result.expanded,
            seconds=statistics.median(times),
        )
    return paths


def add_rows(study: Study, paths: Paths, paper: Mapping[str, Sequence[float]]) -> None:
    """Add the paper's table and what was found; `paper` holds its rows by algorithm."""

    def add(label: str, column: int, digits: int, digits_here: int | None = None) -> None:
        attribute = ("g1", "g2", "g3", "cells", "expanded", "seconds")[column]
        here = digits if digits_here is None else digits_here
        cells = []
        for name, path in paths.items():
            cells += [
                f"{paper[name][column]:.{digits}f}",
                f"{getattr(path, attribute):.{here}f}",
            ]
        study.row(label, *cells)

    for column in range(3):
        add(f"g{column + 1}", column, 2)
    add("cells in the path", 3, 0)
    add("expanded cells", 4, 0)
    add("computing time [s]", 5, 2, 5)


def add_claims(study: Study, claims: Sequence[PathClaim], maps: Sequence[Paths]) -> None:
    """Judge the claims by the first map, and say on how many of all they hold."""
    for claim in claims:
        found = claim.found(maps[0])
        if len(maps) > 1:
            found += f"; so on {sum(claim.test(paths) for paths in maps)} of {len(maps)} maps"
        study.claim(claim.name, claim.sentence, claim.test(maps[0]), found)


def note_others(
    study: Study, claims: Sequence[PathClaim], condition: str, paths: Paths | None
) -> None:
    """Note which claims hold under another condition."""
    if paths is None:
        study.note(f"{condition} there is no path.")
        return
    fail = [claim.name for claim in claims if not claim.test(paths)]
    study.note(f"{condition} these do not hold: {', '.join(fail) or 'none'}.")


def each(paths: Paths, attribute: str, digits: int = 2) -> str:
    """Return a value of all three paths."""
    return ", ".join(f"{n} {getattr(path, attribute):.{digits}f}" for n, path in paths.items())


def draw_paths(
    run: GuidedRun,
    paths: Paths,
    title: str,
    view: tuple[float, float, float, float] | None = None,
) -> Figure:
    """Return a figure of the planning map with all paths, or of a part x0, y0, x1, y1 [m]."""
    ends = paths["A1"].xy[[0, -1]].tolist()
    scene = Scene(
        segments=run.world.surfaces().segments, start=tuple(ends[0]), goal=tuple(ends[1])
    )
    mapper = run.mapper
    panel = Panel(mapper.geometry, mapper.planning_risk, scene, "planning map $M_p$")
    figure = draw_panels([[panel]], title)
    axes = figure.axes[0]
    for name, (style, colour, width) in STYLES.items():
        path = paths[name]
        axes.plot(*path.xy.T, style, color=colour, linewidth=width, label=name, zorder=3)
    if view is not None:
        figure.set_size_inches(7.6, 6.0)
        axes.set_xlim(view[0], view[2])
        axes.set_ylim(view[1], view[3])
    axes.legend(loc="upper right", handlelength=3.5)
    return figure
