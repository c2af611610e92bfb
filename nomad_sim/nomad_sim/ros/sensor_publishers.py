# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the robot's sensors tell, as messages.

Every message object is made once and refilled: the simulator sends some 25 of them a tick.
"""

from __future__ import annotations

import math
from typing import Final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Pose, PoseStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import Bool

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.types import Pose2
from nomad_sim.ros.params import SimulationParameters
from nomad_sim.simulator import Simulator
from nomad_sim.telemetry import Telemetry

__all__ = ["SensorPublishers", "stamp_of"]

_NANO: Final = 1_000_000_000
#: Full angle that the infrared sensors' messages give [rad]: a ray, made visible.
INFRARED_FIELD_OF_VIEW: Final = 0.02


class SensorPublishers:
    """Publishes what was measured in one tick.

    Parameters
    ----------
    node : Node
        Whose topics they are.
    parameters : SimulationParameters
        Frames and limits of the sensors.
    """

    def __init__(self, node: Node, parameters: SimulationParameters) -> None:
        self._clock = node.create_publisher(Clock, names.CLOCK, qos.CLOCK)
        self._infrared = node.create_publisher(Range, names.INFRARED, qos.RANGES)
        self._joints = node.create_publisher(JointState, names.JOINT_STATES, qos.JOINT_STATES)
        self._sonar = node.create_publisher(Range, names.SONAR, qos.RANGES)
        self._odom = node.create_publisher(Odometry, names.ODOM, qos.RELIABLE)
        self._truth = node.create_publisher(PoseStamped, names.GROUND_TRUTH_POSE, qos.RELIABLE)
        self._contact = node.create_publisher(Bool, names.CONTACT, qos.LATCHED)
        self._pose = node.create_publisher(PoseStamped, names.POSE, qos.RELIABLE)
        self._last_contact: bool | None = None

        sonar, infrared = parameters.sonar, parameters.infrared
        self._clock_msg = Clock()
        self._infrared_msgs = [
            Range(
                radiation_type=Range.INFRARED,
                field_of_view=INFRARED_FIELD_OF_VIEW,
                min_range=infrared.min_range,
                max_range=infrared.max_range,
            )
            for _ in infrared.frame_ids
        ]
        self._sonar_msgs = [
            Range(
                radiation_type=Range.ULTRASOUND,
                field_of_view=parameters.sonar_field_of_view,
                min_range=sonar.min_range,
                max_range=sonar.max_range,
            )
            for _ in sonar.frame_ids
        ]
        for messages, frames in (
            (self._infrared_msgs, infrared.frame_ids),
            (self._sonar_msgs, sonar.frame_ids),
        ):
            for message, frame in zip(messages, frames, strict=True):
                message.header.frame_id = frame
        self._joint_msg = JointState(name=[parameters.turret.joint])
        self._odom_msg = Odometry(child_frame_id=names.BASE_FRAME)
        self._odom_msg.header.frame_id = names.ODOM_FRAME
        self._pose_msg = PoseStamped()
        self._pose_msg.header.frame_id = names.MAP_FRAME

    def publish(self, simulator: Simulator, told: Telemetry, epoch: int) -> None:
        """Publish the tick that the simulator has just made.

        First the time, the pose last: whoever has the pose of a stamp can expect the
        readings up to it.

        Parameters
        ----------
        simulator : Simulator
            After its step.
        told : Telemetry
            What the robot tells of it.
        epoch : int
            Stamp of the simulator's time 0 [ns].
        """
        self._clock_msg.clock = _stamp(told.clock, epoch)
        self._clock.publish(self._clock_msg)
        for ray in told.infrared:
            message = self._infrared_msgs[ray.sensor]
            message.header.stamp = _stamp(ray.stamp, epoch)
            message.range = ray.value
            self._infrared.publish(message)
        for turret in told.turret:
            self._joint_msg.header.stamp = _stamp(turret.stamp, epoch)
            self._joint_msg.position = [turret.angle]
            self._joints.publish(self._joint_msg)
        for echo in told.sonar:
            message = self._sonar_msgs[echo.sensor]
            message.header.stamp = _stamp(echo.stamp, epoch)
            message.range = echo.value
            self._sonar.publish(message)
        now = stamp_of(epoch + simulator.nanoseconds)
        velocity = simulator.velocity
        self._odom_msg.header.stamp = now
        _fill(self._odom_msg.pose.pose, simulator.odometry)
        self._odom_msg.twist.twist.linear.x = velocity.linear
        self._odom_msg.twist.twist.angular.z = velocity.angular
        self._odom.publish(self._odom_msg)
        if simulator.contact != self._last_contact:
            self._last_contact = simulator.contact
            self._contact.publish(Bool(data=simulator.contact))
        self._pose_msg.header.stamp = now
        _fill(self._pose_msg.pose, simulator.pose)
        self._truth.publish(self._pose_msg)
        for pose in told.pose:
            self._pose_msg.header.stamp = _stamp(pose.stamp, epoch)
            _fill(self._pose_msg.pose, pose.pose)
            self._pose.publish(self._pose_msg)


def _stamp(time: float, epoch: int) -> Time:
    """Return the stamp of a robot's time [s]; before time 0 there is none."""
    return stamp_of(max(epoch + round(time * _NANO), 0))


def stamp_of(nanoseconds: int) -> Time:
    """Return the stamp of a time [ns]."""
    seconds, rest = divmod(nanoseconds, _NANO)
    return Time(sec=seconds, nanosec=rest)


def _fill(message: Pose, pose: Pose2) -> None:
    message.position.x = pose.x
    message.position.y = pose.y
    message.orientation.z = math.sin(0.5 * pose.theta)
    message.orientation.w = math.cos(0.5 * pose.theta)
