# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a stranger sends who shares the robot's domain; see `hostile_drive`."""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, Range

from fuzzy_map_building.parameter_schema import ParameterInfo, describe, flatten
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_navigation.params import motion_parameters, planner_parameters
from nomad_sim.ros.params import SimulationParameters
from ros.harness import Probe, Received
from ros.room import stamp

__all__ = ["DEFAULTS", "ENDS", "KINDS", "SIM", "Stranger"]

#: Where the robot goes to and fro (x, y) [m].
ENDS = ((5.35, 5.45), (1.25, 5.25))
SIM: dict[str, Any] = {"world": "lab", "rate": 4.0, "lockstep": True, "lockstep_timeout": 2.0}
DEFAULTS: Mapping[str, Any] = {
    names.MAPPER_NODE: mapper_parameters("consistent"),
    names.PLANNER_NODE: planner_parameters("consistent"),
    names.MOTION_NODE: motion_parameters("consistent"),
    names.SIMULATOR_NODE: SimulationParameters(),
}
#: What may be set to other allowed values without taking the guard away, by node.
HARMLESS: Mapping[str, tuple[str, ...]] = {
    names.MAPPER_NODE: (
        "evidence.k_empty",
        "evidence.k_occupied",
        "evidence.range_margin",
        "evidence.visibility_radius",
        "fusion.max_count",
        "publishing.period",
    ),
    names.PLANNER_NODE: ("cost", "adjacency"),
    names.MOTION_NODE: ("perception_cap", "livelock_limit", "goal_tolerance", "timeout.plan"),
    names.SIMULATOR_NODE: ("rate", "lockstep_timeout"),
}
#: What a way is disturbed by; the last kind is all of it.
KINDS = ("parameters", "ranges", "poses", "clock", "all")


class Stranger:
    """Sends what should not be believed, and counts it by topic and kind."""

    def __init__(self, probe: Probe, truth: Received[PoseStamped], rng: random.Random) -> None:
        self._probe, self._truth, self._rng = probe, truth, rng
        self._sonar = probe.publisher(Range, names.SONAR, qos.RANGES, 2)
        self._infrared = probe.publisher(Range, names.INFRARED, qos.RANGES, 2)
        self._pose = probe.publisher(PoseStamped, names.POSE, qos.RELIABLE, 2)
        self._joint = probe.publisher(JointState, names.JOINT_STATES, qos.JOINT_STATES, 2)
        self._clock = probe.publisher(Clock, names.CLOCK, qos.CLOCK, 3)
        self._changed: set[tuple[str, str]] = set()
        self.sent: Counter[str] = Counter()
        self.refused_sets: Counter[str] = Counter()
        self.faults: list[str] = []

    def act(self, kind: str) -> None:
        """Do one thing of a kind."""
        acts: dict[str, Callable[[], None]] = {
            "parameters": self._set,
            "ranges": self._range,
            "poses": self._lie,
            "clock": self._turn_back,
        }
        acts[self._rng.choice(KINDS[:-1]) if kind == "all" else kind]()

    def go(self) -> None:
        """Set back what was changed."""
        for node, name in sorted(self._changed):
            default = flatten(DEFAULTS[node])[name]
            self._request(node, Parameter(name, value=SIM.get(name, default)).to_parameter_msg())
        self._changed.clear()

    @property
    def _now(self) -> float:
        """Simulated time, by the robot's true pose [s]."""
        return stamp(self._truth.last)

    def _time(self) -> Time:
        """Return a time that is not now."""
        now, kind = self._now, self._rng.randrange(4)
        if kind == 0:
            return Time(sec=self._rng.choice((-1, -(2**31), 0, 2**31 - 1)))
        if kind == 1:
            return Time(sec=round(now), nanosec=self._rng.choice((10**9, 2**32 - 1)))
        away = self._rng.choice((-1e3, -30.0, -3.0, 3.0, 30.0, 1e6))
        return stamp_from_seconds(max(0.0, now + away))

    def _range(self) -> None:
        ring = self._rng.choice((names.SONAR, names.INFRARED))
        frame, when = f"{ring}_{self._rng.randrange(16)}", stamp_from_seconds(self._now)
        message = Range(max_range=6.5, min_range=0.1, field_of_view=0.4363, range=3.0)
        kind = self._rng.choice(("frame", "nan", "negative", "stamp", "twice", "field"))
        if kind == "frame":
            frame = self._rng.choice(("", "sonar_16", "map", "sonar_-1", "\u00e9" * 300))
        elif kind in ("nan", "negative"):
            message.range = math.nan if kind == "nan" else -self._rng.uniform(0.1, 1e30)
        elif kind == "stamp":
            when = self._time()
        elif kind == "field":
            message.field_of_view = self._rng.choice((math.nan, -1.0, 0.0, 1e9))
            message.range = math.nan  # of an infrared nobody looks at the field of view
        message.header.stamp, message.header.frame_id = when, frame
        publisher = self._sonar if ring == names.SONAR else self._infrared
        # A stamp that a sensor has had, so that it is one too many.
        for _ in range(2 if kind == "twice" else 1):
            publisher.publish(message)
        self.sent[f"{ring}.{kind}"] += 1

    def _lie(self) -> None:
        message = PoseStamped()
        message.header.frame_id = "map"
        message.pose.orientation.w = 1.0
        true = self._truth.last.pose
        message.pose.position.x, message.pose.position.y = true.position.x, true.position.y
        message.header.stamp = stamp_from_seconds(self._now + 0.01)
        kind = self._rng.choice(("frame", "nan", "far", "stamp", "upright", "jump", "turret"))
        if kind == "frame":
            message.header.frame_id = self._rng.choice(("", "odom", "Map", "base_link"))
        elif kind == "nan":
            message.pose.position.x = self._rng.choice((math.nan, math.inf))
        elif kind == "far":
            message.pose.position.y = self._rng.choice((1e8, -1e300))
        elif kind == "stamp":
            message.header.stamp = self._time()
        elif kind == "upright":
            message.pose.orientation.w = self._rng.choice((0.0, math.nan))
        elif kind == "jump":
            message.pose.position.x += self._rng.uniform(-3.0, 3.0)
            message.pose.position.y += self._rng.uniform(-3.0, 3.0)
            if self._rng.random() < 0.3:  # what ends the mission if it is believed
                message.pose.position.x, message.pose.position.y = self._rng.choice(ENDS)
            turned = self._rng.uniform(-math.pi, math.pi)
            message.pose.orientation.z = math.sin(0.5 * turned)
            message.pose.orientation.w = math.cos(0.5 * turned)
        else:
            joint = JointState(name=["turret_joint"], position=[math.nan])
            joint.header.stamp = self._time()
            self._joint.publish(joint)
            self.sent["joint_states"] += 1
            return
        self._pose.publish(message)
        self.sent[f"pose.{kind}"] += 1

    def _turn_back(self) -> None:
        back = self._rng.choice((0.1, 1.0, 10.0, 1e3, -1e3))
        when = stamp_from_seconds(max(0.0, self._now - back))
        self._clock.publish(Clock(clock=when))
        self.sent["clock"] += 1

    def _set(self) -> None:
        node = self._rng.choice(tuple(DEFAULTS))
        infos = describe(type(DEFAULTS[node]))
        if self._rng.random() < 0.4:
            name = self._rng.choice(HARMLESS[node])
            value = self._near(node, name, infos[name])
            answer = self._request(node, Parameter(name, value=value).to_parameter_msg())
            self._changed.add((node, name))
            if not answer.successful:
                self.faults.append(f"{node} refused {name} = {value!r}: {answer.reason}")
            self.sent["parameter.allowed"] += 1
            return
        name = self._rng.choice(tuple(infos))
        message = ParameterMessage(name=name)
        kind = self._rng.choice(("unknown", "nan", "type", "removed", "no type"))
        if kind == "unknown":
            message.name = self._rng.choice((name + "x", "", "\u00e9" * 1000))
            message.value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE)
        elif kind == "nan":
            message.value = ParameterValue(
                type=ParameterType.PARAMETER_DOUBLE, double_value=math.nan
            )
        elif kind == "type":
            message.value = ParameterValue(
                type=ParameterType.PARAMETER_BYTE_ARRAY, byte_array_value=[b"\x01"]
            )
        elif kind == "no type":
            message.value = ParameterValue(type=200)
        answer = self._request(node, message)
        self.refused_sets[node] += 1
        if answer.successful or not answer.reason:
            self.faults.append(f"{node} took {name} of kind {kind!r}")
        self.sent["parameter.refused"] += 1

    def _near(self, node: str, name: str, info: ParameterInfo) -> Any:
        default = SIM.get(name, flatten(DEFAULTS[node])[name])
        if info.choices:
            return self._rng.choice(info.choices)
        if info.type is int:
            return default + self._rng.randrange(3)
        return default * self._rng.uniform(0.95, 1.05)

    def _request(self, node: str, message: ParameterMessage) -> Any:
        request = SetParameters.Request(parameters=[message])
        return self._probe.call(SetParameters, f"{node}/set_parameters", request).results[0]
