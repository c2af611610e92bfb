# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The run of Fig. 8: an operator guides the robot to 43 places of a corridor and a room."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.perception import PerceptionSequence
from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.follower import Follower
from fuzzy_navigation.params import PAPER_PRESET, motion_parameters
from nomad_sim.headless import CONTROL_PERIOD
from nomad_sim.params import simulator_parameters
from nomad_sim.simulator import Simulator
from nomad_sim.world import World
from nomad_sim.world_io import load_world

#: Perceptions of Fig. 8.
PERCEPTIONS = 43
#: Corners of the way that the operator takes [m]: from the right end of the corridor into the
#: room, round it and out again, past the obstacle, up and down the crossing corridor, past the
#: obstacle's other side, and to the left end. The paper does not give its places; these are
#: spread evenly over the way.
WAY = (
    (16.6, 6.1),
    (11.43, 6.0),
    (11.43, 4.0),
    (11.1, 1.7),
    (13.0, 2.3),
    (15.0, 1.9),
    (15.0, 3.7),
    (12.6, 3.6),
    (11.43, 4.1),
    (11.43, 5.7),
    (10.2, 5.8),
    (9.5, 5.4),
    (8.5, 5.4),
    (7.9, 5.9),
    (8.5, 7.4),
    (8.7, 10.7),
    (9.3, 10.7),
    (9.5, 7.3),
    (9.0, 6.8),
    (7.8, 6.2),
    (1.5, 5.9),
)
#: Where the jambs of the door are (x) in the world `corridor` [m].
DOOR_JAMBS = (11.0, 11.85)
#: Centre (x, y) and side of the small obstacle, the first polygon of that world [m].
OBSTACLE, OBSTACLE_SIZE = (9.05, 6.05), 0.5
#: Longest time for one leg of the way or one perception [s].
TIME_LIMIT = 120.0


@dataclass(frozen=True, eq=False)
class GuidedRun:
    """The map and how it came about.

    Parameters
    ----------
    world : World
        Where it was.
    mapper : FuzzyMapper
        With all perceptions.
    places : ndarray of float64, shape (43, 2)
        Where the robot perceived [m].
    way : ndarray of float64, shape (n, 2)
        Where it was [m].
    readings : int
        Number of readings taken.
    update_times : tuple of float
        Time to compute each update of the map [s].
    contacts : int
        Times that the robot touched something.
    """

    world: World
    mapper: FuzzyMapper
    places: NDArray[np.float64]
    way: NDArray[np.float64]
    readings: int
    update_times: tuple[float, ...]
    contacts: int


def guided_run(
    seed: int,
    critical_angles: Mapping[str, float] | None = None,
    widening: float = 0.0,
) -> GuidedRun:
    """Drive along the way of Fig. 8 and perceive at its 43 places.

    Parameters
    ----------
    seed : int
        Of all noise.
    critical_angles : mapping of str to float, optional
        Other critical angles [rad] of some materials.
    widening : float
        How much wider the narrow places are than in the world `corridor`: the door is wider,
        the small obstacle slimmer by this [m].
    """
    world = _widened(load_world("corridor"), widening)
    world = world.with_critical_angles(critical_angles or {})
    parameters = mapper_parameters("map_building")
    fuzzy = FuzzyMapper(parameters.area.geometry(), parameters)
    operator = _Operator(world, seed, parameters)
    stops = _places()
    times = []
    readings = 0
    for k, stop in enumerate(stops):
        if k:
            operator.drive_to(_leg(stops[k - 1], stop))
        packet = operator.perceive()
        readings += len(packet)
        began = time.perf_counter()
        fuzzy.update(packet)
        times.append(time.perf_counter() - began)
    return GuidedRun(
        world=world,
        mapper=fuzzy,
        places=np.array(operator.places),
        way=np.array(operator.way),
        readings=readings,
        update_times=tuple(times),
        contacts=operator.simulator.contacts,
    )


def _widened(world: World, widening: float) -> World:
    """Return the world with a wider door and a slimmer obstacle, their middles in place."""
    walls = []
    for wall in world.walls:
        points = wall.points.copy()
        for jamb, sign in ((DOOR_JAMBS[0], -0.5), (DOOR_JAMBS[1], 0.5)):
            points[points[:, 0] == jamb, 0] += sign * widening
        walls.append(replace(wall, points=points))
    obstacle, *cabinets = world.polygons
    points = np.array(OBSTACLE) + (obstacle.points - OBSTACLE) * (1.0 - widening / OBSTACLE_SIZE)
    polygons = (replace(obstacle, points=points), *cabinets)
    return replace(world, walls=tuple(walls), polygons=polygons)


def _lengths(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the length of way up to each point [m]."""
    return np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])


def _places() -> list[float]:
    """Return the lengths of way [m] at which the robot stops, evenly spread."""
    total = float(_lengths(np.array(WAY))[-1])
    return [float(at) for at in np.linspace(0.0, total, PERCEPTIONS)]


def _leg(start: float, end: float) -> NDArray[np.float64]:
    """Return the points of the way between two lengths [m], corners included."""
    corners = np.array(WAY)
    lengths = _lengths(corners)
    inner = lengths[(lengths > start + 1e-6) & (lengths < end - 1e-6)]
    at = np.concatenate([[start], inner, [end]])
    return np.column_stack([np.interp(at, lengths, corners[:, k]) for k in (0, 1)])


class _Operator:
    """Drives the simulated robot and has it perceive, as the nodes would."""

    def __init__(self, world: World, seed: int, parameters: MapperParameters) -> None:
        start = Pose2(*WAY[0], world.start.theta)
        self.simulator = Simulator(
            world, simulator_parameters({"seed": seed}, world.parameters), start
        )
        self._follower = Follower(motion_parameters(PAPER_PRESET).follower)
        self._assembler = ReadingAssembler(parameters)
        self._sequence = PerceptionSequence(parameters)
        self.places: list[tuple[float, float]] = []
        self.way: list[tuple[float, float]] = [WAY[0]]

    def drive_to(self, path: NDArray[np.float64]) -> None:
        """Follow a path to its end."""
        pose = self.simulator.pose
        self._follower.follow(np.vstack([[pose.x, pose.y], path[1:]]))
        limit = self.simulator.time + TIME_LIMIT
        while not self._follower.done:
            self._tick(*self._follower.step(self.simulator.pose, CONTROL_PERIOD), limit)
        while self.simulator.velocity.linear or self.simulator.velocity.angular:
            self._tick(0.0, 0.0, limit)
        # What the sonars measured on the way is not of the next perception.
        self._assembler.clear()

    def perceive(self) -> list[SonarReading]:
        """Return the readings of one perception, 3 x 16 of them."""
        simulator, sequence = self.simulator, self._sequence
        sequence.start(simulator.time)
        limit = simulator.time + TIME_LIMIT
        while sequence.active:
            self._tick(0.0, 0.0, limit)
            now = simulator.time
            self._assembler.add_pose(now, simulator.pose, now)
            self._assembler.add_turret(now, simulator.turret_angle, now)
            sequence.on_turret(now, simulator.turret_angle)
            for event in simulator.sonar_events:
                self._assembler.add_range(event.sensor, event.stamp, event.range, now)
            for reading in self._assembler.release(now):
                sequence.on_reading(reading)
            angle = sequence.step(now)
            if angle is not None:
                simulator.command_turret(angle)
        if sequence.failed:
            raise RuntimeError(sequence.failed)
        self.places.append((simulator.pose.x, simulator.pose.y))
        return sequence.readings

    def _tick(self, linear: float, angular: float, limit: float) -> None:
        if self.simulator.time > limit:
            pose = self.simulator.pose
            raise RuntimeError(f"the robot is stuck at ({pose.x:.2f}, {pose.y:.2f}) m")
        self.simulator.step(linear, angular, CONTROL_PERIOD)
        self.way.append((self.simulator.pose.x, self.simulator.pose.y))
