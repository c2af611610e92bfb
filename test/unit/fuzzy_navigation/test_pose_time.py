# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import pytest

from fuzzy_navigation.pose_time import PoseTime


def test_a_pose_sets_the_time_to_its_stamp() -> None:
    time = PoseTime()
    assert time.at_pose(50.0, clock=50.2, wall=1.0) == 50.0
    assert time.at_pose(50.05, clock=50.31, wall=1.1) == 50.05
    assert time.now(clock=50.31, wall=1.1) == 50.05


def test_between_poses_the_clock_counts_whatever_its_rate() -> None:
    time = PoseTime()
    time.at_pose(50.0, clock=80.0, wall=1.0)
    assert time.now(clock=80.4, wall=1.01) == pytest.approx(50.4)
    assert time.now(clock=84.0, wall=1.1) == pytest.approx(54.0)
    # Slow motion: a clock that moves, however little, does not stand.
    for k in range(1, 101):
        time.now(clock=84.0 + 0.001 * k, wall=1.1 + 0.9 * k)
    assert time.now(clock=84.1, wall=91.1) == pytest.approx(54.1)


def test_wall_time_counts_while_the_clock_stands() -> None:
    time = PoseTime()
    time.at_pose(50.0, clock=50.0, wall=1.0)
    read = [time.now(clock=50.0, wall=1.0 + 0.1 * k) for k in range(116)]
    assert read[9] == 50.0
    assert read[15] == pytest.approx(50.5)
    assert read[115] == pytest.approx(60.5)
    # And no more once it runs again.
    assert time.now(clock=50.1, wall=12.9) == pytest.approx(60.6)
    assert time.now(clock=50.1, wall=13.4) == pytest.approx(60.6)


def test_a_process_that_was_held_up_is_told_until_it_can_have_heard_what_came() -> None:
    time = PoseTime()
    time.at_pose(50.0, clock=50.0, wall=1.0)
    time.now(clock=50.4, wall=1.4)
    assert not time.catching_up
    # The clock that has gone on is heard a little later.
    assert time.now(clock=50.4, wall=11.4) == pytest.approx(50.4)
    assert time.catching_up
    assert time.now(clock=60.45, wall=11.45) == pytest.approx(60.45)
    assert time.at_pose(60.4, clock=60.5, wall=11.5) == 60.4
    assert time.catching_up
    assert time.now(clock=60.9, wall=11.95) == pytest.approx(60.8)
    assert not time.catching_up


def test_stamps_that_leap_with_the_clock_are_told_as_well() -> None:
    time = PoseTime()
    time.at_pose(50.0, clock=50.0, wall=1.0)
    time.at_pose(54.9, clock=54.9, wall=1.05)  # a simulation at a hundred times real time
    assert not time.catching_up
    assert time.now(clock=3654.95, wall=1.1) == pytest.approx(54.95)
    assert time.at_pose(3655.0, clock=3655.0, wall=1.15) == 3655.0
    assert time.catching_up
    time.at_pose(3655.05, clock=3655.05, wall=1.6)
    time.at_pose(3655.1, clock=3655.1, wall=2.0)
    assert not time.catching_up


def test_before_the_first_pose_a_leap_of_the_clock_is_no_time_that_passed() -> None:
    time = PoseTime()
    assert time.now(clock=0.0, wall=1.0) == 0.0
    assert time.now(clock=500.0, wall=1.5) == pytest.approx(0.5)
    assert time.at_pose(500.1, clock=500.1, wall=1.6) == 500.1


def test_a_clock_set_back_does_not_take_time_back() -> None:
    time = PoseTime()
    time.at_pose(50.0, clock=50.0, wall=1.0)
    assert time.now(clock=0.1, wall=1.1) == 50.0
    assert time.now(clock=0.3, wall=1.3) == pytest.approx(50.2)


def test_a_clock_that_is_set_ahead_does_not_make_time_pass() -> None:
    time = PoseTime()
    time.at_pose(50.0, clock=50.0, wall=1.0)
    # Somebody else's message on /clock, and the next one of the simulator.
    assert time.now(clock=1050.0, wall=1.05) == pytest.approx(50.05)
    assert time.now(clock=50.1, wall=1.06) == pytest.approx(50.05)
    assert time.now(clock=50.2, wall=1.07) == pytest.approx(50.15)
    # A simulation at a hundred times real time, and a process that was held up for a while.
    assert time.now(clock=60.2, wall=1.17) == pytest.approx(60.15)
    assert time.now(clock=360.2, wall=4.17) == pytest.approx(360.15)
