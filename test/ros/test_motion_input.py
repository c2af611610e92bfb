# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion as a process: what it must not take."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import Range

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_map_building.ros.map_conversions import grid_to_msg
from fuzzy_map_building.types import Pose2
from ros.motion_fakes import FRAMES, GEOMETRY
from ros.motion_scene import RESULT, Scene, goal_at, staged


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Scene]:
    """One process for all tests of this module."""
    with staged(tmp_path_factory.mktemp("motion") / "motion.log") as scene:
        yield scene


@pytest.fixture
def scene(stage: Scene) -> Scene:
    """The process without a goal, the robot where it began."""
    stage.reset()
    return stage


def test_bad_goals_are_refused_and_the_running_one_goes_on(scene: Scene) -> None:
    good = scene.go(3.5, 2.5)
    tilted = goal_at(2.0, 2.0)
    tilted.pose.orientation.x, tilted.pose.orientation.w = 1.0, 0.0
    bad = [
        (goal_at(2.0, 2.0, "odom"), 0.0, "frame 'odom', expected 'map'"),
        (goal_at(math.nan, 2.0), 0.0, "not finite"),
        (goal_at(2.0, math.inf), 0.0, "not finite"),
        (goal_at(-1.0, 2.0), 0.0, "outside the map"),
        (goal_at(4.05, 2.0), 0.0, "outside the map"),
        (goal_at(2.0, 1e9), 0.0, "beyond"),
        (tilted, 0.0, "tilted"),
        (goal_at(2.0, 2.0), -0.1, "tolerance"),
        (goal_at(2.0, 2.0), 1e-9, "tolerance"),
        (goal_at(2.0, 2.0), math.nan, "tolerance"),
        (goal_at(2.0, 2.0), math.inf, "tolerance"),
    ]
    for goal, tolerance, reason in bad:
        answer = scene.result(scene.send(goal, tolerance))
        assert answer.status == GoalStatus.STATUS_ABORTED
        assert answer.result.outcome == RESULT.FAILED
        assert reason in answer.result.message
        assert answer.result.min_clearance == math.inf  # nothing was measured
    scene.counts(
        navigate__wrong_frame=1,
        navigate__not_finite=2,
        navigate__outside=2,
        navigate__too_far=1,
        navigate__tilted=1,
        navigate__bad_request=4,
    )
    goals = scene.probe.publisher(PoseStamped, names.GOAL_POSE, qos.RELIABLE)
    goals.publish(goal_at(math.nan, 0.0))
    scene.counts(goal_pose__not_finite=1)
    assert scene.result(good).result.outcome == RESULT.REACHED


def test_bad_poses_and_ranges_are_refused_and_counted(scene: Scene) -> None:
    handle = scene.go(3.5, 2.5)
    poses = scene.probe.publisher(PoseStamped, names.POSE, qos.RELIABLE)
    # A new publisher of best effort would lose what it sends before all know it.
    ranges = scene.robot.infrared

    def pose(x: float, stamp: float, frame: str = "map") -> PoseStamped:
        return pose_to_msg(Pose2(x, 1.0), stamp_from_seconds(stamp), frame)

    nan = pose(1.0, scene.robot.time)
    nan.pose.position.x = math.nan
    unstamped = pose(1.0, 0.0)
    now = scene.robot.time
    for message in (
        pose(9.0, now, "odom"),
        nan,
        unstamped,
        pose(9.0, now + 100.0),
        pose(9.0, now - 0.1),
    ):
        poses.publish(message)
    near = {"range": 0.01, "max_range": 0.8}
    for frame, stamp in (
        ("infrared_7", now),
        ("", now),
        ("infrared_0", 0.0),
        ("infrared_0", now + 100.0),
        ("infrared_0", now - 0.1),
    ):
        message = Range(**near)
        message.header.frame_id = frame
        message.header.stamp = stamp_from_seconds(stamp)
        ranges.publish(message)
    for value in (math.nan, -0.5):
        faulty = Range(range=value, max_range=0.8)
        # Of now, not of before: the robot goes on, and what is older than its readings is late.
        faulty.header.stamp = stamp_from_seconds(scene.robot.time + 0.01)
        faulty.header.frame_id = FRAMES[0]
        ranges.publish(faulty)
    scene.counts(
        pose__wrong_frame=1,
        pose__not_finite=1,
        pose__no_stamp=1,
        pose__future=1,
        infrared__unknown_frame=2,
        infrared__no_stamp=1,
        infrared__future=1,
        infrared__out_of_order=1,
        infrared__faulty=2,
    )
    refused = scene.values()
    # Where the node is slow to hear it, it is too late as well.
    old = [refused.get(f"rejected.pose.{why}", "0") for why in ("out_of_order", "late")]
    assert sorted(old) == ["0", "1"]
    # None of them moved or stopped the robot.
    result = scene.result(handle).result
    assert (result.outcome, result.min_clearance) == (RESULT.REACHED, math.inf)


def test_bad_maps_are_refused_and_the_good_one_stays(scene: Scene) -> None:
    handle = scene.go(3.5, 2.5)
    maps = scene.probe.publisher(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
    stamp = stamp_from_seconds(scene.robot.time)
    wall = np.full(GEOMETRY.shape, 100, np.int8)

    def broken(change: Callable[[OccupancyGrid], None]) -> OccupancyGrid:
        message = grid_to_msg(wall, GEOMETRY, stamp)
        change(message)
        return message

    def set_frame(message: OccupancyGrid) -> None:
        message.header.frame_id = "odom"

    def turn(message: OccupancyGrid) -> None:
        message.info.origin.orientation.z, message.info.origin.orientation.w = 0.6, 0.8

    def shrink(message: OccupancyGrid) -> None:
        message.info.width = 7

    def empty(message: OccupancyGrid) -> None:
        message.info.width = message.info.height = 0
        message.data = []

    unknown = grid_to_msg(np.full(GEOMETRY.shape, -1, np.int8), GEOMETRY, stamp)
    future = grid_to_msg(wall, GEOMETRY, stamp_from_seconds(scene.robot.time + 1000.0))
    reasons = ["wrong_frame", "rotated", "size", "geometry", "unknown", "future"]
    messages = [*map(broken, (set_frame, turn, shrink, empty)), unknown, future]
    for reason, message in zip(reasons, messages, strict=True):
        maps.publish(message)
        scene.counts(**{f"motion_map__{reason}": 1})
    assert scene.result(handle).result.outcome == RESULT.REACHED
