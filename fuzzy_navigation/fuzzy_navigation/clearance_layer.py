# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The clearance layer: what the points that the sensors hit say of the cells near them.

Maps of cells are too coarse for a passage that is hardly wider than the robot. Hit points are
not: the clearance c of the body at a place follows from them to within the sensors' noise. The
layer turns it into a risk mu_I, so that the ladder of alpha-cuts, which asks for less and less
certainty, also comes down in clearance: its first rung, 0.6, is the paper's least clearance.

Since a robot need not drive through the centre of a cell, a cell counts by the best of nine
places in it, and the robot then drives to the one that suits it best.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_navigation.clearance import clearance_at, nearest_square
from fuzzy_navigation.layer_params import LayerParameters
from fuzzy_navigation.plan_types import RiskLayer

__all__ = [
    "PLENTY",
    "best_clearance",
    "best_places",
    "clearance_layer",
    "clearance_risk",
    "places_in_cell",
    "shift_within",
    "warm_up",
]

Floats = NDArray[np.float64]

#: Risk at the least clearance: the first rung of the paper's ladder.
LIMIT_RISK = 0.6
#: What the risk beyond the least clearance stays below it.
STEP = 0.001
#: Risk of what no rung admits.
CLOSED_RISK = 2.0
#: Clearance beyond which more is no better for the place to drive to in a cell [m].
PLENTY = 0.25
#: How far aside the places in a cell are at most, as a part of its side.
MOST_ASIDE = 0.45
#: Most pairs of a hit point and a cell near to it: 10,000 points on cells of 5 cm. What a
#: request has computed of them takes about 100 bytes each.
MOST_PAIRS = 8_000_000
#: What a place off the cell's centre has to be better by, as a part of its distance from it.
DETOUR = 0.1


def clearance_risk(clearance: ArrayLike, parameters: LayerParameters) -> Floats:
    """Return the risk mu_I of places, by the clearance of the body there.

    Parameters
    ----------
    clearance : array_like
        Clearances c [m], +inf where nothing is near.
    parameters : LayerParameters
        The clearances where the risk changes its form.

    Returns
    -------
    ndarray of float64
        2 below `closed`; from 1 there down to 0.6 at `limit`; from 0.599 beyond it down to 0 at
        `free`.
    """
    c = np.asarray(clearance, dtype=np.float64)
    risk = np.empty(c.shape)
    p = parameters
    _risks(for_kernel(c.reshape(-1)), p.closed, p.limit, p.free, for_kernel(risk.reshape(-1)))
    return risk


@njit
def _risks(clearance: Floats, closed: float, limit: float, free: float, risk: Floats) -> None:
    """Fill in the risk of some places, all shape (n,), as `clearance_risk` says."""
    for i in range(len(clearance)):
        c = clearance[i]
        if c < closed:
            risk[i] = CLOSED_RISK
        elif c <= limit:
            risk[i] = LIMIT_RISK + (1.0 - LIMIT_RISK) * (limit - c) / (limit - closed)
        elif c < free:
            risk[i] = (LIMIT_RISK - STEP) * (free - c) / (free - limit)
        else:
            risk[i] = 0.0


def shift_within(shift: float, side: float) -> float:
    """Return how far aside the places of a cell are, which all lie in the cell.

    Parameters
    ----------
    shift : float
        How far aside they are wanted, `LayerParameters.shift` [m].
    side : float
        Side of the cell [m].

    Returns
    -------
    float
        That, but no more than 0.45 sides [m]: farther off a place is one of the neighbours', and
        a cell would count by room that is not its own.
    """
    return min(shift, MOST_ASIDE * side)


def places_in_cell(shift: float) -> Floats:
    """Return the nine places that a cell counts by, its centre first.

    Parameters
    ----------
    shift : float
        How far they are aside [m].

    Returns
    -------
    ndarray of float64, shape (9, 2)
        Offsets (x, y) [m] from the cell's centre.
    """
    sides = (0.0, -shift, shift)
    return np.array([(x, y) for x in sides for y in sides])


def _clearances(centres: ArrayLike, hits: Floats, robot_radius: float, shift: float) -> Floats:
    """Return the clearance [m] at the nine places in each of some cells, shape (m, 9)."""
    cells = np.asarray(centres, dtype=np.float64).reshape(-1, 2)
    clearances = np.empty((len(cells), 9))
    _at_places(for_kernel(cells), for_kernel(hits), robot_radius, shift, for_kernel(clearances))
    return clearances


@njit
def _at_places(
    cells: Floats, hits: Floats, robot_radius: float, shift: float, clearances: Floats
) -> None:
    """Fill in what `_clearances` returns; the places are in the order of `places_in_cell`."""
    for i in range(len(cells)):
        place = 0
        for x in (cells[i, 0], cells[i, 0] - shift, cells[i, 0] + shift):
            for y in (cells[i, 1], cells[i, 1] - shift, cells[i, 1] + shift):
                clearances[i, place] = math.sqrt(nearest_square(x, y, hits)) - robot_radius
                place += 1


def warm_up() -> None:
    """Compile the kernels called here, or load them from the cache."""
    place = np.zeros((1, 2))
    clearance_risk(clearance_at(place, place, 0.0), LayerParameters())
    best_clearance(place, place, 0.0, 0.0)


def best_clearance(centres: ArrayLike, hits: Floats, robot_radius: float, shift: float) -> Floats:
    """Return the largest clearance that the body can have in each of some cells.

    Parameters
    ----------
    centres : array_like, shape (m, 2)
        Centres (x, y) of the cells [m].
    hits : ndarray of float64, shape (n, 2)
        Hit points [m].
    robot_radius : float
        Radius of the body [m].
    shift : float
        How far off its centre the robot may drive through a cell, in x and in y [m].

    Returns
    -------
    ndarray of float64, shape (m,)
        Clearance [m] at the best of nine places; +inf without any hit point.
    """
    best: Floats = _clearances(centres, hits, robot_radius, shift).max(axis=1)
    return best


def best_places(
    centres: ArrayLike,
    hits: Floats,
    robot_radius: float,
    shift: float,
    planned: ArrayLike | None = None,
) -> Floats:
    """Return where in each of some cells to drive.

    Parameters
    ----------
    centres, hits, robot_radius, shift
        As `best_clearance` takes them.
    planned : array_like, shape (m, 2), optional
        Where in the cells the path leads [m]; through their centres if not given.

    Returns
    -------
    ndarray of float64, shape (m, 2)
        The place (x, y) [m], the planned one or one of the nine, where clearance, of which
        0.25 m is plenty, less a tenth of the distance from the planned one is greatest; the
        planned one where all are alike.
    """
    cells = np.asarray(centres, dtype=np.float64).reshape(-1, 1, 2)
    path = cells if planned is None else np.asarray(planned, dtype=np.float64).reshape(-1, 1, 2)
    places = np.concatenate((path, cells + places_in_cell(shift)), axis=1)
    clearance = clearance_at(places.reshape(-1, 2), hits, robot_radius).reshape(places.shape[:2])
    aside = np.hypot(places[..., 0] - path[..., 0], places[..., 1] - path[..., 1])
    best = (np.minimum(clearance, PLENTY) - DETOUR * aside).argmax(axis=1)
    chosen: Floats = places[np.arange(len(places)), best]
    return chosen


def clearance_layer(
    geometry: GridGeometry, hits: Floats, robot_radius: float, parameters: LayerParameters
) -> RiskLayer:
    """Return the layer of risk that hit points lay over a map.

    Parameters
    ----------
    geometry : GridGeometry
        Where the map's cells lie.
    hits : ndarray of float64, shape (n, 2)
        Hit points [m], inside the map or outside.
    robot_radius : float
        Radius of the body [m].
    parameters : LayerParameters
        The layer.

    Returns
    -------
    RiskLayer
        The cells with a risk: ``cut`` is mu_I of each one's best clearance; ``cost`` is of
        that, of no more than 1, the part that a path pays.

    Raises
    ------
    ValueError
        If there are more than `MOST_PAIRS` pairs of a hit point and a cell near to it.
    """
    p = parameters
    # Farther than this from all hit points a cell's best place has no risk.
    shift = shift_within(p.shift, geometry.resolution)
    reach = robot_radius + p.free + math.sqrt(2.0) * shift
    cells, near = _cells_near(geometry, hits, reach)
    known, where = np.unique(cells, return_inverse=True)
    rows, columns = np.divmod(cells, geometry.width)
    x, y = geometry.centre_coordinates(rows, columns)
    offset_x, offset_y = x - near[:, 0], y - near[:, 1]
    best = np.zeros(len(known))
    for shift_x, shift_y in places_in_cell(shift):
        nearest = np.full(len(known), np.inf)
        np.minimum.at(nearest, where, (offset_x + shift_x) ** 2 + (offset_y + shift_y) ** 2)
        np.maximum(best, nearest, out=best)
    cut = clearance_risk(np.sqrt(best) - robot_radius, p)
    risky = cut > 0.0
    known, cut = known[risky], cut[risky]
    cells = np.stack(np.divmod(known, geometry.width), axis=1)
    return RiskLayer(cells, cut, p.cost * np.minimum(cut, 1.0))


def _cells_near(
    geometry: GridGeometry, hits: Floats, reach: float
) -> tuple[NDArray[np.int64], Floats]:
    """Return pairs of a cell, by its flat index, and a hit point that may be so near [m]."""
    counts = np.array((geometry.width, geometry.height))
    # Clipped before they become whole numbers: far corners overflow an integer.
    with np.errstate(over="ignore"):
        low = np.floor((hits - reach - geometry.origin) / geometry.resolution)
        high = np.floor((hits + reach - geometry.origin) / geometry.resolution) + 1.0
    first = np.clip(low, 0, counts).astype(np.int64)
    size = np.clip(high, 0, counts).astype(np.int64) - first
    cells = size[:, 0] * size[:, 1]
    count = int(cells.sum())
    if count > MOST_PAIRS:
        raise ValueError(
            f"{len(hits)} hit points are near to {count} cells of {geometry.resolution:g} m, "
            f"together at most {MOST_PAIRS} are taken; use fewer points or coarser cells"
        )
    hit = np.repeat(np.arange(len(hits)), cells)
    place = np.arange(count) - np.repeat(np.cumsum(cells) - cells, cells)
    rows, columns = np.divmod(place, size[hit, 0])
    rows += first[hit, 1]
    columns += first[hit, 0]
    return rows * geometry.width + columns, hits[hit]
