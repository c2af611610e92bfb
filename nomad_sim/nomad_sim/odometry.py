# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Odometry that drifts away from the true pose."""

from __future__ import annotations

import math

import numpy as np

from fuzzy_map_building.types import Pose2
from nomad_sim.params import OdometryParameters
from nomad_sim.robot import arc

__all__ = ["Odometry"]


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

    def add(self, distance: float, turn: float) -> None:
        """Add a piece of arc.

        Parameters
        ----------
        distance : float
            Way driven, negative backwards [m].
        turn : float
            Angle turned [rad].
        """
        if self._noise is not None:
            p = self._parameters
            along, across = self._noise.standard_normal(2).tolist()
            root = math.sqrt(abs(distance))
            distance += p.distance_noise * root * along
            turn += across * math.hypot(
                p.heading_drift * root, p.turning_noise * math.sqrt(abs(turn))
            )
        self.pose = arc(self.pose, distance, turn, 1.0)
