# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The planner's map: taken whole or by windows, augmented, and handed out for searches."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_navigation.cost_field import hundredths
from fuzzy_navigation.layered_map import LayeredMap
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.plan_types import RiskLayer
from fuzzy_navigation.planning_map import PlanningMap
from fuzzy_navigation.risk import Footprint, augment, checked_risk, real_numbers
from fuzzy_navigation.rungs import Rungs
from fuzzy_navigation.workspace import Workspace

__all__ = ["KeptMap", "MapLike"]

#: A map of risks, or a part of one: any in [0, 1], or hundredths.
MapLike: TypeAlias = ArrayLike | Hundredths


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
        if self._coded is not None and self._barred is None:
            return self._coded if layer is None else self._coded.under(layer)
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
        augmented = augment(self._risk(), radius, self._geometry.resolution, "disc")
        return LayeredMap(augmented, layer, self._barred, self._workspace)

    def take(
        self,
        planning_risk: MapLike,
        barred: ArrayLike | None,
        parameters: PlannerParameters,
    ) -> None:
        """Take a whole map; see `Planner.set_map`."""
        name = "the planning map"
        self._check_shape(name, _shape(planning_risk, name))
        risk = _read(planning_risk, name)
        bars: NDArray[np.bool_] | None = None
        if barred is not None:
            bars = np.array(barred)
            self._check_shape("barred", bars.shape)
            if bars.dtype != np.bool_:
                raise ValueError(f"barred must be an array of bool, got {bars.dtype}")
        if not isinstance(risk, Hundredths):
            self._keep_exact(risk, parameters)
        elif self._coded is None:
            self._keep_codes(risk.codes, parameters)
        else:
            self._coded.renew(risk.codes)
        self._barred = bars

    def take_window(
        self, planning_risk: MapLike, window: Window, parameters: PlannerParameters
    ) -> None:
        """Take new values for a window; see `Planner.update_map`."""
        height, width = self._geometry.shape
        rows, columns = (window.row0, window.row1, height), (window.col0, window.col1, width)
        if not all(0 <= first <= last <= end for first, last, end in (rows, columns)):
            raise ValueError(f"{window} is no part of a map of {height} rows, {width} columns")
        if not self.known:
            raise ValueError("the first planning map must be whole, not a window")
        name = "the window of the planning map"
        shape = _shape(planning_risk, name)
        if shape != window.shape:
            raise ValueError(
                f"{name} has the shape {shape} (rows, columns), but {window} has {window.shape}"
            )
        if window.empty:
            return
        new = _read(planning_risk, name)
        if self._coded is not None and isinstance(new, Hundredths):
            self._coded.update(new.codes, window)
            return
        risk = self._risk().copy()
        risk[window.slices] = new.risks if isinstance(new, Hundredths) else new
        self._keep_exact(risk, parameters)

    def augment(self, parameters: PlannerParameters) -> None:
        """Augment the map anew, for another robot."""
        if self._coded is not None:
            self._keep_codes(self._coded.codes, parameters)
        elif self.known:
            self._keep_exact(self._risk(), parameters)

    def _risk(self) -> NDArray[np.float64]:
        """Return the map as it came; there is one."""
        if self._coded is not None:
            return self._coded.planning_risk
        assert self._planning_risk is not None
        return self._planning_risk

    def _keep_codes(self, codes: NDArray[np.int8], p: PlannerParameters) -> None:
        resolution = self._geometry.resolution
        footprint = Footprint.of(p.robot_radius, resolution, p.augmentation, codes.shape)
        self._coded = PlanningMap(codes.copy(), footprint, self._workspace)
        self._planning_risk = self._augmented = None

    def _keep_exact(self, values: NDArray[np.float64], p: PlannerParameters) -> None:
        augmented = augment(values, p.robot_radius, self._geometry.resolution, p.augmentation)
        augmented.flags.writeable = False
        self._planning_risk, self._augmented, self._coded = values.copy(), augmented, None

    def _check_shape(self, name: str, shape: tuple[int, ...]) -> None:
        if shape != self._geometry.shape:
            raise ValueError(
                f"{name} has the shape {shape} (rows, columns), "
                f"but the planner's area has {self._geometry.shape}"
            )


def _shape(risk: MapLike, name: str) -> tuple[int, ...]:
    return risk.codes.shape if isinstance(risk, Hundredths) else real_numbers(risk, name).shape


def _read(risk: MapLike, name: str) -> NDArray[np.float64] | Hundredths:
    """Return risks checked, in hundredths if they can be."""
    if isinstance(risk, Hundredths):
        return risk
    values = checked_risk(risk, name)
    codes = hundredths(values)
    return values if codes is None else Hundredths(codes[1:-1, 1:-1])
