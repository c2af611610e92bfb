# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Outlines of rasters against the cells themselves, and floor plans against their files."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_server import export_map_server, import_map_server
from nomad_sim.ground_truth import Reachability, reachability
from nomad_sim.simulator import Simulator
from nomad_sim.world import World
from nomad_sim.worlds import floor_plan
from nomad_sim.worlds.draws import GOAL_TOLERANCE
from nomad_sim.worlds.floor_plan import SIMPLIFIED, load_floor_plan, plan_world
from nomad_sim.worlds.outlines import enclosed, outlines, simplified


def rasters() -> list[np.ndarray]:
    rng = np.random.default_rng(5)
    return [
        rng.random((h, w)) < share
        for h, w in ((1, 1), (4, 7), (12, 9))
        for share in (0, 0.3, 0.6, 1)
    ]


@pytest.mark.parametrize("solid", rasters())
def test_crossing_the_outlines_tells_solid_cells_from_free_ones(solid: np.ndarray) -> None:
    sides = [
        side for line in outlines(solid) for side in zip(line, np.roll(line, -1, 0), strict=True)
    ]
    for row in range(solid.shape[0]):
        # From beyond the left border, which is solid, to the right.
        inside = True
        for column in range(solid.shape[1]):
            crossed = [
                side
                for side in sides
                if side[0][0] == side[1][0] == column
                and min(side[0][1], side[1][1]) < row + 0.5 < max(side[0][1], side[1][1])
            ]
            inside ^= len(crossed) % 2 == 1
            assert inside == solid[row, column]


@pytest.mark.parametrize("solid", rasters())
def test_the_area_within_is_that_of_the_free_cells(solid: np.ndarray) -> None:
    assert sum(enclosed(line) for line in outlines(solid)) == -np.count_nonzero(~solid)


def test_solid_cells_that_touch_by_a_corner_belong_together() -> None:
    free = np.zeros((4, 4), dtype=bool)
    free[1:3, 1:3] = True
    free[1, 1] = free[2, 2] = False
    assert len(outlines(~free)) == 2  # two free cells that are apart
    solid = np.zeros((6, 6), dtype=bool)
    solid[2, 2] = solid[3, 3] = True
    assert len(outlines(solid)) == 2  # the border, and one line around both cells


def from_lines(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of each point to a closed line."""
    best = np.full(len(points), np.inf)
    for a, b in zip(line, np.roll(line, -1, 0), strict=True):
        along = b - a
        share = np.clip((points - a) @ along / max(along @ along, 1e-12), 0.0, 1.0)
        best = np.minimum(best, np.hypot(*(points - a - share[:, None] * along).T))
    return best


@pytest.mark.parametrize("slope", [0.0, 0.1, 0.37, 1.0, 2.5])
def test_a_slanted_wall_becomes_a_straight_one(slope: float) -> None:
    rows, columns = np.mgrid[0:60, 0:60]
    (line,) = outlines(rows <= 5 + slope * columns)
    simple = simplified(line, SIMPLIFIED)
    assert from_lines(line, simple).max() <= SIMPLIFIED
    assert {tuple(p) for p in simple} <= {tuple(p) for p in line}
    if slope in (0.0, 1.0):
        assert len(simple) <= 6


def room(folder: Path) -> Path:
    """A plan of 8 x 6 m at 0.05 m: two rooms, a door of 0.9 m, a column and a speck."""
    geometry = GridGeometry(160, 120, 0.05, (-2.0, 3.0))
    occupancy = np.full(geometry.shape, -1, dtype=np.int8)
    occupancy[4:116, 4:156] = 0
    occupancy[:, [4, 155]] = occupancy[[4, 115]] = 100
    occupancy[4:116, 78:81] = 100
    occupancy[50:68, 78:81] = 0
    occupancy[80:86, 30:36] = 100
    occupancy[2, 2] = 0  # a speck that nobody can be in
    export_map_server(folder / "room.yaml", occupancy, geometry)
    return folder / "room.yaml"


def test_a_plan_is_its_raster(tmp_path: Path) -> None:
    plan = load_floor_plan(room(tmp_path))
    corners = np.concatenate([wall.points for wall in plan.walls])
    assert len(plan.walls) == 2  # around the free space, and around the column
    # The rooms of 73 and 74 cells, 110 high, with the door in a wall of 3; the column of 6 x 6.
    x0, y0 = -2.0, 3.0
    wanted = {(x, y) for x in (5, 155) for y in (5, 115)} | {
        (x, y) for x in (30, 36) for y in (80, 86)
    }
    wanted |= {(x, y) for x in (78, 81) for y in (5, 50, 68, 115)}
    found = {(round((x - x0) / 0.05, 6), round((y - y0) / 0.05, 6)) for x, y in corners}
    assert found == wanted


def test_pairs_are_drawn_by_seed_apart_and_reachable(tmp_path: Path) -> None:
    plan = load_floor_plan(room(tmp_path))
    drawn = [plan_world(plan, seed) for seed in range(6)]
    for world in drawn:
        again = plan_world(plan, int(world.name.split("_")[1]))
        assert (again.start, again.goal) == (world.start, world.goal)
        assert 4.0 <= math.dist((world.start.x, world.start.y), world.goal) <= 12.0
        assert reachability(world, tolerance=GOAL_TOLERANCE) is Reachability.REACHABLE
        assert Simulator(world).clearance() >= 0.1 - 1e-9
        x0, y0, x1, y1 = plan.geometry.bounds
        assert x0 <= world.origin[0] < world.origin[0] + world.size[0] <= x1 + 1e-9
        assert y0 <= world.origin[1] < world.origin[1] + world.size[1] <= y1 + 1e-9
    assert len({(w.start, w.goal) for w in drawn}) == len(drawn)


def test_a_raster_of_noise_is_refused_before_its_sides_are_kept() -> None:
    rows, columns = np.indices((400, 400))
    with pytest.raises(ValueError, match=r"have 320[0-9]+ sides of cells, at most 300000"):
        outlines((rows + columns) % 2 == 0)


def test_a_plan_whose_places_do_not_join_is_given_up_in_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[World] = []

    def sealed(world: World) -> World:
        looked.append(world)
        return replace(world, properties={**world.properties, "truth": "unreachable"})

    monkeypatch.setattr(floor_plan, "with_truth", sealed)
    with pytest.raises(ValueError, match=r"m apart .* in 200 pairs of free places; is it a floor"):
        plan_world(load_floor_plan(room(tmp_path)), 1)
    assert len(looked) == 200


def test_a_plan_without_room_is_refused(tmp_path: Path) -> None:
    geometry = GridGeometry(30, 20, 0.1)
    free = np.zeros(geometry.shape, dtype=np.int8)
    export_map_server(tmp_path / "full.yaml", free + np.int8(100), geometry)
    with pytest.raises(ValueError, match="no free cell"):
        load_floor_plan(tmp_path / "full.yaml")
    export_map_server(tmp_path / "small.yaml", free, geometry)
    with pytest.raises(ValueError, match="found no start and goal 4 to 12 m apart"):
        plan_world(load_floor_plan(tmp_path / "small.yaml"), 1)
    with pytest.raises(ValueError, match="cannot read floor plan"):
        load_floor_plan(tmp_path / "none.yaml")


@pytest.mark.parametrize("name", ["depot", "tb3_sandbox"])
def test_real_plans_keep_to_their_rasters(name: str, fuzzy_nav_data: Path) -> None:
    path = fuzzy_nav_data / "server_maps" / f"{name}.yaml"
    plan = load_floor_plan(path)
    occupancy, geometry = import_map_server(path)
    world = plan_world(plan, 1)
    x, y = geometry.centres()
    cell = geometry.resolution
    columns = slice(*np.searchsorted(x, (world.origin[0], world.origin[0] + world.size[0])))
    rows = slice(*np.searchsorted(y, (world.origin[1], world.origin[1] + world.size[1])))
    occupied = np.pad(occupancy != 0, 1, constant_values=True)
    beside = np.zeros(occupancy.shape, dtype=bool)
    for down, right in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        beside |= np.roll(occupied, (down, right), (0, 1))[1:-1, 1:-1] & (occupancy == 0)
    distance = world.still.distances(x[columns], y[rows])
    roomy = free_from(occupancy, beside)[rows, columns]
    # Free cells beside others lie half a cell from a wall, but for what was made straight.
    assert distance[beside[rows, columns] & roomy].max() <= (0.5 + SIMPLIFIED) * cell + 1e-9
    assert reachability(world, tolerance=GOAL_TOLERANCE) is Reachability.REACHABLE


def free_from(occupancy: np.ndarray, beside: np.ndarray) -> np.ndarray:
    """Free cells of the largest free region, the one that the robot is in."""
    largest = np.zeros(occupancy.shape, dtype=bool)
    seen = occupancy != 0
    for first in zip(*np.nonzero(beside), strict=True):
        if seen[first]:
            continue
        region, stack = [first], [first]
        seen[first] = True
        while stack:
            r, c = stack.pop()
            for row, column in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                inside = 0 <= row < seen.shape[0] and 0 <= column < seen.shape[1]
                if inside and not seen[row, column]:
                    seen[row, column] = True
                    region.append((row, column))
                    stack.append((row, column))
        if len(region) > largest.sum():
            largest[:] = False
            largest[tuple(np.array(region).T)] = True
    return largest
