# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Moments of a mission, as lines of text and as figures of both risk maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.mission_types import LogEntry, Stop
from nomad_sim.headless import HeadlessMission
from nomad_sim.render import Figure, Panel, Scene, draw_panels

__all__ = ["Moment", "draw_moments", "entry_line", "moment_of"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Moment:
    """Maps and scene at one moment of a mission.

    Parameters
    ----------
    perceptions : int
        Perceptions made by then.
    geometry : GridGeometry
        Where the maps lie.
    motion_risk, planning_risk : ndarray of float64, shape (H, W)
        M_m and M_p.
    scene : Scene
        The true surfaces, the way so far and the plan.
    """

    perceptions: int
    geometry: GridGeometry
    motion_risk: FloatArray
    planning_risk: FloatArray
    scene: Scene


def moment_of(mission: HeadlessMission) -> Moment:
    """Return how a mission stands now."""
    simulator, log = mission.simulator, mission.mission.log
    surfaces = mission.world.surfaces(simulator.time, simulator.perceptions)
    ended = mission.verdict is not None
    return Moment(
        perceptions=len(log),
        geometry=mission.mapper.geometry,
        motion_risk=mission.mapper.motion_risk.copy(),
        planning_risk=mission.mapper.planning_risk.copy(),
        scene=Scene(
            segments=surfaces.segments,
            circles=surfaces.circles,
            travelled=mission.mission.travelled,
            perceptions=np.array([(e.pose.x, e.pose.y) for e in log]).reshape(-1, 2),
            plan=np.empty((0, 2)) if ended else mission.mission.plan_path,
            start=(mission.start.x, mission.start.y),
            goal=mission.goal,
            robot=simulator.pose,
            robot_radius=simulator.parameters.robot.radius,
        ),
    )


def draw_moments(moments: Sequence[Moment], title: str = "") -> Figure:
    """Return a figure with a column for each moment: M_m above, M_p below.

    Raises
    ------
    ValueError
        If there is no moment.
    """
    return draw_panels(
        [
            [_panel(m, m.motion_risk, "motion risk") for m in moments],
            [_panel(m, m.planning_risk, "planning risk") for m in moments],
        ],
        title,
    )


def _panel(moment: Moment, risk: FloatArray, name: str) -> Panel:
    title = f"{name} after perception {moment.perceptions}"
    return Panel(moment.geometry, risk, replace(moment.scene), title)


def entry_line(entry: LogEntry, started: float = 0.0) -> str:
    """Return a perception of a mission's log as a line.

    Parameters
    ----------
    entry : LogEntry
        The perception.
    started : float
        When the mission began [s], which its time is told from.
    """
    pose = entry.pose
    if entry.on_the_way:
        why = f"on the way,{'':11} alpha {entry.alpha:.1f}"
    elif entry.stop is Stop.NONE:
        why = "at the start" if entry.perception == 1 else "off its path, or moved from it"
    else:
        why = f"stopped by {entry.stop.name.lower():<10} alpha {entry.alpha:.1f}"
    return (
        f"perception {entry.perception:>3} at {entry.stamp - started:7.2f} s, ({pose.x:6.2f}, "
        f"{pose.y:6.2f}) m: {why + ',':<32} {entry.distance_remaining:5.2f} m left"
    )
