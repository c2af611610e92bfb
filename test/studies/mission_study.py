# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions watched for experiments 1 and 2: what the paper's text and figures tell of them."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.params import PAPER_PRESET
from fuzzy_navigation.mission_types import Phase
from nomad_sim.headless import CONTROL_PERIOD, HeadlessMission, MissionLog
from nomad_sim.mission_report import Moment, moment_of
from nomad_sim.workers import run_in_parallel

#: Opening between the two large obstacles of the laboratory: its middle line and its ends [m].
OPENING_X, OPENING_Y = 3.7, (2.2, 3.1)
#: Where the person of experiment 2 stands (x, y), and the radius of its body [m].
PERSON, PERSON_RADIUS = (3.7, 2.65), 0.25
#: Perceptions that see the person.
PERSON_STAYS = 16


@dataclass(frozen=True, eq=False)
class Watched:
    """What is kept of a mission right after a perception and the plan that follows it.

    Parameters
    ----------
    rung : float
        Alpha that the new path was found on.
    plan : ndarray of float64, shape (n, 2)
        The new path [m].
    person : float
        Highest belief of occupied in the cells where the person of experiment 2 stands.
    moment : Moment
        The maps.
    """

    rung: float
    plan: NDArray[np.float64]
    person: float
    moment: Moment


@dataclass(frozen=True, eq=False)
class Run:
    """A mission and how it came about.

    Parameters
    ----------
    log : MissionLog
        Its end.
    watched : tuple of Watched
        One for each perception.
    end : Moment
        The maps at its end.
    perceiving : float
        Time spent perceiving [s].
    """

    log: MissionLog
    watched: tuple[Watched, ...]
    end: Moment
    perceiving: float


def watch(item: tuple[str, int]) -> Run:
    """Run the mission of a (world, seed) and watch it."""
    world, seed = item
    mission = HeadlessMission(world, seed=seed, preset=PAPER_PRESET)
    x, y = mission.mapper.geometry.centres()
    person = np.hypot(x[None, :] - PERSON[0], y[:, None] - PERSON[1]) <= PERSON_RADIUS
    watched: list[Watched] = []
    ticks = 0
    # The perception cap of the mission bounds this loop.
    while mission.verdict is None:
        ticks += mission.mission.phase is Phase.PERCEIVING
        mission.tick()
        if len(mission.mission.log) > len(watched):
            watched.append(
                Watched(
                    rung=mission.mission.feedback().alpha,
                    plan=mission.mission.plan_path,
                    person=float(mission.mapper.occupied[person].max()),
                    moment=moment_of(mission),
                )
            )
    return Run(mission.run(), tuple(watched), moment_of(mission), ticks * CONTROL_PERIOD)


def watch_all(world: str, first_seed: int, count: int, jobs: int) -> list[Run]:
    """Run missions with consecutive seeds."""
    items = [(world, first_seed + i) for i in range(count)]
    runs: dict[int, Run] = {}
    for number, (index, run) in enumerate(run_in_parallel(watch, items, jobs), start=1):
        runs[index] = run
        print(
            f"run {number} of {count}: seed {run.log.seed}, {run.log.outcome.name.lower()} after "
            f"{run.log.perceptions} perceptions",
            flush=True,
        )
    return [runs[index] for index in range(count)]


def crosses_opening(path: NDArray[np.float64]) -> bool:
    """Whether a path (n, 2) [m] leads through the opening between the large obstacles."""
    x, y = path[:, 0] - OPENING_X, path[:, 1]
    # Between two points on different sides, at the height where the line is met.
    for i in np.flatnonzero(np.sign(x[:-1]) != np.sign(x[1:])):
        share = x[i] / (x[i] - x[i + 1])
        if OPENING_Y[0] <= y[i] + share * (y[i + 1] - y[i]) <= OPENING_Y[1]:
            return True
    return False


def length(path: NDArray[np.float64]) -> float:
    """Return the length [m] of a path, shape (n, 2)."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


def spread(values: Sequence[float], digits: int = 0, unit: str = "") -> str:
    """Return a mean with the lowest and the highest value, or the single value."""
    text = f"{statistics.fmean(values):.{digits}f}"
    if len(values) > 1:
        text += f" ({min(values):.{digits}f} to {max(values):.{digits}f})"
    return text + unit
