# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The simulated robot in its world, step by step."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from nomad_sim.ground_truth import occupancy
from nomad_sim.infrared import InfraredRing
from nomad_sim.odometry import Odometry
from nomad_sim.params import SimulatorParameters, simulator_parameters
from nomad_sim.perception_count import PerceptionCount
from nomad_sim.robot import ROUNDING, Velocity, arc, drive, turned
from nomad_sim.sonar import SonarEvent, SonarRing
from nomad_sim.surfaces import Surfaces
from nomad_sim.world import World

__all__ = ["Simulator"]

FloatArray = NDArray[np.float64]

_NANO = 1_000_000_000
# Parts of a step after each of which contact is checked.
_PARTS = 5
# Clearance at which a touch is over [m].
_RELEASE = 1e-3
# Of the least clearance: nanometres.
_DECIMALS = 9
# Longest step [s].
_LONGEST = 1.0
# Largest angle that the turret is sent to [rad].
_TURRET_LIMIT = 1e3


class Simulator:
    """A robot that drives through a world, measures, and touches what it runs into.

    All random numbers come from one seed, in a stream of their own for every kind of
    sensor, each with a fixed number of draws: the same seed and commands give the same
    run, and switching one kind of noise off leaves the others as they were.

    Parameters
    ----------
    world : World
        Where it drives.
    parameters : SimulatorParameters, optional
        By default those that the world asks for.
    start : Pose2, optional
        Where it starts; by default at the world's start.

    Raises
    ------
    ValueError
        If the robot would start in contact with something.
    """

    def __init__(
        self,
        world: World,
        parameters: SimulatorParameters | None = None,
        start: Pose2 | None = None,
    ) -> None:
        self.world = world
        self.parameters = (
            parameters
            if parameters is not None
            else simulator_parameters(world_overrides=world.parameters)
        )
        self._start = start if start is not None else world.start
        free = world.surfaces().distance(self._start.x, self._start.y)
        if free < self.parameters.robot.radius:
            raise ValueError(
                f"the robot cannot start at ({self._start.x:g}, {self._start.y:g}) m in world "
                f"'{world.name}': its body of radius {self.parameters.robot.radius:g} m would "
                f"overlap an obstacle, whose surface is at {free:.3f} m; choose another start"
            )
        self.reset()
        # Loops compile at their first call, which takes seconds: no step has to wait for it.
        self.step(0.0, 0.0, _LONGEST)
        self.reset()

    def reset(self) -> None:
        """Begin again: the same start, time 0, the same random numbers."""
        p = self.parameters
        seeds = np.random.SeedSequence(p.seed).spawn(4)
        streams = [np.random.default_rng(seed) if p.noise else None for seed in seeds]
        self._sonars = SonarRing(p.sonar, p.robot.radius, streams[0], streams[1])
        self._infrareds = InfraredRing(p.infrared, streams[2])
        self._odometry = Odometry(p.odometry, self._start, streams[3])
        self._nanoseconds = 0
        self._firing_interval = max(1, round(p.sonar.firing_interval * _NANO))
        self._fired = 0
        self._pose = self._start
        self._velocity = Velocity()
        self._turret_angle = 0.0
        self._turret_target = 0.0
        self._perceptions = PerceptionCount()
        self._contact = False
        self._contacts = 0
        self._events: list[SonarEvent] = []
        self._clearance = self._surfaces(0).distance(self._pose.x, self._pose.y) - p.robot.radius
        self._least_clearance = self._clearance
        self._infrared = self._infrareds.read(self._pose, self._surfaces(0))

    # What the robot is told.

    def step(self, linear: float, angular: float, dt: float = 0.05) -> None:
        """Let time pass under one command.

        Parameters
        ----------
        linear, angular : float
            Speed [m/s] and turning rate [rad/s] wanted; the drives approach them within
            their limits.
        dt : float
            Time [s], rounded to nanoseconds.

        Raises
        ------
        ValueError
            If a value is not finite, or `dt` is not above 0 and at most 1 s.
        """
        if not (math.isfinite(linear) and math.isfinite(angular)):
            raise ValueError(f"the commanded velocity must be finite, got ({linear}, {angular})")
        if not (1e-9 <= dt <= _LONGEST):
            raise ValueError(f"a step lasts between 1 ns and {_LONGEST:g} s, got {dt} s")
        command = Velocity(linear, angular)
        start, duration = self._nanoseconds, round(dt * _NANO)
        self._events = []
        ends = [start + duration * part // _PARTS for part in range(_PARTS + 1)]
        spans = [(begin, end) for begin, end in itertools.pairwise(ends) if end > begin]
        if self.world.moving:
            for span in spans:
                self._advance(command, [span])
        else:
            self._advance(command, spans)
        self._infrared = self._infrareds.read(self._pose, self._surfaces(self._nanoseconds))

    def command_turret(self, angle: float) -> None:
        """Send the turret to an angle [rad] from the robot's heading.

        Raises
        ------
        ValueError
            If the angle is not finite or beyond 1000 rad.
        """
        if not abs(angle) <= _TURRET_LIMIT:
            raise ValueError(
                f"a turret angle must be finite and within {_TURRET_LIMIT:g} rad, got {angle}"
            )
        if angle != self._turret_target:
            self._perceptions.turn(self._velocity.linear)
        self._turret_target = float(angle)

    def perception_taken(self) -> None:
        """Count a perception that the robot stood for, for obstacles that come and go with them.

        Those of a robot that maps on its way count of themselves, see `PerceptionCount`.
        """
        self._perceptions.take()

    # What the robot and its sensors tell.

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._nanoseconds / _NANO

    @property
    def nanoseconds(self) -> int:
        """Simulated time [ns], exactly."""
        return self._nanoseconds

    @property
    def pose(self) -> Pose2:
        """True pose."""
        return self._pose

    @property
    def odometry(self) -> Pose2:
        """Pose by odometry, which begins at the true one and drifts."""
        return self._odometry.pose

    @property
    def velocity(self) -> Velocity:
        """True velocity."""
        return self._velocity

    @property
    def turret_angle(self) -> float:
        """Angle of the turret from the robot's heading [rad]."""
        return self._turret_angle

    @property
    def sonar_events(self) -> list[SonarEvent]:
        """Readings of the sonars that fired during the last step, in order of time."""
        return self._events

    def infrared(self) -> FloatArray:
        """Return the infrared readings at the end of the last step, shape (16,) [m]."""
        return self._infrared.copy()

    # What only an observer knows.

    @property
    def contact(self) -> bool:
        """Whether the body touches something."""
        return self._contact

    @property
    def contacts(self) -> int:
        """Number of touches so far; leaning on a wall is one."""
        return self._contacts

    @property
    def perceptions(self) -> int:
        """Number of perceptions counted."""
        return self._perceptions.taken

    @property
    def least_clearance(self) -> float:
        """Smallest clearance so far [m], looked at five times a step; 0 where it touched."""
        return round(self._least_clearance, _DECIMALS) + 0.0

    def clearance(self) -> float:
        """Return the distance [m] between the body and the nearest surface, negative inside."""
        return self._clearance

    def ground_truth_grid(self, geometry: GridGeometry) -> NDArray[np.bool_]:
        """Return which cells hold part of an obstacle now, shape (H, W)."""
        return occupancy(self._surfaces(self._nanoseconds), geometry)

    # How a part of a step goes.

    def _surfaces(self, nanoseconds: int) -> Surfaces:
        return self.world.surfaces(nanoseconds / _NANO, self._perceptions.taken)

    def _advance(self, command: Velocity, spans: Sequence[tuple[int, int]]) -> None:
        """Move and fire the sonars that are due.

        Parameters
        ----------
        command : Velocity
            What the robot is told.
        spans : sequence of tuple of int
            Begin and end [ns] of times, one after the other, after each of which contact is
            checked; what is there stays where it is at the end of the last.
        """
        robot, rate = self.parameters.robot, self.parameters.turret.max_rate
        there = self._surfaces(spans[-1][1])
        times = [(end - begin) / _NANO for begin, end in spans]
        track = drive(
            self._pose.x,
            self._pose.y,
            self._pose.theta,
            *self._velocity,
            *command,
            np.array(times),
            np.array(
                (
                    robot.max_linear,
                    robot.max_angular,
                    robot.linear_acceleration,
                    robot.linear_deceleration,
                    robot.angular_acceleration,
                )
            ),
            robot.radius,
            there.segments,
            there.circles,
            there.solids,
        )
        arcs = []
        for (begin, end), dt, row in zip(spans, times, track.tolist(), strict=True):
            linear, angular, x, y, theta, part, self._clearance = row
            before, turret, moving = self._pose, self._turret_angle, part * dt
            self._velocity = Velocity(linear, angular) if part == 1.0 else Velocity()
            self._pose = Pose2(x, y, theta)
            arcs.append((linear * moving, angular * moving))
            self._perceptions.drive(linear * moving)
            self._turret_angle = turned(turret, self._turret_target, rate * dt)
            self._nanoseconds = end
            self._feel(blocked=part < 1.0)
            while (due := (self._fired + 1) * self._firing_interval) <= end:
                elapsed = (due - begin) / _NANO
                self._events += self._sonars.fire(
                    self._fired,
                    due / _NANO,
                    arc(before, linear, angular, min(elapsed, moving)),
                    turned(turret, self._turret_target, rate * elapsed),
                    self._surfaces(due),
                )
                self._fired += 1
        self._odometry.add(arcs)

    def _feel(self, *, blocked: bool) -> None:
        """Update the least clearance and contact."""
        self._least_clearance = min(self._least_clearance, self._clearance)
        if blocked or self._clearance < -ROUNDING:
            if not self._contact:
                self._contacts += 1
            self._contact = True
        elif self._clearance > _RELEASE:
            self._contact = False
