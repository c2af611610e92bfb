# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whether the poses that come can be those of a robot that does what it is told."""

from __future__ import annotations

import math

from fuzzy_map_building.types import Pose2, wrap_angle
from fuzzy_navigation.motion_params import FollowerParameters, WatchParameters

__all__ = ["PoseWatch"]

#: A pose this far from where it was has changed [m].
CHANGE = 0.02


class PoseWatch:
    """Compares poses with the robot's limits and with its commands.

    Parameters
    ----------
    watch : WatchParameters
        What passes.
    follower : FollowerParameters
        Limits of the robot.

    Examples
    --------
    >>> watch = PoseWatch(WatchParameters(), FollowerParameters())
    >>> watch.jump(Pose2(1.0, 1.0), Pose2(1.02, 1.0), 0.05)
    ''
    >>> watch.jump(Pose2(1.0, 1.0), Pose2(1.0, 2.0), 0.05)
    'the pose jumped by 1.00 m and 0 deg within 0.05 s'
    """

    def __init__(self, watch: WatchParameters, follower: FollowerParameters) -> None:
        self.adopt(watch, follower)
        self._since: Pose2 | None = None
        self._commanded = 0.0

    def adopt(self, watch: WatchParameters, follower: FollowerParameters) -> None:
        """Go by other parameters, those of the constructor."""
        self._p = watch
        self._limits = follower

    def jump(self, before: Pose2, pose: Pose2, dt: float) -> str:
        """Return how a pose lies farther from the one before than the robot can have come.

        Parameters
        ----------
        before, pose : Pose2
            The poses.
        dt : float
            Time between them [s].
        """
        way = before.distance_to(pose.x, pose.y)
        turn = abs(wrap_angle(pose.theta - before.theta))
        far = way > self._p.pose_jump + self._limits.max_linear * dt
        if not far and turn <= self._p.pose_turn + self._limits.max_angular * dt:
            return ""
        degrees = math.degrees(turn)
        return f"the pose jumped by {way:.2f} m and {degrees:.0f} deg within {dt:.2f} s"

    def frozen(self, pose: Pose2, speed: float, dt: float) -> str:
        """Return that a robot that is driven does not change its pose.

        Parameters
        ----------
        pose : Pose2
            Where it is said to be.
        speed : float
            Speed commanded since the call before [m/s].
        dt : float
            Time since then [s].
        """
        if self._since is None or self._since.distance_to(pose.x, pose.y) >= CHANGE:
            self._since, self._commanded = pose, 0.0
            return ""
        self._commanded += abs(speed) * dt
        if self._commanded <= self._p.pose_frozen:
            return ""
        return (
            f"the robot was driven for {self._commanded:.2f} m and is still said to be at "
            f"({pose.x:.2f}, {pose.y:.2f}) m: the pose stays, or something unseen holds the robot"
        )
