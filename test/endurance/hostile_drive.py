# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A stranger in the robot's domain, while the robot drives.

The whole stack runs: a simulator, and the other nodes by ``bringup``. The robot goes to and fro in
the laboratory; on each way a second publisher sends what no robot should believe (ranges of wrong
frames, NaN, negative, of other times, repeated; poses in the same manner, and such that jump;
clocks that go back), and parameters are set by the services of all four nodes, to values that
are allowed and to such that are not. Nothing may end or touch anything, what can be told from good
input has to be refused and counted, the robot has to stand after the verdict, and on the last way,
when the stranger has gone, it has to reach its goal.

    .ci/in_environment python3 test/endurance/hostile_drive.py --minutes 4 --seed 1

Parameters that say how near the robot may come to things are set to refused values only: who may
change them can drive it into a wall. What a stranger can do who tells plausible lies (ranges of
the right frames and stamps, commands of velocity) no node can tell; README.md says what keeps
strangers out.
"""

from __future__ import annotations

import argparse
import math
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.action import Navigate
from geometry_msgs.msg import PoseStamped, Twist
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
from fuzzy_navigation.mission_types import Outcome
from fuzzy_navigation.params import motion_parameters, planner_parameters
from nomad_sim.ros.params import SimulationParameters
from ros.harness import NodeProcess, Probe
from ros.motion_scene import goal_at
from ros.room import stamp
from ros.stack import Status, speeds

#: Where the robot goes to and fro (x, y) [m].
ENDS = ((5.35, 5.45), (1.25, 5.25))
#: Longest wait for a verdict and for a node to come up [s of wall time].
PATIENCE = 300.0
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
#: Time between two acts of the stranger [s of wall time].
PAUSE = 0.05
#: Fastest that the robot may be told to drive [m/s], and least that counts as driving.
LIMIT, STANDING = 0.7, 0.01


class Stack:
    """Simulator, bringup, and a client who watches."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.probe = Probe()
        self.truth = self.probe.subscribe(PoseStamped, names.GROUND_TRUTH_POSE, qos.RELIABLE)
        self.commands = self.probe.subscribe(Twist, names.CMD_VEL, qos.RELIABLE)
        self.said = self.probe.subscribe(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
        self.status = {node: Status(self.probe, node) for node in DEFAULTS}
        self.sim = NodeProcess("sim", folder / "sim.log", parameters=SIM | {"seed": seed})
        arguments = ["--ros-args", "-p", "use_sim_time:=true"]
        self.bringup = NodeProcess("bringup", folder / "bringup.log", arguments=arguments)
        self.client = self.probe.action_client(Navigate, names.NAVIGATE, PATIENCE)
        self.truth.wait_for(timeout=PATIENCE)

    @property
    def now(self) -> float:
        """Simulated time, by the robot's true pose [s]."""
        return stamp(self.truth.last)

    def values(self, node: str) -> dict[str, str]:
        """Return what a node says of itself from now on."""
        self.status[node].forget()
        return self.status[node].wait(lambda _: True, node)

    def refused(self, node: str, source: str) -> int:
        """Return how much of a source a node has refused so far."""
        start = f"rejected.{source}."
        return sum(int(n) for key, n in self.values(node).items() if key.startswith(start))

    def send(self, goal: tuple[float, float]) -> Any:
        """Send a goal and return the future of its result."""
        handle = self.probe.send_goal(self.client, Navigate.Goal(goal=goal_at(*goal)))
        return handle.get_result_async()


class Stranger:
    """Sends what should not be believed, and counts it by topic and kind."""

    def __init__(self, stack: Stack, rng: random.Random) -> None:
        self._stack, self._rng = stack, rng
        probe = stack.probe
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

    def _time(self) -> Time:
        """Return a time that is not now."""
        now, kind = self._stack.now, self._rng.randrange(4)
        if kind == 0:
            return Time(sec=self._rng.choice((-1, -(2**31), 0, 2**31 - 1)))
        if kind == 1:
            return Time(sec=round(now), nanosec=self._rng.choice((10**9, 2**32 - 1)))
        away = self._rng.choice((-1e3, -30.0, -3.0, 3.0, 30.0, 1e6))
        return stamp_from_seconds(max(0.0, now + away))

    def _range(self) -> None:
        ring = self._rng.choice((names.SONAR, names.INFRARED))
        frame, when = f"{ring}_{self._rng.randrange(16)}", stamp_from_seconds(self._stack.now)
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
        true = self._stack.truth.last.pose
        message.pose.position.x, message.pose.position.y = true.position.x, true.position.y
        message.header.stamp = stamp_from_seconds(self._stack.now + 0.01)
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
        when = stamp_from_seconds(max(0.0, self._stack.now - back))
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
        return self._stack.probe.call(SetParameters, f"{node}/set_parameters", request).results[0]


def drive(stack: Stack, stranger: Stranger | None, kind: str, goal: tuple[float, float]) -> str:
    """Send the robot on a way, disturbed or not; return the verdict and why."""
    stack.commands.clear()
    result = stack.send(goal)
    end = time.monotonic() + PATIENCE
    while not result.done():
        if time.monotonic() > end:
            raise AssertionError(f"no verdict after {PATIENCE:g} s")
        if stranger is not None:
            stranger.act(kind)
        time.sleep(PAUSE)
    verdict = result.result().result
    assert verdict.message, "a verdict without a reason"
    return f"{Outcome(verdict.outcome).name}: {verdict.message}"


def unsafe(stack: Stack) -> list[str]:
    """Return what has happened that must not, after a verdict."""
    told = list(stack.commands.messages)
    out = []
    if not all(math.isfinite(t.linear.x) and abs(t.linear.x) <= LIMIT for t in told):
        out.append("a command beyond the robot's speed")
    stack.truth.clear()
    stack.truth.wait_for(timeout=PATIENCE)
    begun = stack.now
    stack.truth.wait_for(lambda message: stamp(message) > begun + 2.0, PATIENCE)
    late = [v for t, v in speeds(stack.truth.messages) if t > begun + 1.0]
    if max(late) > STANDING:
        out.append(f"{max(late):.2f} m/s after the verdict")
    if contacts := int(stack.values(names.SIMULATOR_NODE)["contacts"]):
        out.append(f"{contacts} contacts")
    return out


def uncounted(stack: Stack, stranger: Stranger) -> list[str]:
    """Return what was refused and not counted."""
    out = []
    for node, count in stranger.refused_sets.items():
        told = stack.refused(node, "set_parameters")
        if told != count:
            out.append(f"{node} counts {told} of {count} refused parameters")
    sure = ("frame", "nan", "far", "upright")
    for node in (names.MAPPER_NODE, names.MOTION_NODE):
        bad = sum(
            n for key, n in stranger.sent.items() if key.startswith("pose.") and key.endswith(sure)
        )
        told = stack.refused(node, names.POSE)
        if told < bad:
            out.append(f"{node} counts {told} of {bad} bad poses")
        for topic in (names.SONAR, names.INFRARED):
            if stranger.sent[f"{topic}.frame"] and not stack.refused(node, topic):
                out.append(f"{node} counts nothing of '{topic}'")
    return out


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=4.0, help="of the attack (default: 4)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", choices=KINDS, help="only of this kind (default: in turn)")
    parser.add_argument("--keep", type=Path, help="folder for the nodes' logs")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    bad: list[str] = []
    with tempfile.TemporaryDirectory(prefix="hostile_drive_") as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(exist_ok=True)
        stack = Stack(folder, options.seed)
        try:
            stranger = Stranger(stack, rng)
            end, number = time.monotonic() + 60.0 * options.minutes, 0
            while time.monotonic() < end or number == 0:
                kind = options.kind or KINDS[number % len(KINDS)]
                verdict = drive(stack, stranger, kind, ENDS[number % 2])
                found = unsafe(stack)
                print(f"{kind}: {verdict}{''.join(f' ! {f}' for f in found)}", flush=True)
                bad += found
                number += 1
            stranger.go()
            bad += [*stranger.faults, *uncounted(stack, stranger)]
            verdict = drive(stack, None, "", ENDS[number % 2])
            bad += unsafe(stack)
            print(f"undisturbed: {verdict}\n{number} ways, sent: {dict(stranger.sent)}")
            if not verdict.startswith("REACHED"):
                bad.append("the goal was not reached when nobody disturbed any more")
            for process in (stack.bringup, stack.sim):
                process.assert_clean_stop(signal.SIGINT, PATIENCE)
                if "fault in the program" in process.output():
                    bad.append("a fault in a program")
        except AssertionError as failure:
            bad.append(f"broken off: {failure}\n{stack.bringup.output()[-3000:]}")
        finally:
            stack.bringup.close()
            stack.sim.close()
            stack.probe.close()
    print("\n".join(f"! {line}" for line in bad) or "nothing was found")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
