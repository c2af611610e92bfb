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

from nomad_sim.render import Panel, Scene, draw_panels, save_figure
from nomad_sim.ros.demo_options import DemoOptions
from nomad_sim.ros.mission_record import MapSnapshot, MissionRecord
from nomad_sim.ros.params import EPOCH

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
    """
    moments = figure_moments(len(record.perceptions))
    columns = [_panels(record, options, k) for k in moments]
    if not columns:
        return []
    written = []
    for k, column in zip(moments, columns, strict=True):
        number = record.perceptions[k - 1].number
        name = f"perception_{number:02d}.png"
        title = f"{options.world.name}: after perception {number}"
        save_figure(draw_panels([column], title), options.output / name)
        written.append(name)
    save_figure(
        draw_panels([list(row) for row in zip(*columns, strict=True)]), options.output / OVERVIEW
    )
    return [*written, OVERVIEW]


def _panels(record: MissionRecord, options: DemoOptions, count: int) -> list[Panel]:
    """Return M_m and M_p as they were after the first `count` perceptions of the record."""
    perception = record.perceptions[count - 1]
    last = count == len(record.perceptions)
    until = math.inf if last else perception.stamp
    motion = _newest(record.motion_maps, perception.stamp + SLACK)
    planning = _newest(record.planning_maps, perception.stamp + SLACK)
    # What stood there when the perception was made.
    surfaces = options.world.surfaces(
        max(0.0, perception.stamp - EPOCH * 1e-9), perception.number - 1
    )
    plans = [path for stamp, path in record.plans if stamp == planning.stamp]
    scene = Scene(
        segments=surfaces.segments,
        circles=surfaces.circles,
        travelled=np.array([(x, y) for t, x, y in record.way if t <= until]),
        perceptions=np.array([(p.pose.x, p.pose.y) for p in record.perceptions[:count]]),
        plan=plans[-1] if plans and not last else np.empty((0, 2)),
        start=(options.world.start.x, options.world.start.y),
        goal=options.world.goal,
        robot=record.pose if last else perception.pose,
    )
    after = f"after perception {perception.number}"
    return [
        Panel(motion.geometry, motion.risk, scene, f"motion map $M_m$ {after}"),
        Panel(planning.geometry, planning.risk, scene, f"planning map $M_p$ {after}"),
    ]


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
    """
    verdict, world = record.verdict, options.world
    contacts = int(record.simulator.get("contacts", 0))
    truthful = verdict is not None and verdict.outcome.name.lower() == options.expected
    success = truthful and contacts == 0
    summary = {
        "success": success,
        "verdict": verdict.outcome.name.lower() if verdict else None,
        "expected_verdict": options.expected,
        "message": verdict.message if verdict else problem,
        "perceptions": verdict.perceptions if verdict else len(record.perceptions),
        "path_length_m": verdict.path_length if verdict else None,
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
        "rate": options.rate,
        "lockstep": options.lockstep,
        "log": [
            {
                "perception": p.number,
                "stamp_s": p.stamp,
                "x": p.pose.x,
                "y": p.pose.y,
                "theta": p.pose.theta,
                "stopped_because": p.stop.name.lower(),
                "next_phase": p.phase.name.lower(),
                "alpha": p.alpha,
                "distance_remaining_m": p.distance_remaining,
            }
            for p in record.perceptions
        ],
        "figures": list(figures),
        "parameters": record.parameters,
    }
    text = json.dumps(_plain(summary), indent=2, allow_nan=False)
    (options.output / SUMMARY).write_text(text + "\n", encoding="utf-8")
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
