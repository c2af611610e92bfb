# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A small room for tests of the simulator node, and what its robot tells."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from std_srvs.srv import Trigger

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp
from fuzzy_map_building.ros.conversions import stamped_twist_to_msg
from ros.harness import START_DEADLINE, Probe

#: A room of 4 x 3 m in which a crate stands until the first perception has been taken.
ROOM = """
name: room
area: {origin: [0.0, 0.0], size: [4.0, 3.0]}
start: {position: [1.0, 1.5], heading_deg: 0.0}
goal: {position: [3.0, 1.5]}
expected: reached
walls:
  - material: painted_wall
    closed: true
    points: [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]
moving:
  - {name: crate, material: wood, radius: 0.2, waypoints: [[0.0, 3.2, 2.5]], perceptions: [0, 1]}
"""
RATE = 10.0


def write_room(folder: Path) -> str:
    """Return the path of the room's file."""
    file = folder / "room.yaml"
    file.write_text(ROOM)
    return str(file)


class Robot:
    """What the simulated robot tells."""

    def __init__(self, probe: Probe) -> None:
        self.probe = probe
        self.pose = probe.subscribe(PoseStamped, names.POSE, qos.RELIABLE)
        self.diagnostics = probe.subscribe(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
        self.pose.wait_for(timeout=START_DEADLINE)

    @property
    def time(self) -> float:
        return stamp(self.pose.last)

    @property
    def x(self) -> float:
        return float(self.pose.last.pose.position.x)

    def after(self, seconds: float) -> None:
        """Wait until simulated time has gone on."""
        end = self.time + seconds
        self.pose.wait_for(lambda m: stamp(m) >= end, what=f"{seconds} s of simulated time")

    def reset(self) -> None:
        """Bring it back to its start."""
        assert self.probe.call(Trigger, names.RESET_SIMULATOR, Trigger.Request()).success
        self.after(0.05)

    def values(self, matches: Callable[[dict[str, str]], bool] = lambda _: True) -> dict[str, str]:
        """Return the values of a status that comes from now on."""
        self.diagnostics.clear()
        message = self.diagnostics.wait_for(lambda m: matches(status_values(m)))
        return status_values(message)


def stamp(message: Any) -> float:
    return seconds_from_stamp(message.header.stamp)


def status_values(message: DiagnosticArray) -> dict[str, str]:
    return {v.key: v.value for v in message.status[0].values}


def twist(linear: float = 0.0, angular: float = 0.0, lateral: float = 0.0) -> Twist:
    message = Twist()
    message.linear.x, message.linear.y, message.angular.z = linear, lateral, angular
    return message


class Answering:
    """Answers every pose with one stamped command, while it is asked to."""

    def __init__(self, probe: Probe) -> None:
        self.answers: list[float] = []
        self.on = True
        self._publisher = probe.publisher(TwistStamped, names.STAMPED_CMD_VEL, qos.RELIABLE)
        probe.node.create_subscription(PoseStamped, names.POSE, self._on_pose, qos.RELIABLE)

    def _on_pose(self, message: PoseStamped) -> None:
        if self.on:
            self.answers.append(stamp(message))
            self._publisher.publish(stamped_twist_to_msg(stamp(message), 0.0, 0.5))
