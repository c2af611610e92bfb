# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hears the sonars for the motion's guard, and places their ranges."""

from __future__ import annotations

import math

from rclpy.node import Node
from sensor_msgs.msg import JointState, Range

from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.backlog import take_waiting
from fuzzy_map_building.ros.clock import now_seconds, on_clock_set_back
from fuzzy_map_building.ros.clock_gate import ClockGate
from fuzzy_map_building.ros.conversions import Refused, joint_position, range_from_msg
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.explanations import explanations
from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.ros.faulty_ranges import usable

__all__ = ["EchoListener"]


class EchoListener:
    """Subscribes to the sonars, and to the turret that carries them.

    Parameters
    ----------
    node : Node
        Whose subscriptions they are.
    parameters : MotionParameters
        Sonars and turret.
    diagnostics : Diagnostics
        Where refused messages are counted.
    """

    def __init__(self, node: Node, parameters: MotionParameters, diagnostics: Diagnostics) -> None:
        self._node = node
        self._p = parameters
        self._diagnostics = diagnostics
        self._gate = ClockGate(node, diagnostics)
        ours = MapperParameters(sonar=parameters.sonar, turret=parameters.turret)
        self._assembler = ReadingAssembler(ours)
        # The limits are the mapper's own, which are no parameters here.
        self._explanations = explanations(ours.perception, named=False)
        self._sonar = node.create_subscription(Range, names.SONAR, self._on_sonar, qos.RANGES)
        self._subscriptions = [self._sonar]
        if parameters.turret.joint:
            self._subscriptions.append(
                node.create_subscription(
                    JointState, names.JOINT_STATES, self._on_joint_state, qos.JOINT_STATES
                )
            )

        # What waits then is of another time.
        self._jump = on_clock_set_back(node, lambda _: self._assembler.clear())

    def adopt(self, parameters: MotionParameters) -> None:
        """Go by other parameters of the same sonars and turret; what waits goes on waiting."""
        self._p = parameters

    def close(self) -> None:
        """Hear nothing any more."""
        self._jump.unregister()
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)

    def add_pose(self, stamp: float, pose: Pose2) -> None:
        """Take a pose of the robot and its stamp [s]."""
        if self._gate.admits(names.POSE):
            self._assembler.add_pose(stamp, pose, now_seconds(self._node))

    def release(self) -> list[SonarReading]:
        """Return the readings whose place is known by now, since the last call."""
        readings = self._assembler.release(now_seconds(self._node))
        came = self._assembler
        for source, totals, examples in (
            (names.SONAR, came.rejected, came.examples),
            (names.JOINT_STATES, came.turret.rejected, came.turret.examples),
        ):
            self._diagnostics.follow(source, totals, self._explanations, examples)
        return readings

    def _on_sonar(self, message: Range) -> None:
        self._take(message)
        for waiting in take_waiting(self._sonar):
            self._take(waiting)

    def _take(self, message: Range) -> None:
        sonar = self._p.sonar
        try:
            sample = usable(
                range_from_msg(message, sonar.frame_ids, sonar.field_of_view, names.SONAR), "sonar"
            )
        except Refused as refused:
            self._diagnostics.reject(names.SONAR, refused.reason, str(refused))
            return
        # Drivers that tell a number where REP 117 has -inf mean the same: too close to measure.
        # Taken for no measurement it would let the robot drive on into what is there.
        distance = sample.range if sample.range >= sonar.min_range else -math.inf
        if self._gate.admits(names.SONAR):
            now = now_seconds(self._node)
            self._assembler.add_range(sample.sensor, sample.stamp, distance, now)

    def _on_joint_state(self, message: JointState) -> None:
        try:
            sample = joint_position(message, self._p.turret.joint)
        except Refused as refused:
            self._diagnostics.reject(names.JOINT_STATES, refused.reason, str(refused))
            return
        if sample is not None and self._gate.admits(names.JOINT_STATES):
            self._assembler.add_turret(*sample, now_seconds(self._node))
