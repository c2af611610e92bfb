# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Short sonar returns guard against what infrared light does not see, glass above all.

A sonar return from close to the body should come with an infrared hit near its axis. One
that does not is taken for a surface that the infrareds look through: it becomes hit points
of its own, and the infrared rays beside it are believed only up to it.

Everything is done with the positions of what was seen, so that readings taken at different
poses of the robot may be compared.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.infrared_packet import InfraredPacket
from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.sensor_params import (
    InfraredParameters,
    SonarGuardParameters,
    SonarParameters,
)
from fuzzy_map_building.sonar_packet import (
    APEX_X,
    APEX_Y,
    AXIS_X,
    AXIS_Y,
    DIRECTION,
    EMPTY,
    OCCUPIED,
    SonarPacket,
)
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading

__all__ = ["cut_rays", "guard_points", "ray_limits", "rim_points"]

FloatArray = NDArray[np.float64]

#: Slack of comparisons of angles and distances, so that equal ones do not depend on rounding.
_ROUNDING = 1e-9
#: Off the axis of a return from too close to measure, seen from the robot's centre, something
#: smooth may be as close as on it: a robot that passes by must not come closer either [rad].
RIM_SPREAD = math.radians(26.0)
#: How far beyond the sonar's least range a hit may lie that explains such a return [m]: noise. Of
#: what lies farther nothing would come back so soon; robots slid along glass before a wall.
TOUCH_SLACK = 0.03


def guard_points(
    sonar: Sequence[SonarReading],
    hits: FloatArray,
    sonar_p: SonarParameters,
    guard: SonarGuardParameters,
    reach: float,
    robot_radius: float,
) -> FloatArray:
    """Return hit points of the short sonar returns that no infrared hit explains.

    A return at distance r and direction b from the robot's centre is short if
    ``r < robot_radius + reach``. It is explained if an infrared hit lies, seen from there,
    within ``guard.angle`` of b and at most ``guard.slack`` farther away than r. One that is
    not stands for a point on its axis and one at ``guard.spread`` on either side. Of these,
    unless it were all, those are left out that another sonar reading looks through: within
    ``guard.veto_angle`` of its axis, and ``guard.veto_excess`` closer than its own range.
    Otherwise an edge beside a narrow passage, heard off the axes of several sonars, would
    bar the passage.

    Parameters
    ----------
    sonar : sequence of SonarReading
        Readings, each placed at its own pose.
    hits : ndarray of float64, shape (m, 2)
        Points (x, y) [m] in ``map`` that infrareds hit.
    sonar_p : SonarParameters
        The ring of sonars.
    guard : SonarGuardParameters
        The rule; whether it is enabled is for the caller to look at.
    reach : float
        Distance from the body [m] below which a return is short: one of the two of `guard`.
    robot_radius : float
        Radius of the body [m].

    Returns
    -------
    ndarray of float64, shape (n, 2)
        Points (x, y) [m] in ``map``.
    """
    short = _short(sonar, sonar_p, reach + robot_radius)
    if not short:
        return np.zeros((0, 2))
    returns = _unexplained(short, hits, sonar_p, guard)
    if not len(returns):
        return np.zeros((0, 2))
    packet = SonarPacket.from_readings(sonar, sonar_p)
    points = np.empty((3 * len(returns), 2))
    count = _stand_for(
        for_kernel(returns),
        for_kernel(packet.cones),
        packet.forward,
        guard.spread,
        guard.veto_angle,
        guard.veto_excess,
        for_kernel(points),
    )
    return points[:count]


def rim_points(
    sonar: Sequence[SonarReading],
    known: FloatArray,
    sonar_p: SonarParameters,
    guard: SonarGuardParameters,
    robot_radius: float,
) -> FloatArray:
    """Return hit points of the returns from too close to measure that nothing explains.

    Such a return (``-inf``) tells that something is nearer than the sonar's least range, not
    how near. Unless a point that is known already explains it, as a hit does in `guard_points` but
    by no more than `TOUCH_SLACK`, it may touch the body by now: it stands for three points on its
    rim, one on the return's axis and one at `RIM_SPREAD` on either side.

    Parameters
    ----------
    sonar, sonar_p, guard, robot_radius
        As for `guard_points`.
    known : ndarray of float64, shape (m, 2)
        Points (x, y) [m] where something is seen, or was seen or heard before.

    Returns
    -------
    ndarray of float64, shape (n, 2)
        Points (x, y) [m] in ``map``.
    """
    close = [reading for reading in sonar if reading.range == -math.inf]
    if not close:
        return np.zeros((0, 2))
    near = dataclasses.replace(guard, slack=min(guard.slack, TOUCH_SLACK))
    returns = _unexplained(close, known, sonar_p, near)
    angles = returns[:, 2:3] + np.array([0.0, RIM_SPREAD, -RIM_SPREAD])
    rays = np.stack((np.cos(angles), np.sin(angles)), axis=2)
    points: FloatArray = (returns[:, None, :2] + robot_radius * rays).reshape(-1, 2)
    return points


def cut_rays(
    sonar: Sequence[SonarReading],
    infrared: Sequence[InfraredReading],
    sonar_p: SonarParameters,
    infrared_p: InfraredParameters,
    guard: SonarGuardParameters,
    reach: float,
    robot_radius: float,
) -> list[InfraredReading]:
    """Return infrared readings believed only as far as the short sonar returns allow.

    Parameters
    ----------
    sonar, sonar_p, guard, reach, robot_radius
        As for `guard_points`.
    infrared, infrared_p : sequence of InfraredReading, InfraredParameters
        Readings, each placed at its own pose, and their ring.

    Returns
    -------
    list of InfraredReading
        The readings in their order. The `limit` of each is at most what `ray_limits` says of
        it, from the sensor's face.
    """
    cut = list(infrared)
    short = _short(sonar, sonar_p, reach + robot_radius)
    if not short:
        return cut
    seen = InfraredPacket.from_readings(infrared, infrared_p)
    limits = _limits(short, seen, sonar_p, guard)
    if limits is not None:
        faces = limits - infrared_p.mount_radius
        for number, limit in zip(seen.number.tolist(), faces.tolist(), strict=True):
            if limit < cut[number].limit:
                cut[number] = dataclasses.replace(cut[number], limit=limit)
    return cut


def ray_limits(
    sonar: Sequence[SonarReading],
    seen: InfraredPacket,
    sonar_p: SonarParameters,
    guard: SonarGuardParameters,
    reach: float,
    robot_radius: float,
) -> FloatArray | None:
    """Return how far the short sonar returns let infrared rays be believed to be free.

    Parameters
    ----------
    sonar, sonar_p, guard, reach, robot_radius
        As for `guard_points`.
    seen : InfraredPacket
        The rays.

    Returns
    -------
    ndarray of float64, shape (n,), or None
        For each ray the distance [m] from the robot's centre to ``guard.margin`` before the
        nearest return without explanation that lies within ``guard.angle`` of the ray, ``inf``
        without one; None where no return is without explanation.
    """
    short = _short(sonar, sonar_p, reach + robot_radius)
    return _limits(short, seen, sonar_p, guard) if short else None


def warm_up() -> None:
    """Compile the kernels called here, or load them from the cache."""
    short = [SonarReading(Pose2(0.0, 0.0), 0.0, 0.5)]
    guard_points(short, np.ones((1, 2)), SonarParameters(), SonarGuardParameters(), 1.0, 0.0)


def _short(
    sonar: Sequence[SonarReading], sonar_p: SonarParameters, below: float
) -> list[SonarReading]:
    """Return the readings with a return from below a distance from the robot's centre [m]."""
    low, high = sonar_p.min_range, sonar_p.max_range
    return [
        reading
        for reading in sonar
        if (low <= reading.range <= high or reading.range == -np.inf)
        and max(reading.range, low) + sonar_p.mount_radius < below
    ]


def _limits(
    short: Sequence[SonarReading],
    seen: InfraredPacket,
    sonar_p: SonarParameters,
    guard: SonarGuardParameters,
) -> FloatArray | None:
    """Return what `ray_limits` does, for some short returns."""
    returns = _unexplained(short, seen.hit_points(), sonar_p, guard)
    if not len(returns):
        return None
    centre, direction, distance = returns[:, :2], returns[:, 2], returns[:, 3:]
    rays = np.column_stack((np.cos(direction), np.sin(direction)))
    to, away = _polar(centre + distance * rays, seen.centre)
    beside = _between(to, seen.direction[:, None]) <= guard.angle + _ROUNDING
    limits: FloatArray = np.where(beside, away, np.inf).min(axis=1) - guard.margin
    return limits


def _unexplained(
    short: Sequence[SonarReading],
    hits: FloatArray,
    sonar_p: SonarParameters,
    guard: SonarGuardParameters,
) -> FloatArray:
    """Return those of some returns that no hit explains.

    Returns
    -------
    ndarray of float64, shape (n, 4)
        Centre x, y [m], direction [rad] and distance from there [m] of each.
    """
    low, radius = sonar_p.min_range, sonar_p.mount_radius
    rows = np.array(
        [
            (r.pose.x, r.pose.y, r.pose.theta + r.bearing, max(r.range, low) + radius)
            for r in short
        ],
        dtype=np.float64,
    )
    count = _keep_unexplained(for_kernel(rows), for_kernel(hits), guard.angle, guard.slack)
    return rows[:count]


@njit
def _keep_unexplained(returns: FloatArray, hits: FloatArray, widest: float, slack: float) -> int:
    """Move those of some returns that no hit explains to the front; tell how many they are.

    Parameters
    ----------
    returns : ndarray of float64, shape (n, 4)
        As of `_unexplained`.
    hits : ndarray of float64, shape (m, 2)
        Points (x, y) [m] that may explain them.
    widest, slack : float
        How far from a return's axis [rad], and how much farther away [m], a hit may lie.
    """
    kept = 0
    for i in range(len(returns)):
        x = returns[i, 0]
        y = returns[i, 1]
        direction = returns[i, 2]
        distance = returns[i, 3]
        explained = False
        for k in range(len(hits)):
            dx = hits[k, 0] - x
            dy = hits[k, 1] - y
            if math.hypot(dx, dy) <= distance + slack + _ROUNDING:
                off = math.atan2(dy, dx) - direction
                off = (off + math.pi) % (2.0 * math.pi) - math.pi
                if abs(off) <= widest + _ROUNDING:
                    explained = True
                    break
        if not explained:
            returns[kept, 0] = x
            returns[kept, 1] = y
            returns[kept, 2] = direction
            returns[kept, 3] = distance
            kept += 1
    return kept


@njit
def _stand_for(
    returns: FloatArray,
    cones: FloatArray,
    forward: float,
    spread: float,
    veto_angle: float,
    veto_excess: float,
    points: FloatArray,
) -> int:
    """Fill in the points that some returns stand for; tell how many they are.

    Parameters
    ----------
    returns : ndarray of float64, shape (n, 4)
        As of `_unexplained`.
    cones, forward
        Of the `SonarPacket` of all readings.
    spread, veto_angle, veto_excess : float
        The rule [rad, rad, m].
    points : ndarray of float64, shape (3 n, 2)
        Where the points (x, y) [m] go: those through which no longer reading looks.
    """
    kept = 0
    for i in range(len(returns)):
        first = kept
        for turn in (0.0, spread, -spread):
            angle = returns[i, 2] + turn
            x = returns[i, 0] + returns[i, 3] * math.cos(angle)
            y = returns[i, 1] + returns[i, 3] * math.sin(angle)
            if not _seen_through(x, y, cones, forward, veto_angle, veto_excess):
                points[kept, 0] = x
                points[kept, 1] = y
                kept += 1
        if kept > first:
            continue
        # The echo came from somewhere: where nothing is left it may have been anywhere.
        for turn in (0.0, spread, -spread):
            angle = returns[i, 2] + turn
            points[kept, 0] = returns[i, 0] + returns[i, 3] * math.cos(angle)
            points[kept, 1] = returns[i, 1] + returns[i, 3] * math.sin(angle)
            kept += 1
    return kept


@njit
def _seen_through(
    x: float,
    y: float,
    cones: FloatArray,
    forward: float,
    veto_angle: float,
    veto_excess: float,
) -> bool:
    """Whether a longer reading looks through a point (x, y) [m]."""
    for j in range(len(cones)):
        dx = x - (cones[j, APEX_X] - forward * cones[j, AXIS_X])
        dy = y - (cones[j, APEX_Y] - forward * cones[j, AXIS_Y])
        reach = max(cones[j, EMPTY], cones[j, OCCUPIED]) + forward
        if reach > math.hypot(dx, dy) + veto_excess:
            off = math.atan2(dy, dx) - cones[j, DIRECTION]
            if abs((off + math.pi) % (2.0 * math.pi) - math.pi) <= veto_angle + _ROUNDING:
                return True
    return False


def _polar(points: FloatArray, centres: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return direction and distance of each of m points from each of n centres, shape (n, m)."""
    with np.errstate(over="ignore"):  # infinitely far is far as well
        offset = points[None, :, :] - centres[:, None, :]
        direction: FloatArray = np.arctan2(offset[..., 1], offset[..., 0])
        distance: FloatArray = np.hypot(offset[..., 0], offset[..., 1])
    return direction, distance


def _between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the angle between directions [rad], in [0, pi]."""
    angle: FloatArray = np.abs(np.mod(a - b + np.pi, 2.0 * np.pi) - np.pi)
    return angle
