# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the demonstration hears of a mission, in whatever order it comes."""

from __future__ import annotations

import os

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from fuzzy_msgs.action import Navigate
from rclpy.action import ActionServer
from rclpy.action.server import ServerGoalHandle
from unique_identifier_msgs.msg import UUID

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import LogEntry, Outcome, Phase, Stop
from nomad_sim.ros.mission_watch import spinning
from ros.harness import Probe, wait_until

FeedbackMessage = Navigate.Impl.FeedbackMessage


def test_feedback_that_the_verdict_has_overtaken_counts(probe: Probe) -> None:
    goals: list[UUID] = []

    def execute(handle: ServerGoalHandle) -> Navigate.Result:
        goals.append(handle.goal_id)
        handle.abort()
        return Navigate.Result(outcome=Navigate.Result.UNREACHABLE, perceptions=1)

    ActionServer(probe.node, Navigate, names.NAVIGATE, execute)
    told: list[LogEntry] = []

    def on_perception(entry: LogEntry, _: Phase) -> None:
        told.append(entry)

    with spinning(on_perception, {}, int(os.environ["ROS_DOMAIN_ID"])) as watch:
        topic = f"{names.NAVIGATE}/_action/feedback"
        late = probe.publisher(FeedbackMessage, topic, qos.RELIABLE)
        diagnostics = probe.publisher(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
        deaf = DiagnosticStatus(name=names.MOTION_NODE)
        # Told behind it: once this one is known, so is that the motion hears nothing.
        behind = DiagnosticStatus(name=names.SIMULATOR_NODE, values=[KeyValue(key="a", value="b")])

        def known() -> bool:
            diagnostics.publish(DiagnosticArray(status=[deaf, behind]))
            return bool(watch.record.simulator) and watch._navigate.server_is_ready()

        wait_until(known, "the action and the diagnostics")
        assert "motion" in watch.missing
        hears = DiagnosticStatus(name=names.MOTION_NODE, values=[KeyValue(key="ticks", value="1")])

        def there() -> bool:
            diagnostics.publish(DiagnosticArray(status=[hears]))
            return "motion" not in watch.missing

        wait_until(there, "a motion that hears the robot")
        watch.send_goal((2.0, 1.0))
        wait_until(watch.over.is_set, "the verdict")
        assert watch.record.verdict is not None
        assert watch.record.verdict.outcome is Outcome.UNREACHABLE
        feedback = Navigate.Feedback(
            perceptions=1,
            distance_remaining=1.5,
            pose=here(),
            last_stop=Stop.CLEARANCE,
        )
        another = UUID(uuid=list(range(16)))
        late.publish(FeedbackMessage(goal_id=another, feedback=Navigate.Feedback(perceptions=7)))
        late.publish(FeedbackMessage(goal_id=goals[0], feedback=feedback))
        wait_until(lambda: watch.record.perceptions == 1, "the perception")
        assert watch.record.log == told
        assert (told[0].perception, told[0].distance_remaining) == (1, 1.5)
        # A map that is made while the robot moves tells of no stop, whatever the last one was.
        moving = Navigate.Feedback(
            perceptions=2, pose=here(), last_stop=Stop.CLEARANCE, phase=Phase.MOVING
        )
        late.publish(FeedbackMessage(goal_id=goals[0], feedback=moving))
        wait_until(lambda: watch.record.perceptions == 2, "the map on the way")
        assert [(e.on_the_way, e.stop) for e in told] == [
            (False, Stop.CLEARANCE),
            (True, Stop.NONE),
        ]


def here() -> object:
    return pose_to_msg(Pose2(1.0, 1.0), stamp_from_seconds(3.0))
