# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What goes into and comes out of a mission: commands, verdicts, feedback, log."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fuzzy_map_building.types import Pose2

__all__ = [
    "Command",
    "Commands",
    "Drive",
    "Feedback",
    "Finish",
    "LogEntry",
    "Outcome",
    "Perceive",
    "Phase",
    "Plan",
    "Stop",
]


class Outcome(IntEnum):
    """Verdict of a mission, with the numbers of ``Navigate.action``."""

    REACHED = 0
    UNREACHABLE = 1
    LIVELOCK = 2
    CANCELED = 3
    FAILED = 4


class Phase(IntEnum):
    """What the robot is doing, with the numbers of ``Navigate.action``."""

    PERCEIVING = 0
    PLANNING = 1
    MOVING = 2


class Stop(IntEnum):
    """Why the robot last stopped, with the numbers of ``Navigate.action``."""

    NONE = 0
    GOAL = 1
    UNEXPLORED = 2
    CLEARANCE = 3


@dataclass(frozen=True)
class Perceive:
    """Make a perception where the robot stands; answer with ``Mission.on_perception``.

    Parameters
    ----------
    request : int
        Serial number that the answer has to carry.
    """

    request: int


@dataclass(frozen=True)
class Plan:
    """Plan a path; answer with ``Mission.on_plan`` or ``Mission.on_plan_error``.

    Parameters
    ----------
    request : int
        Serial number that the answer has to carry.
    start, goal : Pose2
        Where the robot stands, and where it is to go [m, rad].
    tolerance : float
        Distance from the goal within which the path may end [m].
    barred : tuple of (float, float)
        Positions (x, y) [m] of cells that no path may enter.
    hits : tuple of (float, float)
        Points (x, y) [m] that the sensors have hit.
    slim_radius, slim_above : float
        As `Planner.plan` takes them.
    any_angle : bool
        Whether straight lines at any angle are wanted.
    """

    request: int
    start: Pose2
    goal: Pose2
    tolerance: float
    barred: tuple[tuple[float, float], ...] = ()
    hits: tuple[tuple[float, float], ...] = ()
    slim_radius: float = 0.0
    slim_above: float = 0.0
    any_angle: bool = False


@dataclass(frozen=True)
class Drive:
    """Move with a speed [m/s] and a turning rate [rad/s] until the next such command."""

    linear: float
    angular: float


@dataclass(frozen=True)
class Finish:
    """The mission is over.

    Parameters
    ----------
    mission : int
        Serial number of the mission, as ``Mission.start`` counts them.
    outcome : Outcome
        Verdict.
    message : str
        The same in words.
    perceptions : int
        Perceptions made.
    path_length : float
        Length of the path that the robot came [m].
    min_clearance : float
        Least distance of the body from an infrared hit point [m], +inf without any.
    duration : float
        Time from start to end [s].
    """

    mission: int
    outcome: Outcome
    message: str
    perceptions: int
    path_length: float
    min_clearance: float
    duration: float

    def __str__(self) -> str:
        """Return the verdict in a line."""
        return (
            f"mission {self.mission} {self.outcome.name}: {self.message} "
            f"({self.perceptions} perceptions, {self.path_length:.2f} m, {self.duration:.1f} s)"
        )


Command = Perceive | Plan | Drive | Finish
Commands = tuple[Command, ...]


@dataclass(frozen=True)
class Feedback:
    """State of a running mission.

    Parameters
    ----------
    phase, last_stop : Phase, Stop
        What the robot does, and why it last stopped.
    perceptions : int
        Perceptions made so far.
    alpha : float
        Rung that the present path was found on; 0 before the first path.
    distance_remaining : float
        Length of the path to the goal that is left [m]; the straight distance before the
        first path, NaN before the first pose and the first goal.
    pose : Pose2 or None
        Where the robot is; None before the first pose.
    hold : str
        Why a robot that should move stands; empty if it does not.
    """

    phase: Phase
    last_stop: Stop
    perceptions: int
    alpha: float
    distance_remaining: float
    pose: Pose2 | None
    hold: str


@dataclass(frozen=True)
class LogEntry:
    """One perception of a mission.

    Parameters
    ----------
    perception : int
        Serial number in the mission, from 1.
    stamp : float
        When it ended [s].
    pose : Pose2
        Where it was made.
    stop : Stop
        Why the robot had stopped there; NONE at the start and on the way.
    alpha : float
        Rung of the path that led there; 0 for the first.
    distance_remaining : float
        As in `Feedback` [m].
    on_the_way : bool
        Whether the map was made while the robot moved, without a stop.
    """

    perception: int
    stamp: float
    pose: Pose2
    stop: Stop
    alpha: float
    distance_remaining: float
    on_the_way: bool = False
