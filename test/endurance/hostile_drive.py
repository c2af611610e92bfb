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
import contextlib
import math
import random
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzzy_msgs.action import Navigate
from geometry_msgs.msg import PoseStamped, Twist

from fuzzy_map_building.ros import names, qos
from fuzzy_navigation.mission_types import Outcome
from ros.harness import NodeProcess, Probe, wait_until
from ros.motion_scene import goal_at
from ros.room import stamp
from ros.stack import Status, speeds
from ros.stranger import DEFAULTS, ENDS, KINDS, SIM, Stranger

#: Longest wait for a verdict and for a node to come up [s of wall time].
PATIENCE = 300.0
#: Time between two acts of the stranger [s of wall time], one for each way. What comes often ends
#: a mission soon; what comes seldom meets a robot that drives.
PAUSES = (0.05, 0.2, 0.6, 1.5)
#: Fastest that the robot may be told to drive [m/s], and least that counts as driving.
LIMIT, STANDING = 0.7, 0.01
#: Farthest from the goal that the robot may be said to have reached it [m].
REACHED = 0.4


class Stack:
    """Simulator, bringup, and a client who watches."""

    def __init__(self, folder: Path, seed: int, concurrent: bool = False) -> None:
        self.probe = Probe()
        self.truth = self.probe.subscribe(PoseStamped, names.GROUND_TRUTH_POSE, qos.RELIABLE)
        self.commands = self.probe.subscribe(Twist, names.CMD_VEL, qos.RELIABLE)
        self.status = {node: Status(self.probe, node) for node in DEFAULTS}
        self.sim = NodeProcess("sim", folder / "sim.log", parameters=SIM | {"seed": seed})
        arguments = ["--concurrent"] if concurrent else []
        arguments += ["--ros-args", "-p", "use_sim_time:=true"]
        self.bringup = NodeProcess("bringup", folder / "bringup.log", arguments=arguments)
        self.bringup.wait_for_output("bringup: started", PATIENCE)
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


def drive(
    stack: Stack,
    stranger: Stranger | None,
    kind: str,
    goal: tuple[float, float],
    pause: float = PAUSES[0],
) -> str:
    """Send the robot on a way, disturbed or not; return the verdict and why."""
    stack.commands.clear()
    result = stack.send(goal)
    end = time.monotonic() + PATIENCE
    while not result.done():
        if time.monotonic() > end:
            raise AssertionError(f"no verdict after {PATIENCE:g} s")
        if stranger is not None:
            stranger.act(kind)
        wait_for(pause, result)
    verdict = result.result().result
    assert verdict.message, "a verdict without a reason"
    return f"{Outcome(verdict.outcome).name}: {verdict.message}"


def wait_for(pause: float, result: Any) -> None:
    """Wait for a time [s], or for the verdict."""
    with contextlib.suppress(AssertionError):
        wait_until(result.done, "the next act", pause)


def unsafe(stack: Stack, verdict: str, goal: tuple[float, float]) -> list[str]:
    """Return what has happened that must not, after a verdict."""
    told = list(stack.commands.messages)
    out = []
    true = stack.truth.last.pose.position
    away = math.dist((true.x, true.y), goal)
    if verdict.startswith("REACHED") and away > REACHED:
        out.append(f"said to be at the goal, {away:.2f} m away from it")
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
    parser.add_argument("--quick", action="store_true", help="half a minute")
    parser.add_argument("--minutes", type=float, default=4.0, help="of the attack (default: 4)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", choices=KINDS, help="only of this kind (default: in turn)")
    parser.add_argument("--concurrent", action="store_true", help="map while moving")
    parser.add_argument("--keep", type=Path, help="folder for the nodes' logs")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    bad: list[str] = []
    with tempfile.TemporaryDirectory(prefix="hostile_drive_") as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(exist_ok=True)
        stack = Stack(folder, options.seed, options.concurrent)
        try:
            stranger = Stranger(stack.probe, stack.truth, rng)
            end, number = time.monotonic() + 60.0 * (0.5 if options.quick else options.minutes), 0
            while time.monotonic() < end or number == 0:
                kind = options.kind or KINDS[number % len(KINDS)]
                goal, pause = ENDS[number % 2], rng.choice(PAUSES)
                verdict = drive(stack, stranger, kind, goal, pause)
                found = unsafe(stack, verdict, goal)
                print(
                    f"{kind}, every {pause:g} s: {verdict}{''.join(f' ! {f}' for f in found)}",
                    flush=True,
                )
                bad += found
                number += 1
            stranger.go()
            bad += [*stranger.faults, *uncounted(stack, stranger)]
            goal = ENDS[number % 2]
            verdict = drive(stack, None, "", goal)
            bad += unsafe(stack, verdict, goal)
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
