# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What was seen of a mission from outside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import LogEntry, Outcome

__all__ = ["MapSnapshot", "MissionRecord", "Verdict"]


@dataclass(frozen=True, eq=False)
class MapSnapshot:
    """A map as it was published.

    Parameters
    ----------
    stamp : float
        Simulated time [s].
    geometry : GridGeometry
        Where it lies.
    values : ndarray of int8, shape (height, width)
        Risks in percent.
    """

    stamp: float
    geometry: GridGeometry
    values: NDArray[np.int8]

    @property
    def risk(self) -> NDArray[np.float64]:
        """Risks in [0, 1], shape (height, width)."""
        return self.values / 100.0


@dataclass(frozen=True)
class Verdict:
    """How the mission ended, as the motion sees it.

    Parameters
    ----------
    outcome : Outcome
    message : str
        The same in words.
    perceptions : int
        Perceptions made.
    path_length : float
        Length of the way driven [m].
    min_clearance : float
        Least clearance that the infrared sensors measured [m].
    duration : float
        Simulated time from start to end [s].
    """

    outcome: Outcome
    message: str
    perceptions: int
    path_length: float
    min_clearance: float
    duration: float


@dataclass
class MissionRecord:
    """All that was seen.

    Attributes
    ----------
    log : list of LogEntry
        What the mission told of each perception when it was made.
    motion_maps, planning_maps : list of MapSnapshot
        In the order of their publication.
    plans : list of (stamp, ndarray of float64, shape (n, 2))
        Planned paths [m], with the stamps [s] of the maps that they were planned on.
    way : list of (stamp, x, y)
        True positions [s, m, m], a point a centimetre.
    time : float
        Simulated time that was last heard of [s]; 0 before the first.
    started : float
        Simulated time at which the goal was sent [s]; 0 before.
    pose : Pose2, optional
        Newest true pose.
    simulator : mapping of str to str
        The simulator's newest diagnostics.
    parameters : dict of str to dict
        Values of parameters by node and name, as far as they have been answered.
    verdict : Verdict, optional
        Once the mission is over.
    """

    log: list[LogEntry] = field(default_factory=list)
    motion_maps: list[MapSnapshot] = field(default_factory=list)
    planning_maps: list[MapSnapshot] = field(default_factory=list)
    plans: list[tuple[float, NDArray[np.float64]]] = field(default_factory=list)
    way: list[tuple[float, float, float]] = field(default_factory=list)
    time: float = 0.0
    started: float = 0.0
    pose: Pose2 | None = None
    simulator: Mapping[str, str] = field(default_factory=dict)
    parameters: dict[str, dict[str, Any]] = field(default_factory=dict)
    verdict: Verdict | None = None

    @property
    def perceptions(self) -> int:
        """Serial number of the newest perception that was told of, 0 before the first."""
        return self.log[-1].perception if self.log else 0
