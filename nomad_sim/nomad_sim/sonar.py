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
    faces: FloatArray,
    half_angle: float,
    max_range: float,
    edge_echo: bool,
    reflections: int,
    crosstalk: int,
    body: FloatArray,
    segments: FloatArray,
    circles: FloatArray,
    critical_angles: FloatArray,
    solids: NDArray[np.int64],
    edges: FloatArray,
    marks: FloatArray,
) -> FloatArray:
    """Return the exact ranges [m] of sonars fired together; faces: x, y, axis, shape (G, 3)."""
    ranges = np.empty(faces.shape[0])
    for i in range(faces.shape[0]):
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
        group = self._groups[count % len(self._groups)]
        if not len(group):
            return []
        exact = self.exact(group, pose, turret_angle, surfaces)
        ranges = self._measured(exact)
        return [
            SonarEvent(stamp, int(sensor), float(measured), turret_angle)
            for sensor, measured in zip(group, ranges, strict=True)
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
        faces = np.empty((len(group), 3))
        faces[:, 2] = self._bearings[group] + (pose.theta + turret_angle)
        faces[:, 0] = pose.x + p.mount_radius * np.cos(faces[:, 2])
        faces[:, 1] = pose.y + p.mount_radius * np.sin(faces[:, 2])
        return _ranges(
            faces,
            p.beam_half_angle,
            p.max_range,
            p.edge_echo,
            p.reflections,
            p.crosstalk_reflections,
            np.array([pose.x, pose.y, self._body_radius]),
            surfaces.segments,
            surfaces.circles,
            surfaces.critical_angles,
            surfaces.solids,
            surfaces.edges,
            surfaces.marks,
        )

    def _measured(self, exact: FloatArray) -> FloatArray:
        """Add noise, outliers and limits.

        Each reading takes the same number of draws whatever it sees, so that two worlds
        that differ in one surface share the noise of all other readings.
        """
        p = self._parameters
        ranges = exact
        if self._noise is not None:
            ranges = ranges * (1.0 + p.range_noise * self._noise.standard_normal(len(exact)))
        if self._outliers is not None:
            draw, share = self._outliers.random((2, len(exact)))
            reach = np.minimum(ranges, p.max_range)
            short = p.min_range + share * (reach - p.min_range)
            ranges = np.where((draw < p.short_outliers) & (reach > p.min_range), short, ranges)
            ranges = np.where(draw >= 1.0 - p.lost_outliers, math.inf, ranges)
        ranges = np.where(ranges > p.max_range, math.inf, ranges)
        return np.where(ranges < p.min_range, -math.inf, ranges)
