# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The ring of ultrasonic range finders: what each reads when it fires."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from fuzzy_map_building.types import Pose2
from nomad_sim.echo import crosstalk_range, echo_range
from nomad_sim.params import SonarParameters
from nomad_sim.ray_casting import inside
from nomad_sim.surfaces import Surfaces

__all__ = ["SonarEvent", "SonarRing"]

FloatArray = NDArray[np.float64]

# What stands for draws of noise that is switched off.
_NO_NOISE = np.empty(0)
_NO_OUTLIERS = np.empty((2, 0))


class SonarEvent(NamedTuple):
    """One reading as it was taken.

    Attributes
    ----------
    stamp : float
        Time at which the sonar fired [s].
    sensor : int
        Index of the sonar.
    range : float
        What it read [m], REP 117.
    turret_angle : float
        Angle of the turret at that time [rad].
    """

    stamp: float
    sensor: int
    range: float
    turret_angle: float


@njit
def _ranges(
    bearings: FloatArray,
    x: float,
    y: float,
    heading: float,
    mount_radius: float,
    body_radius: float,
    half_angle: float,
    max_range: float,
    edge_echo: bool,
    reflections: int,
    crosstalk: int,
    segments: FloatArray,
    circles: FloatArray,
    critical_angles: FloatArray,
    solids: NDArray[np.int64],
    edges: FloatArray,
    marks: FloatArray,
) -> FloatArray:
    """Return the exact ranges [m] of sonars fired together, shape (G,).

    Parameters
    ----------
    bearings : ndarray of float64, shape (G,)
        Directions of the sonars on the turret [rad].
    x, y, heading : float
        Centre of the robot [m] and direction of the turret [rad].
    mount_radius, body_radius : float
        Distance of the faces from the centre, and radius of the robot [m].
    half_angle, max_range, edge_echo, reflections, crosstalk
        As the parameters say.
    segments, circles, critical_angles, solids, edges, marks : ndarray
        As for `echo_range` and `inside`.
    """
    body = np.empty(3)
    body[0] = x
    body[1] = y
    body[2] = body_radius
    faces = np.empty((len(bearings), 3))
    for i in range(len(bearings)):
        axis = bearings[i] + heading
        faces[i, 0] = x + mount_radius * math.cos(axis)
        faces[i, 1] = y + mount_radius * math.sin(axis)
        faces[i, 2] = axis
    ranges = np.empty(len(bearings))
    for i in range(len(bearings)):
        x, y, axis = faces[i]
        covered = inside(x, y, segments, solids)
        for c in range(circles.shape[0]):
            covered = covered or (math.hypot(circles[c, 0] - x, circles[c, 1] - y) < circles[c, 2])
        if covered:
            ranges[i] = 0.0
            continue
        ranges[i] = echo_range(
            x,
            y,
            axis,
            half_angle,
            max_range,
            edge_echo,
            reflections,
            body,
            segments,
            circles,
            critical_angles,
            edges,
            marks,
        )
        for j in range(faces.shape[0]):
            if crosstalk > 0 and j != i:
                heard = crosstalk_range(
                    faces[j, 0],
                    faces[j, 1],
                    faces[j, 2],
                    half_angle,
                    max_range,
                    crosstalk,
                    x,
                    y,
                    axis,
                    body,
                    segments,
                    circles,
                    marks,
                )
                ranges[i] = min(ranges[i], heard)
    return ranges


@njit
def _measured(
    ranges: FloatArray,
    noise: FloatArray,
    outliers: FloatArray,
    range_noise: float,
    short_outliers: float,
    lost_outliers: float,
    min_range: float,
    max_range: float,
) -> None:
    """Add noise, outliers and limits to exact ranges [m], shape (G,), in place.

    Parameters
    ----------
    ranges : ndarray of float64, shape (G,)
        The ranges [m].
    noise : ndarray of float64, shape (G,) or (0,)
        Normal draws; none: no noise.
    outliers : ndarray of float64, shape (2, G) or (2, 0)
        Draws from [0, 1[ of what befalls a reading, and of where a short one lies; none: nothing.
    range_noise, short_outliers, lost_outliers, min_range, max_range : float
        As the parameters say.
    """
    for i in range(len(ranges)):
        value = ranges[i]
        if len(noise) > 0:
            value = value * (1.0 + range_noise * noise[i])
        if outliers.shape[1] > 0:
            draw, share = outliers[0, i], outliers[1, i]
            reach = min(value, max_range)
            if draw < short_outliers and reach > min_range:
                value = min_range + share * (reach - min_range)
            if draw >= 1.0 - lost_outliers:
                value = math.inf
        if value > max_range:
            value = math.inf
        elif value < min_range:
            value = -math.inf
        ranges[i] = value


class SonarRing:
    """Sonars on the turret, fired slot after slot.

    Parameters
    ----------
    parameters : SonarParameters
        Where they sit and what they measure.
    body_radius : float
        Radius of the robot [m].
    noise, outliers : Generator
        Random streams of their own, so that switching one on leaves the other as it was.
        None: exact ranges.
    """

    def __init__(
        self,
        parameters: SonarParameters,
        body_radius: float,
        noise: np.random.Generator | None,
        outliers: np.random.Generator | None,
    ) -> None:
        self._parameters = parameters
        self._body_radius = body_radius
        self._noise = noise
        self._outliers = outliers
        self._bearings = np.asarray(parameters.bearings)
        cycle = max(parameters.firing_slots) + 1
        slots = np.asarray(parameters.firing_slots)
        self._groups = [np.flatnonzero(slots == slot) for slot in range(cycle)]
        self._numbers: list[list[int]] = [group.tolist() for group in self._groups]

    def fire(
        self, count: int, stamp: float, pose: Pose2, turret_angle: float, surfaces: Surfaces
    ) -> list[SonarEvent]:
        """Fire the sonars of one slot.

        Parameters
        ----------
        count : int
            Slots fired before, which decides on the slot.
        stamp : float
            Time [s].
        pose : Pose2
            Where the robot is.
        turret_angle : float
            Angle of the turret from the robot's heading [rad].
        surfaces : Surfaces
            What is there.

        Returns
        -------
        list of SonarEvent
            In the order of the sonars.
        """
        slot = count % len(self._groups)
        numbers = self._numbers[slot]
        if not numbers:
            return []
        ranges = self.exact(self._groups[slot], pose, turret_angle, surfaces)
        self._measure(ranges)
        return [
            SonarEvent(stamp, sensor, measured, turret_angle)
            for sensor, measured in zip(numbers, ranges.tolist(), strict=True)
        ]

    def exact(
        self, group: NDArray[np.int64], pose: Pose2, turret_angle: float, surfaces: Surfaces
    ) -> FloatArray:
        """Return the ranges without noise and limits, shape (G,) [m]; ``inf`` without echo.

        Parameters
        ----------
        group : ndarray of int64, shape (G,)
            Sonars that fire together.
        pose, turret_angle, surfaces
            As for `fire`.
        """
        p = self._parameters
        return _ranges(
            self._bearings[group],
            pose.x,
            pose.y,
            pose.theta + turret_angle,
            p.mount_radius,
            self._body_radius,
            p.beam_half_angle,
            p.max_range,
            p.edge_echo,
            p.reflections,
            p.crosstalk_reflections,
            surfaces.segments,
            surfaces.circles,
            surfaces.critical_angles,
            surfaces.solids,
            surfaces.edges,
            surfaces.marks,
        )

    def _measure(self, ranges: FloatArray) -> None:
        """Add noise, outliers and limits to exact ranges, shape (G,) [m], in place.

        Each reading takes the same number of draws whatever it sees, so that two worlds
        that differ in one surface share the noise of all other readings.
        """
        p, number = self._parameters, len(ranges)
        noise, outliers = self._noise, self._outliers
        _measured(
            ranges,
            noise.standard_normal(number) if noise is not None else _NO_NOISE,
            outliers.random((2, number)) if outliers is not None else _NO_OUTLIERS,
            p.range_noise,
            p.short_outliers,
            p.lost_outliers,
            p.min_range,
            p.max_range,
        )
