# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The memory of cells that the motion could not enter, against distances by hand."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.params import planner_parameters
from fuzzy_navigation.planner import Planner, PlanStatus
from fuzzy_navigation.refused_cells import UNEXPLORED_MEMORY, RefusedCells

GEOMETRY = GridGeometry(40, 30, 0.1, (-1.0, 0.5))
KEEP_OUT = 0.28


def near(hits):
    """Return the centres within the keep-out distance of a hit, cell by cell."""
    centres = [GEOMETRY.centre_of(r, c) for r in range(30) for c in range(40)]
    return {
        (x, y) for x, y in centres if any(math.hypot(x - u, y - v) < KEEP_OUT for u, v in hits)
    }


def test_holds_the_cells_around_every_hit_point():
    hits = np.array([(0.513, 1.207), (0.7, 1.25), (2.95, 3.4)])  # the last in a corner
    memory = RefusedCells(5, KEEP_OUT)
    memory.add_obstacle(3, hits, GEOMETRY)
    expected = near(hits)
    assert len(expected) > 30
    assert set(memory.barred(3)) == expected


def test_an_obstacle_is_forgotten_after_its_time():
    memory = RefusedCells(5, KEEP_OUT)
    memory.add_obstacle(3, np.array([(0.5, 1.5)]), GEOMETRY)
    assert memory.barred(7)
    assert memory.barred(8) == ()


def test_an_unexplored_cell_is_forgotten_sooner_but_does_not_shorten_an_obstacle():
    memory = RefusedCells(20, KEEP_OUT)
    memory.add_unexplored(3, 2.05, 3.05)
    assert memory.barred(2 + UNEXPLORED_MEMORY) == ((2.05, 3.05),)
    assert memory.barred(3 + UNEXPLORED_MEMORY) == ()
    memory.add_obstacle(3, np.array([(0.05, 1.05)]), GEOMETRY)
    cell = memory.barred(3)[0]
    memory.add_unexplored(3, *cell)
    assert cell in memory.barred(22)


@pytest.mark.parametrize("hits", [np.empty((0, 2)), np.array([(90.0, 90.0)])])
def test_without_a_hit_in_the_map_there_is_nothing(hits):
    memory = RefusedCells(5, KEEP_OUT)
    memory.add_obstacle(1, hits, GEOMETRY)
    assert memory.barred(1) == ()
    assert not memory.release()


def test_no_memory_as_in_the_paper():
    memory = RefusedCells(0, KEEP_OUT)
    memory.add_obstacle(1, np.array([(0.5, 1.5)]), GEOMETRY)
    memory.add_unexplored(1, 0.55, 1.55)
    assert memory.barred(1) == ()


def test_gives_free_once_a_mission():
    memory = RefusedCells(5, KEEP_OUT)
    memory.add_unexplored(1, 0.55, 1.55)
    assert memory.release()
    assert memory.barred(1) == ()
    memory.add_unexplored(1, 0.55, 1.55)
    assert not memory.release()
    memory.forget()
    memory.add_unexplored(1, 0.55, 1.55)
    assert memory.release()


class TestPlanner:
    """The planner's side: positions that no path may enter."""

    def plan(self, barred, **options):
        planner = Planner(GEOMETRY, planner_parameters(overrides={"robot_radius": 0.0}))
        planner.set_map(np.zeros(GEOMETRY.shape))
        return planner.plan(Pose2(-0.5, 1.0), (2.5, 1.0), barred=barred, **options)

    def test_goes_around(self):
        wall = [GEOMETRY.centre_of(row, 20) for row in range(29)]
        result = self.plan(wall)
        assert result.status is PlanStatus.FOUND
        crossing = result.path[result.path[:, 1] == 20]
        assert (crossing[:, 0] == 29).all()

    def test_finds_no_path_through_a_closed_wall(self):
        wall = [GEOMETRY.centre_of(row, 20) for row in range(30)]
        assert self.plan(wall).status is PlanStatus.NO_PATH

    def test_the_start_and_what_lies_outside_do_not_count(self):
        result = self.plan([(-0.5, 1.0), (99.0, 99.0), (-50.0, 0.0)])
        assert len(result.path) == len(self.plan(()).path)

    @pytest.mark.parametrize("barred", [[(math.nan, 1.0)], [(1.0, math.inf)], [1.0, 2.0, 3.0]])
    def test_refuses_what_is_no_position(self, barred):
        result = self.plan(barred)
        assert result.status is PlanStatus.BAD_REQUEST
        assert "barred" in result.message
