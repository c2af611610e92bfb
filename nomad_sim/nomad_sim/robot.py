# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How the robot moves: a unicycle with limited drives, and the turret on it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzy_map_building.types import Pose2, wrap_angle
from nomad_sim.params import RobotParameters

__all__ = ["Velocity", "arc", "next_velocity", "turned"]


@dataclass(frozen=True)
class Velocity:
    """Speed [m/s] and turning rate [rad/s]."""

    linear: float = 0.0
    angular: float = 0.0


def arc(pose: Pose2, linear: float, angular: float, dt: float) -> Pose2:
    """Return the pose after driving an arc at constant velocity, exactly.

    Parameters
    ----------
    pose : Pose2
        Where the robot is.
    linear, angular : float
        Speed [m/s] and turning rate [rad/s].
    dt : float
        Time [s].

    Examples
    --------
    >>> end = arc(Pose2(0.0, 0.0, 0.0), math.pi / 2, math.pi / 2, 1.0)
    >>> round(end.x, 9), round(end.y, 9), round(end.theta, 9) == round(math.pi / 2, 9)
    (1.0, 1.0, True)
    """
    half = 0.5 * angular * dt
    # The chord of the arc: sin(half)/half of its length, along its mean direction.
    chord = linear * dt * (math.sin(half) / half if half != 0.0 else 1.0)
    theta = pose.theta + angular * dt
    if not -math.pi <= theta < math.pi:  # wrapping rounds: standing still must not turn
        theta = wrap_angle(theta)
    return Pose2(
        pose.x + chord * math.cos(pose.theta + half),
        pose.y + chord * math.sin(pose.theta + half),
        theta,
    )


def _towards(value: float, target: float, gain: float, loss: float) -> float:
    """Return `value` brought towards `target`: growing by `gain` at most, shrinking by `loss`."""
    if value * target < 0.0:
        target = 0.0  # to a standstill before the other way round
    limit = loss if abs(target) < abs(value) else gain
    return value + min(limit, max(-limit, target - value))


def next_velocity(
    velocity: Velocity, target: Velocity, limits: RobotParameters, dt: float
) -> Velocity:
    """Return the velocity after `dt` [s] of bringing it to the commanded one.

    Commands beyond the limits of the drives are cut to them.
    """
    linear = min(limits.max_linear, max(-limits.max_linear, target.linear))
    angular = min(limits.max_angular, max(-limits.max_angular, target.angular))
    turn = limits.angular_acceleration * dt
    return Velocity(
        _towards(
            velocity.linear,
            linear,
            limits.linear_acceleration * dt,
            limits.linear_deceleration * dt,
        ),
        _towards(velocity.angular, angular, turn, turn),
    )


def turned(angle: float, target: float, limit: float) -> float:
    """Return a turret angle [rad] brought towards its target by at most `limit` [rad]."""
    return angle + min(limit, max(-limit, target - angle))
