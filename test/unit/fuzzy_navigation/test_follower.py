# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The follower against motions that can be calculated by hand."""

import itertools
import math
import re

import numpy as np
import pytest
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.follower import Follower
from fuzzy_navigation.params import FollowerParameters

LIMITS = FollowerParameters()
DT = 0.05
Record = NDArray[np.float64]


def drive(points: object, heading: float = 0.0, follower: Follower | None = None) -> Record:
    """Follow a path to its end; one row a tick: time, x, y, heading, v, omega."""
    path = np.asarray(points, dtype=np.float64)
    follower = follower or Follower(LIMITS)
    follower.follow(path)
    x, y, theta = path[0, 0], path[0, 1], heading
    rows = []
    while not follower.done:
        assert len(rows) < 4000, "never arrives"
        v, omega = follower.step(Pose2(x, y, theta), DT)
        rows.append((len(rows) * DT, x, y, theta, v, omega))
        # Exact enough: the midpoint rule over a hundredth of a tick's turn.
        middle = theta + 0.5 * omega * DT
        x, y, theta = x + v * DT * math.cos(middle), y + v * DT * math.sin(middle), theta
        theta += omega * DT
    return np.array(rows)


def line(length: float, angle: float = 0.0) -> NDArray[np.float64]:
    s = np.arange(0.0, length + 0.05, 0.1)
    return np.column_stack([s * math.cos(angle), s * math.sin(angle)])


def test_a_straight_run_is_driven_at_full_speed_and_never_turned() -> None:
    record = drive(line(6.0))
    assert record[:, 4].max() == LIMITS.max_linear
    assert np.abs(record[:, 5]).max() == 0.0
    # Least time: length / v + v / a. The reserve of the braking and the last centimetres cost.
    least = 6.0 / LIMITS.max_linear + LIMITS.max_linear / LIMITS.linear_acceleration
    assert record[-1, 0] < least + 1.5
    # Once it brakes it does not speed up again.
    top = np.flatnonzero(record[:, 4] == LIMITS.max_linear)
    assert (np.diff(record[top[-1] :, 4]) <= 1e-12).all()


@pytest.mark.parametrize("heading", [math.pi, -math.pi, 2.0, -2.0, 0.1])
def test_before_it_sets_out_it_turns_on_the_spot_the_short_way(heading: float) -> None:
    record = drive(line(1.0), heading)
    start = int(np.argmax(record[:, 4] > 0.0))
    assert start > 0
    assert np.hypot(record[: start + 1, 1], record[: start + 1, 2]).max() == 0.0
    assert abs(math.remainder(record[start, 3], 2.0 * math.pi)) < math.radians(3.0)
    turned = np.abs(record[:, 5]).sum() * DT
    assert turned < abs(math.remainder(heading, 2.0 * math.pi)) + 0.1


def test_a_turn_on_the_spot_may_end_before_the_robot_is_aligned() -> None:
    exact = drive(line(1.0), 2.0)
    loose = drive(line(1.0), 2.0, Follower(LIMITS, aligned=math.radians(15.0)))
    start = int(np.argmax(loose[:, 4] > 0.0))
    assert math.radians(5.0) < loose[start, 3] < math.radians(18.0)
    assert np.abs(loose[:, 2]).max() < 0.02
    assert loose[-1, 0] < exact[-1, 0] - 0.3


def test_a_staircase_is_driven_as_the_straight_line_that_it_means() -> None:
    steps = np.array([(0, 0)] + 15 * [(1, 0), (1, 1)])
    points = 0.1 * np.cumsum(steps, axis=0)
    record = drive(points, math.atan2(1, 2))
    length = float(np.hypot(*(points[-1] - points[0])))
    driven = float((record[:, 4] * DT).sum())
    assert driven < 1.01 * length
    least = length / LIMITS.max_linear + LIMITS.max_linear / LIMITS.linear_acceleration
    assert record[-1, 0] < least + 3.0


def test_a_corner_is_rounded_but_not_cut_by_more_than_half_a_cell() -> None:
    points = np.vstack([line(1.0), [(1.0, y) for y in np.arange(0.1, 1.05, 0.1)]])
    record = drive(points)
    apart = np.hypot(record[:, 1] - 1.0, record[:, 2]).min()
    assert 0.0 < apart <= 0.05
    # It goes round without standing.
    on_the_way = record[10:-20, 4]
    assert on_the_way.min() > 0.03


def test_a_path_through_the_laboratory_takes_less_than_a_minute() -> None:
    """15 m from start to goal as the planner turns: right round two obstacles."""
    runs = [
        ((1, 0), 9), ((1, -1), 6), ((0, -1), 11), ((1, -1), 5), ((1, 0), 14), ((1, 1), 4),
        ((1, 0), 6), ((1, 1), 3), ((1, 0), 4), ((0, 1), 3), ((1, 1), 3), ((0, 1), 9),
        ((-1, 1), 4), ((-1, 0), 12), ((-1, -1), 4), ((0, -1), 6), ((-1, -1), 4), ((-1, 0), 22),
        ((-1, 1), 4),
    ]  # fmt: skip
    steps = np.array([(0, 0)] + [step for step, times in runs for _ in range(times)])
    points = 0.1 * np.cumsum(steps, axis=0)
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    assert length == pytest.approx(15.0, abs=1.0)
    record = drive(points, 1.0)
    assert record[-1, 0] < 60.0
    # No chattering: what speeds up and brakes adds up to less than one full cycle per bend.
    assert np.abs(np.diff(record[:, 4])).sum() < 2.0 * LIMITS.max_linear * len(runs)


def test_a_reversal_is_turned_on_the_spot() -> None:
    points = np.array([(0.0, 0.0), (0.5, 0.0), (0.1, 0.0)])
    record = drive(points)
    assert record[:, 1].max() == pytest.approx(0.5, abs=0.005)
    assert np.abs(record[:, 2]).max() < 0.005
    assert record[-1, 1] == pytest.approx(0.1, abs=0.005)


def test_a_corner_too_sharp_to_be_rounded_is_turned_on_the_spot() -> None:
    points = np.array([(0.0, 0.0), (0.5, 0.0), (0.2, 0.3)])
    record = drive(points)
    assert np.hypot(record[:, 1] - 0.5, record[:, 2]).min() < 0.003


def test_progress_is_told_at_each_point_of_the_path() -> None:
    follower = Follower(LIMITS)
    points = line(1.0)
    follower.follow(points)
    np.testing.assert_allclose(follower.vertex_progress, points[:, 0], atol=1e-9)
    np.testing.assert_allclose(follower.points_at(follower.vertex_progress), points, atol=1e-9)
    assert follower.length == pytest.approx(1.0)
    assert follower.remaining == pytest.approx(1.0)
    follower.step(Pose2(0.08, 0.01, 0.0), DT)
    assert follower.progress == pytest.approx(0.08)
    assert follower.remaining == pytest.approx(0.92)
    assert follower.deviation == pytest.approx(0.01, abs=0.003)
    assert not follower.done


def test_a_leap_is_no_progress() -> None:
    follower = Follower(LIMITS)
    follower.follow(line(3.0))
    follower.step(Pose2(2.0, 0.0, 0.0), DT)
    assert follower.progress <= 0.1
    assert follower.deviation == pytest.approx(1.9, abs=0.01)


def test_points_of_a_rounded_path_are_passed_near_the_points_given() -> None:
    follower = Follower(LIMITS)
    points = np.vstack([line(1.0), [(1.0, y) for y in np.arange(0.1, 1.05, 0.1)]])
    follower.follow(points)
    passed = follower.points_at(follower.vertex_progress)
    assert np.hypot(*(passed - points).T).max() <= 0.05
    assert (np.diff(follower.vertex_progress) > 0.0).all()


def test_a_robot_off_the_path_comes_back_to_it() -> None:
    follower = Follower(LIMITS)
    follower.follow(line(3.0))
    x, y, theta = 0.0, 0.03, 0.2
    for _ in range(400):
        v, omega = follower.step(Pose2(x, y, theta), DT)
        x, y = x + v * DT * math.cos(theta), y + v * DT * math.sin(theta)
        theta += omega * DT
    assert follower.done
    assert (x, y) == pytest.approx((3.0, 0.0), abs=0.005)


def test_a_robot_that_was_turned_away_stops_and_turns_back() -> None:
    follower = Follower(LIMITS)
    follower.follow(line(3.0))
    for k in range(30):
        follower.step(Pose2(0.02 * k, 0.0, 0.0), DT)
    speed = follower.velocity[0]
    assert speed > 0.3
    commands = [follower.step(Pose2(0.6, 0.0, 2.0), DT) for _ in range(30)]
    speeds = [v for v, _ in commands]
    assert all(b < a or b == 0.0 for a, b in itertools.pairwise(speeds))
    assert commands[-1][0] == 0.0
    assert commands[-1][1] < 0.0


def test_max_speed_and_standing() -> None:
    follower = Follower(LIMITS)
    follower.follow(line(3.0))
    assert follower.standing
    x = 0.0
    for _ in range(60):
        v, _ = follower.step(Pose2(x, 0.0, 0.0), DT, max_speed=0.2)
        x += v * DT
        assert v <= 0.2
    assert follower.velocity == (0.2, 0.0)
    assert not follower.standing
    follower.halt()
    assert follower.standing
    v, _ = follower.step(Pose2(x, 0.0, 0.0), DT)
    assert v == pytest.approx(LIMITS.linear_acceleration * DT)


def test_a_stop_behind_the_robot_makes_it_brake_at_the_limit() -> None:
    follower = Follower(LIMITS)
    follower.follow(line(3.0))
    x, v = 0.0, 0.0
    for _ in range(40):
        v, _ = follower.step(Pose2(x, 0.0, 0.0), DT)
        x += v * DT
    assert v == LIMITS.max_linear
    braking = []
    while not follower.standing:
        v, _ = follower.step(Pose2(x, 0.0, 0.0), DT, stop_at=-math.inf)
        x += v * DT
        braking.append(v)
    expected = LIMITS.max_linear / (LIMITS.linear_acceleration * DT)
    assert len(braking) == pytest.approx(expected, abs=1)


@pytest.mark.parametrize("points", [[(1.0, 2.0)], [(1.0, 2.0), (1.0, 2.0)]])
def test_a_path_without_length_is_done_at_once(points: list[tuple[float, float]]) -> None:
    follower = Follower(LIMITS)
    follower.follow(points)
    assert follower.done
    assert follower.step(Pose2(1.0, 2.0, 0.3), DT) == (0.0, 0.0)
    assert follower.length == 0.0
    np.testing.assert_array_equal(follower.points_at(follower.vertex_progress), points)


def test_no_time_no_change() -> None:
    follower = Follower(LIMITS)
    follower.follow(line(3.0))
    before = follower.step(Pose2(0.0, 0.0, 0.0), DT)
    assert follower.step(Pose2(0.0, 0.0, 0.0), 0.0) == before


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([], "array of shape (n, 2)"),
        ([1.0, 2.0], "array of shape (n, 2)"),
        ([(0.0, 0.0), (math.nan, 1.0)], "must be finite"),
        ([(0.0, 0.0), (math.inf, 1.0)], "must be finite"),
    ],
)
def test_a_bad_path_is_refused_and_the_old_one_stays(points: object, message: str) -> None:
    follower = Follower(LIMITS)
    follower.follow(line(2.0))
    with pytest.raises(ValueError, match=re.escape(message)):
        follower.follow(points)  # type: ignore[arg-type]
    assert follower.length == pytest.approx(2.0)


@pytest.mark.parametrize("dt", [-0.1, math.nan, math.inf])
def test_a_bad_tick_is_refused(dt: float) -> None:
    follower = Follower(LIMITS)
    follower.follow(line(2.0))
    with pytest.raises(ValueError, match="time of a tick"):
        follower.step(Pose2(0.0, 0.0, 0.0), dt)


@pytest.mark.parametrize("name", ["stop_at", "max_speed"])
def test_a_limit_that_is_no_number_is_refused(name: str) -> None:
    follower = Follower(LIMITS)
    follower.follow(line(2.0))
    with pytest.raises(ValueError, match=name):
        follower.step(Pose2(0.0, 0.0, 0.0), DT, **{name: math.nan})
