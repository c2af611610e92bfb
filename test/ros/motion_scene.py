# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A motion node's process among its scripted partners."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.action import Navigate
from geometry_msgs.msg import PoseStamped
from rclpy.action.client import ClientGoalHandle

from fuzzy_map_building.ros import names, qos
from ros.harness import START_DEADLINE, NodeProcess, Probe, Received, wait_until
from ros.motion_fakes import FRAMES, FakeMapper, FakePlanner, FakeRobot

RESULT = Navigate.Result
PARAMETERS: dict[str, Any] = {
    "use_sim_time": True,
    "infrared.frame_ids": list(FRAMES),
    "infrared.bearings": [0.0, math.pi],
    "sonar.frame_ids": ["sonar_0"],
    "sonar.bearings": [0.0],
    "sonar_guard.enabled": False,
    "timeout.lost": 3.0,
    "timeout.server": 0.5,
    "attempts": 2,
}


def goal_at(x: float, y: float, frame: str = "map") -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y = x, y
    return message


class Scene:
    """A motion process, its scripted partners, and what the tests say and hear."""

    def __init__(
        self, probe: Probe, motion: NodeProcess, mapper: bool = True, planner: bool = True
    ) -> None:
        self.probe = probe
        self.motion = motion
        self.robot = FakeRobot(probe)
        self.mapper = FakeMapper(probe, self.robot, serves=mapper)
        self.planner = FakePlanner(probe, self.mapper, serves=planner)
        self.diagnostics: Received[DiagnosticArray] = probe.subscribe(
            DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE
        )
        self.feedback: list[Navigate.Feedback] = []
        self._handles: list[ClientGoalHandle] = []
        self._client = probe.action_client(Navigate, names.NAVIGATE)
        # From here on the node hears the poses: it complains as long as it does not.
        self.diagnostics.wait_for(
            lambda array: "nothing comes" not in array.status[0].message, START_DEADLINE
        )

    def reset(self) -> None:
        """Make a new start: nobody has a goal, and every partner does what it should."""
        self.robot.recover()
        self.mapper.recover()
        self.planner.recover()
        for handle in self._handles:
            handle.cancel_goal_async()
            self.result(handle)
        self._handles.clear()
        wait_until(lambda: self.robot.idle, "the motion to fall silent")
        self.robot.forget()
        wait_until(lambda: len(self.robot.poses) > 3, "the motion to hear where the robot is")
        self.feedback.clear()

    def close(self) -> None:
        """End the actions while the motion still runs."""
        self.probe.end_actions()

    def send(self, goal: PoseStamped, tolerance: float = 0.0) -> Any:
        """Send a goal and return its handle."""
        handle = self.probe.send_goal(
            self._client,
            Navigate.Goal(goal=goal, tolerance=tolerance),
            lambda message: self.feedback.append(message.feedback),
        )
        self._handles.append(handle)
        return handle

    def result(self, handle: Any) -> Any:
        """Return status and result of a goal."""
        return self.probe.result_of(handle.get_result_async(), "a verdict", 60.0)

    def go(self, x: float, y: float) -> Any:
        """Send a goal and wait until the robot drives."""
        handle = self.send(goal_at(x, y))
        wait_until(lambda: self.robot.speed > 0.1, "the robot to drive")
        return handle

    def values(self) -> dict[str, str]:
        """Return what the node's next diagnostics say."""
        self.diagnostics.clear()
        array = self.diagnostics.wait_for()
        return {v.key: v.value for v in array.status[0].values}

    def problem(self, text: str) -> None:
        """Wait until the diagnostics name a problem."""
        self.diagnostics.wait_for(lambda array: text in array.status[0].message, what=text)

    def counts(self, **expected: int) -> None:
        """Wait until the diagnostics show these counts of refusals by topic and reason."""
        wanted = {f"rejected.{key.replace('__', '.')}": str(n) for key, n in expected.items()}

        def shown(array: DiagnosticArray) -> dict[str, str]:
            return {v.key: v.value for v in array.status[0].values if "rejected" in v.key}

        try:
            self.diagnostics.wait_for(lambda array: wanted.items() <= shown(array).items())
        except AssertionError as error:
            raise AssertionError(f"{shown(self.diagnostics.last)}, wanted {wanted}") from error


@contextlib.contextmanager
def staged(log: Path) -> Iterator[Scene]:
    """Run a motion process with all its partners; it has to end cleanly."""
    probe = Probe()
    motion = NodeProcess("motion", log, parameters=PARAMETERS)
    try:
        scene = Scene(probe, motion)
        yield scene
        scene.close()
        motion.assert_clean_stop()
    finally:
        motion.close()
        probe.close()
