# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How far a way keeps clear of what sensors see, between the places at which it is planned.

A path's places are a cell apart. Where cells are small, no wall that the body would touch between
two of them keeps clear of both; where cells are large, it may.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.clearance import clearance_at
from fuzzy_navigation.follower import Follower
from fuzzy_navigation.stop_rules import StopRule

__all__ = ["LARGE_CELL", "clear_until"]

#: From this side [m] on cells are large. What lies midway between places that are a diagonal of
#: smaller ones apart is closer to both than a body of 0.23 m radius may come.
LARGE_CELL = 0.25
#: Way from one place that is looked at to the next [m].
SAMPLING = 0.1


def clear_until(
    rule: StopRule,
    follower: Follower,
    pose: Pose2,
    hits: NDArray[np.float64],
    robot_radius: float,
    alpha: float,
    vain: int,
    horizon: float,
) -> float:
    """Return up to where a rule lets the robot drive on its way.

    Parameters
    ----------
    rule : StopRule
        Judges each stretch of the way by the clearance at its ends.
    follower : Follower
        Where on which way the robot is.
    pose : Pose2
        Where it is.
    hits : ndarray of float64, shape (n, 2)
        Hit points [m] to keep clear of.
    robot_radius : float
        Radius of the body [m].
    alpha, vain
        As `StopRule.blocked` takes them.
    horizon : float
        Progress [m] up to which the way is looked at.

    Returns
    -------
    float
        Progress [m], that of the robot if it must not go on; infinite if nothing is in the way.
    """
    progress = np.arange(follower.progress, horizon + SAMPLING, SAMPLING)
    places = np.vstack([(pose.x, pose.y), follower.points_at(progress[1:])])
    blocked = rule.blocked(clearance_at(places, hits, robot_radius), alpha, vain)
    return float(progress[np.argmax(blocked)]) if blocked.any() else math.inf
