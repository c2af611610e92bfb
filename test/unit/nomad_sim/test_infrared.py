# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Infrared readings against geometry by hand and the statistics of their noise."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from nomad_sim.infrared import InfraredRing
from nomad_sim.params import InfraredParameters
from nomad_sim.surfaces import Outline, Surfaces


def wall(x, opaque=True):
    return Outline(np.array([[x, -9.0, x, 9.0]]), np.empty((0, 3)), 0.4, opaque, False)


def surfaces(*outlines):
    return Surfaces.of(outlines)


def ring(noise=None, **values):
    return InfraredRing(InfraredParameters(**values), noise)


def test_rays_meet_a_wall_where_they_point():
    ranges = ring().read(Pose2(0.0, 0.0, 0.0), surfaces(wall(0.6)))
    # Sensor i looks at i 22.5 deg from the ring of 0.23 m: 0.6 / cos - 0.23.
    expected = [0.6 / math.cos(math.radians(22.5 * i)) - 0.23 for i in (0, 1, 15)]
    assert ranges[[0, 1, 15]] == pytest.approx(expected)
    assert np.isposinf(ranges[2:15]).all()


def test_they_turn_with_the_robot():
    ranges = ring().read(Pose2(0.0, 0.0, math.radians(45.0)), surfaces(wall(0.6)))
    assert ranges[14] == pytest.approx(0.37)


def test_farther_than_the_reach_is_not_seen():
    assert ring().read(Pose2(0.0, 0.0), surfaces(wall(0.84)))[0] == math.inf
    assert ring().read(Pose2(0.0, 0.0), surfaces(wall(0.82)))[0] == pytest.approx(0.59)


def test_nearer_than_the_least_range_reads_minus_infinity():
    assert ring(min_range=0.05).read(Pose2(0.0, 0.0), surfaces(wall(0.27)))[0] == -math.inf


def test_glass_is_seen_or_seen_through():
    both = surfaces(wall(0.4, opaque=False), wall(0.7))
    assert ring(sees_glass=False).read(Pose2(0.0, 0.0), both)[0] == pytest.approx(0.47)
    assert ring().read(Pose2(0.0, 0.0), both)[0] == pytest.approx(0.17)


def test_a_wall_on_the_same_line_as_glass_is_seen():
    both = surfaces(wall(0.4, opaque=False), wall(0.4))
    assert ring(sees_glass=False).read(Pose2(0.0, 0.0), both)[0] == pytest.approx(0.17)


def test_noise_is_5_mm_and_2_percent():
    noisy = ring(np.random.default_rng(3))
    world = surfaces(wall(0.63))
    reads = np.array([noisy.read(Pose2(0.0, 0.0), world)[0] for _ in range(4000)])
    assert reads.mean() == pytest.approx(0.4, abs=4 * 0.013 / math.sqrt(4000))
    assert reads.std() == pytest.approx(0.005 + 0.02 * 0.4, rel=0.05)


def test_a_touching_surface_never_reads_negative():
    noisy = ring(np.random.default_rng(3))
    reads = np.array([noisy.read(Pose2(0.0, 0.0), surfaces(wall(0.23)))[0] for _ in range(100)])
    assert (reads >= 0.0).all()
    assert (reads == 0.0).any()


def test_a_sensor_draws_the_same_noise_whatever_the_others_see():
    near, far = surfaces(wall(0.6)), surfaces(wall(0.6), wall(-0.5))
    one = ring(np.random.default_rng(5)).read(Pose2(0.0, 0.0), near)
    other = ring(np.random.default_rng(5)).read(Pose2(0.0, 0.0), far)
    assert one[0] == other[0]
    assert one[8] == math.inf
    assert other[8] < 1.0
