# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Drawn worlds: the same for the same seed, valid, and what is said of them is true."""

import math
from collections import deque

import numpy as np
import pytest

from nomad_sim.ground_truth import Reachability
from nomad_sim.simulator import Simulator
from nomad_sim.world import World
from nomad_sim.worlds import KINDS, generate
from nomad_sim.worlds.draws import GOAL_TOLERANCE, MATERIAL_CLASSES

RADIUS = 0.23
SEEDS = range(4)


@pytest.fixture(scope="module")
def worlds() -> dict[tuple[str, int], World]:
    return {(kind, seed): generate(kind, seed) for kind in KINDS for seed in SEEDS}


def content(world: World) -> tuple[object, ...]:
    people = [(m.shape, m.waypoints.tolist(), m.perceptions) for m in world.moving]
    still = world.still.segments.tolist(), world.still.circles.tolist()
    values = dict(world.materials), dict(world.parameters), dict(world.properties)
    return (*still, people, *values, world.size, world.start, world.goal, world.expected)


@pytest.mark.parametrize("kind", KINDS)
def test_a_seed_gives_one_world_and_another_seed_another(
    kind: str, worlds: dict[tuple[str, int], World]
) -> None:
    assert content(generate(kind, 3)) == content(worlds[kind, 3])
    assert len({str(content(worlds[kind, seed])) for seed in SEEDS}) == len(SEEDS)


def test_start_and_goal_lie_in_the_area_and_leave_room(
    worlds: dict[tuple[str, int], World],
) -> None:
    for world in worlds.values():
        assert world.surfaces().distance(world.start.x, world.start.y) >= RADIUS + 0.1 - 1e-9
        assert 0.0 < world.goal[0] < world.size[0]
        assert 0.0 < world.goal[1] < world.size[1]
        assert math.dist((world.start.x, world.start.y), world.goal) >= 3.0
        assert world.still.distance(*world.goal) >= RADIUS


def test_what_was_drawn_is_what_is_there(worlds: dict[tuple[str, int], World]) -> None:
    for (kind, _), world in worlds.items():
        drawn = world.properties
        walls, things = MATERIAL_CLASSES[drawn["material"]]
        angles = {n: math.degrees(m.critical_angle) for n, m in world.materials.items()}
        assert walls[0] <= angles["painted_wall"] <= walls[1]
        assert things[0] <= angles["wood"] == angles["cardboard"] <= things[1]
        assert drawn["kind"] == kind
        half = Simulator(world).parameters.sonar.beam_half_angle
        assert half == pytest.approx(math.radians(drawn["beam"]))
        used = {s.material for s in (*world.walls, *world.polygons, *world.circles)}
        sees = Simulator(world).parameters.infrared.sees_glass
        assert drawn["glass"] == (("seen" if sees else "unseen") if "glass" in used else "none")
        assert drawn["people"] == len(world.moving)


@pytest.mark.parametrize("seed", range(12))
def test_the_door_of_a_slalom_is_its_narrowest_opening(seed: int) -> None:
    world = generate("slalom", seed)
    height = world.size[1] + 0.1  # between the outer walls
    screens: dict[float, float] = {}
    for polygon in world.polygons:
        (x0, y0), (_, y1) = polygon.points.min(axis=0), polygon.points.max(axis=0)
        if y0 < 0.0 or y1 > world.size[1]:  # not the walls about the goal
            screens[x0] = screens.get(x0, height) - (y1 - y0)
    if not world.properties["walled_in"]:
        assert world.properties["door"] == pytest.approx(min(screens.values()))
    assert 0.65 <= world.properties["door"] <= 1.0


def boundary_distances(world: World, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance of grid points to all lines and circles, whatever is inside."""
    points = np.stack(np.meshgrid(x, y), axis=-1)
    best = np.full(points.shape[:2], np.inf)
    for x0, y0, x1, y1 in world.still.segments:
        a, along = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
        share = np.clip((points - a) @ along / (along @ along), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - a - share[..., None] * along, axis=-1))
    for cx, cy, radius in world.still.circles:
        best = np.minimum(best, np.abs(np.hypot(x[None, :] - cx, y[:, None] - cy) - radius))
    return best


def connected(world: World, radius: float, spacing: float = 0.04) -> bool:
    """Whether points of a grid that are clear of every line lead to the goal."""
    x, y = (np.arange(0.0, length, spacing) for length in world.size)
    free = boundary_distances(world, x, y) >= radius
    at_goal = np.hypot(x[None, :] - world.goal[0], y[:, None] - world.goal[1]) <= GOAL_TOLERANCE
    first = round(world.start.y / spacing), round(world.start.x / spacing)
    queue, seen = deque([first]), {first}
    while queue:
        r, c = queue.popleft()
        if at_goal[r, c]:
            return True
        for row, column in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
            inside = 0 <= row < len(y) and 0 <= column < len(x)
            if inside and free[row, column] and (row, column) not in seen:
                seen.add((row, column))
                queue.append((row, column))
    return False


@pytest.mark.parametrize("kind", KINDS)
def test_the_truth_is_that_of_a_search_by_brute_force(
    kind: str, worlds: dict[tuple[str, int], World]
) -> None:
    """A grid of 4 cm shows ways up to 4 cm less wide than they are, and none wider."""
    for seed in range(2):
        world = worlds[kind, seed]
        truth, clearance = world.properties["truth"], world.properties["way_clearance"]
        if connected(world, RADIUS + 0.02):
            assert truth != Reachability.UNREACHABLE.value
        if truth == Reachability.REACHABLE.value:
            assert connected(world, RADIUS + clearance - 0.04)
        if truth == Reachability.UNREACHABLE.value:
            assert not connected(world, RADIUS + 0.02)
        assert world.expected == ("unreachable" if truth == "unreachable" else "reached")


def test_all_truths_are_drawn() -> None:
    drawn = [generate(kind, seed).properties for kind in KINDS for seed in range(8)]
    assert not any(p["truth"] == "reachable" for p in drawn if p["walled_in"])
    truths = [p["truth"] for p in drawn]
    assert {"reachable", "unreachable", "marginal"} == set(truths)
    assert truths.count("reachable") >= 0.75 * len(drawn)
    assert {p["material"] for p in drawn} == set(MATERIAL_CLASSES)


def test_people_stand_where_nobody_is_run_over_and_leave() -> None:
    found = 0
    for seed in range(10):
        world = generate("people", seed)
        for person in world.moving:
            found += 1
            for time in np.linspace(0.0, 20.0, 401):
                place = person.place(time, 0)
                assert place is not None
                # As far as the robot could have come meanwhile, while the person walks.
                reach = 0.6 * min(time, person.waypoints[-1, 0])
                far = math.dist(place, (world.start.x, world.start.y))
                assert far >= RADIUS + person.shape.radius + reach + 0.3
                assert world.still.distance(*place) >= person.shape.radius - 1e-9
            assert person.place(0.0, 20) is None
    assert found >= 10


def test_what_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(ValueError, match="did you mean 'office'"):
        generate("ofice", 1)
    with pytest.raises(ValueError, match="unknown kind of world 'None'"):
        generate(None, 1)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None])
def test_a_seed_is_a_whole_number(seed: object) -> None:
    with pytest.raises(ValueError, match=f"whole number from 0 on, got {seed!r}"):
        generate("office", seed)  # type: ignore[arg-type]
