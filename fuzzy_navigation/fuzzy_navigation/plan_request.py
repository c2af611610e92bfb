# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A request for a path, checked and with its defaults filled in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_map_building.wording import as_meant
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.plan_types import MAX_TOLERANCE
from fuzzy_navigation.positions import position, positions
from fuzzy_navigation.search import COSTS

__all__ = ["MOST_BARRED", "MOST_HITS", "PlanRequest"]

#: Most hit points, and most barred positions, of one request.
MOST_HITS = 10_000
MOST_BARRED = 100_000

# Adjacency where neither request nor parameters say (section IV-A2).
_ADJACENCY = {"g1": 8, "g2": 8, "g3": 4}
# Decimals that survive a float32 message: an alpha of 0.7 must not arrive as 0.69999999.
_DECIMALS = 6
# Largest radius of a slimmer robot [m].
_MAX_SLIM_RADIUS = 5.0


@dataclass(frozen=True)
class PlanRequest:
    """What `Planner.plan` takes, with the units that it has there.

    Parameters
    ----------
    start, goal : tuple of float
        Positions (x, y) [m].
    heading : float
        Heading at the start [rad]; 0 where none was given.
    cost, adjacency, tolerance
        As `Planner.plan` takes them, none left to a default.
    rungs : sequence of float
        Largest admissible risks to try, one after the other.
    barred, hits : ndarray of float64, shape (n, 2)
        Positions (x, y) [m].
    slim_radius, slim_above, any_angle
        As `Planner.plan` takes them.
    """

    start: tuple[float, float]
    heading: float
    goal: tuple[float, float]
    cost: str
    rungs: Sequence[float]
    adjacency: int
    tolerance: float
    barred: NDArray[np.float64]
    hits: NDArray[np.float64]
    slim_radius: float
    slim_above: float
    any_angle: bool

    @classmethod
    def checked(
        cls,
        parameters: PlannerParameters,
        start: Pose2 | tuple[float, float],
        goal: Pose2 | tuple[float, float],
        cost: str | None,
        alpha: float,
        adjacency: int,
        tolerance: float,
        barred: ArrayLike,
        hits: ArrayLike,
        slim_radius: float,
        slim_above: float,
        any_angle: bool,
    ) -> PlanRequest:
        """Return a request by the arguments of `Planner.plan`.

        Raises
        ------
        TypeError, ValueError
            For what no request can be; the message says what is allowed.
        """
        p = parameters
        start_xy, goal_xy = position(start, "start"), position(goal, "goal")
        cost = p.cost if cost is None else cost
        if cost not in COSTS:
            raise ValueError(f"cost must be one of {', '.join(COSTS)}, got {cost!r}")
        if not 0.0 <= alpha <= 1.0:
            raise ValueError(f"alpha must lie in [0, 1], 0 for the ladder, got {as_meant(alpha)}")
        if adjacency not in (0, 4, 8):
            raise ValueError(f"adjacency must be 0, 4 or 8, got {adjacency!r}")
        if not 0.0 <= tolerance <= MAX_TOLERANCE:  # a NaN fails
            raise ValueError(
                f"tolerance must lie in [0, {MAX_TOLERANCE:g}] m, 0 for the parameter, "
                f"got {as_meant(tolerance)}"
            )
        if not 0.0 <= slim_radius <= _MAX_SLIM_RADIUS:
            raise ValueError(
                f"slim_radius must lie in [0, {_MAX_SLIM_RADIUS:g}] m, got {as_meant(slim_radius)}"
            )
        if not 0.0 <= slim_above <= 1.0:
            raise ValueError(f"slim_above must lie in [0, 1], got {as_meant(slim_above)}")
        return cls(
            start=start_xy,
            heading=start.theta if isinstance(start, Pose2) else 0.0,
            goal=goal_xy,
            cost=cost,
            rungs=(_rounded(alpha),) if alpha > 0.0 else p.alpha_ladder,
            adjacency=int(adjacency) or p.adjacency or _ADJACENCY[cost],
            tolerance=_rounded(tolerance) or p.tolerance,
            barred=positions(barred, "barred", MOST_BARRED),
            hits=positions(hits, "hits", MOST_HITS),
            slim_radius=_rounded(slim_radius),
            slim_above=_rounded(slim_above),
            any_angle=any_angle,
        )


def _rounded(value: float) -> float:
    """Return a number as it was before a float32 message; what is small does not become 0."""
    return round(float(value), _DECIMALS) or float(value)
