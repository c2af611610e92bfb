# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions as values: what is to be run, and what came of it in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import Outcome
from nomad_sim.headless import HeadlessMission, MissionLog, random_start
from nomad_sim.world import World

__all__ = ["MissionResult", "MissionSpec", "run_spec"]


@dataclass(frozen=True, eq=False)
class MissionSpec:
    """Everything that a mission depends on: the same values give the same run.

    Parameters
    ----------
    world : World
        Where it takes place.
    seed : int
        Seed of the start pose and of all noise.
    preset : str
        Rule set of mapper, planner and motion.
    start_spread : float
        Largest distance in x and in y of the start from the world's [m], at any heading; 0:
        the world's start and heading.
    mapper, planner, motion, simulator : mapping
        Single parameters by dotted name.
    """

    world: World
    seed: int
    preset: str
    start_spread: float = 0.3
    mapper: Mapping[str, Any] = field(default_factory=dict)
    planner: Mapping[str, Any] = field(default_factory=dict)
    motion: Mapping[str, Any] = field(default_factory=dict)
    simulator: Mapping[str, Any] = field(default_factory=dict)

    def start(self) -> Pose2:
        """Return the start pose.

        Raises
        ------
        ValueError
            If there is no room for one.
        """
        if self.start_spread == 0.0:
            return self.world.start
        return random_start(self.world, self.seed, self.start_spread)

    def mission(self) -> HeadlessMission:
        """Return the mission, ready to run.

        Raises
        ------
        ValueError
            For anything that does not fit: see `HeadlessMission`.
        """
        return HeadlessMission(
            self.world,
            self.start(),
            seed=self.seed,
            preset=self.preset,
            mapper=self.mapper,
            planner=self.planner,
            motion=self.motion,
            simulator=self.simulator,
        )


@dataclass(frozen=True)
class MissionResult:
    """The numbers of a mission.

    Parameters
    ----------
    seed : int
        Its seed.
    start_x, start_y, start_heading : float
        Where it began [m, rad].
    outcome : str
        Name of the verdict's `Outcome`.
    truthful : bool
        Whether the verdict is true of the world.
    perceptions : int
        Perceptions made.
    path_length : float
        Length of the way driven [m].
    min_clearance : float
        Least true distance of the body to a surface [m].
    contacts : int
        Times that the body touched something.
    duration, wall_time : float
        Robot's time, and time to compute it [s].
    message : str
        The verdict in words.
    """

    seed: int
    start_x: float
    start_y: float
    start_heading: float
    outcome: str
    truthful: bool
    perceptions: int
    path_length: float
    min_clearance: float
    contacts: int
    duration: float
    wall_time: float
    message: str

    @classmethod
    def of(cls, log: MissionLog) -> MissionResult:
        """Return the numbers of a mission's log."""
        return cls(
            seed=log.seed,
            start_x=log.start.x,
            start_y=log.start.y,
            start_heading=log.start.theta,
            outcome=log.outcome.name,
            truthful=log.truthful,
            perceptions=log.perceptions,
            path_length=log.path_length,
            min_clearance=log.min_clearance,
            contacts=log.contacts,
            duration=log.duration,
            wall_time=log.wall_time,
            message=log.message,
        )

    @property
    def reached(self) -> bool:
        """Whether the robot came to its goal."""
        return self.outcome == Outcome.REACHED.name

    @property
    def flawless(self) -> bool:
        """Whether the verdict is true and nothing was touched."""
        return self.truthful and self.contacts == 0


def run_spec(spec: MissionSpec) -> MissionResult:
    """Run a mission and return its numbers."""
    return MissionResult.of(spec.mission().run())
