# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The node ``fuzzy_motion``: carries the mission's commands out, one control tick a pose.

The mission (`fuzzy_navigation.mission`) decides; this node tells it what has come and does
what it says. While a mission runs each pose is answered by one command of velocity, on
``cmd_vel_stamped`` with the stamp of the pose and on ``cmd_vel`` without.
"""

from __future__ import annotations

import contextlib
import math
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Final

from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from rclpy.duration import Duration
from rclpy.node import Node
from sensor_msgs.msg import Range

from fuzzy_map_building import sonar_guard
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.backlog import take_waiting
from fuzzy_map_building.ros.clock import (
    create_steady_timer,
    known_seconds,
    now_seconds,
    seconds_from_stamp,
)
from fuzzy_map_building.ros.conversions import (
    Refused,
    range_from_msg,
    stamped_pose_from_msg,
    stamped_twist_to_msg,
    twist_to_msg,
)
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.rivals import Rivals
from fuzzy_map_building.ros.run import spin_node
from fuzzy_navigation import clearance_layer, follower, verdicts
from fuzzy_navigation.agreement import shared_parameters
from fuzzy_navigation.concurrent_mission import mission_of
from fuzzy_navigation.control_tick import SILENCE, ControlTicks, Tick, Untimely
from fuzzy_navigation.mission_record import checked_tolerance
from fuzzy_navigation.mission_types import Commands, Drive, Finish, Outcome, Perceive, Plan
from fuzzy_navigation.parameter_change import ParameterChange
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.planner import PlanResult
from fuzzy_navigation.pose_time import PoseTime
from fuzzy_navigation.risk import check_effort
from fuzzy_navigation.ros.declarations import declare_motion
from fuzzy_navigation.ros.echo_listener import EchoListener
from fuzzy_navigation.ros.faulty_ranges import usable
from fuzzy_navigation.ros.followed_map import FollowedMap, NewMap, NewWindow
from fuzzy_navigation.ros.navigate_server import NavigateServer
from fuzzy_navigation.ros.partners import MapperClient, PlannerClient
from fuzzy_navigation.ros.requests import requested_pose

__all__ = ["MotionNode", "main"]

#: Time between two looks at what should have come [s of wall time].
WATCH_PERIOD: Final = 0.05
#: Time between two feedbacks while nothing changes [s of wall time].
REPORT_PERIOD: Final = 0.2
#: Least time between two log lines on why the robot stands [s of wall time].
LOG_PERIOD: Final = 1.0
#: Longest wait for all to have heard the last command of a node that fails [s].
ACKNOWLEDGEMENT: Final = 0.2


class MotionNode(Node):
    """Brings the robot to goals: action ``navigate``, topic ``goal_pose``."""

    def __init__(self) -> None:
        super().__init__(names.MOTION_NODE)
        self._settings = declare_motion(self, on_change=self._use_parameters)
        parameters = self._settings.values
        # Before the first tick, which would otherwise wait for the compiler.
        for kernels in (sonar_guard, clearance_layer, follower):
            kernels.warm_up()
        self._frames = parameters.infrared.frame_ids
        self._ticks = ControlTicks(parameters.infrared.bearings, parameters.timeout.pose)
        self._time = PoseTime()
        self._mission = mission_of(parameters)
        self._change = ParameterChange(parameters)
        self._settings.remark = self._change.remark
        self._shared = shared_parameters(parameters)
        self._map: tuple[GridGeometry, float] | None = None  # and its stamp [s]
        self._answered: float | None = None  # stamp of the pose that was acted on last [s]
        self._last_pose = self._last_tick = self._last_report = -math.inf
        self._reported: tuple[object, ...] = ()
        self._held, self._advised = False, ""
        self._missions = 0
        self._verdicts: dict[int, Callable[[Finish], None]] = {}
        self._counts: Counter[str] = Counter()
        alone = Rivals(self, (names.CMD_VEL, names.STAMPED_CMD_VEL), actions=(names.NAVIGATE,))
        self._diagnostics = Diagnostics(self, self._values, self._problem, alone)
        self._settings.on_refusal = self._diagnostics.reject
        self._cmd_vel = self.create_publisher(Twist, names.CMD_VEL, qos.RELIABLE)
        self._stamped = self.create_publisher(TwistStamped, names.STAMPED_CMD_VEL, qos.RELIABLE)
        self._mapper = MapperClient(self, self._on_perception)
        self._planner = PlannerClient(
            self, self._on_plan, self._on_plan_error, lambda: self._shared
        )
        self._server = NavigateServer(self, self._begin, self._cancel)
        # Before the ranges: of what is there the executor serves these first.
        self._followed = FollowedMap(
            self,
            names.MOTION_MAP,
            "the motion map",
            self._diagnostics,
            self._admit,
            self._on_map,
            self._on_window,
        )
        self._infrared = self.create_subscription(
            Range, names.INFRARED, self._on_infrared, qos.RANGES
        )
        self._echoes: EchoListener | None = None
        self._listen(parameters)
        self.create_subscription(PoseStamped, names.POSE, self._on_pose, qos.RELIABLE)
        self.create_subscription(PoseStamped, names.GOAL_POSE, self._on_goal_pose, qos.RELIABLE)
        create_steady_timer(self, WATCH_PERIOD, self._watch)
        how = "while it moves" if parameters.concurrent else "where it stands"
        self.get_logger().info(f"ready for goals by '{names.NAVIGATE}'; the robot maps {how}")

    def on_stop(self) -> None:
        """Make the robot stand and end the mission; called before the node is destroyed."""
        self._server.close()
        self._carry_out(self._mission.cancel(self._now(), "the motion node was stopped"))

    def on_fault(self) -> None:
        """Make the robot stand, whatever state this node is in; called when a callback raises."""
        self._drive(0.0, 0.0)
        self._cmd_vel.wait_for_all_acked(Duration(seconds=ACKNOWLEDGEMENT))

    # -- what comes -------------------------------------------------------------------------

    def _on_pose(self, message: PoseStamped) -> None:
        self._take_ranges()  # what was measured before belongs to this pose
        self._last_pose = time.monotonic()
        try:
            stamp, pose = stamped_pose_from_msg(message)
            tick = self._ticks.on_pose(known_seconds(self), stamp, pose)
        except (Refused, Untimely) as refusal:
            self._diagnostics.reject(names.POSE, refusal.reason, str(refusal))
            self._mission.pose_refused(str(refusal))
            return
        if self._echoes is not None:
            self._echoes.add_pose(stamp, pose)
        self._act(tick)

    def _on_infrared(self, message: Range) -> None:
        self._take_range(message)
        self._take_ranges()

    def _take_ranges(self) -> None:
        for message in take_waiting(self._infrared):
            self._take_range(message)

    def _take_range(self, message: Range) -> None:
        try:
            sample = usable(range_from_msg(message, self._frames, topic=names.INFRARED))
            tick = self._ticks.on_range(
                known_seconds(self), sample.sensor, sample.stamp, sample.range
            )
        except (Refused, Untimely) as refusal:
            self._diagnostics.reject(names.INFRARED, refusal.reason, str(refusal))
            return
        self._act(tick)

    def _act(self, tick: Tick | None) -> None:
        """Run one step of the control."""
        if tick is None:
            return
        self._answered, self._last_tick = tick.stamp, time.monotonic()
        self._counts["ticks" if tick.complete else "ticks.incomplete"] += 1
        now = self._now(tick.stamp)
        sonar = self._echoes.release() if self._echoes is not None else ()
        delay = now_seconds(self) - tick.stamp
        self._carry_out(self._mission.on_pose(now, tick.pose, tick.readings, sonar, delay))

    def _admit(self, geometry: GridGeometry) -> None:
        p = self._change.in_force
        check_effort(geometry, p.robot_radius, p.augmentation)

    def _on_map(self, new: NewMap) -> None:
        stamp = seconds_from_stamp(new.stamp)
        commands = self._mission.on_map(self._now(), new.geometry, new.risk, stamp)
        self._map = (new.geometry, stamp)
        self._carry_out(commands)

    def _on_window(self, new: NewWindow) -> None:
        assert self._map is not None
        stamp = seconds_from_stamp(new.stamp)
        commands = self._mission.on_window(self._now(), new.risk, new.window, stamp)
        self._map = (self._map[0], stamp)
        self._carry_out(commands)

    def _on_perception(self, request: int, ok: bool, message: str) -> None:
        self._carry_out(self._mission.on_perception(self._now(), request, ok, message))

    def _on_plan(self, request: int, plan: PlanResult) -> None:
        self._carry_out(self._mission.on_plan(self._now(), request, plan))

    def _on_plan_error(self, request: int, message: str) -> None:
        if self._planner.disagreement:
            self._diagnostics.reject(names.PLAN_PATH, "other_parameters", message)
        self._carry_out(self._mission.on_plan_error(self._now(), request, message))

    def _watch(self) -> None:
        """Let time pass, also when nothing comes."""
        self._mapper.watch()
        self._planner.watch()
        now = time.monotonic()
        if now - self._last_pose > SILENCE:
            self._act(self._ticks.overdue())
        if now - self._last_tick > SILENCE:
            self._carry_out(self._mission.on_tick(self._now()))

    def _listen(self, parameters: MotionParameters) -> None:
        """Hear the sonars if they guard the motion."""
        if not parameters.sonar_guard.enabled:
            if self._echoes is not None:
                self._echoes.close()
            self._echoes = None
        elif self._echoes is None:
            self._echoes = EchoListener(self, parameters, self._diagnostics)
        else:
            self._echoes.adopt(parameters)

    def _use_parameters(self, parameters: MotionParameters) -> None:
        before = self._change.waiting
        self._take_over(parameters)
        waiting = self._change.waiting
        if not set(waiting) <= set(before):
            remark = self._change.remark(waiting)
            self.get_logger().info(remark, throttle_duration_sec=LOG_PERIOD)

    # -- goals ------------------------------------------------------------------------------

    def _on_goal_pose(self, message: PoseStamped) -> None:
        with contextlib.suppress(ValueError):  # counted and logged already
            self._begin(message, 0.0, lambda _: None, names.GOAL_POSE)

    def _begin(
        self,
        goal: PoseStamped,
        tolerance: float,
        on_finish: Callable[[Finish], None],
        source: str = names.NAVIGATE,
    ) -> int:
        """Begin a mission, see `navigate_server.Begin`; one that runs gives way."""
        try:
            pose = requested_pose(goal, "the goal")
            if self._map is not None and (reason := verdicts.beyond(pose, self._map[0])):
                raise Refused("outside", reason)
            checked_tolerance(tolerance)
            if self._change.waiting:
                # What waits for the end of the goal before holds for this one.
                self._carry_out(self._mission.cancel(self._now(), verdicts.REPLACED))
            commands = self._mission.start(self._now(), pose, tolerance)
        except ValueError as error:
            reason = error.reason if isinstance(error, Refused) else "bad_request"
            self._diagnostics.reject(source, reason, str(error))
            raise
        self._missions += 1
        mission = self._missions
        self._verdicts[mission] = on_finish
        self.get_logger().info(f"mission {mission} to ({pose.x:.2f}, {pose.y:.2f}) m")
        self._carry_out(commands)
        self._reported = ()  # the goal's feedback begins with its first tick
        return mission

    def _cancel(self, mission: int) -> bool:
        if mission not in self._verdicts:
            return False
        self._carry_out(self._mission.cancel(self._now()))
        return True

    # -- what the mission wants -------------------------------------------------------------

    def _carry_out(self, commands: Commands) -> None:
        for command in commands:
            if isinstance(command, Drive):
                self._drive(command.linear, command.angular)
            elif isinstance(command, Perceive):
                self._mapper.ask(command.request, self._settings.values.timeout.server)
            elif isinstance(command, Plan):
                assert self._map is not None
                self._planner.ask(command, self._map[1], self._settings.values.timeout.server)
            else:
                self._finish(command)
        # Not before all is carried out: what follows the end of a mission may be that of the next.
        if self._change.waiting and not self._mission.active:
            self._take_over(self._settings.values)
        self._report()

    def _drive(self, linear: float, angular: float) -> None:
        self._cmd_vel.publish(twist_to_msg(linear, angular))
        if self._answered is not None:
            stamped = stamped_twist_to_msg(self._answered, linear, angular)
            self._stamped.publish(stamped)

    def _finish(self, finish: Finish) -> None:
        self._mapper.cancel()
        self._planner.cancel()
        self._counts[f"missions.{finish.outcome.name.lower()}"] += 1
        if finish.outcome is Outcome.REACHED:
            self.get_logger().info(str(finish))
        else:
            self.get_logger().warning(str(finish))
        self._verdicts.pop(finish.mission)(finish)

    def _take_over(self, wanted: MotionParameters) -> None:
        """Go by changed parameters, as far as no mission goes by the old ones."""
        if not self._change.want(wanted, self._mission.active):
            return
        in_force = self._change.in_force
        self._mission = mission_of(in_force, self._mission)
        self._ticks.max_age = in_force.timeout.pose
        self._shared = shared_parameters(in_force)
        self._listen(in_force)

    # -- what it shows ----------------------------------------------------------------------

    def _report(self) -> None:
        """Publish the state of the mission when it has changed, and now and then."""
        if not self._mission.active:
            return
        feedback = self._mission.feedback()
        if feedback.hold and not self._held:
            self.get_logger().warning(
                f"the robot stands: {feedback.hold}", throttle_duration_sec=LOG_PERIOD
            )
        self._held = bool(feedback.hold)
        if self._mission.advice != self._advised:
            self._advised = self._mission.advice
            if self._advised:
                self.get_logger().warning(self._advised)
        state = (feedback.phase, feedback.last_stop, feedback.perceptions, feedback.alpha)
        now = time.monotonic()
        if state == self._reported and now < self._last_report + REPORT_PERIOD:
            return
        self._reported, self._last_report = state, now
        self._server.report(self._missions, feedback, self.get_clock().now().to_msg())

    def _values(self) -> Mapping[str, object]:
        feedback = self._mission.feedback()
        values: dict[str, object] = {
            "active": self._mission.active,
            "phase": feedback.phase.name.lower() if self._mission.active else "idle",
            "last_stop": feedback.last_stop.name.lower(),
            "perceptions": feedback.perceptions,
            "alpha": feedback.alpha,
            "distance_remaining": f"{feedback.distance_remaining:.3f}",
            "maps_on_the_way": self._mission.maps_on_the_way,
        }
        if self._change.waiting:
            values["parameters_waiting"] = self._change.listed(self._change.waiting)
        if self._map is not None:
            values["map_stamp"] = f"{self._map[1]:.3f}"
        values.update(self._followed.values())
        values.update(sorted(self._counts.items()))
        return values

    def _problem(self) -> str:
        hold = self._mission.feedback().hold
        if self._mission.active and (hold or self._mission.advice):
            return f"the robot stands: {hold}" if hold else self._mission.advice
        self._now()  # whoever was held up has not looked for poses yet
        if time.monotonic() - self._last_tick > SILENCE and not self._time.catching_up:
            return f"nothing comes by '{names.POSE}': no goal can be served"
        return self._followed.problem() or self._planner.disagreement

    def _now(self, stamp: float | None = None) -> float:
        """Return the mission's time [s], of a pose with that stamp if there is one."""
        times = now_seconds(self), time.monotonic()
        now = self._time.now(*times) if stamp is None else self._time.at_pose(stamp, *times)
        if self._time.catching_up:
            self._mission.resume(now)
        return now


def main() -> int:
    """Run the node until SIGINT or SIGTERM."""
    return spin_node(MotionNode, name=names.MOTION_NODE)


if __name__ == "__main__":
    sys.exit(main())
