# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What faults do to what the robot tells.

First to the values, in the order in which the faults are given; then to the clock and all
stamps; last to the messages on their way, each kind of message by itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from fuzzy_map_building.types import Pose2, wrap_angle
from nomad_sim.faults import ON_THE_WAY, Fault
from nomad_sim.params import SimulatorParameters
from nomad_sim.telemetry import PoseReport, RangeReport, Telemetry, TurretReport

__all__ = ["FaultInjector"]

T = TypeVar("T", RangeReport, TurretReport, PoseReport)

#: Marks the random stream of faults: the simulator's own do not depend on it.
_STREAM = 3
#: Slack of the comparison of times [s].
_ROUNDING = 1e-9


class FaultInjector:
    """Puts faults into what is told, tick by tick.

    Parameters
    ----------
    faults : sequence of Fault
        The faults.
    seed : int
        The same seed and telemetry give the same faults.
    """

    def __init__(self, faults: Sequence[Fault], seed: int) -> None:
        self._values = []
        self._clocks = []
        self._ways: dict[str, list[_Way]] = {"infrared": [], "sonar": [], "turret": [], "pose": []}
        self._any = len(faults) > 0
        for number, fault in enumerate(faults):
            random = np.random.default_rng([seed, _STREAM, number])
            if fault.target == "clock":
                self._clocks.append(fault)
            elif fault.kind in ON_THE_WAY:
                self._ways[fault.target].append(_Way(fault, random))
            else:
                self._values.append(_Values(fault, random))

    @classmethod
    def of(cls, parameters: SimulatorParameters) -> FaultInjector:
        """Return the injector of a simulator's faults."""
        return cls(parameters.fault_list(), parameters.seed)

    def apply(self, told: Telemetry) -> Telemetry:
        """Return what arrives in a tick in which `told` is sent."""
        if not self._any:
            return told
        infrared, sonar, turret, pose = told.infrared, told.sonar, told.turret, told.pose
        for fault in self._values:
            target, time = fault.target, told.time
            if target == "infrared":
                infrared = fault.ranges(time, infrared)
            elif target == "sonar":
                sonar = fault.ranges(time, sonar)
            elif target == "turret":
                turret = fault.turrets(time, turret)
            else:
                pose = fault.poses(time, pose)
        back = sum(f.values["by"] for f in self._clocks if f.active(told.time))
        return Telemetry(
            time=told.time,
            clock=told.clock - back,
            infrared=self._arrived(told.time, "infrared", _set_back(infrared, back)),
            sonar=self._arrived(told.time, "sonar", _set_back(sonar, back)),
            turret=self._arrived(told.time, "turret", _set_back(turret, back)),
            pose=self._arrived(told.time, "pose", _set_back(pose, back)),
        )

    def _arrived(self, time: float, target: str, sent: tuple[T, ...]) -> tuple[T, ...]:
        for way in self._ways[target]:
            sent = way.carry(time, sent)
        return sent


def _set_back(reports: tuple[T, ...], by: float) -> tuple[T, ...]:
    return tuple(r._replace(stamp=r.stamp - by) for r in reports) if by else reports


class _Values:
    """A fault of what is told."""

    def __init__(self, fault: Fault, random: np.random.Generator) -> None:
        self.target = fault.target
        self._fault = fault
        self._random = random
        self._first: dict[int, float] = {}
        self._stuck: Pose2 | None = None
        self._strayed = np.zeros(3)
        self._before: Pose2 | None = None

    def ranges(self, time: float, told: tuple[RangeReport, ...]) -> tuple[RangeReport, ...]:
        """Return what the ring tells."""
        if not self._fault.active(time):
            self._first.clear()
            return told
        changed = []
        for report in told:
            value: float | None = report.value
            if self._fault.affects(report.sensor):
                value = self._range(report)
            if value is not None:
                changed.append(report._replace(value=value))
        return tuple(changed)

    def _range(self, report: RangeReport) -> float | None:
        """Return what an affected sensor tells; None: nothing."""
        kind, values = self._fault.kind, self._fault.values
        if kind == "dead":
            return None
        if kind == "stuck":
            return self._first.setdefault(report.sensor, report.value)
        if kind == "biased":
            # What is no distance stays what it is; nothing measures less than none.
            finite = math.isfinite(report.value)
            return max(report.value + values["offset"], 0.0) if finite else report.value
        # Two draws for each reading, whatever comes of it.
        draw, place = self._random.random(2)
        if draw >= values["share"]:
            return report.value
        instead = {"faulty": math.nan, "deaf": math.inf}
        if kind == "noisy":
            return float(place * values["range"])
        return instead.get(kind, values.get("range", math.nan))

    def turrets(self, time: float, told: tuple[TurretReport, ...]) -> tuple[TurretReport, ...]:
        """Return what the turret tells: it is stuck."""
        if not self._fault.active(time):
            self._first.clear()
            return told
        return tuple(r._replace(angle=self._first.setdefault(0, r.angle)) for r in told)

    def poses(self, time: float, told: tuple[PoseReport, ...]) -> tuple[PoseReport, ...]:
        """Return where the robot is said to be."""
        active = self._fault.active(time)
        if not active:
            self._stuck = None
            self._strayed[:] = 0.0
            self._before = told[-1].pose if told else self._before
            return told
        return tuple(r._replace(pose=self._pose(r.pose)) for r in told)

    def _pose(self, pose: Pose2) -> Pose2:
        kind, values = self._fault.kind, self._fault.values
        if kind == "stuck":
            self._stuck = pose if self._stuck is None else self._stuck
            return self._stuck
        if kind == "jumping":
            return _moved(pose, values["x"], values["y"], values["theta"])
        before = pose if self._before is None else self._before
        self._before = pose
        way = math.sqrt(pose.distance_to(before.x, before.y))
        deviation = np.array([values["distance"], values["distance"], values["theta"]])
        self._strayed += way * deviation * self._random.standard_normal(3)
        x, y, theta = self._strayed.tolist()
        return _moved(pose, x, y, theta)


def _moved(pose: Pose2, x: float, y: float, theta: float) -> Pose2:
    return Pose2(pose.x + x, pose.y + y, wrap_angle(pose.theta + theta))


class _Way:
    """What becomes of the messages of one kind on their way."""

    def __init__(self, fault: Fault, random: np.random.Generator) -> None:
        self._fault = fault
        self._random = random
        # Due at which true time [s]: what is kept back.
        self._held: list[tuple[float, Any]] = []

    def carry(self, time: float, sent: tuple[T, ...]) -> tuple[T, ...]:
        """Return what arrives at a true time [s] at which something is sent."""
        arrived: list[T] = []
        due: list[T] = [report for until, report in self._held if until <= time + _ROUNDING]
        self._held = [entry for entry in self._held if entry[0] > time + _ROUNDING]
        kind = self._fault.kind
        for report in sent:
            befallen = self._befalls(time, report)
            if not befallen or kind == "duplicated":
                arrived.append(report)
            if befallen and kind == "duplicated":
                arrived.append(report)
            elif befallen and kind != "lost":
                # Without a delay a message waits for the next tick, and comes behind its.
                self._held.append((time + self._fault.values.get("delay", 0.0), report))
        return tuple(arrived + due)

    def _befalls(self, time: float, report: RangeReport | TurretReport | PoseReport) -> bool:
        active = self._fault.active(time)
        if isinstance(report, RangeReport):
            active = active and self._fault.affects(report.sensor)
        return active and bool(self._random.random() < self._fault.values.get("share", 1.0))
