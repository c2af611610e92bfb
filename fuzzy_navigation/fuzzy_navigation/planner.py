# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""From a planning map and positions in metres to a path of poses.

The planner augments the map, walks up the ladder of alpha-cuts until a path exists, and
chooses where near the goal the path ends. Sections are those of Oriolo, Ulivi,
Vendittelli, IEEE Trans. SMC-B 28(3), 1998.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.types import Pose2
from fuzzy_map_building.wording import counted
from fuzzy_navigation.any_angle import pulled_straight
from fuzzy_navigation.clearance_layer import clearance_layer
from fuzzy_navigation.kept_map import KeptMap, MapLike
from fuzzy_navigation.params import PlannerParameters
from fuzzy_navigation.plan_request import PlanRequest
from fuzzy_navigation.plan_types import PlanResult, PlanStatus, RiskLayer
from fuzzy_navigation.rungs import Query, Rungs
from fuzzy_navigation.search import SearchResult

__all__ = ["PlanResult", "PlanStatus", "Planner"]


class Planner:
    """Plans paths of least risk on the newest planning map.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map's cells lie.
    parameters : PlannerParameters, optional
        Costs, cuts and the robot's size.

    Examples
    --------
    >>> planner = Planner(GridGeometry(20, 10, 0.1))
    >>> planner.set_map(np.zeros((10, 20)))
    >>> result = planner.plan(Pose2(0.55, 0.55), (1.45, 0.55))
    >>> result.status.name, len(result.poses), result.alpha
    ('FOUND', 10, 0.6)
    """

    def __init__(
        self, geometry: GridGeometry, parameters: PlannerParameters | None = None
    ) -> None:
        self.geometry = geometry
        self._parameters = parameters if parameters is not None else PlannerParameters()
        self._map = KeptMap(geometry)

    @property
    def parameters(self) -> PlannerParameters:
        """Costs, cuts and the robot's size; new ones hold from the next request on."""
        return self._parameters

    @parameters.setter
    def parameters(self, parameters: PlannerParameters) -> None:
        self._parameters = parameters
        self._map.augment(parameters)

    @property
    def augmented_risk(self) -> NDArray[np.float64] | None:
        """The augmented planning map M_p^a, shape (H, W), read-only; None without a map."""
        return self._map.augmented_risk

    @property
    def nbytes(self) -> int:
        """Memory of the map and of what searches work in [bytes]."""
        return self._map.nbytes

    def set_map(self, planning_risk: MapLike, barred: ArrayLike | None = None) -> None:
        """Take a new planning map.

        Parameters
        ----------
        planning_risk : array_like or Hundredths, shape (H, W)
            M_p, not augmented.
        barred : array_like of bool, shape (H, W), optional
            Cells that no path may enter, such as the unexplored ones of a finished map.

        Raises
        ------
        ValueError
            If shape or values are wrong; the map before stays.
        """
        self._map.take(planning_risk, barred, self._parameters)

    def update_map(self, planning_risk: MapLike, window: Window) -> None:
        """Take what is new in the planning map: the cells of a window.

        What this costs depends on the window, not on the map, as long as risks are
        hundredths. What is barred stays.

        Parameters
        ----------
        planning_risk : array_like or Hundredths, shape (h, w)
            M_p in the window, not augmented.
        window : Window
            The only cells that differ from the map before.

        Raises
        ------
        ValueError
            If there is no map, or shape, values or window are wrong; the map before stays.
        """
        self._map.take_window(planning_risk, window, self._parameters)

    def plan(
        self,
        start: Pose2 | tuple[float, float],
        goal: Pose2 | tuple[float, float],
        cost: str | None = None,
        alpha: float = 0.0,
        adjacency: int = 0,
        tolerance: float = 0.0,
        barred: ArrayLike = (),
        hits: ArrayLike = (),
        slim_radius: float = 0.0,
        slim_above: float = 0.0,
        any_angle: bool = False,
    ) -> PlanResult:
        """Answer a request for a path; never raises for what the request holds.

        Parameters
        ----------
        start, goal : Pose2 or tuple of float
            Positions (x, y) [m]. The start's cell counts as admissible.
        cost : {"g1", "g2", "g3"}, optional
            What the path minimises; the planner's parameter if not given.
        alpha : float
            Largest admissible risk, used alone; 0: the ladder of the parameters.
        adjacency : {0, 4, 8}
            Neighbours of a cell; 0: the planner's parameter.
        tolerance : float
            Distance [m] from the goal within which the path may end, at the nearest
            admissible cell that can be reached, up to `MAX_TOLERANCE`; 0: the planner's
            parameter. The cell that holds the goal always counts as within.
        barred : array_like, shape (n, 2), optional
            Positions (x, y) [m] whose cells no path may enter; those outside the map do not
            count. The start's cell stays admissible.
        hits : array_like, shape (n, 2), optional
            Points (x, y) [m] that sensors have just hit, on the map or beside it; without the
            parameter ``layer.enabled`` they do not count.
        slim_radius : float
            Radius [m] of a slimmer robot, in [0, 5]; 0: there is none. Where the true one has a
            path only on a rung above `slim_above`, the answer is the slim one's on the lowest
            rung, if there is any: it leads to an opening that wide cones make look too narrow.
            Cells of it may be riskier for the true robot than the reported alpha, the rung of
            the true robot's own path.
        slim_above : float
            Rung, in [0, 1].
        any_angle : bool
            Whether to join the cells of the path by straight lines at any angle where these
            cost no more, as the length of a line and not of its cells' steps counts. Poses then
            lie where the lines pass through their cells, not at the centres, and g1, g2 and g3
            are those of the cells on the lines. Without effect on g3 and 4-adjacency.

        Returns
        -------
        PlanResult
        """
        try:
            request = PlanRequest.checked(
                self._parameters, start, goal, cost, alpha, adjacency, tolerance, barred, hits,
                slim_radius, slim_above, any_angle,
            )  # fmt: skip
            layer = self._layer(request.hits)
        except (TypeError, ValueError) as error:
            return PlanResult(PlanStatus.BAD_REQUEST, f"request refused: {error}")
        if not self._map.known:
            return PlanResult(
                PlanStatus.NO_MAP,
                "no planning map has arrived yet; build or load a map, then ask again",
            )
        for name, xy, status in (
            ("start", request.start, PlanStatus.START_OUTSIDE),
            ("goal", request.goal, PlanStatus.GOAL_OUTSIDE),
        ):
            if not self.geometry.contains(*xy):
                return PlanResult(status, self._outside(name, xy))
        return self._climb(request, layer)

    def _cells(self, xy: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the cells of the positions that lie inside the map, shape (n, 2)."""
        cells, inside = self.geometry.cells_of(xy)
        return cells[inside]

    def _layer(self, hits: NDArray[np.float64]) -> RiskLayer | None:
        """Return the risk that hit points lay over the map; None: there is none."""
        p = self._parameters
        if len(hits) == 0 or not p.layer.enabled:
            return None
        return clearance_layer(self.geometry, hits, p.robot_radius, p.layer)

    def _climb(self, request: PlanRequest, layer: RiskLayer | None) -> PlanResult:
        """Try rung after rung, and take the path of the first that does."""
        p = self._parameters
        query = Query(
            self.geometry.cell_of(*request.start),
            self._goal_cells(request.goal, request.tolerance, request.start),
            self._cells(request.barred),
            request.cost,
            request.adjacency,
            p.epsilon,
            p.diagonal,
            p.corner_cutting,
            p.least_risk,
        )
        rungs = self._map.rungs(layer)
        found: dict[float, SearchResult | None] = {}
        tried, limit = request.rungs, math.inf
        if p.rung_choice == "cheapest":
            # The last rung admits what the others do: to an end no path is cheaper, and without
            # one there is none.
            top = request.rungs[-1]
            found[top] = cheapest = rungs.search(query, top)
            if cheapest is None:
                tried = ()
            else:
                limit = p.rung_factor * float(getattr(cheapest, request.cost))
        for rung in tried:
            if rung not in found:
                found[rung] = rungs.search(query, rung)
            result = found[rung]
            if result is not None and getattr(result, request.cost) <= limit:
                break
        else:
            last = request.rungs[-1]
            goal_blocked = rungs.blocked(query, last)
            message = _no_path(request, goal_blocked) + self._closed_by_request(query, layer, last)
            return PlanResult(PlanStatus.NO_PATH, message, alpha=last)
        chosen: tuple[Rungs, float, SearchResult] = rungs, rung, result
        message = f"path of {counted(len(result.path), 'cell')} at alpha {rung:g}"
        if rung > request.rungs[0]:
            dearer = found[request.rungs[0]] is not None
            message += (
                f", {'a much dearer one' if dearer else 'none'} at alpha {request.rungs[0]:g}"
            )
        if request.slim_radius > 0.0 and rung > request.slim_above:
            slimmer = self._map.slimmer(request.slim_radius, layer)
            slim_path = slimmer.search(query, request.rungs[0])
            if slim_path is not None:
                chosen = slimmer, request.rungs[0], slim_path
                message += f"; instead that of a slimmer robot, of {len(slim_path.path)} cells"
        path = chosen[2].path
        places = path.astype(np.float64)
        if request.any_angle and query.adjacency == 8 and query.cost != "g3":
            path, places = _straight(chosen[0], query, chosen[1], path)
        return PlanResult(
            PlanStatus.FOUND,
            message,
            path,
            self._poses(places, request.heading),
            *rungs.risks(query, path),
            rung,
            sum(result.expanded for result in found.values() if result is not None),
        )

    def _closed_by_request(self, query: Query, layer: RiskLayer | None, rung: float) -> str:
        """Say what of the request, not of the map, closes a way that the map has; else nothing."""
        hits, barred = "points that the robot's sensors hit", "cells that it was barred from"
        unbarred = replace(query, barred=query.barred[:0])
        tries: list[tuple[RiskLayer | None, Query, str]] = []
        if layer is not None:
            tries.append((None, query, hits))
        if len(query.barred) > 0:
            tries.append((layer, unbarred, barred))
        if len(tries) == 2:
            tries.append((None, unbarred, f"{hits} and {barred}"))
        for laid, tried, what in tries:
            if self._map.rungs(laid).search(tried, rung) is not None:
                return f"; the map by itself has a path, but it is closed by {what}"
        return ""

    def _goal_cells(
        self, goal: tuple[float, float], tolerance: float, start: tuple[float, float]
    ) -> NDArray[np.int64]:
        """Return the cells where a path may end, nearest first, shape (n, 2)."""
        geometry = self.geometry
        window = geometry.window(*goal, tolerance + geometry.resolution)
        x, y = geometry.centres(window)
        distance = np.hypot(x[None, :] - goal[0], y[:, None] - goal[1])
        row, column = geometry.cell_of(*goal)
        # A millionth of a cell: centres at exactly the tolerance count.
        within = distance <= tolerance + 1e-6 * geometry.resolution
        own = row - window.row0, column - window.col0
        within[own] = True
        # On a border of cells several are as near; a robot that is in the goal's cell stays there.
        if geometry.cell_of(*start) == (row, column):
            distance[own] = 0.0
        cells = np.argwhere(within)
        # Stable: equal distances keep the order of rows, then columns.
        order = np.argsort(distance[within].round(9), kind="stable")
        out: NDArray[np.int64] = cells[order] + (window.row0, window.col0)
        return out

    def _poses(self, places: NDArray[np.float64], heading: float) -> tuple[Pose2, ...]:
        """Return places (row, column) as poses, each heading to the next.

        The last heads as the one before; `heading` [rad] is that of a path of one cell.
        """
        steps = np.diff(places, axis=0)
        headings = [math.atan2(row, column) for row, column in steps.tolist()]
        headings.append(headings[-1] if headings else heading)
        x, y = self.geometry.centre_coordinates(places[:, 0], places[:, 1])
        return tuple(map(Pose2, x.tolist(), y.tolist(), headings))

    def _outside(self, name: str, xy: tuple[float, float]) -> str:
        x0, y0, x1, y1 = self.geometry.bounds
        return (
            f"the {name} ({xy[0]:.2f}, {xy[1]:.2f}) m lies outside the map, which covers "
            f"x {x0:g} to {x1:g} m and y {y0:g} to {y1:g} m; choose a point inside"
        )


def _straight(
    rungs: Rungs, query: Query, rung: float, path: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the path pulled straight: its cells, and places in them (row, column)."""
    first = path.min(axis=0)
    row0, col0 = first.tolist()
    row1, col1 = (path.max(axis=0) + 1).tolist()
    weights = rungs.weights(query, rung, Window(row0, row1, col0, col1))
    cells, places = pulled_straight(path - first, weights, query.corner_cutting)
    return cells + first, places + first


def _no_path(request: PlanRequest, goal_blocked: bool) -> str:
    """Say why there is no path, and what can be done."""
    goal = f"({request.goal[0]:.2f}, {request.goal[1]:.2f}) m"
    alpha = request.rungs[-1]
    if goal_blocked:
        return (
            f"no cell within {request.tolerance:g} m of the goal {goal} is admissible at alpha "
            f"{alpha:g}: an obstacle stands there; choose another goal, or allow a larger "
            "tolerance or alpha"
        )
    advice = "" if alpha >= 1.0 else "; allow a larger alpha"
    return (
        f"no path from ({request.start[0]:.2f}, {request.start[1]:.2f}) m to the goal {goal}: "
        f"cells that are not admissible at alpha {alpha:g} part them{advice}"
    )
