# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""InfraredGatherer: which of the many infrared readings go with the next packet.

Infrared sensors measure all the time and see little each time. While the robot moves one
sweep of the ring is kept every few centimetres: without what was seen on the way, narrow
passages stay closed in the map. Sonar returns from close to the body that no infrared hit
explains guard each sweep, as they do a perception.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.sonar_guard import cut_rays
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading

__all__ = ["InfraredGatherer"]

#: Sweeps kept at most, the newest ones: bounds the memory of a drive without a perception.
_MAX_SWEEPS = 1000
#: Slack of the comparison of distances [m], so that equal steps do not depend on rounding.
_SLACK = 1e-9


@dataclass
class _Sweep:
    """What was seen around one place."""

    place: Pose2
    start: float
    infrared: dict[int, InfraredReading] = field(default_factory=dict)
    sonar: dict[int, SonarReading] = field(default_factory=dict)


class InfraredGatherer:
    """Keeps a sweep of the infrared ring at the start and whenever the robot has moved on.

    What is seen during a perception is the `PerceptionSequence`'s.

    Parameters
    ----------
    parameters : MapperParameters
        The rings, the way from sweep to sweep and the sonar guard; with infrared evidence
        disabled nothing is kept.

    Examples
    --------
    >>> from fuzzy_map_building.params import mapper_parameters
    >>> gatherer = InfraredGatherer(mapper_parameters("consistent"))
    >>> for k in range(30):  # 30 cm in steps of 1 cm
    ...     gatherer.on_infrared(InfraredReading(Pose2(0.01 * k, 0.0), 0.0, 0.4, 0.1 * k, 0))
    >>> [round(reading.pose.x, 2) for reading in gatherer.readings()]
    [0.0, 0.1, 0.2]
    """

    def __init__(self, parameters: MapperParameters) -> None:
        self._parameters = parameters
        self._enabled = parameters.infrared_evidence.enabled
        self._sensors = len(parameters.infrared.bearings)
        self._spacing = parameters.infrared_evidence.sweep_spacing - _SLACK
        self._sweeps: deque[_Sweep] = deque(maxlen=_MAX_SWEEPS)
        self._standing: _Sweep | None = None

    def wants(self, pose: Pose2) -> bool:
        """Whether a reading taken at a pose may be kept."""
        if not self._enabled:
            return False
        sweep = self._sweeps[-1] if self._sweeps else self._standing
        if sweep is None or self._moved_on(sweep, pose):
            return True
        return sweep is not self._standing and len(sweep.infrared) < self._sensors

    def on_infrared(self, reading: InfraredReading) -> None:
        """Offer a reading; it is kept if its sensor has none at this place yet."""
        if not self.wants(reading.pose):
            return
        sweep = self._sweeps[-1] if self._sweeps else self._standing
        if sweep is None or self._moved_on(sweep, reading.pose):
            sweep = _Sweep(reading.pose, reading.stamp)
            self._sweeps.append(sweep)
        sweep.infrared.setdefault(reading.sensor, reading)

    def on_sonar(self, reading: SonarReading) -> None:
        """Take a sonar reading as a guard of the sweep that it was taken in."""
        for sweep in reversed(self._sweeps):
            if reading.stamp >= sweep.start:
                sweep.sonar[reading.sensor] = reading
                return

    def readings(self) -> list[InfraredReading]:
        """Return what was gathered since `restart`, cut where sonars guard."""
        gathered: list[InfraredReading] = []
        before: _Sweep | None = None
        for sweep in self._sweeps:
            gathered += self._guarded(before, sweep)
            before = sweep
        return gathered

    def restart(self, pose: Pose2 | None = None) -> None:
        """Forget what was gathered, after it was fused.

        Parameters
        ----------
        pose : Pose2, optional
            Where the robot stood while a perception took the sweeps of that place; the next
            one is kept when it has moved on. None: the next reading begins a sweep.
        """
        self._sweeps.clear()
        self._standing = _Sweep(pose, -math.inf) if pose is not None else None

    def _moved_on(self, sweep: _Sweep, pose: Pose2) -> bool:
        return sweep.place.distance_to(pose.x, pose.y) >= self._spacing

    def _guarded(self, before: _Sweep | None, sweep: _Sweep) -> Iterable[InfraredReading]:
        """Return a sweep's readings, limited by what sonars saw around its place."""
        p = self._parameters
        own = list(sweep.infrared.values())
        sonar = [*(before.sonar.values() if before else ()), *sweep.sonar.values()]
        if not (p.sonar_guard.enabled and sonar):
            return own
        # What was seen a step before explains a return as well.
        seen = [*own, *(before.infrared.values() if before else ())]
        reach, radius = p.sonar_guard.motion_reach, p.sonar.mount_radius
        cut = cut_rays(sonar, seen, p.sonar, p.infrared, p.sonar_guard, reach, radius)
        return cut[: len(own)]
