# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The sonar guard against loops over the rule as it is worded, and against geometry by hand."""

import math

import numpy as np
import pytest

from fuzzy_map_building.infrared_packet import InfraredPacket
from fuzzy_map_building.params import (
    InfraredParameters,
    MapperParameters,
    SonarGuardParameters,
    SonarParameters,
)
from fuzzy_map_building.sonar_guard import RIM_SPREAD, cut_rays, guard_points, rim_points
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from unit.fuzzy_map_building.scalar_mapper import limit_of_lost_echo

SONAR, INFRARED, GUARD = SonarParameters(), InfraredParameters(), SonarGuardParameters()
MAPPER = MapperParameters(sonar=SONAR)
RADIUS = 0.23


def hits(infrared: list) -> np.ndarray:
    return InfraredPacket.from_readings(infrared, INFRARED).hit_points()


def points(sonar: list, infrared: list, reach: float = 0.6) -> np.ndarray:
    return guard_points(sonar, hits(infrared), SONAR, GUARD, reach, RADIUS)


def limits(sonar: list, infrared: list, reach: float = 0.6) -> np.ndarray:
    cut = cut_rays(sonar, infrared, SONAR, INFRARED, GUARD, reach, RADIUS)
    assert [(r.pose, r.bearing) for r in cut] == [(r.pose, r.bearing) for r in infrared]
    assert [str(r.range) for r in cut] == [str(r.range) for r in infrared]
    return np.array([r.limit for r in cut])


def angle(a: float, b: float) -> float:
    return abs(math.atan2(math.sin(a - b), math.cos(a - b)))


def heading(reading: SonarReading | InfraredReading) -> float:
    return reading.pose.theta + reading.bearing


def reach_of(reading: SonarReading, packet: list[SonarReading]) -> float:
    """How far a reading looks from the robot's centre, a lost echo as far as its neighbours."""
    if reading.range == math.inf:
        return limit_of_lost_echo(reading, packet, MAPPER) + 0.23
    return max(reading.range, 0.12) + 0.23


def test_glass_ahead_becomes_three_hit_points_and_cuts_the_rays_beside_it() -> None:
    pose = Pose2(2.0, 1.0, math.radians(90.0))
    echo = SonarReading(pose, 0.0, 0.30)
    blind = [InfraredReading(pose, math.radians(22.5 * i), math.inf, 0.0, i) for i in range(16)]
    expected = [
        (2.0 + 0.53 * math.cos(math.radians(d)), 1.0 + 0.53 * math.sin(math.radians(d)))
        for d in (90.0, 96.0, 84.0)
    ]
    np.testing.assert_allclose(points([echo], blind), expected, atol=1e-12)
    cut = limits([echo], blind)
    assert cut[0] == pytest.approx(0.25)  # 5 cm before the return
    assert np.isinf(cut[1:]).all()  # the next ray is 22.5 deg away


@pytest.mark.parametrize(
    ("distance", "bearing", "explains"),
    [(0.30, 0.0, True), (0.379, 14.9, True), (0.381, 0.0, False), (0.2, 15.1, False)],
)
def test_an_infrared_hit_explains_a_return(
    distance: float, bearing: float, explains: bool
) -> None:
    pose = Pose2(0.0, 0.0, 3.1)
    echo = SonarReading(pose, 0.1, 0.30)
    hit = InfraredReading(pose, 0.1 + math.radians(bearing), distance)
    assert (len(points([echo], [hit])) == 0) is explains
    assert np.isinf(limits([echo], [hit])).all() or not explains


def test_a_longer_reading_takes_away_the_hits_that_it_looks_through() -> None:
    # An edge 10 deg to the left, 0.7 m away, heard by sonars within 12.5 deg of it. Right of
    # the axis a reading goes on for 2 m, and left of the edge another one.
    pose = Pose2(0.0, 0.0)
    edge, far = 0.47, 1.77

    def packet(*ranges: float) -> list[SonarReading]:
        bearings = (-7.5, 0.0, 7.5, 15.0, 22.5)
        return [
            SonarReading(pose, math.radians(b), r) for b, r in zip(bearings, ranges, strict=True)
        ]

    found = points(packet(far, edge, edge, edge, far), [])
    directions = sorted(round(math.degrees(math.atan2(y, x)), 6) for x, y in found)
    # Of -6 ... 21 deg what lies outside of 0.5 ... 14.5 deg is seen through.
    assert directions == [1.5, 6.0, 7.5, 9.0, 13.5]
    # A pole that one sonar alone hears, between two that look past it, is somewhere all the same.
    assert len(points(packet(far, edge, far, far, far), [])) == 3
    # So is a surface behind which nobody looks more than 15 cm.
    assert len(points(packet(0.61, edge, 0.61, far, far), [])) == 3


def test_only_short_returns_count() -> None:
    pose = Pose2(0.0, 0.0)
    for reading, number in ((0.599, 3), (0.601, 0), (-math.inf, 3), (math.inf, 0), (math.nan, 0)):
        assert len(points([SonarReading(pose, 0.0, reading)], [])) == number
    assert len(points([SonarReading(pose, 0.0, 0.3)], [], reach=0.25)) == 0
    # An infrared reading that is none explains nothing.
    nothing = [InfraredReading(pose, 0.0, value) for value in (math.nan, math.inf, 0.61)]
    assert len(points([SonarReading(pose, 0.0, 0.5)], nothing)) == 3


def test_a_hit_seen_from_elsewhere_explains_as_well() -> None:
    echo = SonarReading(Pose2(0.0, 0.0), 0.0, 0.27)  # a surface at (0.5, 0)
    beside = InfraredReading(Pose2(0.5, 0.4, -math.pi / 2.0), 0.0, 0.17)  # at (0.5, 0), too
    assert len(points([echo], [beside])) == 0
    # Where nothing is seen the ray goes on to 5 cm before the surface: (0.5, 0.4) to (0.5, 0.05).
    through = InfraredReading(beside.pose, 0.0, math.inf)
    assert limits([echo], [through])[0] == pytest.approx(0.4 - 0.05 - 0.23)


def test_many_readings_against_a_loop() -> None:
    rng = np.random.default_rng(3)
    sonar = [
        SonarReading(Pose2(*rng.uniform(-0.2, 0.2, 2), rng.uniform(-9, 9)), 0.4 * i, r)
        for i, r in enumerate(rng.choice([0.2, 0.35, 0.5, 2.0, math.inf, -math.inf], 40))
    ]
    infrared = [
        InfraredReading(Pose2(*rng.uniform(-0.2, 0.2, 2), rng.uniform(-9, 9)), 0.39 * i, r)
        for i, r in enumerate(rng.choice([0.1, 0.3, 0.45, math.inf, math.nan, 3.0], 40))
    ]
    hits = []
    for ray in infrared:
        if ray.range <= 0.6:
            to = ray.pose.theta + ray.bearing
            rho = 0.23 + ray.range
            hits.append((ray.pose.x + rho * math.cos(to), ray.pose.y + rho * math.sin(to)))
    expected, surfaces = [], []
    reaches = [(r, reach_of(r, sonar)) for r in sonar]
    for echo in sonar:
        r = 0.23 + max(echo.range, 0.12)
        if not r < RADIUS + 0.6:
            continue
        b = echo.pose.theta + echo.bearing
        x0, y0 = echo.pose.x, echo.pose.y
        if any(
            angle(math.atan2(y - y0, x - x0), b) <= math.radians(15.0)
            and math.hypot(x - x0, y - y0) <= r + 0.08
            for x, y in hits
        ):
            continue
        turns = (0.0, math.radians(6.0), -math.radians(6.0))
        three = [(x0 + r * math.cos(b + turn), y0 + r * math.sin(b + turn)) for turn in turns]
        left = [
            point
            for point in three
            if not any(
                angle(math.atan2(point[1] - o.pose.y, point[0] - o.pose.x), heading(o))
                <= math.radians(8.0)
                and reach > math.hypot(point[0] - o.pose.x, point[1] - o.pose.y) + 0.15
                for o, reach in reaches
            )
        ]
        expected += left or three
        surfaces.append(three[0])
    assert 2 < len(surfaces) < 25
    assert len(surfaces) < len(expected) < 3 * len(surfaces)
    np.testing.assert_allclose(points(sonar, infrared), expected, atol=1e-9)
    for ray, found in zip(infrared, limits(sonar, infrared), strict=True):
        x0, y0 = ray.pose.x, ray.pose.y
        to = ray.pose.theta + ray.bearing
        wanted = min(
            (
                math.hypot(x - x0, y - y0) - 0.05 - 0.23
                for x, y in surfaces
                if angle(math.atan2(y - y0, x - x0), to) <= math.radians(15.0)
            ),
            default=math.inf,
        )
        if math.isnan(ray.range) or ray.range == 3.0:
            wanted = math.inf  # the reading does not count in any case
        assert found == pytest.approx(wanted, abs=1e-9)


def test_a_ray_that_is_limited_already_is_not_extended() -> None:
    pose = Pose2(0.0, 0.0)
    rays = [InfraredReading(pose, 0.0, math.inf, limit=limit) for limit in (0.1, 0.4)]
    np.testing.assert_allclose(limits([SonarReading(pose, 0.0, 0.3)], rays), [0.1, 0.25])


def test_nothing_in_nothing_out() -> None:
    assert points([], []).shape == (0, 2)
    assert limits([], []).shape == (0,)


def rim(sonar: list, infrared: list, known: object = ()) -> np.ndarray:
    points_known = np.array(known, dtype=float).reshape(-1, 2)
    return rim_points(sonar, np.vstack((hits(infrared), points_known)), SONAR, GUARD, RADIUS)


def test_what_is_too_close_to_measure_may_touch_the_body() -> None:
    pose = Pose2(1.0, 2.0, 0.4)
    readings = [SonarReading(pose, 0.3, -math.inf), SonarReading(pose, 2.0, 0.13)]
    found = rim(readings, [])
    expected = [
        (1.0 + RADIUS * math.cos(0.7 + off), 2.0 + RADIUS * math.sin(0.7 + off))
        for off in (0.0, RIM_SPREAD, -RIM_SPREAD)
    ]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    # Wherever along it the robot goes, one of them comes closer or stays: it has to turn away.
    for off in np.linspace(-0.5 * math.pi, 0.5 * math.pi, 19):
        ahead = np.array((1.0, 2.0)) + 0.1 * np.array((math.cos(0.7 + off), math.sin(0.7 + off)))
        assert np.hypot(*(found - ahead).T).min() < RADIUS
    away = np.array((1.0, 2.0)) - 0.1 * np.array((math.cos(0.7), math.sin(0.7)))
    assert np.hypot(*(found - away).T).min() > RADIUS + 0.05


@pytest.mark.parametrize(
    ("off", "distance", "explains"),
    [(0.0, 0.3, True), (14.9, 0.379, True), (15.1, 0.3, False), (0.0, 0.381, False)],
)
def test_what_was_measured_before_explains_it(off: float, distance: float, explains: bool) -> None:
    pose = Pose2(0.0, 0.0, -1.0)
    echo = SonarReading(pose, 0.0, -math.inf)
    at = -1.0 + math.radians(off)
    point = (distance * math.cos(at), distance * math.sin(at))
    assert (len(rim([echo], [], [point])) == 0) is explains
    hit = InfraredReading(pose, math.radians(off), distance - 0.23)
    assert (len(rim([echo], [hit])) == 0) is explains


def test_returns_that_can_be_measured_are_none_of_it() -> None:
    pose = Pose2(0.0, 0.0)
    others = [SonarReading(pose, 0.0, value) for value in (0.12, 1.0, math.inf, math.nan, 0.05)]
    assert rim(others, []).shape == (0, 2)
