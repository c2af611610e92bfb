# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The action ``build_map``: one perception at a time, from the command to the maps.

A second goal is rejected while a perception goes on: its packet would be of two minds
about the turret. Who wants to start anew cancels the first and waits for its result.

The execute callback is a coroutine that awaits a future; the node's only thread goes on
with poses and readings, which drive the perception by `BuildMapServer.advance`. A packet
is fused as a whole at the end or, when canceled or stopped, not at all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from fuzzy_msgs.action import BuildMap
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from fuzzy_map_building.perception import PerceptionSequence
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import PatientTime, StallWatch, now_seconds
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.types import RangeReading

__all__ = ["BuildMapServer", "FusedPacket"]

#: Wall time that /clock may stand during a perception [s]: its timeouts are of that clock.
STALL_LIMIT: Final = 10.0
#: What a perception is made of.
_SOURCES: Final = (names.SONAR, names.INFRARED, names.POSE, names.JOINT_STATES)


@dataclass(frozen=True)
class FusedPacket:
    """What became of a packet.

    Attributes
    ----------
    perception : int
        Its serial number since the map was last empty.
    accepted : int
        Sonar readings fused; 0: the map is as it was.
    infrared : int
        Infrared readings fused besides.
    problem : str
        Why nothing was fused; empty when something was.
    """

    perception: int
    accepted: int
    infrared: int
    problem: str


@dataclass
class _Goal:
    """A perception that is going on."""

    handle: ServerGoalHandle
    sequence: PerceptionSequence
    outcome: Future
    start: float
    patience: PatientTime
    rejected_before: dict[str, int]
    reported: int = -1


class BuildMapServer:
    """Serves the action; knows neither the sensors nor the map.

    Parameters
    ----------
    node : Node
        Whose action it is.
    new_sequence : callable
        Returns a sequence for one perception.
    command_turret : callable
        Sends the turret to an angle [rad].
    fuse : callable
        Fuses a packet and publishes the maps.
    diagnostics : Diagnostics
        Counts what the node refuses.
    """

    def __init__(
        self,
        node: Node,
        new_sequence: Callable[[], PerceptionSequence],
        command_turret: Callable[[float], None],
        fuse: Callable[[Sequence[RangeReading]], FusedPacket],
        diagnostics: Diagnostics,
    ) -> None:
        self._node = node
        self._new_sequence = new_sequence
        self._command_turret = command_turret
        self._fuse = fuse
        self._diagnostics = diagnostics
        self._clock = StallWatch(STALL_LIMIT)
        self._goal: _Goal | None = None
        self._outcomes: dict[bytes, Future] = {}
        #: Why the last perception failed; empty when it did not.
        self.failure = ""
        self._server = ActionServer(
            node,
            BuildMap,
            names.BUILD_MAP,
            execute_callback=self._execute,
            goal_callback=self._on_goal,
            handle_accepted_callback=self._on_accepted,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            goal_service_qos_profile=qos.REQUESTS,
            result_service_qos_profile=qos.REQUESTS,
            cancel_service_qos_profile=qos.REQUESTS,
        )

    @property
    def sequence(self) -> PerceptionSequence | None:
        """The perception that is going on, if any."""
        return self._goal.sequence if self._goal is not None else None

    def advance(self, now: float) -> None:
        """Let the perception go on; call it with every event and at least at 10 Hz.

        Parameters
        ----------
        now : float
            The node's time [s].
        """
        goal = self._goal
        if goal is None:
            return
        if goal.handle.is_cancel_requested:
            self._node.get_logger().info("perception canceled; the map is as it was")
            self._end(goal, goal.handle.canceled, "the client canceled it; the map is as it was")
            return
        angle = goal.sequence.step(now, goal.patience.read(now))
        if angle is not None:
            self._command_turret(angle)
        self._report(goal)
        if goal.sequence.done:
            self._complete(goal, now)
        elif goal.sequence.failed:
            self.abort(f"{goal.sequence.failed}{self._refused_since(goal)}")
        elif self._clock.stalled(now):
            self.abort(
                f"the clock has stood at {now:.3f} s for {self._clock.limit:g} s; "
                "is the simulator running, and use_sim_time meant?"
            )

    def abort(self, reason: str) -> None:
        """End the perception that is going on, if any, without touching the map."""
        goal = self._goal
        if goal is None:
            return
        self.failure = reason
        self._node.get_logger().error(f"perception failed: {reason}")
        self._end(goal, goal.handle.abort, reason)

    def _rejected(self) -> dict[str, int]:
        return {source: self._diagnostics.total(source) for source in _SOURCES}

    def _refused_since(self, goal: _Goal) -> str:
        """Return what was refused while a perception went on, as the end of its sentence."""
        reasons = [
            self._diagnostics.latest(source)
            for source, total in self._rejected().items()
            if total > goal.rejected_before[source]
        ]
        return "".join(f"; refused: {reason}" for reason in reasons if reason)

    def _on_goal(self, _: BuildMap.Goal) -> GoalResponse:
        if self._goal is None:
            return GoalResponse.ACCEPT
        self._node.get_logger().warning(
            f"{names.BUILD_MAP}: goal rejected, a perception is going on; "
            "cancel it, or wait for its result"
        )
        return GoalResponse.REJECT

    def _on_accepted(self, handle: ServerGoalHandle) -> None:
        now = now_seconds(self._node)
        goal = _Goal(
            handle, self._new_sequence(), Future(), now, PatientTime(now), self._rejected()
        )
        goal.sequence.start(now)
        self._goal = goal
        self._outcomes[bytes(handle.goal_id.uuid)] = goal.outcome
        self._clock.restart()
        handle.execute()
        self.advance(now)

    async def _execute(self, handle: ServerGoalHandle) -> BuildMap.Result:
        result: BuildMap.Result = await self._outcomes.pop(bytes(handle.goal_id.uuid))
        return result

    def _complete(self, goal: _Goal, now: float) -> None:
        packet = self._fuse(goal.sequence.packet)
        if not packet.accepted:
            self.abort(packet.problem)
            return
        self.failure = ""
        fused = BuildMap.Result(
            perception=packet.perception,
            readings=packet.accepted,
            infrared_readings=packet.infrared,
            duration=now - goal.start,
        )
        result = self._end(goal, goal.handle.succeed, "", fused)
        self._node.get_logger().info(
            f"perception {result.perception}: {result.readings} of {goal.sequence.expected} "
            f"readings fused, {result.rejected} rejected, {result.infrared_readings} of infrareds "
            f"fused, {result.infrared_rejected} rejected, {result.duration:.1f} s"
        )

    def _end(
        self,
        goal: _Goal,
        transition: Callable[[], None],
        message: str,
        result: BuildMap.Result | None = None,
    ) -> BuildMap.Result:
        """End a perception, with the count of what was refused since it began."""
        result = BuildMap.Result() if result is None else result
        result.message = message
        rejected, before = self._rejected(), goal.rejected_before
        result.rejected = rejected[names.SONAR] - before[names.SONAR]
        result.infrared_rejected = rejected[names.INFRARED] - before[names.INFRARED]
        self._goal = None
        transition()
        goal.outcome.set_result(result)
        return result

    def _report(self, goal: _Goal) -> None:
        taken = len(goal.sequence.readings)
        if taken == goal.reported:
            return
        goal.reported = taken
        goal.handle.publish_feedback(
            BuildMap.Feedback(readings=taken, expected=goal.sequence.expected)
        )
