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
from fuzzy_navigation.refused_cells import RISKY_RADIUS, UNEXPLORED_MEMORY, RefusedCells

GEOMETRY = GridGeometry(40, 30, 0.1, (-1.0, 0.5))
KEEP_OUT = 0.28
CELL = GEOMETRY.centre_of(25, 30)  # (2.05, 3.05) m


def near(hits):
    """Return the centres within the keep-out distance of a hit, cell by cell."""
    centres = [GEOMETRY.centre_of(r, c) for r in range(30) for c in range(40)]
    return {
        (x, y) for x, y in centres if any(math.hypot(x - u, y - v) < KEEP_OUT for u, v in hits)
    }


def test_holds_the_cells_around_every_hit_point():
    hits = np.array([(0.513, 1.207), (0.7, 1.25), (2.95, 3.4)])  # the last in a corner
    memory = RefusedCells(5, KEEP_OUT, 0.6)
    memory.add_obstacle(3, hits, GEOMETRY)
    expected = near(hits)
    assert len(expected) > 30
    assert set(memory.barred(3)) == expected


def test_an_obstacle_is_forgotten_after_its_time():
    memory = RefusedCells(5, KEEP_OUT, 0.6)
    memory.add_obstacle(3, np.array([(0.5, 1.5)]), GEOMETRY)
    assert memory.barred(7)
    assert memory.barred(8) == ()


def test_a_cell_in_which_the_robot_may_drive_aside_is_held_by_its_best_place():
    """An opening of 0.65 m: its middle stays open, which the centres of the cells miss."""
    jambs = [(0.53, y) for y in (1.075, 1.725)]
    hits = np.array([(x + 0.02 * k, y) for x, y in jambs for k in range(8)])
    by_centres = RefusedCells(5, KEEP_OUT, 0.6)
    by_centres.add_obstacle(3, hits, GEOMETRY)
    by_places = RefusedCells(5, KEEP_OUT, 0.6, shift=0.045)
    by_places.add_obstacle(3, hits, GEOMETRY)
    sides = (0.0, 0.045, -0.045)
    expected = {
        (x, y)
        for x, y in (GEOMETRY.centre_of(r, c) for r in range(30) for c in range(40))
        if max(min(math.dist((x + a, y + b), hit) for hit in hits) for a in sides for b in sides)
        < KEEP_OUT
    }
    assert set(by_places.barred(3)) == expected
    assert expected < set(by_centres.barred(3))
    middle = {cell for cell in by_centres.barred(3) if 1.34 < cell[1] < 1.46}
    assert middle
    assert not middle & expected


def test_the_places_of_a_small_cell_stay_in_it():
    fine = GridGeometry(80, 60, 0.05, (-1.0, 0.5))
    hit = (1.0, 2.0)
    memory = RefusedCells(5, KEEP_OUT, 0.6, shift=0.045)
    memory.add_obstacle(3, np.array([hit]), fine)
    sides = (0.0, 0.0225, -0.0225)
    assert set(memory.barred(3)) == {
        (x, y)
        for x, y in (fine.centre_of(r, c) for r in range(60) for c in range(80))
        if max(math.dist((x + a, y + b), hit) for a in sides for b in sides) < KEEP_OUT
    }


def looked_at_twice(memory, perception, x, y):
    memory.add_unexplored(perception, (x, y), 0.6, 2, GEOMETRY)


def times(memory, cell, perception):
    """Return for how many perceptions a cell is barred from one on."""
    barred = [k for k in range(perception, perception + 60) if cell in memory.barred(k)]
    assert barred == list(range(perception, perception + len(barred)))
    return len(barred)


def test_a_cell_that_does_not_open_is_barred_after_two_looks():
    cell = CELL
    memory = RefusedCells(20, KEEP_OUT, 0.6)
    barred = []
    for looks in range(3):
        memory.add_unexplored(10 + looks, cell, 0.6, looks, GEOMETRY)
        barred.append(times(memory, cell, 10 + looks))
    assert barred == [0, 0, UNEXPLORED_MEMORY]


def test_a_cell_that_stops_the_robot_at_every_visit_is_barred_for_longer_each_time():
    cell, other = CELL, GEOMETRY.centre_of(25, 31)
    memory = RefusedCells(20, KEEP_OUT, 0.6)
    barred = []
    for perception in range(100, 1000, 100):
        memory.add_unexplored(perception, cell, 0.6, 0, GEOMETRY)
        barred.append(times(memory, cell, perception))
        memory.add_unexplored(perception + 50, other, 0.6, 0, GEOMETRY)
    # From the third on, doubled each time, and no longer than the memory reaches.
    assert barred[:6] == [0, 0, 4, 8, 16, 20]
    assert set(barred[6:]) == {20}
    memory.forget()
    memory.add_unexplored(5000, cell, 0.6, 0, GEOMETRY)
    assert memory.barred(5000) == ()


def test_on_a_risky_path_the_cells_around_are_the_same_place():
    memory = RefusedCells(20, KEEP_OUT, 0.6)
    for perception, x in ((10, 2.05), (20, 2.15), (30, 1.95)):
        assert memory.barred(perception) == ()
        memory.add_unexplored(perception, (x, 3.05), 0.8, 0, GEOMETRY)
    # 1.95 is 0.2 m from 2.15: two tries only, of which none bars.
    assert memory.barred(30) == ()
    memory.add_unexplored(40, (2.05, 3.05), 0.8, 0, GEOMETRY)
    expected = {
        (x, y)
        for x, y in (GEOMETRY.centre_of(r, c) for r in range(30) for c in range(40))
        if math.hypot(x - 2.05, y - 3.05) <= RISKY_RADIUS
    }
    assert len(expected) == 9
    assert set(memory.barred(40)) == expected


def test_an_impasse_is_a_place_and_lasts_as_long_as_an_obstacle():
    memory = RefusedCells(5, KEEP_OUT, 0.6)
    memory.add_impasse(3, CELL, 0.15, GEOMETRY)
    centres = [GEOMETRY.centre_of(r, c) for r in range(30) for c in range(40)]
    expected = {(x, y) for x, y in centres if math.dist((x, y), CELL) <= 0.15}
    assert len(expected) == 9
    assert set(memory.barred(7)) == expected
    assert memory.barred(8) == ()


def test_an_unexplored_cell_is_forgotten_sooner_but_does_not_shorten_an_obstacle():
    memory = RefusedCells(20, KEEP_OUT, 0.6)
    looked_at_twice(memory, 3, *CELL)
    assert memory.barred(2 + UNEXPLORED_MEMORY) == (CELL,)
    assert memory.barred(3 + UNEXPLORED_MEMORY) == ()
    memory.add_obstacle(3, np.array([(0.05, 1.05)]), GEOMETRY)
    cell = memory.barred(3)[0]
    looked_at_twice(memory, 3, *cell)
    assert cell in memory.barred(22)


@pytest.mark.parametrize("hits", [np.empty((0, 2)), np.array([(90.0, 90.0)])])
def test_without_a_hit_in_the_map_there_is_nothing(hits):
    memory = RefusedCells(5, KEEP_OUT, 0.6)
    memory.add_obstacle(1, hits, GEOMETRY)
    assert memory.barred(1) == ()
    assert not memory.release()


def test_no_memory_as_in_the_paper():
    memory = RefusedCells(0, KEEP_OUT, 0.6)
    memory.add_obstacle(1, np.array([(0.5, 1.5)]), GEOMETRY)
    looked_at_twice(memory, 1, 0.55, 1.55)
    assert memory.barred(1) == ()


def test_gives_free_what_there_is():
    memory = RefusedCells(5, KEEP_OUT, 0.6)
    looked_at_twice(memory, 1, 0.55, 1.55)
    assert memory.release()
    assert memory.barred(1) == ()
    assert not memory.release()


def test_visits_on_free_and_on_risky_paths_are_counted_apart():
    memory = RefusedCells(20, KEEP_OUT, 0.6)
    for perception, alpha in ((10, 0.6), (20, 0.8), (30, 0.6), (40, 0.8)):
        memory.add_unexplored(perception, CELL, alpha, 0, GEOMETRY)
        assert memory.barred(perception) == ()
    memory.add_unexplored(50, CELL, 0.6, 0, GEOMETRY)
    assert memory.barred(50) == (CELL,)


def test_what_is_given_free_is_judged_anew():
    memory = RefusedCells(20, KEEP_OUT, 0.6)
    for perception in (10, 20, 30):
        memory.add_unexplored(perception, CELL, 0.6, 0, GEOMETRY)
    assert memory.release()
    for perception in (40, 50):
        memory.add_unexplored(perception, CELL, 0.6, 0, GEOMETRY)
        assert memory.barred(perception) == ()
    memory.add_unexplored(60, CELL, 0.6, 0, GEOMETRY)
    assert times(memory, CELL, 60) == UNEXPLORED_MEMORY


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
