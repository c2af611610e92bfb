# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""PerceptionSequence: how one packet of readings is gathered (section III-A).

The turret is turned from angle to angle; at each, one reading of every sonar is taken
that was measured while the turret stood there, and one of every infrared sensor that has one
by then. A sonar that stays silent costs a bounded wait, a turret that does not arrive ends
the perception with a message.
"""

from __future__ import annotations

import math

from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.types import InfraredReading, RangeReading, SonarReading, wrap_angle

__all__ = ["PerceptionSequence"]

#: A turret that does not move is told again after this time [s]: whoever listens may have
#: come up after the first command.
_REPEAT = 0.5


class PerceptionSequence:
    """A state machine: events in, turret commands and readings out; it reads no clock.

    Call `start` once a perception, then the ``on_`` functions as things happen and `step`
    at least at the rate of the poses, until `done` is True or `failed` is not empty.

    Parameters
    ----------
    parameters : MapperParameters
        The ring, the turret's angles and the limits of waiting.

    Attributes
    ----------
    readings : list of SonarReading
        What the present perception has gathered of the sonars.
    infrared : list of InfraredReading
        What it has gathered of the infrared sensors, for which it never waits.
    """

    def __init__(self, parameters: MapperParameters) -> None:
        self._sonars = len(parameters.sonar.bearings)
        enabled = parameters.infrared_evidence.enabled
        self._infrareds = len(parameters.infrared.bearings) if enabled else 0
        self._turret = parameters.turret
        self._limits = parameters.perception
        self._angles = parameters.turret.angles if parameters.turret.joint else ()
        self._active = False
        self._stage = 0
        self._failed = ""
        self._taken: set[int] = set()
        self._taken_infrared: set[int] = set()
        self._stage_start = -math.inf
        self._stage_patience = -math.inf
        self._commanded = -math.inf
        self._ready_from = math.inf
        self._ready_patience = math.inf
        self.readings: list[SonarReading] = []
        self.infrared: list[InfraredReading] = []

    @property
    def expected(self) -> int:
        """Number of readings of a complete perception."""
        return self._sonars * max(1, len(self._angles))

    @property
    def packet(self) -> list[RangeReading]:
        """All that the present perception has gathered."""
        return [*self.readings, *self.infrared]

    @property
    def active(self) -> bool:
        """Whether a perception is going on."""
        return self._active

    @property
    def done(self) -> bool:
        """Whether the perception has ended well, if not completely: see `readings`."""
        return not self._active and self._failed == "" and len(self.readings) > 0

    @property
    def failed(self) -> str:
        """Why the perception ended without result; empty while it has not."""
        return self._failed

    def start(self, now: float) -> None:
        """Begin a perception at time `now` [s]; one that is going on is dropped."""
        self._active = True
        self._failed = ""
        self._stage = 0
        self._forget_readings()
        self._enter_stage(now, now)

    def cancel(self) -> None:
        """Drop the perception that is going on."""
        self._active = False
        self._failed = "the perception was canceled"
        self._forget_readings()

    def on_turret(self, stamp: float, angle: float) -> None:
        """Take note of the turret's angle [rad] at `stamp` [s]; others than finite are ignored."""
        if not (self._active and self._angles and math.isfinite(stamp) and math.isfinite(angle)):
            return
        if abs(wrap_angle(angle - self._angles[self._stage])) > self._turret.tolerance:
            self._ready_from = self._ready_patience = math.inf
        elif self._ready_from == math.inf:
            # Not before the command: what was seen earlier may be another stage's stand.
            self._ready_from = max(stamp, self._stage_start) + self._limits.settle

    def on_reading(self, reading: SonarReading) -> None:
        """Offer a reading; it is taken if it belongs to the present stand of the turret.

        Raises
        ------
        ValueError
            If the reading does not say which sonar of the ring it is from.
        """
        if not 0 <= reading.sensor < self._sonars:
            raise ValueError(
                f"a reading of sonar {reading.sensor} cannot belong to a ring of {self._sonars}"
            )
        if (
            self._active
            and reading.stamp >= self._ready_from
            and reading.sensor not in self._taken
        ):
            self._taken.add(reading.sensor)
            self.readings.append(reading)

    def on_infrared(self, reading: InfraredReading) -> None:
        """Offer an infrared reading; one of each sensor is taken at each stand of the turret."""
        if self.wants_infrared(reading.stamp) and reading.sensor not in self._taken_infrared:
            self._taken_infrared.add(reading.sensor)
            self.infrared.append(reading)

    def wants_infrared(self, stamp: float) -> bool:
        """Whether an infrared reading taken at `stamp` [s] may be one of the perception's."""
        missing = len(self._taken_infrared) < self._infrareds
        return self._active and missing and stamp >= self._ready_from

    def step(self, now: float, patience: float | None = None) -> float | None:
        """Let time pass.

        Parameters
        ----------
        now : float
            Present time [s].
        patience : float, optional
            What a clock shows [s] that started with the perception and by which the limits of
            waiting are measured; `now` if not given. Where simulated time races, one that
            keeps to wall time leaves the messages their time to arrive.

        Returns
        -------
        float or None
            Angle [rad] to command the turret to, or None if there is nothing to command.
        """
        if not self._active:
            return None
        if patience is None:
            patience = now
        if self._ready_patience == math.inf:
            # What is left of settling; while nothing stands that is for ever.
            self._ready_patience = patience + max(0.0, self._ready_from - now)
        complete = len(self._taken) == self._sonars
        if complete or patience - self._ready_patience > self._limits.timeout:
            self._stage += 1
            if self._stage >= len(self._angles):
                self._finish()
                return None
            self._enter_stage(now, patience)
        if not self._angles or self._ready_from < math.inf:
            return None
        if patience - self._stage_patience > self._turret.timeout:
            self._give_up()
            return None
        if now - self._commanded < _REPEAT:
            return None
        self._commanded = now
        return self._angles[self._stage]

    def _enter_stage(self, now: float, patience: float) -> None:
        self._taken = set()
        self._taken_infrared = set()
        self._stage_start = now
        self._stage_patience = patience
        self._ready_patience = math.inf
        self._commanded = -math.inf
        # Without a turret the sonars stand where they are.
        self._ready_from = math.inf if self._angles else now + self._limits.settle

    def _finish(self) -> None:
        self._active = False
        if not self.readings:
            self._failed = (
                f"no reading of any of the {self._sonars} sonars could be placed within "
                f"{self._limits.timeout:g} s; check that ranges, poses and joint angles arrive "
                f"and that their stamps are of one clock"
            )

    def _forget_readings(self) -> None:
        self.readings = []
        self.infrared = []

    def _give_up(self) -> None:
        self._active = False
        self._forget_readings()
        self._failed = (
            f"the turret did not reach {math.degrees(self._angles[self._stage]):.1f} degrees "
            f"within {self._turret.timeout:g} s; check that its commands arrive and that joint "
            f"'{self._turret.joint}' is reported"
        )
