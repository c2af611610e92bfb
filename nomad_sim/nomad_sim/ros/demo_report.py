# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a demonstration leaves: figures of the maps and ``summary.json``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from nomad_sim.mission_report import Moment, draw_moments
from nomad_sim.output_folder import write_result
from nomad_sim.render import Scene, save_figure
from nomad_sim.ros.demo_options import DemoOptions
from nomad_sim.ros.mission_record import MapSnapshot, MissionRecord
from nomad_sim.ros.params import EPOCH
from nomad_sim.shortest_way import length_of, shortest_way

__all__ = ["MOMENTS", "clear_output", "figure_moments", "summarise", "write_figures"]

#: Perceptions after which the paper shows its maps, besides the last (paper, Figs. 13 and 14).
MOMENTS: Final = (4, 5, 13)
SUMMARY: Final = "summary.json"
OVERVIEW: Final = "maps.png"
#: A map belongs to a perception that was told of up to this much before it [s]: the two
#: nodes need not have heard of the same time yet. A perception takes several times as long.
SLACK: Final = 0.25


def clear_output(folder: Path) -> None:
    """Remove what an earlier run has left, so that nothing of it passes for this run's."""
    for file in [*folder.glob("perception_*.png"), folder / OVERVIEW, folder / SUMMARY]:
        file.unlink(missing_ok=True)


def figure_moments(count: int) -> list[int]:
    """Return the perceptions to draw of a run of `count`: the paper's, and the last.

    Examples
    --------
    >>> figure_moments(22), figure_moments(5), figure_moments(2), figure_moments(0)
    ([4, 5, 13, 22], [4, 5], [2], [])
    """
    return [k for k in MOMENTS if k < count] + ([count] if count else [])


def write_figures(record: MissionRecord, options: DemoOptions) -> list[str]:
    """Write a figure for each of the moments and one of all, and return their names.

    Nothing is written for a run without a perception.

    Raises
    ------
    OSError
        If one cannot be written.
    """
    moments = [_moment(record, options, k) for k in figure_moments(len(record.log))]
    name = options.world.name
    figures = {
        f"perception_{m.perceptions:02d}.png": draw_moments([m], f"world {name}") for m in moments
    }
    if moments:
        figures[OVERVIEW] = draw_moments(moments)
    for file, figure in figures.items():
        save_figure(figure, options.output / file)
    return list(figures)


def _moment(record: MissionRecord, options: DemoOptions, count: int) -> Moment:
    """Return how the mission stood after the first `count` perceptions of the record."""
    entry, world = record.log[count - 1], options.world
    last = count == len(record.log)
    until = math.inf if last else entry.stamp
    motion = _newest(record.motion_maps, entry.stamp + SLACK)
    planning = _newest(record.planning_maps, entry.stamp + SLACK)
    # What stood there when the perception was made.
    surfaces = world.surfaces(max(0.0, entry.stamp - EPOCH * 1e-9), entry.perception - 1)
    plans = [path for stamp, path in record.plans if stamp == planning.stamp]
    scene = Scene(
        segments=surfaces.segments,
        circles=surfaces.circles,
        travelled=np.array([(x, y) for t, x, y in record.way if t <= until]),
        perceptions=np.array([(e.pose.x, e.pose.y) for e in record.log[:count]]),
        plan=plans[-1] if plans and not last else np.empty((0, 2)),
        start=(world.start.x, world.start.y),
        goal=world.goal,
        robot=record.pose if last else entry.pose,
    )
    return Moment(entry.perception, motion.geometry, motion.risk, planning.risk, scene)


def _newest(maps: Sequence[MapSnapshot], until: float) -> MapSnapshot:
    """Return the newest map up to a stamp [s], the first if there is none."""
    return max((m for m in maps if m.stamp <= until), key=lambda m: m.stamp, default=maps[0])


def summarise(
    record: MissionRecord,
    options: DemoOptions,
    problem: str,
    durations: Mapping[str, float],
    figures: Sequence[str],
) -> bool:
    """Write ``summary.json`` and return whether the run was a success.

    Parameters
    ----------
    record : MissionRecord
        What was seen.
    options : DemoOptions
        What was asked for.
    problem : str
        Why there is no verdict; empty if there is one.
    durations : mapping
        Wall times [s] by name.
    figures : sequence of str
        File names.

    Returns
    -------
    bool
        Whether the verdict is the true one and the robot touched nothing.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    verdict, world = record.verdict, options.world
    contacts = int(record.simulator.get("contacts", 0))
    truthful = verdict is not None and verdict.outcome.name.lower() in options.expected
    success = truthful and contacts == 0
    way = shortest_way(world)
    summary = {
        "success": success,
        "verdict": verdict.outcome.name.lower() if verdict else None,
        "expected_verdict": " or ".join(options.expected),
        "message": verdict.message if verdict else problem,
        "perceptions": verdict.perceptions if verdict else len(record.log),
        "path_length_m": verdict.path_length if verdict else None,
        # Without the goal's tolerance, for a robot that knows the world.
        "shortest_path_m": length_of(way) if way is not None else None,
        "contacts": contacts,
        "least_true_clearance_m": float(record.simulator.get("least_clearance", math.nan)),
        "least_measured_clearance_m": verdict.min_clearance if verdict else None,
        "simulated_duration_s": verdict.duration if verdict else None,
        "wall_durations_s": dict(durations),
        "world": world.name,
        "world_source": options.world_source,
        "start": [world.start.x, world.start.y, world.start.theta],
        "goal": list(world.goal),
        "seed": options.seed,
        "preset": options.preset,
        "concurrent": options.concurrent,
        "rate": options.rate,
        "lockstep": options.lockstep,
        "log": [
            {
                "perception": entry.perception,
                "stamp_s": entry.stamp,
                "since_goal_s": entry.stamp - record.started,
                "x": entry.pose.x,
                "y": entry.pose.y,
                "theta": entry.pose.theta,
                "on_the_way": entry.on_the_way,
                "stopped_by": entry.stop.name.lower(),
                "alpha": entry.alpha,
                "distance_remaining_m": entry.distance_remaining,
            }
            for entry in record.log
        ],
        "figures": list(figures),
        "simulator": record.simulator,
        "parameters": record.parameters,
    }
    text = json.dumps(_plain(summary), indent=2, allow_nan=False)
    write_result(options.output / SUMMARY, text + "\n")
    return success


def _plain(value: Any) -> Any:
    """Return the value as JSON can hold it: null for what is no number."""
    if isinstance(value, Mapping):
        return {key: _plain(v) for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, float):
        return round(value, 6) if math.isfinite(value) else None
    return value if isinstance(value, (str, int, type(None))) else list(value)
