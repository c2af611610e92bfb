# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The ring of infrared proximity sensors: one narrow ray each."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from nomad_sim.params import InfraredParameters
from nomad_sim.surfaces import Surfaces

__all__ = ["InfraredRing"]

FloatArray = NDArray[np.float64]


class InfraredRing:
    """Infrared sensors on the base, all read at once.

    Parameters
    ----------
    parameters : InfraredParameters
        Where they sit and what they measure.
    noise : Generator, optional
        Random stream of their own. None: exact ranges.
    """

    def __init__(self, parameters: InfraredParameters, noise: np.random.Generator | None) -> None:
        self._parameters = parameters
        self._noise = noise
        self._bearings = np.asarray(parameters.bearings)

    def read(self, pose: Pose2, surfaces: Surfaces) -> FloatArray:
        """Return what every sensor reads, shape (16,) by default [m], REP 117.

        Parameters
        ----------
        pose : Pose2
            Where the robot is.
        surfaces : Surfaces
            What is there.
        """
        p = self._parameters
        ranges = self.exact(pose, surfaces)
        if self._noise is not None:
            # All sensors draw, whatever they see: see SonarRing.
            seen = np.where(np.isfinite(ranges), ranges, 0.0)
            deviation = p.range_noise + p.relative_noise * seen
            ranges = ranges + deviation * self._noise.standard_normal(len(ranges))
            # A proximity is a light intensity: nothing is nearer than touching.
            ranges = np.maximum(ranges, 0.0)
        ranges = np.where(ranges > p.max_range, math.inf, ranges)
        return np.where(ranges < p.min_range, -math.inf, ranges)

    def exact(self, pose: Pose2, surfaces: Surfaces) -> FloatArray:
        """Return the ranges without noise and limits [m]; ``inf`` where nothing is."""
        p = self._parameters
        angles = self._bearings + pose.theta
        directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        starts = directions * p.mount_radius + (pose.x, pose.y)
        return surfaces.cast_rays(starts, directions, sees_glass=p.sees_glass)
