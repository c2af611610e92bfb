# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The memory of looks at the frontier, against rooms drawn as text and a search by hand."""

import math
from collections import deque

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.frontier_looks import DEPTH, FrontierLooks, frontier_in_sight

# Rows from top to bottom, '.' may be entered; the robot stands at R.
ROOM = """
##################
##################
##################
##################
####........######
####........######
####...R....######
####........######
##################
##################
##################
##################
####........######
##################
"""


def drawn(text):
    """Return what may be entered, a geometry whose row 0 is the lowest line, and the pose."""
    lines = text.split()[::-1]
    cells = np.array([[c in ".R" for c in line] for line in lines])
    geometry = GridGeometry(cells.shape[1], cells.shape[0], 0.1, (-0.3, 1.0))
    row = next(i for i, line in enumerate(lines) if "R" in line)
    return cells, geometry, Pose2(*geometry.centre_of(row, lines[row].index("R")))


def frontier_by_hand(cells, geometry, pose, reach):
    """Return cells that are at most DEPTH steps off what the robot can get to, without sight."""
    start = geometry.cell_of(pose.x, pose.y)
    component, queue = {start}, deque([start])
    while queue:
        r, c = queue.popleft()
        for cell in ((r + i, c + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            inside = 0 <= cell[0] < cells.shape[0] and 0 <= cell[1] < cells.shape[1]
            if inside and cells[cell] and cell not in component:
                component.add(cell)
                queue.append(cell)
    near = set()
    for r, c in np.argwhere(~cells).tolist():
        steps = min(max(abs(r - i), abs(c - j)) for i, j in component)
        if steps <= DEPTH and math.dist(geometry.centre_of(r, c), (pose.x, pose.y)) <= reach:
            near.add((r, c))
    return near


def test_in_a_room_all_walls_are_frontier_and_nothing_beyond_them():
    cells, geometry, pose = drawn(ROOM)
    seen = set(map(tuple, frontier_in_sight(cells, geometry, pose, 2.0).tolist()))
    assert len(seen) > 60
    assert seen == frontier_by_hand(cells, geometry, pose, 2.0)
    # The other room may be entered, but the robot cannot get there.
    assert not any(cells[cell] for cell in seen)


def test_no_farther_than_the_reach():
    cells, geometry, pose = drawn(ROOM)
    seen = set(map(tuple, frontier_in_sight(cells, geometry, pose, 0.45).tolist()))
    assert seen == frontier_by_hand(cells, geometry, pose, 0.45)
    assert 0 < len(seen) < 40


def test_what_lies_round_a_corner_is_not_seen():
    cells, geometry, pose = drawn(
        """
        ####################
        ####################
        ####################
        ##############.#####
        ##############.#####
        ##############.#####
        ##############.#####
        ##############.#####
        ##############.#####
        ##############.#####
        ##R............#####
        ####################
        ####################
        """
    )
    seen = {
        geometry.centre_of(*cell)[1]
        for cell in map(tuple, frontier_in_sight(cells, geometry, pose, 5.0).tolist())
    }
    assert max(seen) < pose.y + 0.1 * (DEPTH + 1) + 1e-9
    all_round = frontier_by_hand(cells, geometry, pose, 5.0)
    assert max(geometry.centre_of(*cell)[1] for cell in all_round) > pose.y + 0.8


def test_the_robot_s_own_cell_counts_as_enterable():
    cells, geometry, pose = drawn(ROOM)
    trapped = np.zeros_like(cells)
    seen = frontier_in_sight(trapped, geometry, pose, 0.25)
    here = geometry.cell_of(pose.x, pose.y)
    assert len(seen) == 20  # a disc of 2.5 cells without its middle
    assert here not in set(map(tuple, seen.tolist()))


def barred(looks, cells):
    return {(round(x, 6), round(y, 6)) for x, y in looks.barred(cells)}


def centres(geometry, cells):
    return {tuple(np.round(geometry.centre_of(*cell), 6)) for cell in cells}


def test_what_does_not_open_is_barred_after_enough_looks():
    cells, geometry, pose = drawn(ROOM)
    looks = FrontierLooks(3, 2.0)
    for _ in range(2):
        looks.look(cells, geometry, pose)
        assert looks.barred(cells) == ()
    looks.look(cells, geometry, pose)
    frontier = frontier_by_hand(cells, geometry, pose, 2.0)
    assert barred(looks, cells) == centres(geometry, frontier)


def test_what_opens_is_barred_no_longer():
    cells, geometry, pose = drawn(ROOM)
    looks = FrontierLooks(2, 2.0)
    looks.look(cells, geometry, pose)
    looks.look(cells, geometry, pose)
    opened = cells.copy()
    door = next(iter(frontier_by_hand(cells, geometry, pose, 2.0)))
    opened[door] = True
    assert barred(looks, cells) - barred(looks, opened) == centres(geometry, [door])


def test_what_has_been_open_for_once_is_looked_at_anew():
    cells, geometry, pose = drawn(ROOM)
    looks = FrontierLooks(2, 2.0)
    looks.look(cells, geometry, pose)
    opened = cells.copy()
    door = next(iter(frontier_by_hand(cells, geometry, pose, 2.0)))
    opened[door] = True
    looks.look(opened, geometry, pose)
    looks.look(cells, geometry, pose)
    frontier = frontier_by_hand(cells, geometry, pose, 2.0)
    assert barred(looks, cells) == centres(geometry, frontier - {door})
    looks.look(cells, geometry, pose)
    assert barred(looks, cells) == centres(geometry, frontier)


def test_again_grants_one_more_look():
    cells, geometry, pose = drawn(ROOM)
    looks = FrontierLooks(2, 2.0)
    assert not looks.again()
    looks.look(cells, geometry, pose)
    assert not looks.again()
    looks.look(cells, geometry, pose)
    before = barred(looks, cells)
    assert looks.again()
    assert looks.barred(cells) == ()
    looks.look(cells, geometry, pose)
    assert barred(looks, cells) == before


def test_a_mission_begins_without_memory_and_so_does_another_map():
    cells, geometry, pose = drawn(ROOM)
    looks = FrontierLooks(1, 2.0)
    looks.look(cells, geometry, pose)
    assert looks.barred(cells)
    looks.forget()
    assert looks.barred(cells) == ()
    looks.look(cells, geometry, pose)
    other = GridGeometry(geometry.width, geometry.height, 0.1, (-0.4, 1.0))
    looks.look(np.ones_like(cells), other, pose)
    assert looks.barred(cells) == ()


@pytest.mark.parametrize(("enough", "pose"), [(0, None), (1, Pose2(50.0, 1.0))])
def test_without_the_rule_and_off_the_map_nothing_is_remembered(enough, pose):
    cells, geometry, here = drawn(ROOM)
    looks = FrontierLooks(enough, 2.0)
    looks.look(cells, geometry, pose or here)
    assert looks.barred(cells) == ()
    assert not looks.again()


def test_where_an_infrared_sees_what_is_in_the_way_half_the_looks_are_enough():
    cells, geometry, pose = drawn(ROOM)
    hit = np.array([(pose.x, pose.y + 0.31)])
    looks = FrontierLooks(8, 2.0, keep_out=0.28)
    seen = set(map(tuple, frontier_in_sight(cells, geometry, pose, 2.0).tolist()))
    near = {c for c in seen if math.dist(geometry.centre_of(*c), hit[0]) < 0.28}
    assert 5 < len(near) < 40
    looks.look(cells, geometry, pose, hit)
    assert looks.barred(cells) == ()
    looks.look(cells, geometry, pose, hit)
    assert {geometry.cell_of(*xy) for xy in looks.barred(cells)} == near
    for _ in range(6):
        looks.look(cells, geometry, pose)
    assert {geometry.cell_of(*xy) for xy in looks.barred(cells)} == seen
