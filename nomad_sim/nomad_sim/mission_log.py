# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What came of a mission."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import LogEntry, Outcome

__all__ = ["MissionLog"]


@dataclass(frozen=True, eq=False)
class MissionLog:
    """What came of a mission.

    Attributes
    ----------
    world : str
        Name of the world.
    seed : int
        Seed of the simulator.
    start : Pose2
        Where the robot started.
    goal : tuple of float
        Where it was sent (x, y) [m].
    outcome : Outcome
        Verdict of the mission.
    message : str
        The verdict in words.
    truthful : bool
        Whether the verdict is the one that the world expects.
    perceptions : int
        Perceptions made.
    path_length : float
        Length of the way driven [m].
    min_clearance : float
        Least true distance of the body to a surface [m].
    contacts : int
        Times that the body touched something.
    duration : float
        Robot's time [s].
    wall_time : float
        Time that it took to compute [s].
    entries : tuple of LogEntry
        One for each perception.
    travelled : ndarray of float64, shape (n, 2)
        Positions (x, y) along the way [m].
    motion_risk, planning_risk : ndarray of float64, shape (H, W)
        The last maps.
    """

    world: str
    seed: int
    start: Pose2
    goal: tuple[float, float]
    outcome: Outcome
    message: str
    truthful: bool
    perceptions: int
    path_length: float
    min_clearance: float
    contacts: int
    duration: float
    wall_time: float
    entries: tuple[LogEntry, ...]
    travelled: NDArray[np.float64]
    motion_risk: NDArray[np.float64]
    planning_risk: NDArray[np.float64]

    @property
    def reached(self) -> bool:
        """Whether the robot came to its goal."""
        return self.outcome is Outcome.REACHED
