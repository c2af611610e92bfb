# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The node ``fuzzy_mapper``: messages in, core calls, maps out. Wiring only.

Every range waits in the `ReadingAssembler` until pose and turret angle bracket its
stamp. The readings that come out belong to the perception that the action ``build_map``
runs, or, in continuous mode, to a packet that is fused whenever it is full, while the turret
turns without end. Infrared readings, where they are evidence, join either one with what the
`InfraredGatherer` kept.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Final

from geometry_msgs.msg import PoseStamped
from rclpy.clock import TimeJump
from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState, Range
from std_msgs.msg import Float64

from fuzzy_map_building.continuous import ContinuousGathering
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.infrared_gathering import InfraredGatherer
from fuzzy_map_building.map_folder import MapFolder
from fuzzy_map_building.map_grids import MapGrids
from fuzzy_map_building.mapper import FuzzyMapper, warm_up
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.perception import PerceptionSequence
from fuzzy_map_building.ros import conversions, names, qos
from fuzzy_map_building.ros.backlog import take_waiting
from fuzzy_map_building.ros.build_map_server import BuildMapServer, FusedPacket
from fuzzy_map_building.ros.clock import create_steady_timer, now_seconds, on_clock_set_back
from fuzzy_map_building.ros.clock_gate import ClockGate
from fuzzy_map_building.ros.conversions import Refused
from fuzzy_map_building.ros.declarations import declare_mapper
from fuzzy_map_building.ros.diagnostics import LOG_PERIOD, Diagnostics
from fuzzy_map_building.ros.explanations import explanations
from fuzzy_map_building.ros.map_publisher import MapPublisher
from fuzzy_map_building.ros.map_services import MapServices
from fuzzy_map_building.ros.rivals import Rivals
from fuzzy_map_building.ros.run import spin_node
from fuzzy_map_building.ros.snapshots import SnapshotWriter
from fuzzy_map_building.types import Pose2, RangeReading, SonarReading
from fuzzy_map_building.wording import counted

__all__ = ["MapperNode", "main"]

#: Wall time between two looks at what waits when no message comes [s].
TICK: Final = 0.05


class MapperNode(Node):
    """Perception, processing and fusion."""

    def __init__(self) -> None:
        super().__init__(names.MAPPER_NODE)
        self._settings = declare_mapper(self, on_change=self._use_parameters)
        p = self._settings.values
        warm_up()  # before the first packet, which would otherwise wait for the compiler
        self._mapper = FuzzyMapper(p.area.geometry(), p)
        self._assembler = ReadingAssembler(p)
        self._explanations = explanations(p.perception)
        self._gatherer = InfraredGatherer(p)
        self._continuous = _continuous(p)
        self._snapshots = SnapshotWriter(self.get_fully_qualified_name(), p)
        restored, refusal = self._restore()
        self._maps = MapPublisher(self, self._mapper, p.publishing)
        self._turret = self.create_publisher(Float64, names.TURRET_COMMAND, qos.RELIABLE)
        alone = Rivals(
            self,
            (names.TURRET_COMMAND, names.MOTION_MAP, names.PLANNING_MAP, names.MAP),
            actions=(names.BUILD_MAP,),
        )
        self._diagnostics = Diagnostics(self, self._diagnostic_values, self._problem, alone)
        self._settings.on_refusal = self._diagnostics.reject
        self._gate = ClockGate(self, self._diagnostics)
        self._astray = ""
        if refusal:
            self._refuse_snapshot(f"the map begins empty: {refusal}")
        self._build_map = BuildMapServer(
            self,
            new_sequence=lambda: PerceptionSequence(self._settings.values),
            command_turret=self._command_turret,
            fuse=self._fuse,
            diagnostics=self._diagnostics,
        )
        self.create_subscription(PoseStamped, names.POSE, self._on_pose, qos.RELIABLE)
        self._sonar = self.create_subscription(Range, names.SONAR, self._on_sonar, qos.RANGES)
        self._infrared: Subscription | None = None
        if p.infrared_evidence.enabled:
            self._infrared = self.create_subscription(
                Range, names.INFRARED, self._on_infrared, qos.RANGES
            )
        if p.turret.joint:
            self.create_subscription(
                JointState, names.JOINT_STATES, self._on_joint_state, qos.JOINT_STATES
            )
        self._map_services = MapServices(
            self,
            MapFolder(p.map_folder),
            lambda: self._mapper,
            self._snapshots,
            self._on_other_map,
            self._diagnostics,
        )
        create_steady_timer(self, TICK, self._on_tick)
        self._jump = on_clock_set_back(self, self._on_clock_reset)
        self.get_logger().info(
            f"mapping {p.area.size_x:g} x {p.area.size_y:g} m in cells of "
            f"{p.area.resolution:g} m, {len(p.sonar.frame_ids)} sonars, mode {p.mode}"
            f"{restored and '; ' + restored}"
        )

    def on_stop(self) -> None:
        """End a perception before the node goes, so that its client learns of it."""
        self._build_map.abort("the mapper was stopped")
        self._map_services.finish()
        self._snapshots.close(self._mapper, self._refuse_snapshot)

    def _restore(self) -> tuple[str, str]:
        """Go on from the snapshot; return what was done, and why it could not be."""
        try:
            return self._snapshots.restore(self._mapper), ""
        except ValueError as error:
            return "", str(error)

    # What comes in: converted, handed to the core, refused where it must be.

    def _on_pose(self, message: PoseStamped) -> None:
        try:
            stamp, pose = conversions.stamped_pose_from_msg(message)
        except Refused as refused:
            self._diagnostics.reject(names.POSE, refused.reason, str(refused))
            return
        if self._gate.admits(names.POSE):
            self._assembler.add_pose(stamp, pose, now_seconds(self))
            self._locate(pose)
        self._advance()

    def _locate(self, pose: Pose2) -> None:
        """Take note of a robot that stands where nothing is mapped, and tell of it once."""
        before, self._astray = self._astray, _astray(pose, self._mapper.geometry)
        if self._astray and not before:
            self.get_logger().warning(self._astray, throttle_duration_sec=LOG_PERIOD)

    def _on_joint_state(self, message: JointState) -> None:
        try:
            sample = conversions.joint_position(message, self._settings.values.turret.joint)
        except Refused as refused:
            self._diagnostics.reject(names.JOINT_STATES, refused.reason, str(refused))
            return
        if sample is None or not self._gate.admits(names.JOINT_STATES):
            return  # another joint's, or too early
        if self._assembler.add_turret(*sample, now_seconds(self)) and self._build_map.sequence:
            self._build_map.sequence.on_turret(*sample)
        self._advance()

    def _on_sonar(self, message: Range) -> None:
        self._take_sonar(message)
        for waiting in take_waiting(self._sonar):
            self._take_sonar(waiting)
        self._advance()

    def _take_sonar(self, message: Range) -> None:
        sonar = self._settings.values.sonar
        try:
            sample = conversions.range_from_msg(
                message, sonar.frame_ids, sonar.field_of_view, names.SONAR
            )
        except Refused as refused:
            self._diagnostics.reject(names.SONAR, refused.reason, str(refused))
            return
        if self._gate.admits(names.SONAR):
            self._assembler.add_range(sample.sensor, sample.stamp, sample.range, now_seconds(self))

    def _on_infrared(self, message: Range) -> None:
        self._take_infrared(message)
        if self._infrared is not None:
            for waiting in take_waiting(self._infrared):
                self._take_infrared(waiting)
        self._advance()

    def _take_infrared(self, message: Range) -> None:
        frames = self._settings.values.infrared.frame_ids
        try:
            sample = conversions.range_from_msg(message, frames, topic=names.INFRARED)
        except Refused as refused:
            self._diagnostics.reject(names.INFRARED, refused.reason, str(refused))
            return
        if self._gate.admits(names.INFRARED):
            self._assembler.add_infrared(
                sample.sensor, sample.stamp, sample.range, now_seconds(self)
            )

    def _on_clock_reset(self, jump: TimeJump) -> None:
        self._assembler.clear()
        self._forget_readings()
        self._maps.begin()
        self.get_logger().warning(
            f"the clock went back by {-jump.delta.nanoseconds * 1e-9:.1f} s; "
            "poses and readings that waited were dropped, the map stays (see reset_map)"
        )
        self._build_map.abort("the clock went back")

    # What follows from it.

    def _on_tick(self) -> None:
        self._advance()
        self._maps.advance()

    def _advance(self) -> None:
        now = now_seconds(self)
        for ray in self._assembler.release_infrared(now):
            self._gatherer.on_infrared(ray)
            if self._build_map.sequence is not None:
                self._build_map.sequence.on_infrared(ray)
        for reading in self._assembler.release(now):
            self._gatherer.on_sonar(reading)
            self._take(reading)
        self._count_refusals()
        self._build_map.advance(now)
        if self._continuous is not None and self._build_map.sequence is None:
            angle = self._continuous.turret_command(now)
            if angle is not None:
                self._command_turret(angle)
        if self._maps.undated and now > 0.0:
            self._maps.publish(self._mapper)
        period = self._settings.values.snapshot.period
        self._snapshots.advance(self._mapper, period, self._refuse_snapshot)

    def _take(self, reading: SonarReading) -> None:
        if self._build_map.sequence is not None:
            self._build_map.sequence.on_reading(reading)
        elif self._continuous is not None:
            packet = self._continuous.on_reading(reading)
            if packet is not None:
                self._fuse(packet)

    def _command_turret(self, angle: float) -> None:
        self._turret.publish(Float64(data=angle))

    def _fuse(self, readings: Sequence[RangeReading]) -> FusedPacket:
        packet = [*readings, *self._gatherer.readings()]
        report = self._mapper.update(packet)
        for source, rejected in (
            (names.SONAR, report.rejected),
            (names.INFRARED, report.infrared_rejected),
        ):
            for reason, count in rejected.items():
                text = self._explanations.get(reason, reason)
                self._diagnostics.reject(source, reason, text, count)
        if report.accepted:
            self._snapshots.changed(report.window)
            # Where a perception was made the robot stood, and its sweeps are in the packet.
            standing = self._build_map.sequence is not None
            self._gatherer.restart(readings[0].pose if standing else None)
            if standing and self._continuous is not None:
                self._continuous.forget()  # what it had begun with is of another time
            newest = max(reading.stamp for reading in readings)
            self._maps.publish(self._mapper, newest, report.window)
            return FusedPacket(
                self._mapper.perceptions, report.accepted, report.infrared_accepted, ""
            )
        reasons = ", ".join(
            f"{n} {reason.replace('_', ' ')}" for reason, n in sorted(report.rejected.items())
        )
        return FusedPacket(
            self._mapper.perceptions,
            0,
            0,
            f"none of {counted(len(readings), 'reading')} gave evidence ({reasons})",
        )

    def _forget_readings(self) -> None:
        if self._continuous is not None:
            self._continuous.forget()
        self._gatherer.restart()

    def _use_parameters(self, parameters: MapperParameters) -> None:
        """Go on with other parameters and what is known; nothing that waits is kept."""
        self._mapper = self._mapper.with_parameters(parameters)
        self._assembler = ReadingAssembler(parameters)
        self._explanations = explanations(parameters.perception)
        self._gatherer = InfraredGatherer(parameters)
        self._continuous = _continuous(parameters)
        self._build_map.abort("a parameter was changed")
        self._maps.parameters = parameters.publishing
        self._maps.publish(self._mapper)

    def _on_other_map(self, grids: MapGrids | None) -> None:
        """Go on with a map that was loaded or reset."""
        self._snapshots.discard(self._refuse_snapshot)
        self._forget_readings()
        self._maps.publish(self._mapper, grids=grids)

    def _refuse_snapshot(self, message: str) -> None:
        self._diagnostics.reject("snapshot", "refused", message)

    # What it says of itself.

    def _count_refusals(self) -> None:
        came = self._assembler
        for source, totals, examples in (
            (names.SONAR, came.rejected, came.examples),
            (names.INFRARED, came.infrared_rejected, came.infrared_examples),
            (names.POSE, came.poses.rejected, came.poses.examples),
            (names.JOINT_STATES, came.turret.rejected, came.turret.examples),
        ):
            self._diagnostics.follow(source, totals, self._explanations, examples)

    def _diagnostic_values(self) -> dict[str, object]:
        return {
            "mode": self._settings.values.mode,
            "perceptions": self._mapper.perceptions,
            "perceiving": self._build_map.sequence is not None,
            "waiting_readings": self._assembler.waiting,
            "snapshot_perceptions": self._snapshots.saved,
            "last_failure": self._build_map.failure,
        }

    def _problem(self) -> str:
        failure = self._build_map.failure
        failed = f"the last perception failed: {failure}" if failure else ""
        return "; ".join(filter(None, (failed, self._astray)))


def _astray(pose: Pose2, geometry: GridGeometry) -> str:
    """Return that a robot stands where nothing is mapped, in words; empty if it does not."""
    if geometry.contains(pose.x, pose.y):
        return ""
    x0, y0, x1, y1 = geometry.bounds
    return (
        f"the robot at ({pose.x:.2f}, {pose.y:.2f}) m stands outside the mapped area, x {x0:g} to "
        f"{x1:g} m and y {y0:g} to {y1:g} m, where it can be given no goal: set 'area.origin_x', "
        "'area.origin_y', 'area.size_x' and 'area.size_y' at the start so that the area holds "
        f"all places of the robot, or find out why '{names.POSE}' says so"
    )


def _continuous(parameters: MapperParameters) -> ContinuousGathering | None:
    return ContinuousGathering(parameters) if parameters.mode == "continuous" else None


def main() -> int:
    """Run the node until SIGINT or SIGTERM."""
    return spin_node(MapperNode, name=names.MAPPER_NODE)


if __name__ == "__main__":
    sys.exit(main())
