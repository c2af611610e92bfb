# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The action ``navigate``: goals in, feedback and verdicts out.

A goal that cannot be is accepted and at once aborted with the outcome FAILED: a rejection
could not say why.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from builtin_interfaces.msg import Time
from fuzzy_msgs.action import Navigate
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_navigation.mission_types import Feedback, Finish, Outcome

__all__ = ["Begin", "NavigateServer"]

#: Begins a mission to a goal with a tolerance [m, 0: the parameter]; the callable gets the
#: verdict. Returns the mission's serial number, raises ValueError for a goal that cannot be.
Begin = Callable[[PoseStamped, float, Callable[[Finish], None]], int]


class NavigateServer:
    """Serves the action; knows nothing of how a mission is done.

    Parameters
    ----------
    node : Node
        Whose action it is.
    begin : callable
        See `Begin`.
    cancel : callable
        ``cancel(mission)`` makes the robot stand and ends the mission; returns whether there
        was anything to end.
    """

    def __init__(self, node: Node, begin: Begin, cancel: Callable[[int], bool]) -> None:
        self._begin = begin
        self._cancel = cancel
        self._missions: dict[bytes, int] = {}
        self._running: dict[int, ServerGoalHandle] = {}
        self._closed = False
        self._server = ActionServer(
            node,
            Navigate,
            names.NAVIGATE,
            execute_callback=self._execute,
            goal_callback=self._on_goal,
            cancel_callback=self._on_cancel,
            goal_service_qos_profile=qos.REQUESTS,
            result_service_qos_profile=qos.REQUESTS,
            cancel_service_qos_profile=qos.REQUESTS,
        )

    def close(self) -> None:
        """Reject every goal from now on."""
        self._closed = True

    def report(self, mission: int, feedback: Feedback, stamp: Time) -> None:
        """Publish the state of a mission, if it is one that was begun by the action."""
        handle = self._running.get(mission)
        if handle is None or not handle.is_active or feedback.pose is None:
            return
        handle.publish_feedback(
            Navigate.Feedback(
                phase=int(feedback.phase),
                last_stop=int(feedback.last_stop),
                perceptions=feedback.perceptions,
                alpha=feedback.alpha,
                distance_remaining=feedback.distance_remaining,
                pose=pose_to_msg(feedback.pose, stamp),
            )
        )

    def _on_goal(self, _: Navigate.Goal) -> GoalResponse:
        return GoalResponse.REJECT if self._closed else GoalResponse.ACCEPT

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        mission = self._missions.get(bytes(handle.goal_id.uuid))
        # Without a mission it has not begun yet, and will not.
        if mission is None or self._cancel(mission):
            return CancelResponse.ACCEPT
        return CancelResponse.REJECT

    async def _execute(self, handle: ServerGoalHandle) -> Navigate.Result:
        if handle.is_cancel_requested:
            handle.canceled()
            return _nothing_done(Navigate.Result.CANCELED, "cancelled before it began")
        verdict = Future()
        key = bytes(handle.goal_id.uuid)
        try:
            mission = self._begin(
                handle.request.goal, handle.request.tolerance, verdict.set_result
            )
        except ValueError as error:
            handle.abort()
            return _nothing_done(Navigate.Result.FAILED, str(error))
        self._missions[key], self._running[mission] = mission, handle
        finish: Finish = await verdict
        del self._missions[key], self._running[mission]
        if finish.outcome is Outcome.REACHED:
            handle.succeed()
        elif handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()  # also where a newer goal took its place
        return Navigate.Result(
            outcome=int(finish.outcome),
            message=finish.message,
            perceptions=finish.perceptions,
            path_length=finish.path_length,
            min_clearance=finish.min_clearance,
            duration=finish.duration,
        )


def _nothing_done(outcome: int, message: str) -> Navigate.Result:
    """Return the result of a goal for which the robot did nothing, and measured nothing."""
    return Navigate.Result(outcome=outcome, message=message, min_clearance=math.inf)
