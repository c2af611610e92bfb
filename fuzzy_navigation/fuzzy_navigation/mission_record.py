# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a mission has done so far: counters, way and log."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_map_building.wording import as_meant
from fuzzy_navigation.mission_types import Finish, LogEntry, Outcome, Stop
from fuzzy_navigation.plan_types import MAX_TOLERANCE

__all__ = ["MissionRecord", "checked_tolerance"]

#: How much nearer than the tolerance a path has to end, for the robot does not stop exactly [m].
ARRIVAL_MARGIN = 0.01
#: Distance between two recorded positions [m].
SPACING = 0.02
# Of the least clearance and of what a float32 message has carried: micrometres.
_DECIMALS = 6


def checked_tolerance(tolerance: float) -> float:
    """Return the tolerance [m] of a goal, 0 meaning the parameter's, as before a float32 message.

    Raises
    ------
    ValueError
        If it is negative, not finite, or too small for the robot's accuracy.
    """
    least = 2.0 * ARRIVAL_MARGIN
    tolerance = round(tolerance, _DECIMALS) or tolerance  # what is small does not become 0
    if tolerance != 0.0 and not least <= tolerance <= MAX_TOLERANCE:
        raise ValueError(
            f"the goal's tolerance must be at least {least} m and at most {MAX_TOLERANCE:g} m, "
            f"or 0 for the parameter 'goal_tolerance', got {as_meant(tolerance)}"
        )
    return tolerance


class MissionRecord:
    """Counters, way and log of one mission.

    Parameters
    ----------
    mission : int
        Serial number.
    goal : Pose2
        Where to go [m].
    tolerance : float
        Distance from the goal that counts as reached [m].
    started : float
        Time of the start [s].
    """

    def __init__(self, mission: int, goal: Pose2, tolerance: float, started: float) -> None:
        self.mission = mission
        self.goal = goal
        self.tolerance = tolerance
        self.started = started
        self.perceptions = 0
        self.alpha = 0.0
        self.last_stop = Stop.NONE
        self.because = ""
        self.without_progress = 0
        self.log: list[LogEntry] = []
        self._path_length = 0.0
        self._min_clearance = math.inf
        self._last: Pose2 | None = None
        self._way: list[tuple[float, float]] = []

    @property
    def path_length(self) -> float:
        """Length of the way that the robot came [m]."""
        return self._path_length

    @property
    def path_tolerance(self) -> float:
        """Distance from the goal within which a path may end [m]."""
        return self.tolerance - ARRIVAL_MARGIN

    @property
    def looked_in_vain(self) -> int:
        """How many perceptions in a row have not ended a stop for want of clearance."""
        return self.without_progress if self.last_stop is Stop.CLEARANCE else 0

    @property
    def travelled(self) -> NDArray[np.float64]:
        """Positions (x, y) along the way [m], shape (m, 2)."""
        return np.array(self._way, dtype=np.float64).reshape(-1, 2)

    def pass_by(self, pose: Pose2, clearance: float) -> None:
        """Take note of a pose and of the clearance [m] measured there."""
        if self._last is not None:
            self._path_length += self._last.distance_to(pose.x, pose.y)
        self._last = pose
        self._min_clearance = min(self._min_clearance, clearance)
        if not self._way or pose.distance_to(*self._way[-1]) >= SPACING:
            self._way.append((pose.x, pose.y))

    def perceived(
        self, now: float, pose: Pose2, distance_remaining: float, on_the_way: bool = False
    ) -> None:
        """Count a perception and log it."""
        self.perceptions += 1
        stop = Stop.NONE if on_the_way else self.last_stop
        told = (now, pose, stop, self.alpha, distance_remaining, on_the_way)
        self.log.append(LogEntry(self.perceptions, *told))

    def stopped(self, reason: Stop, progress: bool, because: str = "") -> None:
        """Take note of why the robot stopped and whether it had come on since it perceived."""
        self.last_stop, self.because = reason, because
        self.without_progress = 0 if progress else self.without_progress + 1

    def finish(self, outcome: Outcome, message: str, time: float) -> Finish:
        """Return the verdict with the counters."""
        if outcome is Outcome.REACHED:
            self.last_stop = Stop.GOAL
        return Finish(
            self.mission,
            outcome,
            message,
            self.perceptions,
            self._path_length,
            # A sensor that touches something reads 0, less a rounding error.
            round(self._min_clearance, _DECIMALS) + 0.0,
            time - self.started,
        )
