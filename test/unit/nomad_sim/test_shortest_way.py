# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The shortest way, against geometry by hand."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from nomad_sim.ground_truth import reachable
from nomad_sim.shortest_way import length_of, shortest_way
from nomad_sim.world import Circle, MovingObstacle, Wall, World
from nomad_sim.world_io import load_world, world_names

RADIUS = 0.23


def room(*shapes: Wall | Circle) -> World:
    walls = [Wall(np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]]), "rough", True)]
    return World(
        name="room",
        origin=(0.0, 0.0),
        size=(6.0, 4.0),
        start=Pose2(1.0, 2.0),
        goal=(5.0, 2.0),
        expected="reached",
        walls=(*walls, *(s for s in shapes if isinstance(s, Wall))),
        circles=tuple(s for s in shapes if isinstance(s, Circle)),
    )


def test_without_obstacles_it_is_the_straight_line() -> None:
    way = shortest_way(replace(room(), goal=(4.7, 3.1)))
    assert way is not None
    assert way.tolist() == [[1.0, 2.0], [4.7, 3.1]]


def test_around_a_cylinder_it_is_two_tangents_and_an_arc() -> None:
    way = shortest_way(room(Circle(3.0, 2.0, 0.5, "rough")))
    assert way is not None
    r = 0.5 + RADIUS
    tangent = math.sqrt(4.0 - r * r)
    arc = r * (math.pi - 2.0 * math.acos(r / 2.0))
    exact = 2.0 * tangent + arc
    assert exact - 1e-3 <= length_of(way) <= 1.02 * exact


def test_around_the_end_of_a_wall_it_turns_on_a_circle() -> None:
    """A thin wall up to y = 3: the body's centre passes on an arc about its end."""
    way = shortest_way(room(Wall(np.array([[3.0, 0.0], [3.0, 3.0]]), "rough")))
    assert way is not None
    to_end = math.hypot(2.0, 1.0)
    tangent = math.sqrt(to_end**2 - RADIUS**2)
    half_turn = 0.5 * math.pi - math.atan2(2.0, 1.0) + math.pi / 2 - math.acos(RADIUS / to_end)
    exact = 2.0 * (tangent + RADIUS * half_turn)
    assert exact - 1e-3 <= length_of(way) <= 1.02 * exact


def test_a_gap_narrower_than_the_body_is_no_way() -> None:
    gap = room(
        Wall(np.array([[3.0, 0.0], [3.0, 1.8]]), "rough"),
        Wall(np.array([[3.0, 2.2], [3.0, 4.0]]), "rough"),
    )
    assert shortest_way(gap) is None
    assert shortest_way(gap, robot_radius=0.15) is not None


def test_who_comes_and_goes_is_out_of_the_way() -> None:
    person = Circle(0.0, 0.0, 1.9, "clothes")
    waypoints = np.array([[0.0, 3.0, 2.0]])
    with_person = replace(room(), moving=(MovingObstacle("p", person, waypoints, (0.0, 5.0)),))
    assert shortest_way(with_person) is not None
    assert shortest_way(replace(room(), moving=(MovingObstacle("p", person, waypoints),))) is None


@pytest.mark.parametrize("name", world_names())
def test_in_the_worlds_that_come_along_it_is_free_and_there_when_the_goal_can_be_reached(
    name: str,
) -> None:
    world = load_world(name)
    way = shortest_way(world)
    assert (way is not None) == reachable(world)
    if way is not None:
        straight = math.dist((world.start.x, world.start.y), world.goal)
        assert straight <= length_of(way) <= 5.0 * straight
        points = [p for a, b in itertools.pairwise(way) for p in np.linspace(a, b, 50)]
        assert min(world.still.distance(*p) for p in points) >= RADIUS - 0.01
