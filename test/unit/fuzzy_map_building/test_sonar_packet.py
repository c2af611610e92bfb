# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What each reading of a packet says: REP 117, apexes, and lost echoes."""

import math

import numpy as np
import pytest

from fuzzy_map_building.params import SonarParameters
from fuzzy_map_building.sonar_packet import SonarPacket, neighbour_limits
from fuzzy_map_building.types import Pose2, SonarReading

INF = math.inf
CENTER = SonarParameters()
MOUNT = SonarParameters(apex="mount")


def packet(
    ranges: list[float], degrees: list[float], sonar: SonarParameters = CENTER
) -> SonarPacket:
    pose = Pose2(1.0, 2.0, math.radians(30.0))
    readings = [
        SonarReading(pose, math.radians(b - 30.0), r) for r, b in zip(ranges, degrees, strict=True)
    ]
    return SonarPacket.from_readings(readings, sonar)


def test_an_echo_says_empty_before_and_occupied_at_its_range() -> None:
    p = packet([2.0], [90.0])
    np.testing.assert_allclose(p.apex, [[1.0, 2.0]])
    np.testing.assert_allclose(p.axis, [[0.0, 1.0]], atol=1e-15)
    assert p.empty_range[0] == p.occupied_range[0] == pytest.approx(2.23)


def test_apex_at_the_mount_keeps_the_range() -> None:
    p = packet([2.0], [90.0], MOUNT)
    np.testing.assert_allclose(p.apex, [[1.0, 2.23]])
    assert p.empty_range[0] == p.occupied_range[0] == 2.0


@pytest.mark.parametrize(("sonar", "longer"), [(CENTER, 0.23), (MOUNT, 0.0)])
def test_too_close_is_occupied_at_min_range_and_says_nothing_of_empty(
    sonar: SonarParameters, longer: float
) -> None:
    p = packet([-INF], [0.0], sonar)
    assert p.empty_range[0] == 0.0
    assert p.occupied_range[0] == pytest.approx(0.12 + longer)


def test_faults_are_counted_by_reason() -> None:
    p = packet([math.nan, 0.1, 6.6, -1.0, 1.0, 0.12, 6.5], [0, 45, 90, 135, 180, 225, 270])
    assert p.rejected == {"nan": 1, "out_of_range": 3}
    assert len(p) == 3


def test_an_empty_packet() -> None:
    p = SonarPacket.from_readings([], CENTER)
    assert len(p) == 0
    assert p.rejected == {}
    assert p.apex.shape == p.axis.shape == (0, 2)


def test_a_lost_echo_is_never_occupied() -> None:
    for rule in ("neighbours", "full"):
        p = packet([INF, 2.0, 3.0], [0, 40, -40], SonarParameters(lost_echo=rule))
        assert p.occupied_range[0] == -INF


def test_a_lost_echo_is_limited_by_its_nearer_neighbour() -> None:
    p = packet([INF, 2.0, 3.0, 0.5], [0, 40, -50, 180])
    assert p.empty_range[0] == pytest.approx(2.23)
    p = packet([INF, 2.0, 3.0, 0.5], [0, 40, -50, 180], SonarParameters(lost_echo="full"))
    assert p.empty_range[0] == pytest.approx(6.73)


def test_ignored_lost_echoes_are_counted() -> None:
    p = packet([INF, 2.0, INF], [0, 40, 90], SonarParameters(lost_echo="ignore"))
    assert p.rejected == {"lost_echo": 2}
    assert len(p) == 1
    assert p.empty_range[0] == pytest.approx(2.23)


@pytest.mark.parametrize(
    ("degrees", "ranges", "limits"),
    [
        # Around the circle: 350 and 10 are neighbours.
        ([350, 10, 180], [INF, 2.0, 1.0], [1.0, INF, INF]),
        ([350, 10, 330], [INF, 2.0, 4.0], [2.0, INF, INF]),
        # One neighbour, on both sides.
        ([0, 90], [INF, 1.5], [1.5, INF]),
        # A lost neighbour sets no limit, nor does what lies behind it.
        ([0, 20, 40, 320, 300], [INF, INF, 1.0, INF, 1.0], [INF, 1.0, INF, 1.0, INF]),
        # Nobody heard anything; nobody else was there.
        ([0, 20, 40], [INF, INF, INF], [INF, INF, INF]),
        ([0], [INF], [INF]),
        # Another reading of the same direction counts, whole turns apart or not.
        ([0, 360, 90, 270], [INF, 1.2, 3.0, 4.0], [1.2, INF, INF, INF]),
        ([0, 0.5, 90, 270], [INF, 3.5, 3.0, 4.0], [3.0, INF, INF, INF]),
        # All readings of the neighbouring direction count.
        ([0, 20.0, 20.3, 340], [INF, 3.0, 0.7, 5.0], [0.7, INF, INF, INF]),
        # Only those of one direction: no neighbour at all but themselves.
        ([5, 5, 5], [INF, 2.0, 3.0], [2.0, INF, INF]),
    ],
)
def test_neighbour_limits(degrees: list, ranges: list, limits: list) -> None:
    for turn in (0.0, 77.0, 213.0, -720.0):
        directions = np.radians(np.array(degrees, dtype=float) + turn)
        np.testing.assert_array_equal(neighbour_limits(directions, np.array(ranges)), limits)


def test_limits_do_not_depend_on_the_order() -> None:
    rng = np.random.default_rng(3)
    directions = rng.uniform(-10, 10, 40)
    returned = np.where(rng.random(40) < 0.4, INF, rng.uniform(0.2, 6, 40))
    limits = neighbour_limits(directions, returned)
    order = rng.permutation(40)
    np.testing.assert_array_equal(
        neighbour_limits(directions[order], returned[order]), limits[order]
    )
