# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parts of the mapper and of the motion node that take messages, fed in one process."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzy_map_building.continuous import ContinuousGathering
from fuzzy_map_building.infrared_gathering import InfraredGatherer
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.perception import PerceptionSequence
from fuzzy_map_building.types import RangeReading, SonarReading
from fuzzy_navigation.control_tick import CLOCK_SLACK, SILENCE, ControlTicks, Tick, Untimely
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_types import Commands
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.pose_time import PoseTime
from nomad_sim.telemetry import Telemetry

__all__ = ["Control", "Perception"]


class Perception:
    """The part of the mapper node that gathers a packet."""

    def __init__(self, parameters: MapperParameters) -> None:
        self._assembler = ReadingAssembler(parameters)
        self._sequence = PerceptionSequence(parameters)
        self._gatherer = InfraredGatherer(parameters)
        continuous = parameters.mode == "continuous"
        self._continuous = ContinuousGathering(parameters) if continuous else None
        self._full: list[SonarReading] | None = None
        self._now = 0.0
        self._request: int | None = None
        self._failure = ""

    def start(self, request: int) -> None:
        """Begin a perception."""
        self._request = request
        self._failure = ""
        self._sequence.start(self._now)

    def tick(self, told: Telemetry) -> float | None:
        """Take what was told; return an angle for the turret [rad], if any."""
        before, self._now = self._now, told.clock
        now, assembler = self._now, self._assembler
        if now < before - CLOCK_SLACK:
            self._begin_anew()
        self._take_infrared(told)
        for turret in told.turret:
            if assembler.add_turret(turret.stamp, turret.angle, now):
                self._sequence.on_turret(turret.stamp, turret.angle)
        for echo in told.sonar:
            assembler.add_range(echo.sensor, echo.stamp, echo.value, now)
        for pose in told.pose:
            assembler.add_pose(pose.stamp, pose.pose, now)
        for ray in assembler.release_infrared(now):
            self._gatherer.on_infrared(ray)
            self._sequence.on_infrared(ray)
        for reading in assembler.release(now):
            self._gatherer.on_sonar(reading)
            if self._sequence.active:
                self._sequence.on_reading(reading)
            elif self._continuous is not None:
                self._full = self._continuous.on_reading(reading) or self._full
        if self._sequence.active or self._continuous is None:
            return self._sequence.step(now)
        return self._continuous.turret_command(now)

    def _take_infrared(self, told: Telemetry) -> None:
        # Most are of no use: asked first, since they would take half of a mission's time.
        wanted = self._sequence.wants_infrared(told.clock)
        if not wanted and not any(self._gatherer.wants(pose.pose) for pose in told.pose):
            return
        for ray in told.infrared:
            self._assembler.add_infrared(ray.sensor, ray.stamp, ray.value, told.clock)

    def _begin_anew(self) -> None:
        """Drop what waits and the perception that is going on: the clock went back."""
        self._assembler.clear()
        self._gatherer.restart()
        if self._continuous is not None:
            self._continuous.forget()
        if self._sequence.active:
            self._sequence.cancel()
            self._failure = "the clock went back"

    def ended(self) -> tuple[int, list[RangeReading], str] | None:
        """Return (request, packet, failure) once, when a perception is over."""
        if self._request is None or self._sequence.active:
            return None
        request, self._request = self._request, None
        packet = [*self._sequence.packet, *self._gatherer.readings()]
        return request, packet, self._failure or self._sequence.failed

    def full(self) -> list[RangeReading] | None:
        """Return a packet of continuous mode once, when it is full."""
        full, self._full = self._full, None
        return None if full is None else [*full, *self._gatherer.readings()]

    def fused(self, *, standing: bool) -> None:
        """Begin to gather for the next packet; the last was that of a perception, or was not."""
        # Where a perception was made the robot stood, and its sweeps are in the packet.
        self._gatherer.restart(self._sequence.readings[0].pose if standing else None)
        if standing and self._continuous is not None:
            self._continuous.forget()


class Control:
    """The part of the motion node that makes control ticks and places the sonars' ranges."""

    def __init__(self, mission: Mission, parameters: MotionParameters) -> None:
        self._mission = mission
        self._ticks = ControlTicks(parameters.infrared.bearings, parameters.timeout.pose)
        self._time = PoseTime()
        self._clock = 0.0
        self._wall = 0.0
        self._last_tick = 0.0
        p = MapperParameters(sonar=parameters.sonar, turret=parameters.turret)
        self._echoes = ReadingAssembler(p) if parameters.sonar_guard.enabled else None

    @property
    def now(self) -> float:
        """The mission's time [s]."""
        return self._time.now(self._clock, self._wall)

    def pass_time(self, told: Telemetry) -> None:
        """Let the clocks go on to when `told` came."""
        if self._echoes is not None and told.clock < self._clock - CLOCK_SLACK:
            self._echoes.clear()
        self._clock, self._wall = told.clock, told.time

    def tick(self, told: Telemetry) -> Iterator[Commands]:
        """Take what was told, and yield what the mission answers."""
        for ray in told.infrared:
            if (due := self._range(ray.sensor, ray.stamp, ray.value)) is not None:
                yield self._act(due)
        if self._echoes is not None:
            for turret in told.turret:
                self._echoes.add_turret(turret.stamp, turret.angle, told.clock)
            for echo in told.sonar:
                self._echoes.add_range(echo.sensor, echo.stamp, echo.value, told.clock)
        for pose in told.pose:
            try:
                tick = self._ticks.on_pose(told.clock, pose.stamp, pose.pose)
            except Untimely:
                continue
            if self._echoes is not None:
                self._echoes.add_pose(pose.stamp, pose.pose, told.clock)
            if tick is not None:
                yield self._act(tick)
        if told.time - self._last_tick > SILENCE:
            yield self._mission.on_tick(self.now)

    def _range(self, sensor: int, stamp: float, value: float) -> Tick | None:
        if value != value:  # faulty
            return None
        try:
            return self._ticks.on_range(self._clock, sensor, stamp, value)
        except Untimely:
            return None

    def _act(self, tick: Tick) -> Commands:
        self._last_tick = self._wall
        now = self._time.at_pose(tick.stamp, self._clock, self._wall)
        sonar = self._echoes.release(self._clock) if self._echoes is not None else ()
        delay = self._clock - tick.stamp
        return self._mission.on_pose(now, tick.pose, tick.readings, sonar, delay)
