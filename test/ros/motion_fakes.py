# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Scripted partners of the motion node: a robot without a world, a mapper, a planner.

All of them live in the probe's node and are driven by its thread; a test changes their
behaviour through plain attributes.
"""

from __future__ import annotations

import math
import time

import numpy as np
from fuzzy_msgs.action import BuildMap
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import OccupancyGrid
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Range

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import (
    create_steady_timer,
    stamp_from_seconds,
)
from fuzzy_map_building.ros.conversions import path_to_msg, pose_to_msg
from fuzzy_map_building.ros.map_conversions import grid_to_msg
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.planner import Planner
from fuzzy_navigation.search import warm_up
from ros.harness import Probe

#: Simulated time of one step [s].
STEP = 0.05
#: Wall time of a step that nobody answers, and least one of a step that is answered [s].
SLOWEST, FASTEST = 0.05, 0.005
GEOMETRY = GridGeometry(40, 30, 0.1)
FRAMES = ("infrared_0", "infrared_1")


class FakeRobot:
    """Does what it is told, exactly, and tells where it is; as fast as it is answered."""

    def __init__(self, probe: Probe) -> None:
        self.time = 10.0
        self.recover()
        self.forget()
        self._answered = False
        self._stepped = 0.0
        self._clock = probe.node.create_publisher(Clock, names.CLOCK, qos.CLOCK)
        self._pose = probe.node.create_publisher(PoseStamped, names.POSE, qos.RELIABLE)
        self.infrared = probe.node.create_publisher(Range, names.INFRARED, qos.RANGES)
        probe.node.create_subscription(Twist, names.CMD_VEL, self._on_command, qos.RELIABLE)
        create_steady_timer(probe.node, FASTEST, self._step)

    def recover(self) -> None:
        """Let everything work that a test has broken."""
        self.distance = math.inf
        self.clock_runs = self.poses_come = True
        self.pose_offset = 0.0
        self.infrared_come = [True, True]

    def forget(self) -> None:
        """Begin anew, at rest at the same place."""
        self.x, self.y, self.theta = 1.0, 1.0, 0.0
        #: (wall time, speed, turning rate) of each command, and wall time of each pose.
        self.commands: list[tuple[float, float, float]] = []
        self.poses: list[float] = []

    @property
    def idle(self) -> bool:
        """Whether nobody has commanded it for ten poses."""
        last = self.commands[-1][0] if self.commands else 0.0
        return sum(t > last for t in self.poses[-10:]) == 10

    @property
    def speed(self) -> float:
        """The speed commanded last [m/s]."""
        return self.commands[-1][1] if self.commands else 0.0

    @property
    def stands(self) -> bool:
        """Whether the last command was to stand."""
        return not self.commands or self.commands[-1][1:] == (0.0, 0.0)

    def halt(self) -> None:
        """Stop, as a robot does whose commands fail to come."""
        self.commands.append((time.monotonic(), 0.0, 0.0))

    def _on_command(self, message: Twist) -> None:
        self.commands.append((time.monotonic(), message.linear.x, message.angular.z))
        self._answered = True

    def _step(self) -> None:
        now = time.monotonic()
        if not self.clock_runs or now < self._stepped + (0.0 if self._answered else SLOWEST):
            return
        self._answered, self._stepped = False, now
        self.time += STEP
        if self.commands:
            _, v, omega = self.commands[-1]
            self.theta += omega * STEP
            self.x += v * STEP * math.cos(self.theta)
            self.y += v * STEP * math.sin(self.theta)
        stamp = stamp_from_seconds(self.time)
        self._clock.publish(Clock(clock=stamp))
        for frame, comes in zip(FRAMES, self.infrared_come, strict=True):
            if comes:
                message = Range(max_range=0.8, range=self.distance)
                message.header.frame_id, message.header.stamp = frame, stamp
                self.infrared.publish(message)
        if self.poses_come:
            self.poses.append(time.monotonic())
            stamp = stamp_from_seconds(self.time + self.pose_offset)
            self._pose.publish(pose_to_msg(Pose2(self.x, self.y, self.theta), stamp))


class FakeMapper:
    """Knows that everything is free, and says so when asked."""

    def __init__(self, probe: Probe, robot: FakeRobot, serves: bool = True) -> None:
        self._robot = robot
        self._probe = probe
        self.map_stamp = 0.0
        self.recover()
        self._maps = probe.node.create_publisher(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
        self._ends: list[tuple[float, Future]] = []
        self._late_map: float | None = None
        create_steady_timer(probe.node, FASTEST, self._step)
        if serves:
            self._server = ActionServer(
                probe.node,
                BuildMap,
                names.BUILD_MAP,
                self._execute,
                goal_callback=self._on_goal,
                cancel_callback=lambda _: CancelResponse.ACCEPT,
            )

    def recover(self) -> None:
        """Do what a mapper does, in a world without obstacles."""
        self.values = np.zeros(GEOMETRY.shape, np.int8)
        #: What to do with the next goals: succeed, abort, reject, hang, or succeed a while
        #: before the map comes (late_map).
        self.behaviour = "succeed"
        #: What it says when it aborts.
        self.reason = ""
        self.goals = 0
        self.cancelled = 0

    def leave(self) -> None:
        """Serve no more, without a word."""
        self._probe.run(self._server.destroy)

    def publish(self) -> None:
        """Publish the map with the stamp of now."""
        self.map_stamp = round(self._robot.time, 9)
        self._maps.publish(grid_to_msg(self.values, GEOMETRY, stamp_from_seconds(self.map_stamp)))

    def _on_goal(self, _: BuildMap.Goal) -> GoalResponse:
        self.goals += 1
        return GoalResponse.REJECT if self.behaviour == "reject" else GoalResponse.ACCEPT

    async def _execute(self, handle: ServerGoalHandle) -> BuildMap.Result:
        end: Future = Future()
        self._ends.append((self._robot.time + 4 * STEP, end))
        self._handle = handle
        await end
        if handle.is_cancel_requested:
            self.cancelled += 1
            handle.canceled()
        elif self.behaviour == "abort":
            handle.abort()
            return BuildMap.Result(message=self.reason)
        else:
            if self.behaviour == "late_map":
                self._late_map = self._robot.time + 10 * STEP
            else:
                self.publish()
            handle.succeed()
        return BuildMap.Result()

    def _step(self) -> None:
        """End the perceptions whose time has come."""
        if self._late_map is not None and self._robot.time >= self._late_map:
            self._late_map = None
            self.publish()
        for due, end in list(self._ends):
            over = self._robot.time >= due and self.behaviour != "hang"
            if over or self._handle.is_cancel_requested:
                self._ends.remove((due, end))
                end.set_result(None)


class FakePlanner:
    """Plans with the core on the mapper's map, or answers something else."""

    def __init__(self, probe: Probe, mapper: FakeMapper, serves: bool = True) -> None:
        self._mapper = mapper
        self.recover()
        warm_up()  # not in the thread that moves the robot
        if serves:
            probe.node.create_service(PlanPath, names.PLAN_PATH, self._on_request)

    def recover(self) -> None:
        """Do what a planner does."""
        self.requests: list[PlanPath.Request] = []
        #: Answers that still go out with the stamp of an older map.
        self.behind = 0
        #: Fields of the answer that differ from what the core says.
        self.changes: dict[str, object] = {}

    def _on_request(
        self, request: PlanPath.Request, response: PlanPath.Response
    ) -> PlanPath.Response:
        self.requests.append(request)
        planner = Planner(GEOMETRY)
        planner.set_map(self._mapper.values / 100.0)
        start, goal = request.start.pose.position, request.goal.pose.position
        result = planner.plan((start.x, start.y), (goal.x, goal.y), tolerance=request.tolerance)
        stamp = self._mapper.map_stamp
        if self.behind > 0:
            self.behind -= 1
            stamp -= 1.0
        response.status, response.message = int(result.status), result.message
        response.path = path_to_msg(result.poses, stamp_from_seconds(stamp))
        response.alpha = result.alpha
        for name, value in self.changes.items():
            setattr(response, name, value)
        return response
