# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The worlds that come with the package: their verdicts, sizes and passages."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nomad_sim.ground_truth import reachable
from nomad_sim.ray_casting import cast_rays
from nomad_sim.simulator import Simulator
from nomad_sim.world_io import load_world, world_names

RADIUS = 0.23


def free(world, x, y, degrees):
    """Return the free way from (x, y) in a direction and the opposite one."""
    angles = np.radians([degrees, degrees + 180.0])
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    surfaces = world.surfaces(math.inf, 10**6)
    starts = np.array([[x, y], [x, y]])
    return cast_rays(starts, directions, surfaces.segments, surfaces.circles).sum()


def test_the_worlds_are_there():
    named = {"corridor", "lab", "lab_person", "office", "slalom", "unreachable"}
    assert named <= set(world_names())


def test_readme_tells_areas_starts_and_goals():
    readme = (Path(__file__).resolve().parents[3] / "README.md").read_text(encoding="utf-8")
    section = readme.partition("\n## Worlds\n")[2].partition("\n## ")[0]
    rows = [line.strip("| ").split(" | ") for line in section.splitlines() if "deg | (" in line]
    told = {name: row[1:] for row in rows for name in re.findall(r"`(\w+)`", row[0])}
    assert told == {world.name: in_a_row(world) for world in map(load_world, world_names())}


def in_a_row(world):
    """Return area, start and goal as README tells them."""
    assert world.origin == (0.0, 0.0)
    start, degrees = world.start, math.degrees(world.start.theta)
    return [
        "{:g} x {:g}".format(*world.size),
        f"({start.x:g}, {start.y:g}), {degrees:g} deg",
        "({:g}, {:g})".format(*world.goal),
    ]


@pytest.mark.parametrize("name", world_names())
class TestEveryWorld:
    def test_its_expected_outcome_is_the_truth(self, name):
        world = load_world(name)
        assert reachable(world, RADIUS, tolerance=0.3) is (world.expected == "reached")

    def test_it_is_named_after_its_file_and_says_what_it_is(self, name):
        world = load_world(name)
        assert world.name == name
        assert world.description

    def test_the_robot_may_start_anywhere_near_its_start(self, name):
        world = load_world(name)
        for dx in (-0.3, 0.0, 0.3):
            for dy in (-0.3, 0.0, 0.3):
                Simulator(world, start=replace(world.start, x=world.start.x + dx))
                Simulator(world, start=replace(world.start, y=world.start.y + dy))

    def test_nothing_leaves_the_area(self, name):
        world = load_world(name)
        # From the start, no way of a point leads out: the border is closed.
        geometry = replace(world, size=(world.size[0] + 2.0, world.size[1] + 2.0)).geometry(0.05)
        x, y = geometry.centres()
        blocked = world.surfaces(math.inf, 10**6).distances(x - 1.0, y - 1.0) < 0.05
        row, column = geometry.cell_of(world.start.x + 1.0, world.start.y + 1.0)
        reached = np.zeros_like(blocked)
        reached[row, column] = True
        while True:
            grown = reached.copy()
            grown[1:] |= reached[:-1]
            grown[:-1] |= reached[1:]
            grown[:, 1:] |= reached[:, :-1]
            grown[:, :-1] |= reached[:, 1:]
            grown &= ~blocked
            if (grown == reached).all():
                break
            reached = grown
        edge = np.ones_like(blocked)
        edge[1:-1, 1:-1] = False
        assert not (reached & edge).any()


def test_the_laboratory_is_that_of_the_experiments():
    world = load_world("lab")
    assert world.size == (7.6, 6.3)
    assert (world.start.x, world.start.y, *world.goal) == (1.25, 5.25, 5.35, 5.45)
    # The opening between the obstacles, and the narrow passage beside the cabinet.
    assert free(world, 3.7, 2.65, 90.0) == pytest.approx(0.9)
    assert free(world, 7.2, 4.25, 0.0) == pytest.approx(0.95)


def test_the_person_closes_the_opening_for_a_while():
    world = load_world("lab_person")
    (person,) = world.moving
    assert person.place(1e6, 15) == (3.7, 2.65)
    assert person.place(0.0, 16) is None
    stays = replace(world, moving=(replace(person, perceptions=(0.0, math.inf)),))
    assert not reachable(stays, RADIUS, tolerance=0.3)


def test_the_corridor_is_that_of_figure_8():
    world = load_world("corridor")
    geometry = world.geometry(0.1)
    assert (geometry.width, geometry.height) == (180, 120)
    assert free(world, 11.4, 4.92, 0.0) == pytest.approx(0.85)
    # Simulation 1: about 12 m from the room to the end of the corridor's left branch.
    assert world.start.distance_to(*world.goal) == pytest.approx(12.0, abs=0.1)


def test_doors_and_screens_have_their_widths():
    office, slalom = load_world("office"), load_world("slalom")
    assert free(office, 2.67, 4.3, 90.0) == pytest.approx(0.8)
    assert free(office, 6.4, 2.97, 0.0) == pytest.approx(0.8)
    for x, y in ((1.8, 3.6), (3.3, 0.4), (4.8, 3.6), (6.3, 0.4)):
        # 0.9 m to the area's edge, 5 cm behind which the wall stands.
        assert free(slalom, x, y, 90.0) == pytest.approx(0.95)


def test_the_sealed_chamber_would_hold_the_robot():
    world = load_world("unreachable")
    inside = replace(world, start=replace(world.start, x=4.3, y=2.4))
    assert reachable(inside, RADIUS)
