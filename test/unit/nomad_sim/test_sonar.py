# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The ring of sonars: where they look, when they fire, and how their readings scatter."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from nomad_sim.params import SonarParameters
from nomad_sim.sonar import SonarRing
from nomad_sim.surfaces import Outline, Surfaces

ORIGIN = Pose2(0.0, 0.0, 0.0)


def box(half):
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    segments = np.hstack([corners, np.roll(corners, -1, axis=0)])
    return Surfaces.of([Outline(segments, np.empty((0, 3)), math.radians(25.0), True, False)])


def ring(noise=None, outliers=None, **values):
    return SonarRing(SonarParameters(**values), 0.23, noise, outliers)


def generators(seed=0):
    return [np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(2)]


def test_faces_sit_on_the_ring_and_turn_with_robot_and_turret():
    room = box(2.0)
    ranges = ring().exact(np.arange(16), ORIGIN, 0.0, room)
    assert ranges[[0, 4, 8, 12]] == pytest.approx(4 * [2.0 - 0.23])
    turned = ring().exact(np.arange(16), Pose2(0.0, 0.0, 0.3), math.radians(22.5) - 0.3, room)
    assert turned == pytest.approx(np.roll(ranges, -1))
    moved = ring().exact(np.array([0]), Pose2(0.5, 0.2, 0.0), 0.0, room)
    assert moved == pytest.approx([1.5 - 0.23])


def test_slots_fire_in_turn():
    sonars = ring()
    fired = [[e.sensor for e in sonars.fire(k, 0.04 * k, ORIGIN, 0.1, box(2.0))] for k in range(5)]
    assert fired == [
        [0, 4, 8, 12],
        [1, 5, 9, 13],
        [2, 6, 10, 14],
        [3, 7, 11, 15],
        [0, 4, 8, 12],
    ]
    event = sonars.fire(2, 0.08, ORIGIN, 0.1, box(2.0))[1]
    assert (event.stamp, event.sensor, event.turret_angle) == (0.08, 6, 0.1)


def test_any_firing_order():
    sonars = ring(frame_ids=("a", "b", "c"), bearings=(0.0, 1.0, 2.0), firing_slots=(2, 0, 2))
    fired = [[e.sensor for e in sonars.fire(k, 0.0, ORIGIN, 0.0, box(2.0))] for k in range(4)]
    assert fired == [[1], [], [0, 2], [1]]


def test_limits_of_the_range():
    near = Pose2(2.0 - 0.23 - 0.1, 0.0, 0.0)
    assert ring().fire(0, 0.0, near, 0.0, box(2.0))[0].range == -math.inf
    assert ring().fire(0, 0.0, ORIGIN, 0.0, box(8.0))[0].range == math.inf
    assert ring().fire(0, 0.0, ORIGIN, 0.0, box(6.7))[0].range == pytest.approx(6.47)


@pytest.mark.parametrize("overlap", [-1e-12, 0.0, 1e-12])
def test_a_sonar_that_touches_a_wall_reads_too_near(overlap):
    there = Pose2(2.0 - 0.23 + overlap, 0.0, 0.0)
    assert ring().fire(0, 0.0, there, 0.0, box(2.0))[0].range == -math.inf


def test_a_sonar_inside_an_obstacle_reads_too_near():
    segments = np.array([[0, -1, 1, -1], [1, -1, 1, 1], [1, 1, 0, 1], [0, 1, 0, -1]], dtype=float)
    solid = Surfaces.of([Outline(segments, np.empty((0, 3)), 0.4, True, True)])
    assert ring().fire(0, 0.0, ORIGIN, 0.0, solid)[0].range == -math.inf
    disc = Outline(np.empty((0, 4)), np.array([[0.3, 0.0, 0.2]]), 0.4, True, True)
    assert ring().fire(0, 0.0, ORIGIN, 0.0, Surfaces.of([disc]))[0].range == -math.inf


def test_noise_is_1_percent_of_the_range():
    noise, _ = generators(1)
    sonars, world = ring(noise), box(3.23)
    reads = np.array(
        [e.range for _ in range(700) for e in sonars.fire(0, 0.0, ORIGIN, 0.0, world)]
    )
    assert reads.mean() == pytest.approx(3.0, abs=4 * 0.03 / math.sqrt(2800))
    assert reads.std() == pytest.approx(0.03, rel=0.05)


def test_outliers_come_as_often_as_asked():
    noise, outliers = generators(2)
    sonars, world = ring(noise, outliers, short_outliers=0.1, lost_outliers=0.2), box(3.23)
    reads = np.array(
        [e.range for _ in range(1000) for e in sonars.fire(0, 0.0, ORIGIN, 0.0, world)]
    )
    # Short ones are spread evenly over 0.12-3 m: those below 2.85 m are told from noise.
    short = (reads < 2.85).mean() * (3.0 - 0.12) / (2.85 - 0.12)
    assert np.isposinf(reads).mean() == pytest.approx(0.2, abs=4 * math.sqrt(0.16 / 4000))
    assert short == pytest.approx(0.1, abs=4 * math.sqrt(0.09 / 4000))
    assert (reads > 0.12).all()


def test_a_lost_echo_can_become_a_short_one():
    noise, outliers = generators(3)
    reads = [
        e.range
        for e in ring(noise, outliers, short_outliers=1.0).fire(0, 0.0, ORIGIN, 0.0, box(9.0))
    ]
    assert all(0.12 <= r <= 6.5 for r in reads)


def test_noise_and_outliers_have_streams_of_their_own():
    def reads(**values):
        sonars = ring(*generators(4), **values)
        return [e.range for k in range(200) for e in sonars.fire(k, 0.0, ORIGIN, 0.0, box(3.0))]

    plain, disturbed = np.array(reads()), np.array(reads(lost_outliers=0.3))
    kept = np.isfinite(disturbed)
    assert 0.1 < (~kept).mean() < 0.5
    assert (plain[kept] == disturbed[kept]).all()


def test_a_reading_draws_the_same_noise_whatever_the_others_see():
    wall = Outline(np.array([[3.0, -9.0, 3.0, 9.0]]), np.empty((0, 3)), 0.4, True, False)
    alone = ring(*generators(5))
    crowded = ring(*generators(5))
    for k in range(8):
        one = alone.fire(k, 0.0, ORIGIN, 0.0, Surfaces.of([wall]))
        two = crowded.fire(k, 0.0, ORIGIN, 0.0, box(3.0))
        if k % 4 == 0:
            assert one[0].range == two[0].range


def test_crosstalk_shortens_only_where_a_pulse_arrives():
    # Two mirrors at 45 deg bring the pulse of a sonar that looks along x to one that looks
    # along y: from (0.23, 0) to x = 2, up to y = 3, back to x = 0 and down to (0, 0.23).
    mirrors = [
        Outline(np.array([ends]), np.empty((0, 3)), math.radians(25.0), True, False)
        for ends in ([1.5, -0.5, 2.5, 0.5], [1.5, 3.5, 2.5, 2.5], [-0.5, 2.5, 0.5, 3.5])
    ]
    world = Surfaces.of(mirrors)
    quiet = ring(edge_echo=False, reflections=0).exact(np.array([0, 4]), ORIGIN, 0.0, world)
    assert np.isposinf(quiet).all()
    loud = ring(edge_echo=False, reflections=0, crosstalk_reflections=3)
    way = 1.77 + 3.0 + 2.0 + 2.77
    assert loud.exact(np.array([0, 4]), ORIGIN, 0.0, world) == pytest.approx(2 * [way / 2.0])
    # Fired one after the other they do not disturb each other.
    assert np.isposinf(loud.exact(np.array([0]), ORIGIN, 0.0, world)).all()
