# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A robot that stands still and measures what a test tells it to: for tests of the mapper."""

from __future__ import annotations

import math
from collections.abc import Callable

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import Float64

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_map_building.types import Pose2
from ros.harness import Probe

FIELD_OF_VIEW = math.radians(25.0)
JOINT = "turret_joint"


def range_to_msg(sensor: int, stamp: Time, value: float) -> Range:
    """Return the message of sonar number `sensor`."""
    message = Range(
        radiation_type=Range.ULTRASOUND,
        field_of_view=FIELD_OF_VIEW,
        min_range=0.12,
        max_range=6.5,
        range=value,
    )
    message.header.frame_id = names.sonar_frame(sensor)
    message.header.stamp = stamp
    return message


def joint_to_msg(stamp: Time, angle: float) -> JointState:
    """Return the message of the turret's angle [rad]."""
    message = JointState(name=[JOINT], position=[angle])
    message.header.stamp = stamp
    return message


class Talker:
    """Publishers of all that the mapper listens to."""

    def __init__(self, probe: Probe) -> None:
        self._clock = probe.node.get_clock()
        self._pose = probe.publisher(PoseStamped, names.POSE, qos.RELIABLE)
        self._joint = probe.publisher(JointState, names.JOINT_STATES, qos.JOINT_STATES)
        self._range = probe.publisher(Range, names.SONAR, qos.RANGES)

    def now(self) -> Time:
        """Return the present time."""
        return self._clock.now().to_msg()

    def pose(self, message: PoseStamped) -> None:
        """Send a pose."""
        self._pose.publish(message)

    def joint(self, message: JointState) -> None:
        """Send a joint state."""
        self._joint.publish(message)

    def range(self, message: Range) -> None:
        """Send a range."""
        self._range.publish(message)


class FakeRobot:
    """Publishes pose, turret and the ranges of 16 sonars at 50 Hz, and obeys the turret's command.

    Parameters
    ----------
    probe : Probe
        The node that it is part of.
    pose : Pose2
        Where it stands.
    measure : callable
        Range [m] by sonar and turret angle [rad].

    Attributes
    ----------
    commands : list of float
        Turret angles that were commanded [rad].
    turret_stuck, blind, lost, unstamped : bool
        Whether the turret does not obey, no ranges come, no poses come, ranges have no stamp.
    """

    def __init__(self, probe: Probe, pose: Pose2, measure: Callable[[int, float], float]) -> None:
        self.pose = pose
        self.measure = measure
        self.angle = 0.0
        self.commands: list[float] = []
        self.turret_stuck = self.blind = self.lost = self.unstamped = False
        self._probe = probe
        self._node = probe.node
        self._talker = Talker(probe)
        self._subscription = self._node.create_subscription(
            Float64, names.TURRET_COMMAND, self._on_command, qos.RELIABLE
        )
        self._timer = self._node.create_timer(0.02, self._tick)

    def obeys(self) -> bool:
        """Return whether somebody turns the turret."""
        return self._subscription.get_publisher_count() > 0

    def close(self) -> None:
        """Fall silent."""
        self._probe.run(lambda: self._node.destroy_timer(self._timer))
        self._probe.run(lambda: self._node.destroy_subscription(self._subscription))

    def _on_command(self, message: Float64) -> None:
        self.commands.append(message.data)
        if not self.turret_stuck:
            self.angle = message.data

    def _tick(self) -> None:
        stamp = self._talker.now()
        if not self.lost:
            self._talker.pose(pose_to_msg(self.pose, stamp))
        self._talker.joint(joint_to_msg(stamp, self.angle))
        if self.blind:
            return
        measured = Time() if self.unstamped else stamp
        for sensor in range(16):
            self._talker.range(range_to_msg(sensor, measured, self.measure(sensor, self.angle)))
