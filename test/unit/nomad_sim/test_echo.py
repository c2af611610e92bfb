# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Echoes against geometry worked out by hand."""

import math
from itertools import pairwise

import numpy as np
import pytest

from nomad_sim.echo import crosstalk_range, echo_range
from nomad_sim.surfaces import Outline, Surfaces

HALF = math.radians(10.0)
NOBODY = np.zeros(3)


def deg(angle):
    return math.radians(angle)


def wall(*points, critical=25.0, solid=False):
    """Return a line of walls through the points, closed where it is a solid polygon."""
    ring = [*points, points[0]] if solid else points
    segments = np.array([[*a, *b] for a, b in pairwise(ring)], dtype=float)
    return Outline(segments, np.empty((0, 3)), deg(critical), True, solid)


def pole(x, y, radius, critical=40.0):
    return Outline(np.empty((0, 4)), np.array([[x, y, radius]]), deg(critical), True, False)


def echo(
    outlines, x=0.0, y=0.0, axis=0.0, half=HALF, reflections=0, edges=True, body=NOBODY, reach=6.5
):
    s = Surfaces.of(outlines)
    return echo_range(
        x, y, deg(axis), half, reach, edges, reflections, np.asarray(body, dtype=float),
        s.segments, s.circles, s.critical_angles, s.edges, s.marks,
    )  # fmt: skip


FAR = 50.0


class TestFlatWall:
    @pytest.mark.parametrize("distance", [0.05, 0.5, 1.0, 3.0, 6.4])
    @pytest.mark.parametrize("tilt", [-9.9, 0.0, 4.0, 10.0])
    def test_normal_inside_the_beam_gives_the_distance(self, distance, tilt):
        assert echo([wall((distance, -FAR), (distance, FAR))], axis=tilt) == pytest.approx(
            distance, abs=1e-12
        )

    @pytest.mark.parametrize("tilt", [12.0, 20.0, 30.0, 34.9])
    def test_inclined_wall_echoes_from_the_border_of_the_beam(self, tilt):
        # The ray of least incidence in the beam meets the wall at tilt - 10 deg.
        expected = 2.0 / math.cos(deg(tilt - 10.0))
        walls = [wall((2.0, -FAR), (2.0, FAR))]
        assert echo(walls, axis=tilt) == pytest.approx(expected, abs=1e-12)
        assert echo(walls, axis=-tilt) == pytest.approx(expected, abs=1e-12)

    @pytest.mark.parametrize("tilt", [35.1, 45.0, 70.0])
    def test_beyond_the_critical_angle_the_echo_is_lost(self, tilt):
        assert echo([wall((1.0, -FAR), (1.0, FAR))], axis=tilt) == math.inf

    def test_the_critical_angle_counts_from_the_ray_not_from_the_axis(self):
        walls = [wall((1.0, -FAR), (1.0, FAR), critical=8.0)]
        assert echo(walls, axis=17.9) == pytest.approx(1.0 / math.cos(deg(7.9)))
        assert echo(walls, axis=18.1) == math.inf

    def test_a_wall_that_ends_before_its_foot_echoes_from_its_nearest_part(self):
        # Wall on x = 1 from y = 0.1 on; the beam looks along x, incidence at its end 5.7 deg.
        walls = [wall((1.0, 0.1), (1.0, FAR))]
        assert echo(walls, edges=False) == pytest.approx(math.hypot(1.0, 0.1), abs=1e-12)

    def test_beyond_the_reach_is_no_echo(self):
        assert echo([wall((6.6, -FAR), (6.6, FAR))]) == math.inf

    def test_an_empty_world_gives_no_echo(self):
        assert echo([]) == math.inf


class TestEdges:
    def test_the_free_end_of_a_wall_seen_edge_on(self):
        walls = [wall((2.0, 0.1), (5.0, 0.25))]
        assert echo(walls, edges=False) == math.inf
        assert echo(walls) == pytest.approx(math.hypot(2.0, 0.1), abs=1e-12)

    def test_a_convex_corner_whose_faces_both_turn_away(self):
        diamond = wall((1.0, 0.05), (2.0, 1.0), (3.0, 0.05), (2.0, -1.0), solid=True)
        assert echo([diamond], edges=False) == math.inf
        assert echo([diamond]) == pytest.approx(math.hypot(1.0, 0.05), abs=1e-12)

    def test_a_concave_corner_sends_the_sound_back(self):
        corner = wall((1.0, 2.0), (2.0, 1.0), (1.0, 0.0))
        assert echo([corner], y=1.1, edges=False) == math.inf
        assert echo([corner], y=1.1) == pytest.approx(math.hypot(2.0, 0.1), abs=1e-12)

    def test_an_edge_outside_the_beam_is_silent(self):
        end = wall((2.0, 2.0 * math.tan(deg(10.1))), (5.0, 5.0 * math.tan(deg(10.1))))
        assert echo([end]) == math.inf

    def test_a_hidden_edge_is_silent(self):
        # The screen itself reflects the sound away, and still hides the edge.
        end = wall((2.0, 0.0), (5.0, 0.0))
        screen = wall((0.5, -1.5), (1.5, 1.5), critical=5.0)
        assert echo([end, screen]) == math.inf
        assert echo([end]) == pytest.approx(2.0)

    def test_a_joint_of_two_walls_in_line_is_no_edge(self):
        first = wall((1.0, 2.0), (2.0, 1.0))
        second = wall((2.0, 1.0), (3.0, 0.0), critical=8.0)
        assert echo([first, second], x=0.0, y=1.0) == math.inf

    def test_flush_faces_of_two_boxes_are_no_edge(self):
        # Seen at 45 deg, where only an edge could echo: their joint is at (1, 1).
        boxes = [
            wall((0.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0), solid=True),
            wall((1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), solid=True),
        ]
        assert echo(boxes, axis=45.0) == math.inf
        assert echo(boxes[:1], axis=45.0) == pytest.approx(math.sqrt(2.0))

    def test_a_corner_of_two_crossing_walls_echoes(self):
        # They cross at (2, 0) and stand at 45 deg to the sound.
        walls = [wall((0.0, -2.0), (4.0, 2.0)), wall((0.0, 2.0), (4.0, -2.0))]
        assert echo(walls, edges=False) == math.inf
        assert echo(walls) == pytest.approx(2.0)

    def test_a_partition_that_meets_a_wall_makes_a_corner(self):
        walls = [wall((0.0, 3.0), (3.0, 0.0)), wall((1.5, 1.5), (3.0, 3.0))]
        # The wall stands at 45 deg to this beam; the joint is one wall's end on the other.
        assert echo(walls, y=1.5) == pytest.approx(1.5)
        assert echo(walls[:1], y=1.5) == math.inf


class TestCircle:
    def test_the_nearest_point_inside_the_beam(self):
        assert echo([pole(2.0, 0.1, 0.3)]) == pytest.approx(math.hypot(2.0, 0.1) - 0.3, abs=1e-12)

    def test_a_circle_beside_the_axis_echoes_from_the_border_of_the_beam(self):
        # Centre at 15 deg, distance 2, radius 0.5; the border ray passes 5 deg beside it.
        centre = 2.0 * math.cos(deg(15.0)), 2.0 * math.sin(deg(15.0))
        beta = deg(5.0)
        expected = 2.0 * math.cos(beta) - math.sqrt(0.25 - (2.0 * math.sin(beta)) ** 2)
        assert echo([pole(*centre, 0.5)]) == pytest.approx(expected, abs=1e-12)

    def test_incidence_on_the_curve(self):
        # The border ray meets the circle at incidence asin(2 sin(5 deg) / 0.5) = 20.4 deg.
        centre = 2.0 * math.cos(deg(15.0)), 2.0 * math.sin(deg(15.0))
        incidence = math.degrees(math.asin(2.0 * math.sin(deg(5.0)) / 0.5))
        assert echo([pole(*centre, 0.5, critical=incidence + 0.1)]) < math.inf
        assert echo([pole(*centre, 0.5, critical=incidence - 0.1)]) == math.inf

    def test_a_circle_has_no_edges(self):
        assert len(Surfaces.of([pole(2.0, 0.0, 0.3)]).edges) == 0

    def test_it_hides_what_is_behind(self):
        # Edge-on circle out of the critical angle in all of the beam: nothing comes back.
        centre = 1.0 * math.cos(deg(18.0)), 1.0 * math.sin(deg(18.0))
        screen = pole(*centre, 0.9, critical=5.0)
        assert echo([screen, wall((3.0, -FAR), (3.0, FAR))]) == math.inf

    @pytest.mark.parametrize("side", [-1.0, 1.0])
    def test_beside_it_what_is_behind_is_heard(self, side):
        # Centre at 12 deg, covering 14 deg to each side: of the wall, all beyond 2 deg on the
        # other side is left. What falls on the circle itself is lost (8.3 deg and more).
        centre = math.cos(deg(12.0)), -side * math.sin(deg(12.0))
        screen = pole(*centre, math.sin(deg(14.0)), critical=5.0)
        heard = echo([screen, wall((3.0, -FAR), (3.0, FAR))])
        assert heard == pytest.approx(3.0 / math.cos(deg(2.0)), abs=1e-12)


class TestOcclusion:
    def test_the_nearer_of_two_walls(self):
        walls = [wall((3.0, -FAR), (3.0, FAR)), wall((1.5, -FAR), (1.5, FAR))]
        assert echo(walls) == pytest.approx(1.5)

    def test_a_mirror_in_front_hides_the_wall_behind(self):
        glass = wall((1.0, -1.0), (2.0, 1.0), critical=8.0)
        behind = wall((3.0, -FAR), (3.0, FAR))
        assert echo([glass, behind], edges=False) == math.inf

    def test_half_hidden_the_other_half_is_heard(self):
        # The screen covers the beam from 2 deg upwards: what is left of the wall is nearest
        # along the axis, though the screen sends everything away.
        edge = math.tan(deg(2.0))
        screen = wall((1.0, edge), (2.0, edge + 1.8), critical=5.0)
        behind = wall((3.0, -FAR), (3.0, FAR))
        assert echo([screen, behind], edges=False) == pytest.approx(3.0)
        # Tilted by 8 deg, the beam looks at the wall from -2 to 2 deg only: still its foot.
        assert echo([screen, behind], edges=False, axis=8.0) == pytest.approx(3.0)
        # From 4 deg on nothing is left.
        assert echo([screen, behind], edges=False, axis=14.0) == math.inf

    def test_a_gap_lets_the_sound_through_where_it_is(self):
        # A gap between 3 and 4 deg in a mirror; the wall behind echoes at 1 / cos(3 deg).
        low, high = math.tan(deg(3.0)), math.tan(deg(4.0))
        screens = [
            wall((1.0, low), (1.3, low - 2.0), critical=1.0),
            wall((1.0, high), (1.3, high + 2.0), critical=1.0),
        ]
        behind = wall((2.0, -FAR), (2.0, FAR))
        assert echo([*screens, behind], edges=False) == pytest.approx(2.0 / math.cos(deg(3.0)))


class TestReflection:
    MIRROR = ((2.0, -1.0), (4.0, 1.0))

    def test_an_echo_by_way_of_a_mirror_is_as_long_as_the_way(self):
        # A mirror at 45 deg sends the axis from (3, 0) straight up to the ceiling at y = 2.
        outlines = [wall(*self.MIRROR, critical=25.0), wall((-FAR, 2.0), (FAR, 2.0))]
        assert echo(outlines, edges=False) == math.inf
        assert echo(outlines, edges=False, reflections=1) == pytest.approx(5.0, abs=1e-12)

    def test_a_target_before_the_mirror_but_on_its_far_side_is_not_seen(self):
        # Between the mirror image at (3, -3) and the mirror: no real sound passes there.
        outlines = [wall(*self.MIRROR), wall((2.9, -1.5), (3.1, -1.5), critical=60.0)]
        assert echo(outlines, edges=False, reflections=1) == math.inf

    def test_the_mirror_shows_edges_too(self):
        outlines = [wall(*self.MIRROR), wall((3.0, 1.7), (3.0, 4.0))]
        assert echo(outlines, reflections=1) == pytest.approx(4.7, abs=1e-12)

    def test_two_mirrors_need_two_reflections(self):
        # Up from the first mirror, at y = 2 to the left by a second one, wall at x = 1.
        second = wall((2.0, 1.0), (4.0, 3.0))
        target = wall((1.0, 1.6), (1.0, 2.4))
        outlines = [wall(*self.MIRROR), second, target]
        assert echo(outlines, edges=False, reflections=1, reach=8.0) == math.inf
        # The second mirror runs from lower left to upper right: it sends upward sound right.
        assert echo(outlines, edges=False, reflections=2, reach=8.0) == math.inf
        outlines[1] = wall((2.0, 3.0), (4.0, 1.0))
        assert echo(outlines, edges=False, reflections=1, reach=8.0) == math.inf
        way = echo(outlines, edges=False, reflections=2, reach=8.0)
        assert way == pytest.approx(7.0, abs=1e-12)

    def test_a_way_longer_than_the_reach_is_lost(self):
        outlines = [wall(*self.MIRROR), wall((-FAR, 3.6), (FAR, 3.6))]
        assert echo(outlines, edges=False, reflections=1) == math.inf

    def test_a_direct_echo_comes_before_a_reflected_one(self):
        outlines = [
            wall(*self.MIRROR),
            wall((-FAR, 2.0), (FAR, 2.0)),
            wall((2.5, -0.4), (2.5, -0.3)),
        ]
        assert echo(outlines, edges=False, reflections=1) == pytest.approx(math.hypot(2.5, 0.3))

    def test_the_robot_itself_stands_in_the_way(self):
        # A body of radius 0.7 m, 4 m from the mirror image, covers 10.08 deg on each side.
        outlines = [wall(*self.MIRROR), wall((-FAR, 2.0), (FAR, 2.0))]
        assert echo(outlines, edges=False, reflections=1, body=[3.0, 1.0, 0.7]) == math.inf
        assert echo(outlines, edges=False, reflections=1, body=[3.0, 1.0, 0.69]) < math.inf


class TestCrosstalk:
    @staticmethod
    def heard(outlines, sender, hearer, reflections=2, body=NOBODY):
        s = Surfaces.of(outlines)
        return crosstalk_range(
            *sender, HALF, 6.5, reflections, *hearer, body,
            s.segments, s.circles, s.marks,
        )  # fmt: skip

    def test_two_mirrors_bring_a_pulse_to_a_sonar_that_looks_elsewhere(self):
        # Sent along x from the origin, up at x = 3, back along -x at y = 2 ... to (0.5, 2)
        # where another sonar looks along x: it hears half of 3 + 2 + 2.5 m.
        mirrors = [wall((2.0, -1.0), (4.0, 1.0)), wall((2.0, 3.0), (4.0, 1.0))]
        sender, hearer = (0.0, 0.0, 0.0), (0.5, 2.0, 0.0)
        assert self.heard(mirrors, sender, hearer) == pytest.approx(3.75, abs=1e-12)
        assert self.heard(mirrors, sender, hearer, reflections=1) == math.inf

    def test_sound_from_outside_its_beam_is_not_heard(self):
        mirrors = [wall((2.0, -1.0), (4.0, 1.0)), wall((2.0, 3.0), (4.0, 1.0))]
        assert self.heard(mirrors, (0.0, 0.0, 0.0), (0.5, 2.0, deg(10.1))) == math.inf
        assert self.heard(mirrors, (0.0, 0.0, 0.0), (0.5, 2.0, deg(9.9))) < math.inf

    def test_what_stands_between_keeps_it_away(self):
        mirrors = [wall((2.0, -1.0), (4.0, 1.0)), wall((2.0, 3.0), (4.0, 1.0))]
        screen = wall((1.0, 1.5), (1.0, 2.5))
        assert self.heard([*mirrors, screen], (0.0, 0.0, 0.0), (0.5, 2.0, 0.0)) == math.inf

    def test_without_reflection_nothing_is_heard(self):
        assert self.heard([], (0.0, 0.0, 0.0), (2.0, 0.0, math.pi)) == math.inf
