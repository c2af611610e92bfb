# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a turning ring of sonars tells at random, for tests of the mapper."""

import math

import numpy as np

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2, SonarReading

LAB = GridGeometry(76, 63, 0.1)


def perception(pose: Pose2, seed: int = 0, ranges: float | None = None) -> list[SonarReading]:
    """48 readings: 16 sonars at three angles of the turret."""
    rng = np.random.default_rng(seed)
    return [
        SonarReading(
            pose,
            math.radians(22.5 * i + 7.5 * j),
            float(rng.uniform(0.2, 4.0)) if ranges is None else ranges,
        )
        for j in range(3)
        for i in range(16)
    ]
