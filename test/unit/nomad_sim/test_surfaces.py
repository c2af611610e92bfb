# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which points echo, and how surfaces are put together."""

import math
import time

import numpy as np
import pytest

from nomad_sim.surfaces import MAX_CROSSINGS, Outline, Surfaces

NO_CIRCLES = np.empty((0, 3))


def outline(points, closed=True, solid=True, **values):
    points = np.array(points, dtype=float)
    segments = np.hstack([points, np.roll(points, -1, axis=0)])
    segments = segments if closed else segments[:-1]
    fields = {"critical_angle": 0.5, "opaque": True, **values}
    return Outline(segments, NO_CIRCLES, solid=solid, **fields)


def box(x0, y0, x1, y1, **values):
    return outline([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], **values)


def circle(x, y, radius):
    return Outline(np.empty((0, 4)), np.array([[x, y, radius]]), 0.7, False, False)


def points(array):
    return {(round(float(x), 6), round(float(y), 6)) for x, y in array}


def test_a_box_has_four_edges():
    assert points(Surfaces.of([box(0, 0, 2, 1)]).edges) == {(0, 0), (2, 0), (2, 1), (0, 1)}


def test_a_wall_has_two_ends_and_its_bends():
    line = outline([[0, 0], [1, 0], [2, 0.01], [3, 1]], closed=False, solid=False)
    # The bend of 0.6 deg at (1, 0) is no corner.
    assert points(Surfaces.of([line]).edges) == {(0, 0), (2, 0.01), (3, 1)}


def test_a_box_against_a_wall_makes_two_corners_and_its_hidden_side_none():
    wall = outline([[-5, 0], [5, 0]], closed=False, solid=False)
    inside = Surfaces.of([wall, box(0, 0, 2, 1)])
    assert points(inside.edges) == {(-5, 0), (5, 0), (0, 0), (2, 0), (2, 1), (0, 1)}


def test_flush_boxes_echo_like_one():
    pair = Surfaces.of([box(0, 0, 1, 1), box(1, 0, 2, 1)])
    assert points(pair.edges) == {(0, 0), (2, 0), (2, 1), (0, 1)}


def test_a_corner_inside_another_obstacle_is_none():
    pair = Surfaces.of([box(0, 0, 2, 2), box(1, 1, 3, 3)])
    assert points(pair.edges) == {
        (0, 0), (2, 0), (0, 2), (3, 1), (3, 3), (1, 3),  # corners of either
        (2, 1), (1, 2),  # where they cross
    }  # fmt: skip


def test_marks_hold_all_ends_and_crossings():
    cross = [
        outline([[-1, 0], [1, 0]], closed=False, solid=False),
        outline([[0, -1], [0, 1]], closed=False, solid=False),
        circle(1.0, 0.0, 0.5),
    ]
    marks = points(Surfaces.of(cross).marks)
    assert {(-1, 0), (1, 0), (0, -1), (0, 1), (0, 0), (0.5, 0)} == marks


def test_circles_that_cross():
    marks = Surfaces.of([circle(0.0, 0.0, 1.0), circle(1.0, 0.0, 1.0)]).marks
    assert points(marks) == points([[0.5, math.sqrt(0.75)], [0.5, -math.sqrt(0.75)]])


def test_order_of_properties_follows_the_surfaces():
    s = Surfaces.of([circle(5, 5, 1), box(0, 0, 1, 1), circle(8, 8, 1)])
    assert s.critical_angles.tolist() == [0.5] * 4 + [0.7] * 2
    assert s.opaque.tolist() == [True] * 4 + [False] * 2
    assert s.solids.tolist() == [[0, 4]]
    segments, circles = s.seen_by_infrared
    assert len(segments) == 4
    assert len(circles) == 0


def test_joined_surfaces_keep_their_properties():
    still = Surfaces.of([box(0, 0, 1, 1), circle(5, 5, 1)])
    moving = Surfaces.of([box(0, 0, 1, 1, critical_angle=0.9), circle(0, 0, 2)])
    joined = still.joined([moving.shifted(0.5, 0.25)])
    assert joined.critical_angles.tolist() == [0.5] * 4 + [0.9] * 4 + [0.7] * 2
    assert joined.solids.tolist() == [[0, 4], [4, 8]]
    assert joined.circles.tolist() == [[5, 5, 1], [0.5, 0.25, 2]]
    # The boxes cross at (1, 0.25) and (0.5, 1): there the nearest surface can change.
    assert {(1, 0.25), (0.5, 1)} <= points(joined.marks)
    assert joined.distance(1.4, 0.3) < 0.0
    assert still.joined([]) is still


def test_distance_by_hand():
    s = Surfaces.of([box(0, 0, 2, 1), circle(4, 0.5, 0.5)])
    assert s.distance(1.0, 3.0) == pytest.approx(2.0)
    assert s.distance(-3.0, 5.0) == pytest.approx(5.0)
    assert s.distance(1.0, 0.6) == pytest.approx(-0.4)
    assert s.distance(3.2, 0.5) == pytest.approx(0.3)
    assert s.distance(4.0, 0.5) == pytest.approx(-0.5)
    assert Surfaces.of([]).distance(0.0, 0.0) == math.inf
    grid = s.distances(np.array([1.0, 3.2]), np.array([0.5, 3.0, 0.6]))
    expected = [[s.distance(x, y) for x in (1.0, 3.2)] for y in (0.5, 3.0, 0.6)]
    assert grid == pytest.approx(np.array(expected))


def test_distances_of_a_grid_are_those_of_its_points():
    rng = np.random.default_rng(1)
    star = rng.uniform(-2.0, 2.0, (7, 2))
    star = star[np.argsort(np.arctan2(star[:, 1], star[:, 0]))]
    s = Surfaces.of([outline(star), box(1.0, 1.0, 2.0, 3.0), circle(-1.0, 2.0, 0.7)])
    x, y = np.linspace(-3.0, 3.0, 17), np.linspace(-2.5, 3.5, 19)
    expected = np.array([[s.distance(a, b) for a in x] for b in y])
    assert s.distances(x, y) == pytest.approx(expected, abs=1e-12)
    assert (expected < 0.0).any()


def test_too_many_crossings_are_refused():
    n = 150
    comb = [outline([[0, k], [200, k]], closed=False, solid=False) for k in range(n)]
    comb += [outline([[k + 1, -1], [k + 1, 200]], closed=False, solid=False) for k in range(n)]
    with pytest.raises(ValueError, match=f"22500 times, more than {MAX_CROSSINGS}"):
        Surfaces.of(comb)


def strewn(number: int) -> list[Outline]:
    """Walls and boxes at the same density, whatever their number."""
    rng = np.random.default_rng(0)
    corners = rng.random((number, 2)) * math.sqrt(number)
    return [
        box(x, y, x + 0.7, y + 0.4) if k % 2 else outline([[x, y], [x + 0.9, y + 0.5]], False)
        for k, (x, y) in enumerate(corners)
    ]


def test_crossings_are_those_of_all_pairs():
    surfaces = Surfaces.of(strewn(120))
    expected = set()
    for i, p in enumerate(surfaces.segments):
        for q in surfaces.segments[:i]:
            along = np.array([p[2:] - p[:2], q[:2] - q[2:]]).T
            if np.linalg.det(along) != 0.0:
                t, w = np.linalg.solve(along, q[:2] - p[:2])
                if 0.0 < t < 1.0 and 0.0 < w < 1.0:
                    expected.add(tuple((p[:2] + t * (p[2:] - p[:2])).round(6)))
    ends = points(surfaces.segments.reshape(-1, 2))
    assert len(expected) > 60
    found = points(surfaces.marks) - ends
    assert len(found) == len(expected - ends)
    assert all(min(math.dist(p, q) for q in found) < 2e-6 for p in expected - ends)


def test_what_is_looked_at_grows_with_the_segments_and_not_with_their_pairs():
    sizes = 800, 3200
    worlds = [strewn(number) for number in sizes]
    least = [math.inf, math.inf]
    for _ in range(4):
        for k, outlines in enumerate(worlds):
            began = time.process_time()
            Surfaces.of(outlines)
            least[k] = min(least[k], time.process_time() - began)
    # Four times the segments: with all pairs it would be sixteen times.
    assert least[1] < 9.0 * least[0]
