# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The ring of infrared proximity sensors: one narrow ray each."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from fuzzy_map_building.types import Pose2
from nomad_sim.params import InfraredParameters
from nomad_sim.surfaces import Surfaces

__all__ = ["InfraredRing"]

FloatArray = NDArray[np.float64]

# What stands for draws of noise that is switched off.
_NO_NOISE = np.empty(0)


@njit
def _rays(
    bearings: FloatArray, x: float, y: float, heading: float, mount_radius: float
) -> tuple[FloatArray, FloatArray]:
    """Return starts [m] and directions of the rays of a robot's sensors, shape (n, 2) each."""
    starts = np.empty((len(bearings), 2))
    directions = np.empty((len(bearings), 2))
    for i in range(len(bearings)):
        angle = bearings[i] + heading
        directions[i, 0] = math.cos(angle)
        directions[i, 1] = math.sin(angle)
        starts[i, 0] = directions[i, 0] * mount_radius + x
        starts[i, 1] = directions[i, 1] * mount_radius + y
    return starts, directions


@njit
def _measured(
    ranges: FloatArray,
    noise: FloatArray,
    range_noise: float,
    relative_noise: float,
    min_range: float,
    max_range: float,
) -> None:
    """Add noise and limits to exact ranges [m], shape (n,), in place.

    Parameters
    ----------
    ranges : ndarray of float64, shape (n,)
        The ranges [m].
    noise : ndarray of float64, shape (n,) or (0,)
        Normal draws; none: no noise.
    range_noise, relative_noise, min_range, max_range : float
        As the parameters say.
    """
    for i in range(len(ranges)):
        value = ranges[i]
        if len(noise) > 0 and value < math.inf:
            # A proximity is a light intensity: nothing is nearer than touching.
            value = max(value + (range_noise + relative_noise * value) * noise[i], 0.0)
        if value > max_range:
            value = math.inf
        elif value < min_range:
            value = -math.inf
        ranges[i] = value


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
        p, noise = self._parameters, self._noise
        ranges = self.exact(pose, surfaces)
        _measured(
            ranges,
            # All sensors draw, whatever they see: see SonarRing.
            noise.standard_normal(len(ranges)) if noise is not None else _NO_NOISE,
            p.range_noise,
            p.relative_noise,
            p.min_range,
            p.max_range,
        )
        return ranges

    def exact(self, pose: Pose2, surfaces: Surfaces) -> FloatArray:
        """Return the ranges without noise and limits [m]; ``inf`` where nothing is."""
        p = self._parameters
        starts, directions = _rays(self._bearings, pose.x, pose.y, pose.theta, p.mount_radius)
        return surfaces.cast_rays(starts, directions, sees_glass=p.sees_glass)
