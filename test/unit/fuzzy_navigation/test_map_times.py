# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which stamps of maps are believed."""

import math

import pytest

from fuzzy_navigation.control_tick import Untimely
from fuzzy_navigation.map_times import FUTURE_TOLERANCE, LONGEST_STEP_BACK, MapTimes


def test_maps_of_a_running_clock_are_taken():
    times = MapTimes("the map")
    for now in (10.0, 11.0, 4000.0):
        times.check(now, now - 1.0)
        times.check(now, now + 5.0)  # heard of before its /clock
        times.check(now, now - 2.0)  # overtaken on the way


def test_the_future_is_refused_and_leaves_no_trace():
    times = MapTimes("the motion map")
    with pytest.raises(Untimely, match=r"the motion map is stamped 1000.000 s, 900.000 s ahead"):
        times.check(100.0, 1000.0)
    times.check(100.0, 99.0)
    # Before simulated time has begun nothing is of the future.
    MapTimes("the map").check(math.inf, 1e9)


def test_what_is_long_gone_is_refused():
    times = MapTimes("the map")
    times.check(500.0, 499.0)
    with pytest.raises(Untimely, match=r"stamped 3.000 s, 496.000 s before the newest") as refusal:
        times.check(500.0, 3.0)
    assert refusal.value.reason == "outdated"
    times.check(500.0, 499.0 - LONGEST_STEP_BACK)
    # An older map that was taken does not make still older ones acceptable.
    with pytest.raises(Untimely):
        times.check(500.0, 499.0 - 1.5 * LONGEST_STEP_BACK)


def test_a_clock_that_is_set_back_brings_old_stamps():
    times = MapTimes("the map")
    times.check(500.0, 499.0)
    times.check(1.0, 2.0)
    times.check(3.0, 3.0)
    with pytest.raises(Untimely):
        times.check(3.0, 3.1 + FUTURE_TOLERANCE)
