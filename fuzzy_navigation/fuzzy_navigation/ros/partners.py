# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion's two partners, asked without ever waiting: the mapper and the planner.

Each client has at most one request in hand. A newer one replaces it, and answers to what
was replaced are not passed on. `watch` has to be called several times a second: it sends
what could not be sent yet and gives up when a partner is missing.

A partner that was killed says no farewell: for up to 20 s it seems to be there, and when it was
started anew meanwhile, for ever. What was asked of it is then never answered. So each client
looks at who publishes a topic that its partner publishes; somebody new there has not heard the
request.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time
from fuzzy_msgs.action import BuildMap
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import Point
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.clock import PatientTime, seconds_from_stamp
from fuzzy_map_building.ros.conversions import path_from_msg, pose_to_msg
from fuzzy_navigation.agreement import disagreement
from fuzzy_navigation.mission_types import Plan
from fuzzy_navigation.planner import PlanResult, PlanStatus

__all__ = ["MapperClient", "PlannerClient", "plan_result"]

_ENDS: Final = {GoalStatus.STATUS_ABORTED: "aborted", GoalStatus.STATUS_CANCELED: "canceled"}
#: Decimals that a float32 carries: 0.7 must not arrive as 0.699999988.
_DECIMALS: Final = 6


class _Renewal:
    """Notices that a partner was started anew.

    Parameters
    ----------
    node : Node
        Who looks.
    topic : str
        A topic that the partner publishes.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._node = node
        self._topic = topic
        self._known: frozenset[bytes] = frozenset()

    def begin(self) -> None:
        """Take note of who is there now."""
        self._known = self._publishers()

    def happened(self) -> bool:
        """Whether somebody is there who was not at the beginning."""
        return not self._publishers() <= self._known

    def _publishers(self) -> frozenset[bytes]:
        infos = self._node.get_publishers_info_by_topic(self._topic)
        return frozenset(bytes(info.endpoint_gid) for info in infos)


class MapperClient:
    """Has the mapper make perceptions, by the action ``build_map``.

    Parameters
    ----------
    node : Node
        Whose client it is.
    on_end : callable
        ``on_end(request, ok, message)``, called once for each request that was not replaced.
    """

    def __init__(self, node: Node, on_end: Callable[[int, bool, str], None]) -> None:
        self._client = ActionClient(node, BuildMap, names.BUILD_MAP)
        self._renewal = _Renewal(node, f"{names.BUILD_MAP}/_action/status")
        self._time = PatientTime(0.0)
        self._on_end = on_end
        self._request: int | None = None
        self._deadline = 0.0
        self._sent = False
        # A goal whose end has not come; the mapper rejects a second one.
        self._handle: ClientGoalHandle | None = None

    def ask(self, request: int, limit: float) -> None:
        """Ask for a perception; `limit` is how long the mapper may be missing [s of wall time]."""
        self.cancel()
        self._request, self._sent = request, False
        self._deadline = self._time.read(math.inf) + limit
        self.watch()

    def cancel(self) -> None:
        """End the perception that was asked for, if any; nothing more comes of it."""
        self._request = None
        if self._handle is not None:
            self._handle.cancel_goal_async()

    def watch(self) -> None:
        """Send what could not be sent yet; give up when the mapper is missing."""
        now, ready = self._time.read(math.inf), self._client.server_is_ready()
        busy = self._handle is not None or (self._request is not None and self._sent)
        renewed = ready and busy and self._renewal.happened()
        if renewed or not ready:
            self._handle = None
        if self._request is None:
            return
        if self._sent:
            if renewed or not ready:
                end = "was started anew" if renewed else "went away"
                self._end(self._request, False, f"the mapper {end} during the perception")
        elif ready and self._handle is None:
            self._sent = True
            self._renewal.begin()
            future = self._client.send_goal_async(BuildMap.Goal())
            future.add_done_callback(partial(self._on_response, self._request))
        elif now > self._deadline:
            self._end(
                self._request,
                False,
                "the mapper does not end a perception that was cancelled"
                if ready
                else f"nobody serves the action '{names.BUILD_MAP}': is the mapper running?",
            )

    def _on_response(self, request: int, future: Future) -> None:
        handle = future.result()
        if not handle.accepted:
            self._end(
                request, False, "the mapper rejected it: it works on a perception for another"
            )
            return
        self._handle = handle
        handle.get_result_async().add_done_callback(partial(self._on_result, request, handle))
        if request != self._request:
            handle.cancel_goal_async()

    def _on_result(self, request: int, handle: ClientGoalHandle, future: Future) -> None:
        if handle is self._handle:
            self._handle = None
        status, result = future.result().status, future.result().result
        if status == GoalStatus.STATUS_SUCCEEDED:
            self._end(request, True, "")
            return
        end = _ENDS.get(status, f"ended with status {status}")
        why = result.message or "its diagnostics say why"
        self._end(request, False, f"the mapper {end} it: {why}")

    def _end(self, request: int, ok: bool, message: str) -> None:
        if request == self._request:
            self._request = None
            self._on_end(request, ok, message)


class PlannerClient:
    """Has the planner plan, by the service ``plan_path``, on a map that is new enough.

    Parameters
    ----------
    node : Node
        Whose client it is.
    on_plan : callable
        ``on_plan(request, plan)``, called at most once for each request.
    on_error : callable
        ``on_error(request, message)``, called instead when there is no usable answer.
    parameters : callable
        Returns the parameters that the planner has to agree on, as `shared_parameters` does.

    Attributes
    ----------
    disagreement : str
        In what the planner's last answer did not agree; empty when it did.
    """

    def __init__(
        self,
        node: Node,
        on_plan: Callable[[int, PlanResult], None],
        on_error: Callable[[int, str], None],
        parameters: Callable[[], Sequence[str]],
    ) -> None:
        self.disagreement = ""
        self._parameters = parameters
        self._client = node.create_client(PlanPath, names.PLAN_PATH)
        self._renewal = _Renewal(node, names.PLAN)
        self._time = PatientTime(0.0)
        self._on_plan = on_plan
        self._on_error = on_error
        self._plan: Plan | None = None
        self._map_stamp = 0.0
        self._deadline = 0.0
        self._future: Future | None = None

    def ask(self, plan: Plan, map_stamp: float, limit: float) -> None:
        """Ask for a path.

        Parameters
        ----------
        plan : Plan
            What is wanted.
        map_stamp : float
            Stamp of the motion map [s]; an answer on an older planning map does not count.
        limit : float
            How long the planner may be missing, or behind with its map [s of wall time].
        """
        self.cancel()
        self._plan, self._map_stamp = plan, map_stamp
        self._deadline = self._time.read(math.inf) + limit
        self.watch()

    def cancel(self) -> None:
        """Forget what was asked for, if anything; nothing more comes of it."""
        self._plan = None
        self._forget()

    def watch(self) -> None:
        """Ask again where need be; give up when the planner is missing."""
        now = self._time.read(math.inf)
        if self._plan is None:
            return
        if self._client.service_is_ready():
            if self._future is not None and self._renewal.happened():
                self._forget()
            if self._future is None:
                self._send(self._plan)
            return
        self._forget()
        if now > self._deadline:
            self._error(f"nobody serves '{names.PLAN_PATH}': is the planner running?")

    def _send(self, plan: Plan) -> None:
        # The time does not matter: positions in the map are those of any time.
        request = PlanPath.Request(
            start=pose_to_msg(plan.start, Time()),
            goal=pose_to_msg(plan.goal, Time()),
            tolerance=plan.tolerance,
            barred=[Point(x=x, y=y) for x, y in plan.barred],
            hits=[Point(x=x, y=y) for x, y in plan.hits],
            slim_radius=plan.slim_radius,
            slim_above=plan.slim_above,
            any_angle=plan.any_angle,
        )
        self._renewal.begin()
        self._future = self._client.call_async(request)
        self._future.add_done_callback(self._on_response)

    def _forget(self) -> None:
        if self._future is not None:
            self._client.remove_pending_request(self._future)
            self._future = None

    def _on_response(self, future: Future) -> None:
        current = future is self._future
        if not current or self._plan is None:
            return
        self._future = None
        response = future.result()
        self.disagreement = disagreement(self._parameters(), response.parameters)
        if self.disagreement:
            self._error(self.disagreement)
            return
        stamp = seconds_from_stamp(response.path.header.stamp)
        if stamp < self._map_stamp:
            if self._time.read(math.inf) > self._deadline:
                self._error(
                    f"the planner works on a map of {stamp:.3f} s, but the newest is of "
                    f"{self._map_stamp:.3f} s: does it hear '{names.PLANNING_MAP}'?"
                )
            return  # `watch` asks again
        try:
            plan = plan_result(response)
        except ValueError as error:
            self._error(str(error))
            return
        request, self._plan = self._plan.request, None
        self._on_plan(request, plan)

    def _error(self, message: str) -> None:
        if self._plan is not None:
            request, self._plan = self._plan.request, None
            self._on_error(request, message)


def plan_result(response: PlanPath.Response) -> PlanResult:
    """Return a planner's answer as a value; its cells are not in the message.

    Raises
    ------
    ValueError
        If the answer has an unknown status, no usable path, or an alpha out of range.
    """
    if response.status not in list(PlanStatus):
        raise ValueError(f"the planner answered with the unknown status {response.status}")
    if not 0.0 <= response.alpha <= 1.0:
        raise ValueError(f"the planner answered with the impossible alpha {response.alpha}")
    return PlanResult(
        PlanStatus(response.status),
        response.message or "the planner gave no reason",
        poses=tuple(path_from_msg(response.path, what="the planner's path")),
        g1=response.g1,
        g2=response.g2,
        g3=response.g3,
        alpha=round(response.alpha, _DECIMALS),
        expanded=response.expanded_cells,
    )
