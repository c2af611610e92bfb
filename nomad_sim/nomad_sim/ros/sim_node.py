# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The node ``nomad_sim``: the simulated robot and its world.

It gives the time (``/clock``), tells what the sensors measure, and obeys ``cmd_vel``, the same
with a stamp (``cmd_vel_stamped``), and ``turret/command``. A tick is 0.05 s of simulated time.
How the ticks follow each other in wall time is decided by `TickGate`: parameters ``rate``,
``lockstep``, ``lockstep_timeout``.

Obstacles that come and go with the number of perceptions need that number. Everybody who
listens to an action's status sees its goals succeed, so a completed ``build_map`` is
counted here without the mapper knowing of it. Those of a robot that maps on its way the simulator
counts by the turret that turns while the robot drives.

``reset`` begins anew with the same seed. Parameters of the robot, the sensors and the
noise that were changed meanwhile take effect with it. The stamps do not go back; they jump
ahead by `RESET_JUMP`, so that nobody interpolates between the poses before and after.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from typing import Final

import numpy as np
from action_msgs.msg import GoalStatus, GoalStatusArray
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import create_steady_timer, seconds_from_stamp
from fuzzy_map_building.ros.conversions import (
    Refused,
    stamped_twist_from_msg,
    twist_from_msg,
)
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.map_conversions import grid_to_msg
from fuzzy_map_building.ros.rivals import Rivals
from fuzzy_map_building.ros.run import spin_node
from nomad_sim.fault_injection import FaultInjector
from nomad_sim.ros.declarations import declare_simulation
from nomad_sim.ros.params import EPOCH, SimulationParameters
from nomad_sim.ros.sensor_publishers import SensorPublishers, stamp_of
from nomad_sim.ros.tick_gate import TickGate
from nomad_sim.simulator import Simulator
from nomad_sim.telemetry import Telemetry, telemetry_of
from nomad_sim.world_io import load_world

__all__ = ["TICK", "SimNode", "main"]

#: Simulated time of a tick [s].
TICK: Final = 0.05
#: A timer takes no longer period [s]; of a rate just above 0 a tick's would be endless.
LONGEST_WAIT: Final = 60.0
#: How far stamps jump ahead at a reset [ns].
RESET_JUMP: Final = 2_000_000_000
#: A command beyond this multiple of the robot's limits is no speed that anybody meant.
ABSURD: Final = 10.0
#: Simulated time between two looks at whether moving obstacles have moved [ns].
TRUTH_PERIOD: Final = 1_000_000_000
#: Difference of times that is due to rounding [s].
TOLERANCE: Final = 1e-6
#: Share of the wanted rate below which the simulator counts as too slow.
SLOW: Final = 0.9
#: Groups of parameters that the simulator takes over only when it begins anew.
_MODEL: Final = ("sonar", "infrared", "robot", "turret", "odometry", "faults")


class SimNode(Node):
    """Runs the simulator in time and connects it."""

    def __init__(self) -> None:
        super().__init__(names.SIMULATOR_NODE)
        self._settings = declare_simulation(self, on_change=self._use_parameters)
        values = self._settings.values
        self._world = load_world(values.world)
        start = values.start.pose()
        if start is not None:
            self._world.check_inside(start.x, start.y, "the start")
        self._simulator = Simulator(self._world, values, start)
        # The first step compiles loops, which may take seconds: not while others wait for it.
        self._simulator.step(0.0, 0.0, TICK)
        self._simulator.reset()
        self._faults = FaultInjector.of(self._simulator.parameters)
        self._epoch = EPOCH
        self._command = (0.0, 0.0)
        self._commanded_at = 0
        self._judged: set[bytes] = set()
        self._truth: NDArray[np.int8] | None = None
        self._truth_at = 0

        alone = Rivals(self, (names.CLOCK, names.POSE))
        self._diagnostics = Diagnostics(self, self._values, self._problem, alone)
        self._settings.on_refusal = self._diagnostics.reject
        self._sensors = SensorPublishers(self, values)
        self._truth_publisher = self.create_publisher(
            OccupancyGrid, names.GROUND_TRUTH_MAP, qos.LATCHED
        )
        self._publish_truth()
        self.create_subscription(Twist, names.CMD_VEL, self._on_cmd_vel, qos.RELIABLE)
        self.create_subscription(
            TwistStamped, names.STAMPED_CMD_VEL, self._on_stamped_cmd_vel, qos.RELIABLE
        )
        self.create_subscription(Float64, names.TURRET_COMMAND, self._on_turret, qos.RELIABLE)
        self.create_subscription(
            GoalStatusArray,
            f"{names.BUILD_MAP}/_action/status",
            self._on_build_map_status,
            qos_profile_action_status_default,
        )
        self.create_service(
            Trigger, names.RESET_SIMULATOR, self._on_reset, qos_profile=qos.REQUESTS
        )

        now = time.monotonic()
        self._achieved = 0.0
        self._measured = (now, 0)
        self._gate = TickGate(now, _period(values), values.lockstep, values.lockstep_timeout)
        self._timer = create_steady_timer(self, TICK, self._advance)
        self._arm()
        self.get_logger().info(
            f"world '{self._world.name}', seed {values.seed}, rate {values.rate:g}"
            + (", in lockstep" if values.lockstep else "")
        )

    def _advance(self) -> None:
        """Take the next tick if it is due."""
        now = time.monotonic()
        if self._gate.wait(now) == 0.0:
            told = self._tick()
            self._gate.ticked(now, self._asked(told))
        self._arm()

    def _arm(self) -> None:
        """Set the timer to when there is something to do."""
        wait = min(self._gate.wait(time.monotonic()), LONGEST_WAIT)
        self._timer.timer_period_ns = max(1, round(wait * 1e9))
        self._timer.reset()

    def _tick(self) -> Telemetry:
        simulator = self._simulator
        age = 1e-9 * (simulator.nanoseconds - self._commanded_at)
        if age >= TICK and age + TICK > self._patience:
            self._command = (0.0, 0.0)
            self._gate.disengage()
        simulator.step(*self._command, TICK)
        told = self._faults.apply(telemetry_of(simulator))
        self._sensors.publish(simulator, told, self._epoch)
        if self._world.moving and simulator.nanoseconds - self._truth_at >= TRUTH_PERIOD:
            self._publish_truth()
        return told

    def _asked(self, told: Telemetry) -> float | None:
        """Return the stamp of the newest pose that was told [s]; None if none was."""
        return max((1e-9 * self._epoch + p.stamp for p in told.pose), default=None)

    @property
    def _patience(self) -> float:
        """Age of a command [s] at which the robot brakes, so that it stands in good time."""
        robot, velocity = self._simulator.parameters.robot, self._simulator.velocity
        braking = max(
            abs(velocity.linear) / robot.linear_deceleration,
            abs(velocity.angular) / robot.angular_acceleration,
        )
        # A command whose age is exactly the timeout is as old as it may become.
        return self._settings.values.command_timeout - braking + TOLERANCE

    def _publish_truth(self) -> None:
        """Publish which cells are occupied, if they are not the same as before."""
        geometry = self._world.geometry(self._settings.values.ground_truth_resolution)
        truth = self._simulator.ground_truth_grid(geometry).astype(np.int8) * np.int8(100)
        self._truth_at = self._simulator.nanoseconds
        if self._truth is not None and np.array_equal(truth, self._truth):
            return
        self._truth = truth
        stamp = stamp_of(self._epoch + self._simulator.nanoseconds)
        self._truth_publisher.publish(grid_to_msg(truth, geometry, stamp))

    def _on_cmd_vel(self, message: Twist) -> None:
        try:
            self._obey(*twist_from_msg(message))
        except Refused as refusal:
            self._diagnostics.reject(names.CMD_VEL, refusal.reason, str(refusal))

    def _on_stamped_cmd_vel(self, message: TwistStamped) -> None:
        try:
            stamp, command = stamped_twist_from_msg(message)
            self._obey(*command)
        except Refused as refusal:
            self._diagnostics.reject(names.STAMPED_CMD_VEL, refusal.reason, str(refusal))
            return
        self._gate.answered(time.monotonic(), stamp)
        self._advance()

    def _obey(self, linear: float, angular: float) -> None:
        """Take a command that somebody may have meant; the drives cut it to their limits."""
        robot = self._simulator.parameters.robot
        if abs(linear) > ABSURD * robot.max_linear or abs(angular) > ABSURD * robot.max_angular:
            raise Refused(
                "absurd",
                f"velocity command of {linear:g} m/s and {angular:g} rad/s exceeds the robot's "
                f"limits of {robot.max_linear:g} m/s and {robot.max_angular:.3g} rad/s more than "
                f"{ABSURD:g} times; are the units right?",
            )
        self._command = (linear, angular)
        self._commanded_at = self._simulator.nanoseconds

    def _on_turret(self, message: Float64) -> None:
        try:
            self._simulator.command_turret(message.data)
        except ValueError as error:
            self._diagnostics.reject(names.TURRET_COMMAND, "bad_angle", str(error))

    def _on_build_map_status(self, message: GoalStatusArray) -> None:
        """Count perceptions that succeeded; each is judged once, when it is first seen ended."""
        listed = {bytes(s.goal_info.goal_id.uuid) for s in message.status_list}
        self._judged &= listed
        now = (self._epoch + self._simulator.nanoseconds) * 1e-9
        for status in message.status_list:
            goal = bytes(status.goal_info.goal_id.uuid)
            if status.status < GoalStatus.STATUS_SUCCEEDED or goal in self._judged:
                continue
            self._judged.add(goal)
            accepted = seconds_from_stamp(status.goal_info.stamp)
            # Goals of another time belong to a simulation before this one.
            ours = self._epoch * 1e-9 <= accepted <= now
            if ours and status.status == GoalStatus.STATUS_SUCCEEDED:
                self._simulator.perception_taken()
                self._truth_at = -TRUTH_PERIOD

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        values = self._settings.values
        stamp = self._epoch + self._simulator.nanoseconds + RESET_JUMP
        self._simulator = Simulator(self._world, values, values.start.pose())
        self._faults = FaultInjector.of(self._simulator.parameters)
        self._epoch = stamp
        self._command = (0.0, 0.0)
        self._commanded_at = 0
        self._measured = (time.monotonic(), 0)
        self._gate.disengage()
        self._publish_truth()
        response.success = True
        response.message = f"at the start of world '{self._world.name}' with seed {values.seed}"
        return response

    def _use_parameters(self, values: SimulationParameters) -> None:
        self._gate.configure(
            time.monotonic(), _period(values), values.lockstep, values.lockstep_timeout
        )
        self._arm()
        running = self._simulator.parameters
        if any(getattr(values, group) != getattr(running, group) for group in _MODEL):
            self.get_logger().info(
                "parameters of the robot, its sensors and the noise take effect with the "
                f"service '{names.RESET_SIMULATOR}'"
            )

    def _problem(self) -> str:
        now, simulated = time.monotonic(), self._simulator.nanoseconds
        began, before = self._measured
        self._measured = (now, simulated)
        self._achieved = 1e-9 * (simulated - before) / max(now - began, 1e-9)
        wanted = self._settings.values.rate
        # One tick more or less within the period is no delay.
        if self._achieved + TICK / max(now - began, TICK) >= SLOW * wanted:
            return ""
        reason = "waits for commands" if self._gate.engaged else "the machine is too slow"
        return f"runs at {self._achieved:.2f} times real time instead of {wanted:g}: {reason}"

    def _values(self) -> Mapping[str, object]:
        simulator = self._simulator
        return {
            "world": self._world.name,
            "time": f"{1e-9 * (self._epoch + simulator.nanoseconds):.3f}",
            "rate": f"{self._achieved:.3f}",
            "rate_wanted": f"{self._settings.values.rate:g}",
            "time_given_up": f"{self._gate.dropped:.3f}",
            "lockstep": "engaged" if self._gate.engaged else "free",
            "lockstep_timeouts": self._gate.timeouts,
            "perceptions": simulator.perceptions,
            "contacts": simulator.contacts,
            "least_clearance": f"{simulator.least_clearance:.4f}",
        }


def _period(values: SimulationParameters) -> float:
    """Return the wall time from tick to tick [s]."""
    return TICK / values.rate if values.rate > 0.0 else 0.0


def main() -> int:
    """Run the node until SIGINT or SIGTERM."""
    return spin_node(SimNode, name=names.SIMULATOR_NODE)


if __name__ == "__main__":
    sys.exit(main())
