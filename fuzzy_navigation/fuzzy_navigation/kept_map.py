# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The planner's map: taken whole or by windows, augmented, and handed out for searches."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_navigation.cost_field import hundredths
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.plan_types import RiskLayer
from fuzzy_navigation.planning_map import LayeredMap, PlanningMap, Rungs
from fuzzy_navigation.risk import Footprint, augment, checked_risk, real_numbers
from fuzzy_navigation.workspace import Workspace

__all__ = ["KeptMap"]


class KeptMap:
    """A planning map and its augmentation: in hundredths where it can be, else as it is.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map's cells lie.
    """

    def __init__(self, geometry: GridGeometry) -> None:
        self._geometry = geometry
        self._workspace = Workspace()
        self._coded: PlanningMap | None = None
        self._planning_risk: NDArray[np.float64] | None = None
        self._augmented: NDArray[np.float64] | None = None
        self._barred: NDArray[np.bool_] | None = None

    @property
    def known(self) -> bool:
        """Whether there is a map."""
        return self._coded is not None or self._augmented is not None

    @property
    def augmented_risk(self) -> NDArray[np.float64] | None:
        """The augmented map, shape (H, W), read-only; None without a map."""
        if self._coded is None:
            return self._augmented
        augmented = self._coded.augmented_risk
        augmented.flags.writeable = False
        return augmented

    @property
    def nbytes(self) -> int:
        """Memory of the map and of what searches work in [bytes]."""
        arrays = (self._planning_risk, self._augmented, self._barred)
        own = sum(array.nbytes for array in arrays if array is not None)
        coded = 0 if self._coded is None else self._coded.nbytes
        return own + coded + self._workspace.nbytes

    def rungs(self, layer: RiskLayer | None) -> Rungs:
        """Return what a request climbs; there is a map."""
        if self._coded is not None and layer is None and self._barred is None:
            return self._coded
        risk = self.augmented_risk
        assert risk is not None
        return LayeredMap(risk, layer, self._barred, self._workspace)

    def slimmer(self, radius: float, layer: RiskLayer | None) -> Rungs:
        """Return what a slimmer robot would climb; there is a map.

        It is augmented for the occasion, the whole of it.

        Parameters
        ----------
        radius : float
            The slimmer robot's [m].
        layer : RiskLayer, optional
            The risk that hit points lay over the map for the true one.
        """
        risk = self._risk()
        assert risk is not None
        augmented = augment(risk, radius, self._geometry.resolution, "disc")
        return LayeredMap(augmented, layer, self._barred, self._workspace)

    def take(
        self, planning_risk: ArrayLike, barred: ArrayLike | None, parameters: PlannerParameters
    ) -> None:
        """Take a whole map; see `Planner.set_map`."""
        values = checked_risk(planning_risk, "the planning map")
        self._check_shape("the planning map", values)
        bars: NDArray[np.bool_] | None = None
        if barred is not None:
            bars = np.array(barred)
            self._check_shape("barred", bars)
            if bars.dtype != np.bool_:
                raise ValueError(f"barred must be an array of bool, got {bars.dtype}")
        self._keep(values, parameters)
        self._barred = bars

    def take_window(
        self, planning_risk: ArrayLike, window: Window, parameters: PlannerParameters
    ) -> None:
        """Take new values for a window; see `Planner.update_map`."""
        height, width = self._geometry.shape
        rows, columns = (window.row0, window.row1, height), (window.col0, window.col1, width)
        if not all(0 <= first <= last <= end for first, last, end in (rows, columns)):
            raise ValueError(f"{window} is no part of a map of {height} rows, {width} columns")
        if not self.known:
            raise ValueError("the first planning map must be whole, not a window")
        name = "the window of the planning map"
        values = real_numbers(planning_risk, name)
        if values.shape != window.shape:
            raise ValueError(
                f"{name} has the shape {values.shape} (rows, columns), "
                f"but {window} has {window.shape}"
            )
        if window.empty:
            return
        values = checked_risk(values, name)
        codes = _codes(values)
        if self._coded is not None and codes is not None:
            self._coded.update(codes, window)
            return
        before = self._risk()
        assert before is not None
        risk = before.copy()
        risk[window.slices] = values
        self._keep(risk, parameters)

    def augment(self, parameters: PlannerParameters) -> None:
        """Augment the map anew, for another robot."""
        risk = self._risk()
        if risk is not None:
            self._keep(risk, parameters)

    def _risk(self) -> NDArray[np.float64] | None:
        return self._planning_risk if self._coded is None else self._coded.planning_risk

    def _keep(self, values: NDArray[np.float64], p: PlannerParameters) -> None:
        resolution = self._geometry.resolution
        codes = _codes(values)
        if codes is not None:
            footprint = Footprint.of(p.robot_radius, resolution, p.augmentation, values.shape)
            self._coded = PlanningMap(codes, footprint, self._workspace)
            self._planning_risk = self._augmented = None
            return
        augmented = augment(values, p.robot_radius, resolution, p.augmentation)
        augmented.flags.writeable = False
        self._planning_risk, self._augmented, self._coded = values.copy(), augmented, None

    def _check_shape(self, name: str, values: NDArray[np.generic]) -> None:
        if values.shape != self._geometry.shape:
            raise ValueError(
                f"{name} has the shape {values.shape} (rows, columns), "
                f"but the planner's area has {self._geometry.shape}"
            )


def _codes(values: NDArray[np.float64]) -> NDArray[np.int8] | None:
    """Return risks in hundredths, None if they are none."""
    codes = hundredths(values, np.broadcast_to(np.True_, values.shape))
    return None if codes is None else codes[1:-1, 1:-1]
