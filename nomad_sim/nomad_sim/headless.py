# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The whole loop in one process, without ROS: simulator, mapper, planner and mission.

It is the composition that the four nodes form over topics and services, with the same core
objects and the same order of events in a control tick. The maps pass between mapper, planner
and mission as they do in messages, in whole percent, so that with the sensors' noise off a
mission here and one over ROS give the same maps.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.occupancy import risk_to_int8
from fuzzy_map_building.params import DEFAULT_PRESET, mapper_parameters
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.concurrent_mission import mission_of
from fuzzy_navigation.mission_types import (
    Commands,
    Drive,
    Finish,
    Outcome,
    Perceive,
    Plan,
)
from fuzzy_navigation.params import motion_parameters, planner_parameters
from fuzzy_navigation.planner import Planner
from nomad_sim.fault_injection import FaultInjector
from nomad_sim.headless_parts import Control, Perception
from nomad_sim.mission_log import MissionLog
from nomad_sim.params import simulator_parameters
from nomad_sim.simulator import Simulator
from nomad_sim.telemetry import telemetry_of
from nomad_sim.world import World
from nomad_sim.world_io import load_world

__all__ = ["CONTROL_PERIOD", "HeadlessMission", "MissionLog", "random_start", "run_mission"]

#: Time of a control tick [s]: one pose, one command.
CONTROL_PERIOD = 0.05
#: How often a random start is drawn before the place is given up.
_DRAWS = 1000


class HeadlessMission:
    """One mission, tick by tick.

    Parameters
    ----------
    world : World or str or path
        The world, its name, or its file.
    start : Pose2, optional
        Where the robot starts; by default where the world says.
    goal : tuple of float, optional
        Where it is sent (x, y) [m]; by default where the world says.
    seed : int
        Seed of all noise.
    preset : str
        Rule set of mapper, planner and motion.
    mapper, planner, motion, simulator : mapping, optional
        Single parameters by dotted name that override the preset; the mapped area is the
        world's unless `mapper` says otherwise.

    Attributes
    ----------
    simulator : Simulator
    mapper : FuzzyMapper
    planner : Planner
    mission : Mission
        The core objects at work.
    verdict : Finish or None
        The mission's end, once it has come.

    Raises
    ------
    ValueError
        For an unknown world, preset or parameter, a refused value, a start that overlaps an
        obstacle, or a start or goal that is no place in the world's area.
    """

    def __init__(
        self,
        world: World | str | os.PathLike[str],
        start: Pose2 | None = None,
        goal: tuple[float, float] | None = None,
        seed: int = 0,
        *,
        preset: str = DEFAULT_PRESET,
        mapper: Mapping[str, Any] | None = None,
        planner: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        simulator: Mapping[str, Any] | None = None,
    ) -> None:
        self.world = world if isinstance(world, World) else load_world(world)
        self.goal = self.world.goal if goal is None else _goal(self.world, goal)
        if start is not None:
            _check_start(self.world, start)
        self.simulator = Simulator(
            self.world,
            simulator_parameters({"seed": seed, **(simulator or {})}, self.world.parameters),
            start,
        )
        self.start = self.simulator.pose
        p = mapper_parameters(preset, {**_area(self.world), **(mapper or {})})
        geometry = p.area.geometry()
        self.mapper = FuzzyMapper(geometry, p)
        self.planner = Planner(geometry, planner_parameters(preset, planner))
        drive = motion_parameters(preset, motion)
        self.mission = mission_of(drive)
        self._faults = FaultInjector.of(self.simulator.parameters)
        self._control = Control(self.mission, drive)
        self.verdict: Finish | None = None
        self._perception = Perception(p)
        self._drive = Drive(0.0, 0.0)
        self._handle(self.mission.start(self.now, self.goal))

    @property
    def now(self) -> float:
        """The mission's time [s]."""
        return self._control.now

    def send(self, goal: tuple[float, float]) -> None:
        """Send the robot on to another goal (x, y) [m], with the map that it has.

        Raises
        ------
        ValueError
            If the goal is no place in the world's area.
        """
        self.goal = _goal(self.world, goal)
        self.verdict = None
        self._handle(self.mission.start(self.now, self.goal))

    def tick(self) -> None:
        """Let one control period pass: move, measure, decide."""
        simulator = self.simulator
        simulator.step(self._drive.linear, self._drive.angular, CONTROL_PERIOD)
        told = self._faults.apply(telemetry_of(simulator))
        angle = self._perception.tick(told)
        if angle is not None:
            simulator.command_turret(angle)
        self._control.pass_time(told)
        self._fuse_packet()
        self._finish_perception()
        for commands in self._control.tick(told):
            self._handle(commands)

    def run(
        self,
        on_perception: Callable[[HeadlessMission], None] | None = None,
        time_limit: float = 3600.0,
    ) -> MissionLog:
        """Run the mission to its end.

        Parameters
        ----------
        on_perception : callable, optional
            Called after each perception with this object; `mission.log` has its entry.
        time_limit : float
            Robot's time [s] after which the mission is cancelled.

        Returns
        -------
        MissionLog

        Raises
        ------
        ValueError
            If the time limit is negative or NaN.
        """
        if not time_limit >= 0.0:
            raise ValueError(f"the time limit must be 0 s or longer, got {time_limit!r}")
        began = time.perf_counter()
        logged = len(self.mission.log)
        while self.verdict is None:
            self.tick()
            if on_perception is not None and len(self.mission.log) > logged:
                logged = len(self.mission.log)
                on_perception(self)
            if self.simulator.time > time_limit:
                self._handle(self.mission.cancel(self.now, f"not over after {time_limit:g} s"))
        return self._log(self.verdict, time.perf_counter() - began)

    def _handle(self, commands: Commands) -> None:
        """Carry out the mission's commands."""
        for command in commands:
            if isinstance(command, Drive):
                self._drive = command
            elif isinstance(command, Perceive):
                self._perception.start(command.request)
            elif isinstance(command, Plan):
                plan = self.planner.plan(
                    command.start,
                    command.goal,
                    tolerance=command.tolerance,
                    barred=command.barred,
                    hits=command.hits,
                    slim_radius=command.slim_radius,
                    slim_above=command.slim_above,
                    any_angle=command.any_angle,
                )
                self._handle(self.mission.on_plan(self.now, command.request, plan))
            else:
                self.verdict = command

    def _fuse_packet(self) -> None:
        """Fuse a packet that was gathered on the way and tell the mission."""
        packet = self._perception.full()
        if packet is not None and self.mapper.update(packet).accepted:
            self._perception.fused(standing=False)
            self._publish_maps()

    def _publish_maps(self) -> None:
        # As a message carries them: in whole percent.
        self.planner.set_map(risk_to_int8(self.mapper.planning_risk) / 100.0)
        motion_risk = risk_to_int8(self.mapper.motion_risk) / 100.0
        self._handle(self.mission.on_map(self.now, self.mapper.geometry, motion_risk))

    def _finish_perception(self) -> None:
        """Fuse a perception that has come to its end and tell the mission."""
        ended = self._perception.ended()
        if ended is None:
            return
        request, packet, failure = ended
        now = self.now
        if not failure:
            report = self.mapper.update(packet)
            if report.accepted == 0:
                failure = f"no reading could be used: {report.rejected}"
        if failure:
            self._handle(self.mission.on_perception(now, request, False, failure))
            return
        self._perception.fused(standing=True)
        self.simulator.perception_taken()
        self._publish_maps()
        self._handle(self.mission.on_perception(now, request, True))

    def _log(self, verdict: Finish, wall_time: float) -> MissionLog:
        simulator = self.simulator
        expected = Outcome[self.world.expected.upper()]
        return MissionLog(
            world=self.world.name,
            seed=simulator.parameters.seed,
            start=self.start,
            goal=self.goal,
            outcome=verdict.outcome,
            message=verdict.message,
            truthful=verdict.outcome is expected,
            perceptions=verdict.perceptions,
            path_length=verdict.path_length,
            min_clearance=simulator.least_clearance,
            contacts=simulator.contacts,
            duration=verdict.duration,
            wall_time=wall_time,
            entries=self.mission.log,
            travelled=self.mission.travelled,
            motion_risk=self.mapper.motion_risk.copy(),
            planning_risk=self.mapper.planning_risk.copy(),
        )


def _goal(world: World, goal: tuple[float, float]) -> tuple[float, float]:
    """Return a goal in the world's area, or raise ValueError."""
    try:
        x, y = map(float, goal)
    except (TypeError, ValueError):
        raise ValueError(f"the goal must be a position (x, y) [m], got {goal!r}") from None
    world.check_inside(x, y, "the goal")
    return x, y


def _check_start(world: World, start: Pose2) -> None:
    if not isinstance(start, Pose2):
        raise ValueError(f"the start must be a Pose2(x, y, theta) [m, m, rad], got {start!r}")
    world.check_inside(start.x, start.y, "the start")


def _area(world: World) -> dict[str, float]:
    return {
        "area.size_x": world.size[0],
        "area.size_y": world.size[1],
        "area.origin_x": world.origin[0],
        "area.origin_y": world.origin[1],
    }


def run_mission(
    world: World | str | os.PathLike[str],
    start: Pose2 | None = None,
    goal: tuple[float, float] | None = None,
    seed: int = 0,
    **options: Any,
) -> MissionLog:
    """Run a mission from start to verdict.

    Parameters
    ----------
    world, start, goal, seed
        See `HeadlessMission`.
    **options
        ``on_perception`` and ``time_limit`` of `HeadlessMission.run`; all others are those of
        `HeadlessMission`.

    Returns
    -------
    MissionLog

    Raises
    ------
    ValueError
        See `HeadlessMission`.

    Examples
    --------
    >>> log = run_mission("lab", seed=1)
    >>> log.outcome.name, log.contacts
    ('REACHED', 0)
    """
    run = {name: options.pop(name) for name in ("on_perception", "time_limit") if name in options}
    return HeadlessMission(world, start, goal, seed, **options).run(**run)


def random_start(world: World, seed: int, spread: float = 0.3, clearance: float = 0.05) -> Pose2:
    """Draw a start pose around the world's.

    Parameters
    ----------
    world : World
        The world.
    seed : int
        The same seed gives the same pose; the simulator's noise does not depend on it.
    spread : float
        Largest distance in x and in y from the world's start [m]; the heading is any.
    clearance : float
        Least distance of the body from all surfaces [m].

    Raises
    ------
    ValueError
        If there is no room.
    """
    generator = np.random.default_rng([seed, 1])
    radius = simulator_parameters(None, world.parameters).robot.radius
    surfaces = world.surfaces()
    x_low, y_low = world.origin
    for _ in range(_DRAWS):
        x = world.start.x + generator.uniform(-spread, spread)
        y = world.start.y + generator.uniform(-spread, spread)
        heading = generator.uniform(-np.pi, np.pi)
        inside = x_low <= x < x_low + world.size[0] and y_low <= y < y_low + world.size[1]
        if inside and surfaces.distance(x, y) >= radius + clearance:
            return Pose2(float(x), float(y), float(heading))
    raise ValueError(
        f"no start with {clearance:g} m of clearance within {spread:g} m of "
        f"({world.start.x:g}, {world.start.y:g}) in world '{world.name}'"
    )
