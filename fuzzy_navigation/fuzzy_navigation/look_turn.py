# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A turn on the spot, so that the next look from the same place goes along other rays."""

from __future__ import annotations

import math

from fuzzy_map_building.types import Pose2, wrap_angle
from fuzzy_navigation.motion_params import FollowerParameters

__all__ = ["LookTurn"]

#: Heading error [rad] at which the turn ends.
ALIGNED = math.radians(1.0)
#: Rate at which the error is corrected [1/s]: slow enough for commands that come a tick late.
RATE = 4.0
#: Time that a turn may take [s], in times of the least that it needs, and on top of them.
SLOWNESS, PAUSE = 3.0, 1.0


class LookTurn:
    """Turns the robot by an angle, and gives up on one that does not turn.

    Parameters
    ----------
    angle : float
        By how much [rad]; 0: not at all.
    follower : FollowerParameters
        Limits of the robot.
    """

    def __init__(self, angle: float, follower: FollowerParameters) -> None:
        self._angle = angle
        self._p = follower
        self._heading = 0.0
        self._left = 0.0
        self._omega = 0.0

    def begin(self, pose: Pose2) -> bool:
        """Set out from a pose; tell whether there is anything to do."""
        self._heading = pose.theta + self._angle
        self._left = SLOWNESS * self._angle / self._p.max_angular + PAUSE
        self._omega = 0.0
        return self._angle != 0.0

    def step(self, pose: Pose2, dt: float) -> float | None:
        """Return the turning rate of one tick [rad/s], None once the turn is over.

        Parameters
        ----------
        pose : Pose2
            Where the robot is.
        dt : float
            Time since the last tick [s].
        """
        self._left -= dt
        error = wrap_angle(self._heading - pose.theta)
        if abs(error) <= ALIGNED or self._left <= 0.0:
            return None
        change = self._p.angular_acceleration * dt
        wanted = min(max(RATE * error, -self._p.max_angular), self._p.max_angular)
        self._omega = min(max(wanted, self._omega - change), self._omega + change)
        return self._omega
