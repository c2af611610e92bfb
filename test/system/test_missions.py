# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole missions, watched tick by tick and judged by the worlds' own coordinates."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from fuzzy_map_building.params import PAPER_PRESET
from fuzzy_map_building.types import Pose2
from nomad_sim.headless import CONTROL_PERIOD, HeadlessMission, MissionLog, random_start
from nomad_sim.reference import clutter
from nomad_sim.world import Circle, World
from nomad_sim.world_io import load_world

RADIUS = 0.23
#: A goal that cannot be reached is not driven to for as long as it is in earnest.
FEW = {"perception_cap": 20}

MISSIONS = {
    "lab": (lambda: load_world("lab"), 1, {}),
    "lab, by the paper": (lambda: load_world("lab"), 4, {"preset": PAPER_PRESET}),
    "slalom": (lambda: load_world("slalom"), 2, {}),
    "office": (lambda: load_world("office"), 3, {}),
    "clutter, by the paper": (lambda: clutter(1), 1, {"preset": PAPER_PRESET}),
    "unreachable": (lambda: load_world("unreachable"), 1, {"motion": FEW}),
}


@dataclass(frozen=True, eq=False)
class Watched:
    """A mission with what was true after each tick."""

    world: World
    mission: HeadlessMission
    log: MissionLog
    poses: list[Pose2]
    commands_ended: bool


@pytest.fixture(scope="module", params=MISSIONS)
def watched(request: pytest.FixtureRequest) -> Watched:
    make, seed, options = MISSIONS[request.param]
    world = make()
    mission = HeadlessMission(world, random_start(world, seed), seed=seed, **options)
    poses = [mission.simulator.pose]
    tick = mission.tick

    def noting() -> None:
        tick()
        poses.append(mission.simulator.pose)

    mission.tick = noting  # type: ignore[method-assign]
    log = mission.run()
    mission.tick = tick  # type: ignore[method-assign]
    for _ in range(10):  # after the verdict
        mission.tick()
        poses.append(mission.simulator.pose)
    still = poses[-1] == poses[-5]
    return Watched(world, mission, log, poses, still)


def distance_to_sides(points: np.ndarray, corners: np.ndarray, closed: bool) -> np.ndarray:
    """Distance [m] of each point to the nearest side, shape (n,), by projection on it."""
    nearest = np.full(len(points), np.inf)
    last = len(corners) if closed else len(corners) - 1
    for i in range(last):
        a, b = corners[i], corners[(i + 1) % len(corners)]
        along = b - a
        share = np.clip((points - a) @ along / (along @ along), 0.0, 1.0)
        foot = a + share[:, None] * along
        nearest = np.minimum(nearest, np.hypot(*(points - foot).T))
    return nearest


def inside(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Whether each point lies in a polygon, by the angle that its outline turns around it."""
    offset = corners[None, :, :] - points[:, None, :]
    angle = np.arctan2(offset[:, :, 1], offset[:, :, 0])
    turned = np.diff(angle, axis=1, append=angle[:, :1])
    turned = (turned + math.pi) % (2.0 * math.pi) - math.pi
    return np.abs(turned.sum(axis=1)) > math.pi


def clearance(world: World, points: np.ndarray) -> np.ndarray:
    """Distance of a body of `RADIUS` to all that lasts, shape (n,), negative inside."""
    free = np.full(len(points), np.inf)
    for wall in world.walls:
        free = np.minimum(free, distance_to_sides(points, wall.points, wall.closed))
    for polygon in world.polygons:
        free = np.minimum(free, distance_to_sides(points, polygon.points, closed=True))
        free[inside(points, polygon.points)] = -np.inf
    for circle in world.circles:
        assert isinstance(circle, Circle)
        far = np.hypot(points[:, 0] - circle.x, points[:, 1] - circle.y)
        free = np.minimum(free, far - circle.radius)
    return free - RADIUS


def test_the_verdict_is_true_and_nothing_was_touched(watched: Watched) -> None:
    log = watched.log
    assert log.truthful, log.message
    assert log.contacts == 0
    if log.reached:
        end = watched.poses[-1]
        assert math.hypot(end.x - log.goal[0], end.y - log.goal[1]) <= 0.3 + 0.02


def test_the_body_never_overlaps_an_obstacle(watched: Watched) -> None:
    points = np.array([(pose.x, pose.y) for pose in watched.poses])
    free = clearance(watched.world, points)
    assert free.min() > 0.0
    # The simulator, which looks five times a tick, agrees.
    assert watched.log.min_clearance <= free.min() + 1e-9
    assert watched.log.min_clearance == pytest.approx(free.min(), abs=0.01)


def test_the_way_is_driven_within_the_robot_s_limits(watched: Watched) -> None:
    x, y, theta = np.array([(p.x, p.y, p.theta) for p in watched.poses]).T
    steps = np.hypot(np.diff(x), np.diff(y))
    turns = (np.diff(theta) + math.pi) % (2.0 * math.pi) - math.pi
    assert steps.max() <= 0.6 * CONTROL_PERIOD + 1e-9  # 24 inches a second
    assert np.abs(turns).max() <= math.radians(60.0) * CONTROL_PERIOD + 1e-9
    assert watched.log.path_length == pytest.approx(steps.sum(), abs=0.05)
    # It drives the way that it faces, never sideways.
    moving = steps > 1e-4
    across = np.abs(
        -np.sin(theta[:-1] + 0.5 * turns) * np.diff(x)
        + np.cos(theta[:-1] + 0.5 * turns) * np.diff(y)
    )
    assert (across[moving] <= 0.05 * steps[moving] + 1e-6).all()
    assert watched.commands_ended  # after the verdict it stands


def test_maps_are_risks_and_only_what_was_near_has_changed(watched: Watched) -> None:
    log, mapper = watched.log, watched.mission.mapper
    for risk in (log.motion_risk, log.planning_risk):
        assert risk.shape == mapper.geometry.shape
        assert np.isfinite(risk).all()
        assert risk.min() >= 0.0
        assert risk.max() <= 1.0
    x, y = mapper.geometry.centres()
    nearest = np.min(
        [np.hypot(x[None, :] - e.pose.x, y[:, None] - e.pose.y) for e in log.entries], axis=0
    )
    # 1.5 m from the centres of the cones, which is the robot's.
    unseen = nearest > 1.5 + 0.05
    assert (log.motion_risk[unseen] == 1.0).all()
    assert (log.planning_risk[unseen] == 0.0).all()
    # Where the robot stood when it perceived is no obstacle.
    rows = [mapper.geometry.cell_of(e.pose.x, e.pose.y) for e in log.entries]
    assert max(log.planning_risk[cell] for cell in rows) < 0.9


def test_perceptions_come_in_order_and_each_says_why(watched: Watched) -> None:
    log = watched.log
    assert [e.perception for e in log.entries] == list(range(1, log.perceptions + 1))
    stamps = [e.stamp for e in log.entries]
    assert stamps == sorted(stamps)
    assert log.entries[0].stop.name == "NONE"
    assert {e.stop.name for e in log.entries[1:]} <= {"UNEXPLORED", "CLEARANCE"}
    assert all(0.6 - 1e-6 <= e.alpha <= 1.0 for e in log.entries[1:])


def test_most_of_what_is_believed_free_is_free(watched: Watched) -> None:
    """Cells that are safe to enter: few of them hold part of an obstacle."""
    truth = watched.mission.simulator.ground_truth_grid(watched.mission.mapper.geometry)
    safe = watched.log.motion_risk <= 0.9
    assert safe.sum() > 200
    assert truth[safe].mean() < 0.1
