# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Infrared hit points and clearances against geometry by hand."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import InfraredReading, Pose2
from fuzzy_navigation.clearance import (
    InfraredRing,
    approach_speed,
    clearance_at,
    hit_points,
)
from fuzzy_navigation.params import InfraredParameters

RADIUS = 0.23
RING = InfraredParameters()
NO_HITS = np.empty((0, 2))


def reading(sensor: int, distance: float, stamp: float = 0.0) -> InfraredReading:
    return InfraredReading(
        Pose2(1.0, 2.0, 0.5 * math.pi), sensor * math.pi / 8.0, distance, stamp, sensor
    )


def test_hit_points_lie_ahead_of_their_sensors() -> None:
    hits = hit_points([reading(0, 0.1), reading(4, 0.2), reading(8, 0.3)], RADIUS)
    # The robot at (1, 2) looks along +y; sensor 4 looks to its left, along -x.
    np.testing.assert_allclose(hits, [(1.0, 2.33), (0.57, 2.0), (1.0, 1.47)], atol=1e-12)


@pytest.mark.parametrize("distance", [math.inf, math.nan, 0.61, 0.019, -0.5])
def test_what_is_no_measurement_is_no_hit(distance: float) -> None:
    assert hit_points([reading(0, distance)], RADIUS, 0.02, 0.6).shape == (0, 2)


def test_too_close_to_measure_is_a_hit_at_the_shortest_range() -> None:
    hits = hit_points([reading(0, -math.inf)], RADIUS, 0.02, 0.6)
    np.testing.assert_allclose(hits, [(1.0, 2.25)])


@pytest.mark.parametrize("distance", [0.02, 0.6])
def test_the_bounds_of_the_range_count(distance: float) -> None:
    assert len(hit_points([reading(0, distance)], RADIUS, 0.02, 0.6)) == 1


def test_clearance_is_the_distance_to_the_nearest_hit_less_the_body() -> None:
    rng = np.random.default_rng(1)
    points, hits = rng.uniform(-2, 2, (7, 2)), rng.uniform(-2, 2, (9, 2))
    found = clearance_at(points, hits, RADIUS)
    for (x, y), clearance in zip(points, found, strict=True):
        by_hand = min(math.dist((x, y), hit) for hit in hits) - RADIUS
        assert clearance == pytest.approx(by_hand)
    assert clearance_at(points[0], hits, RADIUS).shape == (1,)


def test_nothing_seen_is_infinite_clearance() -> None:
    np.testing.assert_array_equal(clearance_at([(0, 0), (1, 1)], NO_HITS, RADIUS), np.inf)


@pytest.mark.parametrize("clearance", [0.0, 0.05, 0.12, 0.6, 3.0])
def test_the_approach_speed_leaves_room_for_delay_and_braking(clearance: float) -> None:
    v = approach_speed(clearance, 0.5, 0.1)
    assert v * 0.1 + v * v / (2.0 * 0.5) == pytest.approx(clearance)


def test_the_approach_speed_at_the_ends() -> None:
    assert approach_speed(-0.1, 0.5, 0.1) == 0.0
    assert approach_speed(math.inf, 0.5, 0.1) == math.inf


class TestRing:
    def test_the_newest_reading_of_each_sensor_counts(self) -> None:
        ring = InfraredRing(RING)
        ring.update([reading(0, 0.1, 1.0), reading(4, 0.2, 1.0)])
        ring.update([reading(0, 0.3, 1.1), reading(0, 0.5, 0.9)])
        hits = ring.hits(1.1, 0.5)
        np.testing.assert_allclose(sorted(hits.tolist()), [(0.57, 2.0), (1.0, 2.53)])

    def test_old_readings_do_not_count(self) -> None:
        ring = InfraredRing(RING)
        ring.update([reading(0, 0.1, 1.0), reading(4, 0.2, 1.4)])
        assert len(ring.hits(1.5, 0.5)) == 2
        assert len(ring.hits(1.51, 0.5)) == 1
        assert len(ring.hits(3.0, 0.5)) == 0

    def test_a_faulty_reading_is_none(self) -> None:
        ring = InfraredRing(RING)
        ring.update([reading(0, 0.1, 1.0)])
        ring.update([reading(0, math.nan, 1.1)])
        assert len(ring.hits(1.2, 0.5)) == 1

    @pytest.mark.parametrize("sensor", [-1, 16])
    def test_an_unknown_sensor_is_refused_with_all_that_came_along(self, sensor: int) -> None:
        ring = InfraredRing(RING)
        stranger = InfraredReading(Pose2(0, 0, 0), 0.0, 0.1, 1.0, sensor)
        with pytest.raises(ValueError, match=rf"sensor {sensor}: .* 0 to 15"):
            ring.update([reading(0, 0.1, 1.0), stranger])
        assert ring.present(1.0, 0.5) == []
