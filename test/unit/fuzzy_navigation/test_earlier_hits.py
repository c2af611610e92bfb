# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which of the points that were measured before an echo confirms."""

import math

import numpy as np
import pytest

from fuzzy_map_building.sensor_params import SonarParameters
from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.earlier_hits import EarlierHits

#: Faces 0.23 m from the centre, least range 0.12 m: with the slack of 0.03 m points up to 0.38 m.
SONAR = SonarParameters()
HERE = Pose2(1.0, 2.0, math.pi / 2.0)
ANGLE = math.radians(15.0)
RECALL = 0.5


def at(distance: float, degrees: float) -> tuple[float, float]:
    """Return the point at a distance from the robot, by its direction from the x axis."""
    angle = math.radians(degrees)
    return HERE.x + distance * math.cos(angle), HERE.y + distance * math.sin(angle)


def ahead(distance: float) -> SonarReading:
    """Return what a sonar ahead, which looks along y, tells."""
    return SonarReading(HERE, 0.0, distance)


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        (at(0.34, 90.0), True),
        (at(0.37, 104.0), True),
        (at(0.37, 106.0), False),
        (at(0.34, -90.0), False),
        (at(0.39, 90.0), False),
    ],
    ids=["on the axis", "just beside it", "too far beside", "behind", "too far"],
)
def test_an_echo_confirms_what_it_may_come_from(
    point: tuple[float, float], expected: bool
) -> None:
    earlier = EarlierHits()
    earlier.keep(np.array([point]), HERE, RECALL)
    confirmed = earlier.confirmed([ahead(-math.inf)], SONAR, ANGLE)
    np.testing.assert_array_equal(confirmed, [point] if expected else np.empty((0, 2)))
    # What can be measured speaks for itself.
    for distance in (0.12, 1.0, math.inf, math.nan):
        assert len(earlier.confirmed([ahead(distance)], SONAR, ANGLE)) == 0


def test_it_keeps_what_is_near_and_that_once() -> None:
    earlier = EarlierHits()
    near, far = at(0.34, 90.0), at(RECALL + 0.01, 0.0)
    for _ in range(1000):
        earlier.keep(np.array([near, far]), HERE, RECALL)
    echoes = [ahead(-math.inf)]
    np.testing.assert_array_equal(earlier.confirmed(echoes, SONAR, math.pi), [near])
    earlier.keep(np.empty((0, 2)), Pose2(HERE.x + RECALL, HERE.y), RECALL)  # from elsewhere
    assert len(earlier.confirmed(echoes, SONAR, math.pi)) == 0
    earlier.keep(np.array([near]), HERE, RECALL)
    earlier.forget()
    assert len(earlier.confirmed(echoes, SONAR, math.pi)) == 0
    earlier.keep(np.array([near]), HERE, 0.0)
    assert len(earlier.confirmed(echoes, SONAR, math.pi)) == 0
