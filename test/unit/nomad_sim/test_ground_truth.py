# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Occupancy against sampling, and reachability against gaps of known width."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from nomad_sim.ground_truth import (
    Reachability,
    _leads,
    occupancy,
    reachability,
    reachable,
    way_clearance,
)
from nomad_sim.surfaces import Outline, Surfaces
from nomad_sim.world import Circle, MovingObstacle, Polygon, Wall, World


def box(x0, y0, x1, y1, material="wood"):
    return Polygon(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float), material)


def hall(*polygons, circles=(), moving=(), goal=(5.0, 1.0)):
    corners = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 2.0], [0.0, 2.0]])
    return World(
        name="hall",
        origin=(0.0, 0.0),
        size=(6.0, 2.0),
        start=Pose2(1.0, 1.0),
        goal=goal,
        expected="reached",
        walls=(Wall(corners, "painted_wall", closed=True),),
        polygons=polygons,
        circles=circles,
        moving=moving,
    )


class TestOccupancy:
    def test_a_box_on_the_borders_of_cells_fills_exactly_its_cells(self):
        world = hall(box(1.1, 0.5, 1.7, 0.9))
        geometry = GridGeometry.from_size(5.8, 1.8, 0.1, (0.1, 0.1))
        grid = occupancy(world.surfaces(), geometry)
        expected = np.zeros(geometry.shape, dtype=bool)
        expected[4:8, 10:16] = True
        assert (grid == expected).all()

    def test_a_thin_wall_on_a_border_fills_both_sides(self):
        wall = Outline(np.array([[0.0, 0.5, 1.0, 0.5]]), np.empty((0, 3)), 0.4, True, False)
        grid = occupancy(Surfaces.of([wall]), GridGeometry(10, 10, 0.1))
        assert np.flatnonzero(grid.any(axis=1)).tolist() == [4, 5]
        assert grid[4:6].all()

    def test_slanted_walls_and_circles_against_sampling(self):
        rng = np.random.default_rng(3)
        geometry = GridGeometry(24, 18, 0.25)
        for _ in range(20):
            ends = rng.uniform(0.2, 4.0, 4)
            circle = np.array([[*rng.uniform(1.0, 4.0, 2), rng.uniform(0.1, 0.6)]])
            surfaces = Surfaces.of(
                [
                    Outline(ends[None], np.empty((0, 3)), 0.4, True, False),
                    Outline(np.empty((0, 4)), circle, 0.4, True, False),
                ]
            )
            grid = occupancy(surfaces, geometry)
            along = np.linspace(ends[:2], ends[2:], 4000)
            cells, _ = geometry.cells_of(along)
            touched = np.zeros(geometry.shape, dtype=bool)
            touched[cells[:, 0], cells[:, 1]] = True
            steps = (np.arange(40) + 0.5) / 40
            for row in range(geometry.height):
                for column in range(geometry.width):
                    x = (column + steps)[None, :] * 0.25 - circle[0, 0]
                    y = (row + steps)[:, None] * 0.25 - circle[0, 1]
                    touched[row, column] |= (np.hypot(x, y) < circle[0, 2]).any()
            # Sampling misses slivers only.
            assert not (touched & ~grid).any()
            assert (grid & ~touched).sum() <= 3


class TestReachable:
    @pytest.mark.parametrize(("gap", "answer"), [(0.9, True), (0.48, True), (0.44, False)])
    def test_a_gap_against_the_diameter_of_the_robot(self, gap, answer):
        world = hall(box(3.0, 0.0, 3.2, 1.0 - gap / 2), box(3.0, 1.0 + gap / 2, 3.2, 2.0))
        assert reachable(world) is answer

    def test_between_two_pillars(self):
        def pillars(gap):
            y = 0.5 * gap + 0.4
            return tuple(Circle(3.0, 1.0 + s * y, 0.4, "wood") for s in (-1.0, 1.0))

        assert reachable(hall(circles=pillars(0.5)))
        assert not reachable(hall(circles=pillars(0.42)))

    def test_a_smaller_robot_passes(self):
        world = hall(box(3.0, 0.0, 3.2, 0.85), box(3.0, 1.15, 3.2, 2.0))
        assert not reachable(world)
        assert reachable(world, robot_radius=0.13)

    def test_what_cannot_be_decided_is_said(self):
        world = hall(box(3.0, 0.0, 3.2, 0.77), box(3.0, 1.23, 3.2, 2.0))
        with pytest.raises(ValueError, match="do not decide"):
            reachable(world)

    def test_the_tolerance_lets_it_end_beside_the_goal(self):
        # The goal lies 0.1 m before a wall: the body cannot stand on it.
        world = hall(goal=(5.9, 1.0))
        assert not reachable(world)
        assert reachable(world, tolerance=0.3)
        # But not through a wall.
        closed = hall(box(3.0, 0.0, 3.1, 2.0), goal=(3.5, 1.0))
        assert not reachable(closed, tolerance=0.5)

    def test_obstacles_that_give_way_do_not_count(self):
        screen = box(-0.1, 0.0, 0.1, 2.0)

        def mover(**values):
            return MovingObstacle("screen", screen, np.array([[0.0, 3.0, 0.0]]), **values)

        assert not reachable(hall(moving=(mover(),)))
        assert reachable(hall(moving=(mover(perceptions=(0, 16)),)))
        assert reachable(hall(moving=(mover(times=(5.0, math.inf)),)))

    def test_a_start_without_room(self):
        assert not reachable(hall(box(0.8, 0.8, 1.2, 1.2)))


class TestClearanceOfTheBestWay:
    @pytest.mark.parametrize("gap", [0.3, 0.44, 0.47, 0.5, 0.55, 0.57, 0.7, 1.0])
    def test_it_is_half_the_gap_but_for_the_body(self, gap):
        world = hall(box(3.0, 0.0, 3.2, 1.0 - gap / 2), box(3.0, 1.0 + gap / 2, 3.2, 2.0))
        bounds = way_clearance(world)
        assert bounds.low <= gap / 2 - 0.23 <= bounds.high
        # Half the diagonal of a cell on either side, and what the cells' places make of it.
        assert bounds.high - bounds.low <= 0.09
        fine = way_clearance(world, limits=(gap / 2 - 0.23,))  # what it is: never decided
        assert fine.low <= gap / 2 - 0.23 <= fine.high
        assert fine.high - fine.low <= 0.012

    def test_the_wider_of_two_ways_counts(self):
        wall = (box(3.0, 0.5, 3.2, 1.1), box(3.0, 1.8, 3.2, 2.0))
        bounds = way_clearance(hall(*wall), limits=(0.12,))
        assert bounds.low <= 0.12 <= bounds.high  # 0.7 m above, 0.5 m below

    def test_start_and_goal_count(self):
        bounds = way_clearance(hall(goal=(5.0, 1.7)), limits=(0.07,))
        assert bounds.low <= 0.07 <= bounds.high

    @pytest.mark.parametrize(
        ("gap", "truth"), [(0.44, "unreachable"), (0.48, "marginal"), (0.54, "marginal"),
                           (0.46, "marginal"), (0.58, "reachable"), (0.9, "reachable")],
    )  # fmt: skip
    def test_a_goal_is_marginal_below_five_centimetres(self, gap, truth):
        world = hall(box(3.0, 0.0, 3.2, 1.0 - gap / 2), box(3.0, 1.0 + gap / 2, 3.2, 2.0))
        assert reachability(world) is Reachability(truth)


def test_a_way_that_touches_by_corners_alone_counts_where_ways_are_ruled_out():
    clearance = np.array([[1.0, 0.0], [0.0, 1.0]])
    goal = np.array([[False, False], [False, True]])
    assert _leads(clearance, 1.0, (0, 0), goal, True)
    assert not _leads(clearance, 1.0, (0, 0), goal, False)
    assert _leads(clearance, 0.0, (0, 0), goal, False)
    assert not _leads(clearance, 1.1, (0, 0), goal, True)
