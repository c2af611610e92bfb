# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""ContinuousGathering: packets of readings without end, while the robot does what it likes.

Nobody waits for the turret: a reading counts wherever the turret stood or turned when it was
taken, for each is placed at the angle of its own stamp. Once the ring has spoken, which is when
all sonars have or the first one speaks again, the turret goes to the next angle, to and fro, so
that it need not turn back between two packets.
"""

from __future__ import annotations

from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.types import SonarReading

__all__ = ["ContinuousGathering"]


class ContinuousGathering:
    """Gathers packets of ``packet_size`` sonar readings and keeps the turret turning.

    Parameters
    ----------
    parameters : MapperParameters
        The ring, the turret's angles and the size of a packet.

    Examples
    --------
    >>> from fuzzy_map_building.params import mapper_parameters
    >>> from fuzzy_map_building.types import Pose2
    >>> gathering = ContinuousGathering(mapper_parameters(overrides={"packet_size": 2}))
    >>> first, second = (SonarReading(Pose2(0.0, 0.0), 0.0, 1.0, t, 0) for t in (0.1, 0.2))
    >>> gathering.on_reading(first), len(gathering.on_reading(second))
    (None, 2)
    """

    def __init__(self, parameters: MapperParameters) -> None:
        angles = parameters.turret.angles if parameters.turret.joint else ()
        # There and back, both ends twice: any three rounds in a row of three angles have each.
        self._angles = (*angles, *reversed(angles))
        self._sonars = len(parameters.sonar.bearings)
        self._size = parameters.packet_size
        self._packet: list[SonarReading] = []
        self._stage = 0
        self._commanded: float | None = None
        self._heard: set[int] = set()
        self._round_over = False

    @property
    def waiting(self) -> int:
        """Number of readings of the packet that is being gathered."""
        return len(self._packet)

    def forget(self) -> None:
        """Drop what was gathered, and command the turret anew."""
        self._packet = []
        self._commanded = None

    def on_reading(self, reading: SonarReading) -> list[SonarReading] | None:
        """Take a reading; return the packet that it completes, if any."""
        if self._commanded is not None and reading.stamp >= self._commanded:
            self._round_over |= reading.sensor in self._heard
            self._heard.add(reading.sensor)
            self._round_over |= len(self._heard) == self._sonars
        self._packet.append(reading)
        if len(self._packet) < self._size:
            return None
        packet, self._packet = self._packet, []
        return packet

    def turret_command(self, now: float) -> float | None:
        """Return the angle [rad] to command the turret to, or None if there is none to command.

        Parameters
        ----------
        now : float
            Present time [s].
        """
        if not self._angles or (self._commanded is not None and not self._round_over):
            return None
        if self._commanded is not None:
            self._stage = (self._stage + 1) % len(self._angles)
        self._commanded = now
        self._round_over = False
        self._heard.clear()
        return self._angles[self._stage]
