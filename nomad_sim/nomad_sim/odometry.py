# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Odometry that drifts away from the true pose."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.jit import njit
from fuzzy_map_building.types import Pose2
from nomad_sim.params import OdometryParameters
from nomad_sim.robot import arc_end

__all__ = ["Odometry"]

FloatArray = NDArray[np.float64]


@njit
def _summed(
    x: float,
    y: float,
    theta: float,
    arcs: FloatArray,
    noise: FloatArray,
    distance_noise: float,
    heading_drift: float,
    turning_noise: float,
) -> tuple[float, float, float]:
    """Return a pose after arcs, shape (n, 2), with normal draws for each, shape (n, 2)."""
    for i in range(len(arcs)):
        distance = arcs[i, 0]
        turn = arcs[i, 1]
        root = math.sqrt(abs(distance))
        distance += distance_noise * root * noise[i, 0]
        turn += noise[i, 1] * math.hypot(
            heading_drift * root, turning_noise * math.sqrt(abs(turn))
        )
        x, y, theta = arc_end(x, y, theta, distance, turn, 1.0)
    return x, y, theta


class Odometry:
    """Pose summed up from noisy wheel turns.

    The errors of distance and heading are random walks: their variances grow in
    proportion to the distance driven and the angle turned, whatever the length of a step.

    Parameters
    ----------
    parameters : OdometryParameters
        How fast it drifts.
    start : Pose2
        Where it begins, without error.
    noise : Generator, optional
        Random stream of its own. None: no drift.
    """

    def __init__(
        self, parameters: OdometryParameters, start: Pose2, noise: np.random.Generator | None
    ) -> None:
        self._parameters = parameters
        self._noise = noise
        self.pose = start

    def add(self, arcs: Sequence[tuple[float, float]]) -> None:
        """Add pieces of way, each an arc.

        Parameters
        ----------
        arcs : sequence of tuple of float
            Way driven [m], negative backwards, and angle turned [rad] of each.
        """
        p, start = self._parameters, self.pose
        shape = len(arcs), 2
        noise = self._noise.standard_normal(shape) if self._noise is not None else np.zeros(shape)
        self.pose = Pose2(
            *_summed(
                start.x,
                start.y,
                start.theta,
                np.array(arcs, dtype=np.float64).reshape(shape),
                noise,
                p.distance_noise,
                p.heading_drift,
                p.turning_noise,
            )
        )
