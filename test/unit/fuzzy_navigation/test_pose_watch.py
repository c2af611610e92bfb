# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Poses that no robot can have, and poses that stay while it is driven."""

import math

import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.params import FollowerParameters, WatchParameters
from fuzzy_navigation.pose_watch import PoseWatch

HERE = Pose2(1.0, 2.0, 3.0)


@pytest.fixture
def watch() -> PoseWatch:
    return PoseWatch(WatchParameters(), FollowerParameters())


#: 0.3 m beyond 0.6 m/s, and 20 deg beyond 60 deg/s.
@pytest.mark.parametrize(
    ("way", "turn", "dt", "jumps"),
    [
        (0.32, 0.0, 0.05, False),
        (0.34, 0.0, 0.05, True),
        (0.89, 0.0, 1.0, False),
        (0.91, 0.0, 1.0, True),
        (0.0, 22.9, 0.05, False),
        (0.0, -23.1, 0.05, True),
        (0.0, 79.0, 1.0, False),
        (0.0, -81.0, 1.0, True),
    ],
)
def test_a_jump_is_farther_than_the_robot_can_have_come(
    watch: PoseWatch, way: float, turn: float, dt: float, jumps: bool
) -> None:
    there = Pose2(HERE.x + 0.6 * way, HERE.y - 0.8 * way, HERE.theta + math.radians(turn))
    told = watch.jump(HERE, there, dt)
    assert (told != "") is jumps
    if jumps:
        assert f"{way:.2f} m and {abs(turn):.0f} deg within {dt:.2f} s" in told


def test_a_pose_that_stays_while_the_robot_is_driven(watch: PoseWatch) -> None:
    assert watch.frozen(HERE, 0.0, 0.05) == ""
    driven = 0.0
    while not (told := watch.frozen(HERE, 0.4, 0.05)):
        driven += 0.4 * 0.05
        assert driven < 1.0
    assert driven == pytest.approx(0.2, abs=0.021)
    assert "(1.00, 2.00) m" in told
    # It stays so without further driving, until the pose changes.
    assert watch.frozen(Pose2(1.01, 2.0), 0.0, 0.05) != ""
    assert watch.frozen(Pose2(1.03, 2.0), 0.4, 0.05) == ""


def test_a_robot_that_stands_turns_or_comes_on_is_not_frozen(watch: PoseWatch) -> None:
    for k in range(1000):
        assert watch.frozen(Pose2(1.0, 2.0, 0.05 * k), 0.0, 0.05) == ""
    for k in range(1000):
        assert watch.frozen(Pose2(1.0 + 0.3 * 0.05 * k, 2.0), 0.6, 0.05) == ""
