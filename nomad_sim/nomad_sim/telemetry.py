# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the robot tells of one tick: its clock, and a list of messages of each kind.

The simulator knows the truth; this is what leaves it. The node publishes it and the loop in
one process takes it as the nodes take messages, so that a fault put in between
(`nomad_sim.faults`) does the same to both.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, repeat
from typing import NamedTuple

from fuzzy_map_building.types import Pose2
from nomad_sim.simulator import Simulator

__all__ = ["PoseReport", "RangeReport", "Telemetry", "TurretReport", "telemetry_of"]


class PoseReport(NamedTuple):
    """A pose in ``map`` as it is told, and when it was so by the robot's clock [s]."""

    stamp: float
    pose: Pose2


class TurretReport(NamedTuple):
    """An angle of the turret [rad] as it is told, and when it was so by the robot's clock [s]."""

    stamp: float
    angle: float


class RangeReport(NamedTuple):
    """A range as it is told.

    Attributes
    ----------
    stamp : float
        When it was measured, by the robot's clock [s].
    value : float
        The range [m], REP 117.
    sensor : int
        Index in its ring.
    """

    stamp: float
    value: float
    sensor: int


@dataclass(frozen=True)
class Telemetry:
    """All that is told in one tick, of each kind in the order in which it is sent.

    Parameters
    ----------
    time : float
        True time of the simulator [s].
    clock : float
        What the robot's clock shows [s].
    infrared, sonar : tuple of RangeReport
    turret : tuple of TurretReport
    pose : tuple of PoseReport
        Messages of each kind.
    """

    time: float
    clock: float
    infrared: tuple[RangeReport, ...]
    sonar: tuple[RangeReport, ...]
    turret: tuple[TurretReport, ...]
    pose: tuple[PoseReport, ...]


def telemetry_of(simulator: Simulator) -> Telemetry:
    """Return what a robot without faults tells of the simulator's last step."""
    now = simulator.time
    return Telemetry(
        time=now,
        clock=now,
        infrared=tuple(map(RangeReport, repeat(now), simulator.infrared().tolist(), count())),
        sonar=tuple(RangeReport(e.stamp, e.range, e.sensor) for e in simulator.sonar_events),
        turret=(TurretReport(now, simulator.turret_angle),),
        pose=(PoseReport(now, simulator.pose),),
    )
