# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The rules that stop the robot before it gets too close to what its sensors see.

Paper, section IV-B, stop condition 2: the proximity sensors see an obstacle closer than a least
clearance.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzy_navigation.clearance_layer import clearance_risk
from fuzzy_navigation.params import ClearanceParameters, LayerParameters

__all__ = [
    "ClosingClearance",
    "LayerClearance",
    "StopRule",
    "StrictClearance",
    "stop_rule",
]

#: A clearance that is less by more than this [m] has shrunk: noise apart.
SHRINKING = 0.001
#: From one rung of the ladder to the next.
RUNG = 0.1


class StopRule(Protocol):
    """Decides, from clearances along the path, which of the next steps must not be made."""

    def blocked(
        self, clearances: NDArray[np.float64], alpha: float, vain: int
    ) -> NDArray[np.bool_]:
        """Tell which steps are forbidden.

        Parameters
        ----------
        clearances : ndarray of float64, shape (m + 1,)
            Clearance [m] where the robot is and, predicted from the present hit points, at the
            next m places of its path.
        alpha : float
            Rung of the ladder that the path was found on.
        vain : int
            How many perceptions in a row have not ended a stop for want of clearance.

        Returns
        -------
        ndarray of bool, shape (m,)
            For each step from one place to the next.
        """


class ClosingClearance:
    """Forbid steps that bring the body too close and closer than it is.

    The plain rule stops a robot that is already near a wall for good; this one lets it leave,
    and after a perception without progress lets it come down to a smaller clearance.

    Parameters
    ----------
    limit, override : float
        Least clearance [m], and the least one after a perception without progress.
    """

    def __init__(self, limit: float, override: float) -> None:
        self._limit = limit
        self._override = override

    def blocked(
        self, clearances: NDArray[np.float64], alpha: float, vain: int
    ) -> NDArray[np.bool_]:
        """See `StopRule.blocked`."""
        limit = self._override if vain > 0 else self._limit
        following = clearances[1:]
        return (following < limit) & (following < clearances[:-1])


class StrictClearance:
    """Forbid every step from a place whose clearance is too small, as the paper words it.

    Parameters
    ----------
    limit : float
        Least clearance [m].
    """

    def __init__(self, limit: float) -> None:
        self._limit = limit

    def blocked(
        self, clearances: NDArray[np.float64], alpha: float, vain: int
    ) -> NDArray[np.bool_]:
        """See `StopRule.blocked`."""
        return clearances[:-1] < self._limit


class LayerClearance:
    """Forbid steps that the clearance layer forbids, and that lead closer than the robot is.

    The risk of the clearance must not exceed the rung that the path was found on: a path that
    the planner could only find where it is narrow may be driven there. At the first rung, 0.6,
    this is the paper's least clearance. After a perception in vain it is the next rung: where the
    planner sees just room enough, noise alone would hold the robot for good. Every second one
    more adds a rung, up to the clearance at which the layer closes a cell.

    Parameters
    ----------
    layer : LayerParameters
        The layer.
    """

    def __init__(self, layer: LayerParameters) -> None:
        self._layer = layer

    def blocked(
        self, clearances: NDArray[np.float64], alpha: float, vain: int
    ) -> NDArray[np.bool_]:
        """See `StopRule.blocked`."""
        following = clearances[1:]
        alpha += RUNG * ((vain + 1) // 2)
        closer = following < clearances[:-1] - SHRINKING
        return (clearance_risk(following + self._layer.slack, self._layer) > alpha) & closer


def stop_rule(clearance: ClearanceParameters, layer: LayerParameters) -> StopRule:
    """Return the rule that ``clearance.rule`` names."""
    if clearance.rule == "layer":
        return LayerClearance(layer)
    if clearance.rule == "strict":
        return StrictClearance(clearance.limit)
    return ClosingClearance(clearance.limit, clearance.override)
