# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The clearance layer against its piecewise definition and a loop over cells, places, points."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.parameter_schema import ParameterError
from fuzzy_navigation.clearance_layer import (
    best_clearance,
    best_places,
    clearance_layer,
    clearance_risk,
    places_in_cell,
    shift_within,
)
from fuzzy_navigation.layer_params import LayerParameters
from fuzzy_navigation.plan_types import RiskLayer

P = LayerParameters()
RADIUS = 0.23
GEOMETRY = GridGeometry(30, 20, 0.1, (-1.0, 2.0))
NO_HITS = np.empty((0, 2))


def risk_by_hand(c: float) -> float:
    """mu_I as the method words it."""
    if c < 0.05:
        return 2.0
    if c <= 0.12:
        return 1.0 - 0.4 * (c - 0.05) / 0.07
    if c < 0.20:
        return 0.599 * (0.2 - c) / 0.08
    return 0.0


def clearances_by_hand(x: float, y: float, hits: np.ndarray) -> dict[tuple[float, float], float]:
    """Clearance at each of the nine places of a cell, by the offset of the place."""
    return {
        (dx, dy): min(math.hypot(x + dx - u, y + dy - v) for u, v in hits) - RADIUS
        for dx in (-0.045, 0.0, 0.045)
        for dy in (-0.045, 0.0, 0.045)
    }


def some_hits(seed: int) -> np.ndarray:
    """Points on the map, at its rim, and just outside."""
    rng = np.random.default_rng(seed)
    return np.vstack([rng.uniform((-1.4, 1.6), (2.4, 4.4), (12, 2)), [(-1.05, 3.0), (2.05, 4.05)]])


def over_the_map(layer: RiskLayer) -> tuple[np.ndarray, np.ndarray]:
    """Cut and cost of every cell, 0 where the layer has none; each cell is named once."""
    assert len(np.unique(layer.cells, axis=0)) == len(layer.cells)
    cut, cost = np.zeros((2, *GEOMETRY.shape))
    cut[tuple(layer.cells.T)], cost[tuple(layer.cells.T)] = layer.cut, layer.cost
    return cut, cost


@pytest.mark.parametrize(
    ("clearance", "risk"),
    [
        (-0.1, 2.0),
        (0.049, 2.0),
        (0.05, 1.0),
        (0.085, 0.8),
        (0.12, 0.6),
        (0.16, 0.2995),
        (0.2, 0.0),
        (math.inf, 0.0),
    ],
)
def test_the_risk_of_a_clearance(clearance, risk):
    assert clearance_risk(clearance, P) == pytest.approx(risk, abs=1e-12)


def test_the_risk_follows_the_pieces_between_their_ends():
    clearances = np.linspace(0.0, 0.3, 3001)
    by_hand = [risk_by_hand(c) for c in clearances]
    np.testing.assert_allclose(clearance_risk(clearances, P), by_hand, atol=1e-9)
    assert (np.diff(clearance_risk(clearances, P)) <= 0.0).all()


def test_the_paper_s_least_clearance_is_on_the_first_rung_exactly():
    assert clearance_risk(0.12, P) <= 0.6 < clearance_risk(math.nextafter(0.12, 0.0), P) + 1e-12
    assert clearance_risk(0.1199, P) > 0.6


@pytest.mark.parametrize("seed", range(4))
def test_the_layer_is_that_of_each_cell_s_best_place(seed):
    hits = some_hits(seed)
    layer = clearance_layer(GEOMETRY, hits, RADIUS, P)
    assert len(layer.cells) > 50
    cut, cost = over_the_map(layer)
    for row in range(GEOMETRY.height):
        for column in range(GEOMETRY.width):
            x, y = GEOMETRY.centre_of(row, column)
            risk = risk_by_hand(max(clearances_by_hand(x, y, hits).values()))
            assert cut[row, column] == pytest.approx(risk, abs=1e-9)
            assert cost[row, column] == pytest.approx(0.8 * min(risk, 1.0), abs=1e-9)


def test_no_hit_points_give_no_risk():
    for hits in (NO_HITS, np.array([(50.0, 3.0), (-1e300, 3.0), (0.0, 1e18)])):
        layer = clearance_layer(GEOMETRY, hits, RADIUS, P)
        assert layer.cells.shape == (0, 2)
        assert layer.cut.shape == layer.cost.shape == (0,)


def test_parts_of_the_layer_follow_their_parameters():
    hits = np.array([(0.53, 3.02)])
    p = LayerParameters(closed=0.1, limit=0.3, free=0.7, shift=0.0, cost=0.25)
    cut, cost = over_the_map(clearance_layer(GEOMETRY, hits, 0.1, p))
    for row, column in ((10, 15), (10, 17), (13, 17), (15, 19), (2, 10), (10, 24)):
        x, y = GEOMETRY.centre_of(row, column)
        c = math.hypot(x - 0.53, y - 3.02) - 0.1
        risk = 0.599 * (0.7 - c) / 0.4 if c > 0.3 else 1.0 - 0.4 * (c - 0.1) / 0.2
        risk = 2.0 if c < 0.1 else max(risk, 0.0)
        assert cut[row, column] == pytest.approx(risk, abs=1e-12)
        assert cost[row, column] == pytest.approx(0.25 * min(risk, 1.0), abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_the_best_place_of_a_cell(seed):
    hits = some_hits(seed)
    centres = np.random.default_rng(seed).uniform((-1.0, 2.0), (2.0, 4.0), (40, 2))
    clearances = best_clearance(centres, hits, RADIUS, 0.045)
    places = best_places(centres, hits, RADIUS, 0.045)
    for (x, y), clearance, place in zip(centres, clearances, places, strict=True):
        nine = clearances_by_hand(x, y, hits)
        assert clearance == pytest.approx(max(nine.values()))
        worth = {d: min(c, 0.25) - 0.1 * math.hypot(*d) for d, c in nine.items()}
        offset = tuple(np.round(place - (x, y), 9))
        assert worth[offset] == pytest.approx(max(worth.values()))


def test_where_there_is_room_the_centre_is_best():
    centres = np.array([(0.0, 3.0), (1.0, 3.0)])
    np.testing.assert_array_equal(best_places(centres, NO_HITS, RADIUS, 0.045), centres)
    far = np.array([(0.0, 3.55), (1.0, 2.45)])
    np.testing.assert_array_equal(best_places(centres, far, RADIUS, 0.045), centres)
    assert np.isinf(best_clearance(centres, NO_HITS, RADIUS, 0.045)).all()


def test_between_two_walls_the_place_is_in_the_middle():
    """A gap of 0.65 m whose middle is 4.5 cm beside the cells' centres."""
    x = np.arange(0.0, 1.0, 0.02)
    hits = np.vstack([np.column_stack([x, np.full(50, y)]) for y in (2.72, 3.37)])
    places = best_places([(0.45, 3.0)], hits, RADIUS, 0.045)
    np.testing.assert_allclose(places, [(0.45, 3.045)])
    assert best_clearance([(0.45, 3.0)], hits, RADIUS, 0.045)[0] == pytest.approx(0.095, abs=5e-4)


def test_nine_places_the_centre_first():
    places = places_in_cell(0.03)
    assert places[0].tolist() == [0.0, 0.0]
    assert sorted(map(tuple, places.tolist())) == sorted(
        (x, y) for x in (-0.03, 0.0, 0.03) for y in (-0.03, 0.0, 0.03)
    )


@pytest.mark.parametrize(("side", "shift"), [(0.05, 0.0225), (0.1, 0.045), (0.2, 0.045)])
def test_the_places_of_a_small_cell_stay_in_it(side, shift):
    assert shift_within(0.045, side) == pytest.approx(shift, abs=1e-12)
    geometry = GridGeometry(40, 40, side)
    hit = np.array([geometry.centre_of(20, 20)])
    parameters = LayerParameters(closed=0.02, limit=0.1, free=1.0)
    layer = clearance_layer(geometry, hit, RADIUS, parameters)
    risks = dict(zip(map(tuple, layer.cells.tolist()), layer.cut.tolist(), strict=True))
    # Of a cell to the side the best of the nine places is one of the corners farthest away.
    cells = round(0.4 / side)
    clearance = math.hypot(cells * side + shift, shift) - RADIUS
    risk = clearance_risk([clearance], parameters)[0]
    assert 0.0 < risk < 0.6
    assert risks[20, 20 + cells] == pytest.approx(risk, abs=1e-9)


@pytest.mark.parametrize(
    "values",
    [{"closed": 0.12}, {"limit": 0.2}, {"free": 0.1}, {"closed": 0.3}],
)
def test_clearances_have_to_rise(values):
    with pytest.raises(ParameterError, match=r"layer\.closed.*rise"):
        LayerParameters(**values)
