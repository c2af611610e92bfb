# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How the robot moves: a unicycle with limited drives, which obstacles stop, and its turret."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from fuzzy_map_building.types import Pose2
from nomad_sim.beam import wrapped
from nomad_sim.ray_casting import nearest_distance

__all__ = ["ROUNDING", "Velocity", "arc", "arc_end", "drive", "next_velocity", "turned"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Overlap with an obstacle that is none: driving along a wall in touch with it must not jam [m].
ROUNDING = 1e-9
# Clearance at which the body rests on what it touches [m].
_RESTING = 1e-7
# Halvings of the way after which the place of a touch is known.
_HALVINGS = 20


class Velocity(NamedTuple):
    """Speed [m/s] and turning rate [rad/s]."""

    linear: float = 0.0
    angular: float = 0.0


@njit
def arc_end(
    x: float, y: float, theta: float, linear: float, angular: float, dt: float
) -> tuple[float, float, float]:
    """Return the pose after an arc, as `arc` does, in numbers."""
    half = 0.5 * angular * dt
    # The chord of the arc: sin(half)/half of its length, along its mean direction.
    chord = linear * dt * (math.sin(half) / half if half != 0.0 else 1.0)
    turned_to = theta + angular * dt
    if not -math.pi <= turned_to < math.pi:  # wrapping rounds: standing still must not turn
        turned_to = wrapped(turned_to)
    return x + chord * math.cos(theta + half), y + chord * math.sin(theta + half), turned_to


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
    return Pose2(*arc_end(pose.x, pose.y, pose.theta, linear, angular, dt))


@njit
def _towards(value: float, target: float, gain: float, loss: float) -> float:
    """Return `value` brought towards `target`: growing by `gain` at most, shrinking by `loss`."""
    if value * target < 0.0:
        target = 0.0  # to a standstill before the other way round
    limit = loss if abs(target) < abs(value) else gain
    return value + min(limit, max(-limit, target - value))


@njit
def next_velocity(
    linear: float,
    angular: float,
    target_linear: float,
    target_angular: float,
    max_linear: float,
    max_angular: float,
    linear_acceleration: float,
    linear_deceleration: float,
    angular_acceleration: float,
    dt: float,
) -> tuple[float, float]:
    """Return speed and turning rate after `dt` [s] of bringing them to the commanded ones.

    Commands beyond the limits of the drives are cut to them.

    Parameters
    ----------
    linear, angular, target_linear, target_angular : float
        Present and commanded speed [m/s] and turning rate [rad/s].
    max_linear, max_angular, linear_acceleration, linear_deceleration, angular_acceleration : float
        Limits, see `RobotParameters`.
    dt : float
        Time [s].
    """
    target_linear = min(max_linear, max(-max_linear, target_linear))
    target_angular = min(max_angular, max(-max_angular, target_angular))
    turn = angular_acceleration * dt
    return (
        _towards(linear, target_linear, linear_acceleration * dt, linear_deceleration * dt),
        _towards(angular, target_angular, turn, turn),
    )


@njit
def _until_touch(
    x: float,
    y: float,
    theta: float,
    linear: float,
    angular: float,
    dt: float,
    radius: float,
    segments: FloatArray,
    circles: FloatArray,
    solids: IntArray,
) -> tuple[float, float]:
    """Return which part of an arc the body drives before it touches, and its clearance there.

    See `drive`; the part is 1 without a touch, the clearance [m] negative inside an obstacle.
    """
    end = arc_end(x, y, theta, linear, angular, dt)
    clearance = nearest_distance(end[0], end[1], segments, circles, solids) - radius
    if linear == 0.0 or clearance >= -ROUNDING:
        return 1.0, clearance
    now = nearest_distance(x, y, segments, circles, solids) - radius
    # Whoever is inside an obstacle, since it came over him, may still get out.
    least = min(-ROUNDING, now)
    if clearance >= least:
        return 1.0, clearance
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS if now > _RESTING else 0):
        middle = 0.5 * (low + high)
        there = arc_end(x, y, theta, linear, angular, middle * dt)
        if nearest_distance(there[0], there[1], segments, circles, solids) - radius >= least:
            low = middle
        else:
            high = middle
    end = arc_end(x, y, theta, linear, angular, low * dt)
    return low, nearest_distance(end[0], end[1], segments, circles, solids) - radius


@njit
def drive(
    x: float,
    y: float,
    theta: float,
    linear: float,
    angular: float,
    target_linear: float,
    target_angular: float,
    times: FloatArray,
    limits: FloatArray,
    radius: float,
    segments: FloatArray,
    circles: FloatArray,
    solids: IntArray,
) -> FloatArray:
    """Drive towards a commanded velocity, and stand where the body touches something.

    Parameters
    ----------
    x, y, theta : float
        Where the robot is [m, m, rad].
    linear, angular, target_linear, target_angular : float
        Present and commanded speed [m/s] and turning rate [rad/s].
    times : ndarray of float64, shape (n,)
        Times [s] one after the other, in each of which the velocity stays the same.
    limits : ndarray of float64, shape (5,)
        Of the drives, as `next_velocity` takes them.
    radius : float
        Radius of the body [m].
    segments, circles, solids : ndarray
        Surfaces, as for `ray_casting.nearest_distance`.

    Returns
    -------
    ndarray of float64, shape (n, 7)
        Of each time: velocity [m/s, rad/s], pose at its end [m, m, rad], for which part of it
        the robot drove, and its clearance there [m]. Where the part is below 1 it stands then.
    """
    track = np.empty((len(times), 7))
    for i in range(len(times)):
        linear, angular = next_velocity(
            linear,
            angular,
            target_linear,
            target_angular,
            limits[0],
            limits[1],
            limits[2],
            limits[3],
            limits[4],
            times[i],
        )
        part, clearance = _until_touch(
            x, y, theta, linear, angular, times[i], radius, segments, circles, solids
        )
        x, y, theta = arc_end(x, y, theta, linear, angular, part * times[i])
        track[i, 0] = linear
        track[i, 1] = angular
        track[i, 2] = x
        track[i, 3] = y
        track[i, 4] = theta
        track[i, 5] = part
        track[i, 6] = clearance
        if part < 1.0:
            linear = angular = 0.0
    return track


def turned(angle: float, target: float, limit: float) -> float:
    """Return a turret angle [rad] brought towards its target by at most `limit` [rad]."""
    return angle + min(limit, max(-limit, target - angle))
