# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Drives a unicycle along a path within its limits, and stops it precisely."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.types import Pose2, wrap_angle
from fuzzy_navigation.params import FollowerParameters
from fuzzy_navigation.path_smoothing import Leg, SmoothPath, smooth_path

__all__ = ["Follower", "warm_up"]

Floats = NDArray[np.float64]

#: Rates [1/s] at which errors are corrected: slow enough for commands that come a tick late.
POSITION_RATE = 5.0
HEADING_RATE = 4.0
LATERAL_RATE = 2.5
#: Lateral errors are corrected over this distance at least [m].
LATERAL_DISTANCE = 0.08
#: Part of the angular acceleration that a planned change of curvature may take.
CURVATURE_PART = 0.8
#: Part of the linear acceleration that a planned braking takes; the rest is in reserve.
BRAKING_PART = 0.8
#: Heading error [rad] at which a turn on the spot ends.
ALIGNED = math.radians(1.0)
#: Part of the arrival distance at which the robot is told to stand: the rest is its own error.
ARRIVAL_PART = 0.25
#: How far from where it was along the path the robot is looked for [m].
SEARCH = 0.1
#: Slowest useful speed [m/s]: below it a command moves nothing in a tick.
CREEP = 1e-3


@njit
def _nearest(x: float, y: float, points: Floats) -> int:
    """Return the number of the point, of shape (n, 2), that is nearest to (x, y) [m]."""
    nearest, least = 0, math.inf
    for i in range(len(points)):
        dx = x - points[i, 0]
        dy = y - points[i, 1]
        square = dx * dx + dy * dy
        if square < least:
            nearest, least = i, square
    return nearest


def warm_up() -> None:
    """Compile the kernel, or load it from the cache."""
    _nearest(0.0, 0.0, for_kernel(np.zeros((1, 2))))


class Follower:
    """Follows one path at a time.

    The path is rounded (`path_smoothing`), a speed is laid along it that the turning rate and
    its acceleration allow, and the pose is fed back. Before a leg the robot turns on the spot.

    Parameters
    ----------
    parameters : FollowerParameters
        Limits of the robot.
    aligned : float
        Heading error [rad] at which a turn on the spot ends; what is left the robot turns by as
        it drives off.
    """

    def __init__(self, parameters: FollowerParameters, aligned: float = ALIGNED) -> None:
        self._p = parameters
        self._aligned = aligned
        self._path = SmoothPath((), np.zeros(1))
        self._s = np.zeros(1)
        self._xy = np.zeros((1, 2))
        self._vertices = np.zeros((1, 2))
        self._vertex_s = [0.0]
        self._speed: list[Floats] = []
        self._leg = 0
        self._turning = True
        self._progress = 0.0
        self._deviation = 0.0
        self._v = 0.0
        self._omega = 0.0
        self._arrived = True

    def adopt(self, parameters: FollowerParameters, aligned: float) -> None:
        """Go by other limits, those of the constructor; a path in hand is kept as it is bent.

        On the way no other limit of `FollowerParameters` may change than `max_linear`.
        """
        self._p, self._aligned = parameters, aligned
        self._speed = [self._speed_limit(leg) for leg in self._path.legs]

    @property
    def length(self) -> float:
        """Length of the driven path [m]."""
        return self._path.length

    @property
    def progress(self) -> float:
        """Distance along the path that the robot has come [m]."""
        return self._progress

    @property
    def remaining(self) -> float:
        """Distance along the path to its end [m]."""
        return self.length - self._progress

    @property
    def vertex_progress(self) -> Floats:
        """Progress [m] at which each point given to `follow` is passed, shape (n,)."""
        return self._path.vertex_s

    @property
    def vertices(self) -> Floats:
        """Points (x, y) [m] of the driven path there, shape (n, 2)."""
        return self._vertices

    def vertices_until(self, progress: float) -> int:
        """Return how many of the points given to `follow` are passed at some progress [m]."""
        return bisect_right(self._vertex_s, progress)

    @property
    def deviation(self) -> float:
        """Distance of the robot from the driven path at the last step [m]."""
        return self._deviation

    @property
    def velocity(self) -> tuple[float, float]:
        """The last command: speed [m/s] and turning rate [rad/s]."""
        return self._v, self._omega

    @property
    def standing(self) -> bool:
        """Whether the last command was to stand."""
        return self._v == 0.0 and self._omega == 0.0

    @property
    def done(self) -> bool:
        """Whether the robot stands at the path's last point."""
        return self._arrived and self.standing

    def follow(self, path_xy: ArrayLike, *, moving: bool = False) -> None:
        """Take a new path.

        Parameters
        ----------
        path_xy : array_like, shape (n, 2)
            Points (x, y) [m], the first one where the robot is.
        moving : bool
            Whether a robot that moves goes over to it without a stop; if not, it turns on the
            spot before it sets out.

        Raises
        ------
        ValueError
            If there is no point or one is not finite; the old path stays.
        """
        path = smooth_path(path_xy, self._p.max_deviation)
        self._speed = [self._speed_limit(leg) for leg in path.legs]
        self._path = path
        if path.legs:
            self._s = np.concatenate([leg.s for leg in path.legs])
            self._xy = np.concatenate([leg.xy for leg in path.legs])
        else:
            self._s = np.zeros(1)
            self._xy = np.asarray(path_xy, dtype=np.float64)[:1]
        # Asked for at every tick.
        self._vertices = self.points_at(path.vertex_s)
        self._vertex_s = path.vertex_s.tolist()
        self._leg = 0
        self._turning = self._turning or not moving
        self._progress = 0.0
        self._deviation = 0.0
        self._arrived = not path.legs

    def points_at(self, progress: ArrayLike) -> Floats:
        """Return the points (x, y) [m] of the driven path at some progress [m], shape (m, 2)."""
        wanted = np.asarray(progress, dtype=np.float64)
        return np.column_stack([np.interp(wanted, self._s, self._xy[:, k]) for k in (0, 1)])

    def halt(self) -> None:
        """Take note that the robot was commanded to stand at once."""
        self._v = self._omega = 0.0
        self._turning = True

    def step(
        self,
        pose: Pose2,
        dt: float,
        *,
        stop_at: float = math.inf,
        max_speed: float = math.inf,
        delay: float = 0.0,
    ) -> tuple[float, float]:
        """Return the command of one tick.

        Parameters
        ----------
        pose : Pose2
            Where the robot is.
        dt : float
            Time since the last command [s].
        stop_at : float
            Progress [m] at which the robot has to stand; one that lies behind it makes it brake.
        max_speed : float
            Upper limit of the speed [m/s].
        delay : float
            How long ago the robot was there [s].

        Returns
        -------
        v, omega : float
            Speed [m/s] and turning rate [rad/s], inside the limits, changed against the last
            command by no more than the accelerations allow.

        Raises
        ------
        ValueError
            If `dt` is negative or not finite, or a limit is NaN.
        """
        if not (math.isfinite(dt) and dt >= 0.0):
            raise ValueError(f"the time of a tick must be finite and not negative, got {dt} s")
        if math.isnan(stop_at) or math.isnan(max_speed):
            raise ValueError(f"stop_at ({stop_at}) and max_speed ({max_speed}) must be numbers")
        if not self._path.legs:
            return self._command(0.0, 0.0, dt)
        leg = self._path.legs[self._leg]
        pose = self._predicted(pose, dt + delay)
        i, lateral = self._locate(leg, pose, dt)
        end = min(float(leg.s[-1]), stop_at)
        to_end = end - self._progress
        close = ARRIVAL_PART * self._p.arrival
        if to_end <= close and self._v <= POSITION_RATE * self._p.arrival:
            if self._progress >= leg.s[-1] - close:
                self._finish_leg()
            return self._command(0.0, 0.0, dt)
        error = wrap_angle(pose.theta - float(leg.heading[i]))
        if abs(error) > self._p.turn_in_place:
            self._turning = True
        if self._turning:
            if self._v > 0.0:
                return self._command(0.0, self._omega, dt)
            still = HEADING_RATE * (self._aligned - ALIGNED)
            still = max(self._p.angular_acceleration * dt, still)
            if abs(error) > self._aligned or abs(self._omega) > still:
                return self._command(0.0, -self._turn_rate(error), dt)
            self._turning = False
        v = self._approach(to_end, dt)
        v = min(v, float(self._speed[self._leg][i]), max_speed)
        v = self._limited(v, self._v, self._p.linear_acceleration, self._p.max_linear, dt)
        omega = self._steer(leg, v, lateral, error)
        # What the robot cannot turn in time, it must not drive either.
        missing = abs(omega - self._turning_rate(omega, dt))
        v = float(v * max(CREEP, 1.0 - missing / self._p.max_angular))
        return self._command(v, omega, dt)

    def _predicted(self, pose: Pose2, dt: float) -> Pose2:
        """Return where the robot is about half a tick after a command that is a tick late."""
        turn = self._omega * dt
        heading = pose.theta + 0.5 * turn
        return Pose2(
            pose.x + self._v * dt * math.cos(heading),
            pose.y + self._v * dt * math.sin(heading),
            pose.theta + turn,
        )

    def _speed_limit(self, leg: Leg) -> Floats:
        """Return the speed [m/s] along a leg that curvature and the leg's end allow."""
        p = self._p
        curvature = np.abs(leg.curvature)
        change = np.abs(np.gradient(leg.curvature, leg.s))
        with np.errstate(divide="ignore", over="ignore"):  # as good as straight: no limit
            limit = np.minimum(p.max_linear, 0.9 * p.max_angular / curvature)
            limit = np.minimum(limit, np.sqrt(CURVATURE_PART * p.angular_acceleration / change))
        # The largest v with v^2 <= limit^2 + 2 a (distance) for every point ahead.
        a2 = 2.0 * BRAKING_PART * p.linear_acceleration
        energy = limit**2 + a2 * leg.s
        braked = np.minimum.accumulate(energy[::-1])[::-1] - a2 * leg.s
        speed: Floats = np.sqrt(np.maximum(braked, 0.0))
        return speed

    def _locate(self, leg: Leg, pose: Pose2, dt: float) -> tuple[int, float]:
        """Find the robot along the leg: the nearest sample, and how far left of it it is."""
        # Only near where it was: the path may come by here again later.
        reach = SEARCH + self._v * dt
        first = bisect_left(leg.s, self._progress - SEARCH)
        last = bisect_right(leg.s, self._progress + reach)
        i = first + _nearest(pose.x, pose.y, for_kernel(leg.xy[first:last]))
        dx, dy = pose.x - float(leg.xy[i, 0]), pose.y - float(leg.xy[i, 1])
        c, s = math.cos(leg.heading[i]), math.sin(leg.heading[i])
        along, lateral = dx * c + dy * s, -dx * s + dy * c
        progress = float(leg.s[i]) + along
        self._progress = min(max(progress, float(leg.s[first])), float(leg.s[last - 1]))
        self._deviation = math.hypot(dx, dy)
        return i, lateral

    def _finish_leg(self) -> None:
        if self._leg + 1 < len(self._path.legs):
            self._leg += 1
            self._turning = True
        else:
            self._arrived = True

    def _approach(self, distance: float, dt: float) -> float:
        """Return the speed [m/s] from which the robot stops within a distance [m]."""
        if distance <= 0.0:
            return 0.0
        braking = BRAKING_PART * self._p.linear_acceleration
        # The command holds for a tick: half of it is driven at the old speed.
        lag = braking * dt
        return min(math.sqrt(lag * lag + 2.0 * braking * distance) - lag, POSITION_RATE * distance)

    def _turn_rate(self, error: float) -> float:
        """Return the turning rate [rad/s] that ends at heading error 0 without overshoot."""
        braking = BRAKING_PART * self._p.angular_acceleration
        rate = min(math.sqrt(2.0 * braking * abs(error)), HEADING_RATE * abs(error))
        return math.copysign(min(rate, self._p.max_angular), error)

    def _steer(self, leg: Leg, v: float, lateral: float, error: float) -> float:
        """Return the turning rate [rad/s]: the curve's own, and what corrects the errors."""
        gain = min((LATERAL_RATE / max(v, CREEP)) ** 2, 1.0 / LATERAL_DISTANCE**2)
        curvature = float(np.interp(self._progress, leg.s, leg.curvature))
        return v * curvature - HEADING_RATE * error - v * gain * lateral

    def _command(self, v: float, omega: float, dt: float) -> tuple[float, float]:
        p = self._p
        self._v = self._limited(v, self._v, p.linear_acceleration, p.max_linear, dt)
        self._omega = self._turning_rate(omega, dt)
        return self._v, self._omega

    def _turning_rate(self, omega: float, dt: float) -> float:
        p = self._p
        return self._limited(omega, self._omega, p.angular_acceleration, p.max_angular, dt)

    @staticmethod
    def _limited(value: float, old: float, acceleration: float, limit: float, dt: float) -> float:
        change = acceleration * dt
        value = min(max(value, -limit), limit)
        # Last: one that drives when it is given a smaller limit slows down to it.
        return min(max(value, old - change), old + change)
