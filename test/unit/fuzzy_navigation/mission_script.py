# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A script for a mission: a robot that does what it is told, and partners that answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation.concurrent_mission import mission_of
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_types import Command, Commands, Drive, Finish, Perceive, Plan
from fuzzy_navigation.params import PAPER_PRESET, MotionParameters, motion_parameters
from fuzzy_navigation.planner import PlanResult, PlanStatus

DT = 0.05
#: No sensor.
NONE: Mapping[str, int] = {}
RADIUS = 0.23
GEOMETRY = GridGeometry(60, 40, 0.1)
#: Distance [m] that an infrared sensor at (x, y) measures in a direction [rad].
Seen = Callable[[float, float, float], float]


def nothing(x: float, y: float, direction: float) -> float:
    return math.inf


def hall(x: float, y: float, direction: float) -> float:
    """Return what sonars hear of the walls of a hall around the map."""
    across, along = math.cos(direction), math.sin(direction)
    to_x = ((6.5 if across > 0.0 else -0.5) - x) / across if across != 0.0 else math.inf
    to_y = ((4.5 if along > 0.0 else -0.5) - y) / along if along != 0.0 else math.inf
    return min(to_x, to_y)


def wall_at(x_wall: float) -> Seen:
    """Return what sensors see of a wall along y."""

    def seen(x: float, y: float, direction: float) -> float:
        if math.cos(direction) <= 1e-9:
            return math.inf
        distance = (x_wall - x) / math.cos(direction)
        return distance if distance <= 0.6 else math.inf

    return seen


def corridor(y_low: float, y_high: float, x_from: float = -math.inf) -> Seen:
    """Return what sensors see of two walls along x that begin somewhere."""

    def seen(x: float, y: float, direction: float) -> float:
        up = math.sin(direction)
        if abs(up) <= 1e-9:
            return math.inf
        distance = ((y_high if up > 0.0 else y_low) - y) / up
        hit = x + distance * math.cos(direction)
        return distance if distance <= 0.6 and hit >= x_from else math.inf

    return seen


def cells_along(*corners: tuple[float, float]) -> list[Pose2]:
    """Return the centres of the cells on straight or diagonal runs between corners [m]."""
    cells = [GEOMETRY.cell_of(*corners[0])]
    for corner in corners[1:]:
        row, column = GEOMETRY.cell_of(*corner)
        while cells[-1] != (row, column):
            r, c = cells[-1]
            cells.append((r + int(np.sign(row - r)), c + int(np.sign(column - c))))
    return [Pose2(*GEOMETRY.centre_of(*cell)) for cell in cells]


class Script:
    """One mission object, a robot at (1.05, 2.05) looking along x, and a free map."""

    def __init__(self, parameters: MotionParameters | None = None, **overrides: object) -> None:
        self.parameters = parameters or motion_parameters(overrides=overrides)
        self.mission = Mission(self.parameters)
        self.now = 100.0
        self.pose = Pose2(1.05, 2.05, 0.0)
        self.seen: Seen = nothing
        #: What 16 sonars see, with the infrareds' bearings.
        self.heard: Seen = hall
        self.risk: NDArray[np.float64] = np.zeros(GEOMETRY.shape)
        self.commands: list[Command] = []
        self.poses: list[Pose2] = []

    def take(self, commands: Commands) -> Commands:
        self.commands += commands
        return commands

    def start(self, x: float = 3.05, y: float = 2.05, tolerance: float = 0.0) -> Commands:
        return self.take(self.mission.start(self.now, (x, y), tolerance))

    def sonar(self) -> list[SonarReading]:
        readings = []
        for k in range(16):
            direction = self.pose.theta + k * math.pi / 8.0
            x = self.pose.x + RADIUS * math.cos(direction)
            y = self.pose.y + RADIUS * math.sin(direction)
            distance = self.heard(x, y, direction)
            readings.append(SonarReading(self.pose, k * math.pi / 8.0, distance, self.now, k))
        return readings

    def infrared(self) -> list[InfraredReading]:
        readings = []
        for k in range(16):
            direction = self.pose.theta + k * math.pi / 8.0
            x = self.pose.x + RADIUS * math.cos(direction)
            y = self.pose.y + RADIUS * math.sin(direction)
            distance = self.seen(x, y, direction)
            readings.append(InfraredReading(self.pose, k * math.pi / 8.0, distance, self.now, k))
        return readings

    def tick(
        self,
        infrared: bool = True,
        sonar: bool = True,
        stuck: Mapping[str, int] = NONE,
        dazzled: int = -1,
        delay: float = 0.0,
    ) -> Commands:
        """Let a tick pass: the robot moves as told before, then its pose is told.

        A sensor of a ring may be stuck at 0.5 m, an infrared dazzled so that it sees something
        at 0.02 m, and the pose may come late.
        """
        self.now += DT
        seen = [
            replace(r, range=0.5 if stuck.get("infrared") == r.sensor else 0.02)
            if r.sensor in (stuck.get("infrared"), dazzled)
            else r
            for r in (self.infrared() if infrared else ())
        ]
        heard = [
            replace(r, range=0.5) if stuck.get("sonar") == r.sensor else r
            for r in (self.sonar() if sonar else ())
        ]
        commands = self.take(self.mission.on_pose(self.now, self.pose, seen, heard, delay))
        self.poses.append(self.pose)
        for command in commands:
            if isinstance(command, Drive):
                heading = self.pose.theta + 0.5 * DT * command.angular
                self.pose = Pose2(
                    self.pose.x + DT * command.linear * math.cos(heading),
                    self.pose.y + DT * command.linear * math.sin(heading),
                    self.pose.theta + DT * command.angular,
                )
        return commands

    def run(self, limit: float = 60.0) -> Commands:
        """Tick until there is something else to do than to drive."""
        for _ in range(math.ceil(limit / DT)):
            commands = self.tick()
            if any(not isinstance(command, Drive) for command in commands):
                return commands
        raise AssertionError(f"nothing for {limit} s; {self.mission.feedback()}")

    def show_map(self) -> Commands:
        return self.take(self.mission.on_map(self.now, GEOMETRY, self.risk))

    def perceive(self, commands: Commands) -> Commands:
        """Answer the request for a perception in `commands`, and return what follows."""
        (request,) = (c.request for c in commands if isinstance(c, Perceive))
        follow = self.show_map()
        return follow + self.take(self.mission.on_perception(self.now, request, True))

    def plan(self, commands: Commands, poses: list[Pose2], alpha: float = 0.6) -> Commands:
        """Answer the request for a plan in `commands` with a path."""
        (request,) = (c.request for c in commands if isinstance(c, Plan))
        result = PlanResult(PlanStatus.FOUND, "found", poses=tuple(poses), alpha=alpha)
        return self.take(self.mission.on_plan(self.now, request, result))

    def set_out(self, *corners: tuple[float, float], alpha: float = 0.6) -> Commands:
        """Start for the last corner, perceive and plan: the robot is about to move."""
        self.tick()
        commands = self.start(*corners[-1])
        self.tick()
        here = (self.pose.x, self.pose.y)
        return self.plan(self.perceive(commands), cells_along(here, *corners), alpha)

    def again(self, commands: Commands, *corners: tuple[float, float], alpha: float) -> Commands:
        """Perceive and plan once more."""
        here = (self.pose.x, self.pose.y)
        return self.plan(self.perceive(commands), cells_along(here, *corners), alpha)


class Concurrent(Script):
    """A script with a mapper that sends maps on the way and knows the world up to some x."""

    def __init__(self, known_to: float = math.inf, **overrides: object) -> None:
        super().__init__(concurrent=True, **overrides)
        self.mission = mission_of(self.parameters)
        self.know(known_to)

    def know(self, known_to: float) -> None:
        """Have what lies beyond some x [m] unexplored."""
        x, _ = GEOMETRY.centres()
        self.risk = np.where(x[None, :] > known_to, 1.0, np.zeros(GEOMETRY.shape))

    def ticks(self, count: int) -> list[float]:
        """Let ticks pass with nothing else to do than to drive; return the speeds."""
        speeds = []
        for _ in range(count):
            (drive,) = self.tick()
            assert isinstance(drive, Drive)
            speeds.append(drive.linear)
        return speeds

    def refuse(self, commands: Commands, status: PlanStatus = PlanStatus.NO_PATH) -> Commands:
        (plan,) = plans(commands)
        answer = PlanResult(status, "none", alpha=1.0)
        return self.take(self.mission.on_plan(self.now, plan.request, answer))


def plans(commands: Commands) -> list[Plan]:
    return [command for command in commands if isinstance(command, Plan)]


def paper_script(**overrides: object) -> Script:
    """Return a script of a robot that goes by the rules of the paper."""
    return Script(motion_parameters(PAPER_PRESET, overrides))


def finish_of(commands: Commands) -> Finish:
    """Return the verdict; the command before it has to be to stand."""
    assert isinstance(commands[-1], Finish)
    assert commands[-2] == Drive(0.0, 0.0)
    return commands[-1]
