# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion's callbacks: any messages, goals and answers, in any order; no wild command."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
from fuzzy_msgs.action import BuildMap, Navigate
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import Twist
from rclpy.action import CancelResponse, GoalResponse

from fuzz import messages
from fuzz.draw import Draw
from fuzz.motion_partners import Partner, Perception
from fuzz.nodes import Bench, GoalHandle, finished, node_of
from fuzz.surface import Surface, Target, check_words
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.parameter_schema import flatten
from fuzzy_map_building.ros import clock, conversions, map_conversions
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.control_tick import ControlTicks
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_types import Phase
from fuzzy_navigation.pose_time import PoseTime
from fuzzy_navigation.ros import motion_node
from fuzzy_navigation.ros.faulty_ranges import usable
from fuzzy_navigation.ros.motion_node import MotionNode

__all__ = ["SURFACES"]

MOST_CALLS = 16


class Commands:
    """Publishes commands, if the robot can drive them."""

    def __init__(self, node: MotionNode) -> None:
        self._node = node
        self._publish = node._cmd_vel.publish
        self.moving = False
        self.count = 0

    def __call__(self, message: Twist) -> None:
        self.count += 1
        limits = self._node._mission._p.follower
        linear, angular = message.linear.x, message.angular.z
        assert 0.0 <= linear <= limits.max_linear, f"speed {linear}"
        assert abs(angular) <= limits.max_angular, f"turning rate {angular}"
        self.moving = linear != 0.0 or angular != 0.0
        if self.moving:
            assert self._node._mission.active
            assert self._node._mission.phase is Phase.MOVING
        self._publish(message)


class Case:
    """One case: a motion without map or goal, and whatever happens to it."""

    def __init__(
        self, node: MotionNode, bench: Bench, commands: Commands, counts: Counter[str]
    ) -> None:
        self.node = node
        self.bench = bench
        self.commands = commands
        self.counts = counts
        bench.begin()
        p = node._change.in_force
        self.p = p
        node._ticks = ControlTicks(p.infrared.bearings)
        node._time = PoseTime()
        node._mission = Mission(p)
        node._map = None
        node._followed.forget()
        self.windows = 0
        self.info: dict[str, Any] = {}
        node._last_tick = -math.inf
        node._missions = 0
        node._verdicts.clear()
        node._server._missions.clear()
        node._server._running.clear()
        node._server._closed = False
        self.mapper = node._mapper._client = Partner()
        self.planner = node._planner._client = Partner()
        node._mapper._request = node._mapper._handle = None
        node._planner._plan = node._planner._future = None
        if node._echoes is not None:
            node._echoes._assembler.clear()
        commands.moving = False
        self.place = (0.55, 0.55)
        self.goals: list[GoalHandle] = []
        self.perceptions: list[Perception] = []

    def message(self, name: str, message: Any, check: Callable[[Any], Any]) -> None:
        """Hand a message to its callback; what conversions refuse moves nothing."""
        self.counts[name] += 1
        try:
            check(message)
            refused = False
        except conversions.Refused as error:
            check_words(error)
            refused = True
        rejected, feedback = self.bench.rejected(), self.node._mission.feedback()
        count = self.commands.count
        {
            "pose": self.node._on_pose,
            "infrared": self.node._on_infrared,
            "map": self.node._followed.on_map,
            "window": lambda m: self.node._followed.on_window(m, self.info),
        }[name](message)
        if refused:
            assert self.bench.rejected() == rejected + 1, f"{name} was not counted"
            assert self.commands.count == count, f"a refused {name} moved the robot"
            assert repr(self.node._mission.feedback()) == repr(feedback)

    def pose(self, draw: Draw) -> None:
        x, y = self.place
        if draw.byte() % 2:
            self.place = (x + draw.between(-0.05, 0.05), y + draw.between(-0.05, 0.05))
        message = messages.stamped_pose(draw, self.bench.now, *self.place)
        self.message("pose", message, conversions.stamped_pose_from_msg)

    def infrared(self, draw: Draw) -> None:
        frames = self.p.infrared.frame_ids
        message = messages.range_of(draw, self.bench.now, draw.choice(frames), 0.1)
        self.message(
            "infrared",
            message,
            lambda m: usable(conversions.range_from_msg(m, frames)),
        )

    def ring(self, draw: Draw) -> None:
        """A tick as a robot's sensors bring it, mostly."""
        self.bench.set(self.bench.now + 0.05)
        self.bench.wall += 0.05
        self.pose(draw)
        reach = draw.choice((math.inf, math.inf, 0.5, 0.06))
        stamp = stamp_from_seconds(self.bench.now)
        for frame in self.p.infrared.frame_ids:
            message = messages.range_of(Draw(b""), self.bench.now, frame, 0.1)
            message.header.stamp = stamp
            message.range = messages.float32(reach)
            self.node._on_infrared(message)

    def echo(self, draw: Draw) -> None:
        if self.node._echoes is None:
            return
        self.counts["sonar"] += 1
        sonar = self.p.sonar
        self.node._echoes._on_sonar(
            messages.range_of(
                draw, self.bench.now, draw.choice(sonar.frame_ids), sonar.field_of_view
            )
        )
        self.node._echoes._on_joint_state(
            messages.joint_state(draw, self.bench.now, self.p.turret.joint, 0.0)
        )

    def map(self, draw: Draw) -> None:
        values = draw.choice(((0,), (0, 0, 0, 20), (0, 100), (100,)))
        resolution = draw.choice((0.1, 0.1, 0.1, 0.02, 1e-3, 1e-6))
        message = messages.grid(draw, self.bench.now, 16, 12, resolution, values)
        stamp = clock.nanoseconds_from_stamp(message.header.stamp)
        if self.node._followed._follower.outdated(stamp):
            self.node._followed.on_map(message)  # not looked at
        else:
            self.message("map", message, map_conversions.risk_from_msg)

    def window(self, draw: Draw) -> None:
        """A window, mostly one that goes on from the map."""
        follower, area = self.node._followed._follower, self.node._mission._area
        geometry = area.geometry if area is not None else GridGeometry(16, 12, 0.1)
        self.windows += 1
        now = self.bench.now + 0.01 * self.windows
        message = messages.window(draw, now, geometry.width, geometry.height)
        self.info = messages.window_info(draw, follower._number)
        taken = follower.taken
        self.message("window", message, map_conversions.window_from_msg)
        if follower.taken > taken and area is self.node._mission._area and area is not None:
            self.counts["window taken"] += 1
            p = self.node._mission._p  # some that a case sets wait for the end of a mission
            rules = p.beta, p.robot_radius, p.augmentation
            codes = area.codes
            assert codes is not None
            whole = ExploredArea(geometry, codes, *rules, self.node._mission._pose)
            assert np.array_equal(area.cells, whole.cells)

    def goal(self, draw: Draw) -> None:
        x, y = draw.between(0.0, 1.6), draw.between(0.0, 1.2)
        message = messages.stamped_pose(draw, self.bench.now, x, y)
        active = self.node._mission.active
        if draw.byte() % 2:
            self.counts["goal_pose"] += 1
            self.node._on_goal_pose(message)
        else:
            self.counts["navigate"] += 1
            request = Navigate.Goal(goal=message)
            request.tolerance = messages.float32(draw.number(lambda: 0.1))
            server = self.node._server
            assert server._on_goal(request) is GoalResponse.ACCEPT
            handle = GoalHandle(len(self.goals) + 1, request)
            handle.start = server._execute
            self.goals.append(handle)
            handle.execute()
            assert handle.work is not None
            done, result = finished(handle.work)
            if done:
                handle.work = None
                assert result.message
                assert handle.state in ("aborted", "succeeded", "canceled")
                if result.outcome == Navigate.Result.FAILED and not active:
                    assert not self.node._mission.active, "a refused goal began a mission"
        if not self.node._mission.active:
            assert not self.commands.moving

    def cancel(self) -> None:
        self.counts["cancel"] += 1
        for goal in self.goals:
            if goal.is_active and self.node._server._on_cancel(goal) is CancelResponse.ACCEPT:
                goal.state = "canceling"

    def answer(self, draw: Draw) -> None:
        """The mapper or the planner answers, well, badly, or late."""
        if self.mapper.asked and draw.byte() % 2:
            self.counts["build_map_answer"] += 1
            _, future = self.mapper.asked.pop(0 if draw.byte() % 4 else -1)
            self.perceptions.append(Perception(not draw.one_in(6)))
            future.set_result(self.perceptions[-1])
        elif self.perceptions and draw.byte() % 2:
            perception = self.perceptions.pop(0)
            status = draw.byte() if draw.one_in(6) else draw.choice((4, 4, 4, 5, 6))
            result = BuildMap.Result(message=draw.text())
            perception.result.set_result(SimpleNamespace(status=status, result=result))
        elif self.planner.asked:
            self.counts["plan_answer"] += 1
            _, future = self.planner.asked.pop(0 if draw.byte() % 4 else -1)
            future.set_result(self._plan(draw))

    def _plan(self, draw: Draw) -> PlanPath.Response:
        response = PlanPath.Response(message=draw.text())
        response.status = draw.byte() if draw.one_in(8) else draw.choice((0, 0, 0, 1, 2, 3, 4, 5))
        response.alpha = messages.float32(draw.number(lambda: draw.choice((0.6, 1.0))))
        response.path.header.stamp = stamp_from_seconds(max(0.0, self.bench.now))
        response.path.header.frame_id = draw.text() if draw.one_in(12) else "map"
        column, row = round(self.place[0] / 0.1 - 0.5), round(self.place[1] / 0.1 - 0.5)
        for _ in range(draw.below(12)):
            pose = pose_to_msg(Pose2(0.1 * column + 0.05, 0.1 * row + 0.05), stamp_from_seconds(1))
            if draw.one_in(12):
                pose.pose.position.x = draw.float64()
            response.path.poses.append(pose)
            column += draw.choice((1, 1, 0, 1, -1, 40))
            row += draw.choice((0, 0, 1, -1))
        return response

    def good_luck(self, draw: Draw) -> None:
        """What partners do that work, so that missions come far."""
        for _ in range(3):
            self.node._watch()
            for _, future in self.mapper.asked:
                perception = Perception(True)
                future.set_result(perception)
                perception.result.set_result(
                    SimpleNamespace(status=4, result=BuildMap.Result(message=""))
                )
            self.mapper.asked.clear()
            free = messages.grid(Draw(b""), self.bench.now, 16, 12, 0.1, (0,))
            self.node._followed.on_map(free)
            asked, self.planner.asked = self.planner.asked, []
            for _, future in asked:
                response = self._plan(Draw(bytes([1, 0, 1, 0, 0, 6]) + bytes(60)))
                response.status, response.alpha = PlanPath.Response.FOUND, 0.6
                future.set_result(response)
        for _ in range(draw.below(8)):
            self.ring(Draw(b""))

    def step(self, draw: Draw) -> None:
        """One thing that happens."""
        kind = draw.byte() % 26
        if kind <= 3:
            self.ring(draw)
        elif kind <= 7:
            (self.pose, self.pose, self.infrared, self.echo)[kind - 4](draw)
        elif kind <= 10:
            self.map(draw)
        elif kind <= 12:
            self.goal(draw)
        elif kind == 13:
            self.cancel()
        elif kind <= 16:
            self.answer(draw)
        elif kind <= 18:
            self.good_luck(draw)
        elif kind <= 20:
            self.bench.wait(draw)
            self.node._watch()
        elif kind == 21:
            partner = draw.choice((self.mapper, self.planner))
            partner.ready = bool(draw.byte() % 2)
        elif kind == 22:
            self.node._diagnostics.publish()
        elif kind >= 24:
            self.window(draw)
        else:
            self.node._watch()

    def end(self) -> None:
        """Whatever went before: stopped, the robot stands and each goal has one result."""
        self.node.on_stop()
        assert not self.commands.moving
        assert not self.node._mission.active
        for goal in self.goals:
            if goal.work is not None:
                done, result = finished(goal.work)
                assert done
                assert result.message
            assert not goal.is_active
        assert not self.node._server._running
        assert not self.node._verdicts


@contextlib.contextmanager
def _opened(counts: Counter[str]) -> Iterator[Target]:
    parameters = {"preset": "consistent"}
    clocks = [clock, motion_node]
    with node_of(MotionNode, parameters, clocks) as (node, bench):
        names = [*flatten(node._settings.values), "preset"]
        start = node._settings.values
        known = [name for name in flatten(start) if not node.describe_parameter(name).read_only]
        good = [p.to_parameter_msg() for p in node.get_parameters(known)]
        commands = Commands(node)
        node._cmd_vel = SimpleNamespace(
            publish=commands, wait_for_all_acked=node._cmd_vel.wait_for_all_acked
        )

        def target(data: bytes) -> None:
            draw = Draw(data)
            node._mission = Mission(node._settings.values)
            if node._settings.values != start:
                bench.set_parameters(good)
            case = Case(node, bench, commands, counts)
            if draw.byte() % 4:  # a robot that stands in a known place with a goal
                case.ring(Draw(b""))
                node._followed.on_map(messages.grid(Draw(b""), bench.now, 16, 12, 0.1, (0,)))
                case.goal(Draw(bytes([0, 192, 0, 128])))
            for _ in range(MOST_CALLS):
                if not draw.left:
                    break
                if draw.one_in(24):
                    bench.ask_parameters(draw, names, counts)
                case.step(draw)
            case.end()

        yield target


def _seeds() -> list[bytes]:
    return [
        bytes([1, 0, 17, 7] + [0, 0] * 8),
        bytes([1, 0, 17, 7, 0, 17, 7, 0, 13, 0, 11, 0, 0, 0, 0, 0, 17, 5]),
        bytes(range(256)),
        bytes(range(255, 0, -1)),
        bytes([0] + [0, 11, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0] * 6),
        bytes([1] + [0, 23, 0, 14, 1, 1, 0, 15, 1, 1, 0, 0, 9, 0, 0, 0, 16, 0, 0] * 4),
    ]


_COUNTS: Counter[str] = Counter()
SURFACES = (Surface("motion", lambda: _opened(_COUNTS), _seeds, longest=256, counts=_COUNTS),)
