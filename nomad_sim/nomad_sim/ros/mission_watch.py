# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sends a goal through the action ``navigate`` and records what happens on the way."""

from __future__ import annotations

import contextlib
import math
import threading
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Final

import numpy as np
import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.action import BuildMap, Navigate
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from unique_identifier_msgs.msg import UUID

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp
from fuzzy_map_building.ros.conversions import (
    path_from_msg,
    pose_to_msg,
    stamped_pose_from_msg,
)
from fuzzy_map_building.ros.map_conversions import grid_from_msg
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import LogEntry, Outcome, Phase, Stop
from nomad_sim.ros.mission_record import MapSnapshot, MissionRecord, Verdict

__all__ = ["MissionWatch", "spinning"]

#: Length of the way between two points that are kept of it [m].
SPACING: Final = 0.01
#: Decimals that a float32 carries.
DECIMALS: Final = 6


class MissionWatch(Node):
    """Watches a mission as any client of the nodes could.

    Callbacks run in the thread that spins the node, and so does what sends requests: rclpy
    loses an answer that comes before the request is in its books. Attributes may be read
    from any thread.

    Parameters
    ----------
    on_perception : callable
        Called with each perception when it is told of, and with what the robot does next.
    wanted : mapping of str to sequence of str
        Parameters to ask for, by name of the node.

    Attributes
    ----------
    record : MissionRecord
        What has been seen so far.
    failure : str
        Why there will be no verdict; empty if nothing is wrong.
    over : threading.Event
        Set when there is a verdict or a failure.
    """

    def __init__(
        self,
        on_perception: Callable[[LogEntry, Phase], None],
        wanted: Mapping[str, Sequence[str]],
    ) -> None:
        super().__init__("demo")
        self.record = MissionRecord()
        self.failure = ""
        self.over = threading.Event()
        self._motion_hears = False
        self._on_perception = on_perception
        self._wanted = wanted
        self._parameter_clients = {
            node: self.create_client(GetParameters, f"{node}/get_parameters") for node in wanted
        }
        self._navigate = ActionClient(self, Navigate, names.NAVIGATE)
        self._goal = UUID(uuid=list(uuid.uuid4().bytes))
        # Not by the client, which drops the feedback that comes after the result.
        self.create_subscription(
            Navigate.Impl.FeedbackMessage,
            f"{names.NAVIGATE}/_action/feedback",
            self._on_feedback,
            qos.RELIABLE,
        )
        self._build_map = ActionClient(self, BuildMap, names.BUILD_MAP)
        self._plan_path = self.create_client(PlanPath, names.PLAN_PATH)
        self.create_subscription(
            PoseStamped, names.GROUND_TRUTH_POSE, self._on_true_pose, qos.RELIABLE
        )
        self.create_subscription(
            DiagnosticArray, names.DIAGNOSTICS, self._on_diagnostics, qos.RELIABLE
        )
        for topic, maps in (
            (names.MOTION_MAP, self.record.motion_maps),
            (names.PLANNING_MAP, self.record.planning_maps),
        ):
            on_map = partial(self._on_map, maps)
            self.create_subscription(OccupancyGrid, topic, on_map, qos.LATCHED)
        self.create_subscription(Path, names.PLAN, self._on_plan, qos.LATCHED)

    @property
    def missing(self) -> str:
        """Which of the four nodes are not there yet, '' when all are.

        The motion is there once it hears the robot: as fast as possible, much of the robot's
        time may pass before, in which a goal would be given up.
        """
        there = {
            "sim": self.record.pose is not None and bool(self.record.simulator),
            "mapper": bool(self.record.motion_maps) and self._build_map.server_is_ready(),
            "planner": self._plan_path.service_is_ready(),
            "motion": self._motion_hears and self._navigate.server_is_ready(),
        }
        there.update(
            (node, client.service_is_ready())
            for node, client in self._parameter_clients.items()
            if all(there.values())
        )
        return ", ".join(name for name, ready in there.items() if not ready)

    def ask_parameters(self) -> None:
        """Have the parameters recorded; to be called when no node is missing."""
        self.executor.create_task(self._ask_parameters)

    def _ask_parameters(self) -> None:
        for node, client in self._parameter_clients.items():
            request = GetParameters.Request(names=list(self._wanted[node]))
            client.call_async(request).add_done_callback(partial(self._on_parameters, node))

    def send_goal(self, goal: tuple[float, float]) -> None:
        """Send the robot to (x, y) [m]; once."""
        self.executor.create_task(self._send_goal, goal)

    def _send_goal(self, goal: tuple[float, float]) -> None:
        self.record.started = self.record.time
        message = Navigate.Goal(goal=pose_to_msg(Pose2(*goal), Time()))
        future = self._navigate.send_goal_async(message, goal_uuid=self._goal)
        future.add_done_callback(self._on_answer)

    def _on_parameters(self, node: str, future: Future) -> None:
        values = [parameter_value_to_python(value) for value in future.result().values]
        self.record.parameters[node] = dict(zip(self._wanted[node], values, strict=True))

    def _on_answer(self, future: Future) -> None:
        handle: ClientGoalHandle = future.result()
        if handle.accepted:
            handle.get_result_async().add_done_callback(self._on_result)
        else:
            self.failure = "the motion node rejected the goal"
            self.over.set()

    def _on_result(self, future: Future) -> None:
        result: Navigate.Result = future.result().result
        self.record.verdict = Verdict(
            outcome=Outcome(result.outcome),
            message=result.message,
            perceptions=result.perceptions,
            path_length=round(result.path_length, DECIMALS),
            min_clearance=round(result.min_clearance, DECIMALS),
            duration=round(result.duration, DECIMALS),
        )
        self.over.set()

    def _on_feedback(self, message: Any) -> None:
        feedback: Navigate.Feedback = message.feedback
        log = self.record.log
        if message.goal_id != self._goal or feedback.perceptions <= self.record.perceptions:
            return
        stamp, pose = stamped_pose_from_msg(feedback.pose)
        # After a perception for which the robot stood it plans before it moves.
        on_the_way = feedback.phase == Navigate.Feedback.MOVING
        entry = LogEntry(
            perception=feedback.perceptions,
            stamp=stamp,
            pose=pose,
            stop=Stop.NONE if on_the_way else Stop(feedback.last_stop),
            alpha=round(feedback.alpha, DECIMALS),
            distance_remaining=round(feedback.distance_remaining, DECIMALS),
            on_the_way=on_the_way,
        )
        log.append(entry)
        self._on_perception(entry, Phase(feedback.phase))

    def _on_true_pose(self, message: PoseStamped) -> None:
        self.record.time, pose = stamped_pose_from_msg(message)
        self.record.pose = pose
        way = self.record.way
        if not way or math.dist(way[-1][1:], (pose.x, pose.y)) >= SPACING:
            way.append((self.record.time, pose.x, pose.y))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == names.SIMULATOR_NODE:
                self.record.simulator = {pair.key: pair.value for pair in status.values}
            elif status.name == names.MOTION_NODE:
                self._motion_hears |= any(pair.key == "ticks" for pair in status.values)

    def _on_map(self, maps: list[MapSnapshot], message: OccupancyGrid) -> None:
        maps.append(MapSnapshot(seconds_from_stamp(message.header.stamp), *grid_from_msg(message)))

    def _on_plan(self, message: Path) -> None:
        path = np.array([(p.x, p.y) for p in path_from_msg(message)]).reshape(-1, 2)
        self.record.plans.append((seconds_from_stamp(message.header.stamp), path))


@contextlib.contextmanager
def spinning(
    on_perception: Callable[[LogEntry, Phase], None],
    wanted: Mapping[str, Sequence[str]],
    domain: int,
) -> Iterator[MissionWatch]:
    """Have a `MissionWatch` spun by a thread of its own while the context is open.

    Parameters
    ----------
    on_perception, wanted
        See `MissionWatch`.
    domain : int
        ROS domain.

    Raises
    ------
    Exception
        At the end, whatever a callback has raised.
    """
    rclpy.init(args=[], domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    watch = MissionWatch(on_perception, wanted)
    executor = SingleThreadedExecutor()
    executor.add_node(watch)
    stop = threading.Event()
    faults: list[BaseException] = []

    def spin() -> None:
        try:
            while not stop.is_set():
                executor.spin_once(timeout_sec=0.1)
        except Exception as fault:
            faults.append(fault)
            watch.failure = f"{type(fault).__name__}: {fault}"
            watch.over.set()

    thread = threading.Thread(target=spin, name="watch")
    thread.start()
    try:
        yield watch
    finally:
        stop.set()
        thread.join()
        executor.shutdown()
        watch.destroy_node()
        rclpy.try_shutdown()
    if faults:
        raise faults[0]
