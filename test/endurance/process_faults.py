# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""kill -9 of each node at random moments of missions, and what becomes of them.

The whole stack runs: a simulator, and the other nodes by ``bringup --respawn``. The robot goes
to and fro in the laboratory; on each way one node is killed after a random part of a simulated
minute. The simulator, whose end is that of the robot, is started anew by this script. When
motion was killed, its goal is sent again, as a client has to.

    .ci/in_environment python3 test/endurance/process_faults.py --kills 10

A node needs some seconds of a processor to start. Where the machine is so busy that they take
minutes, ``--patience 300`` lets the motion wait that long for it: its limits of 5 s and more,
three times each, are made for a machine that runs a robot.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzzy_msgs.action import Navigate
from geometry_msgs.msg import PoseStamped

from fuzzy_map_building.ros import names, qos
from fuzzy_navigation.mission_types import Outcome
from nomad_sim.ros.sim_node import TICK
from ros.harness import NodeProcess, Probe, wait_until
from ros.motion_scene import goal_at
from ros.room import stamp
from ros.stack import Status, silent, speeds
from ros.test_bringup import children

NODES = ("mapper", "planner", "motion", "sim")
#: Where the robot goes to and fro (x, y) [m].
ENDS = ((5.35, 5.45), (1.25, 5.25))
#: A node is killed within this simulated time after the goal was sent [s].
WITHIN = 60.0
#: Longest wait for a verdict and for a node to come up [s of wall time].
PATIENCE = 600.0
SIM: dict[str, Any] = {"world": "lab", "rate": 8.0, "lockstep": True, "lockstep_timeout": 2.0}


@dataclass
class Fate:
    """What became of the missions in which one node was killed."""

    verdicts: list[str] = field(default_factory=list)
    lost: int = 0
    standing: list[float] = field(default_factory=list)
    waits: list[float] = field(default_factory=list)
    contacts: int = 0


class Stack:
    """Simulator, bringup, and a client."""

    def __init__(self, folder: Path, seed: int, patience: float, concurrent: bool) -> None:
        self._folder, self._seed, self._sims = folder, seed, 0
        self.probe = Probe()
        self.truth = self.probe.subscribe(PoseStamped, names.GROUND_TRUTH_POSE, qos.RELIABLE)
        self.status = {
            name: Status(self.probe, node)
            for name, node in (("sim", names.SIMULATOR_NODE), ("motion", names.MOTION_NODE))
        }
        self.sim = self._start_sim()
        log = folder / "bringup.log"
        arguments = ["--respawn", "1000", *(["--concurrent"] if concurrent else [])]
        arguments += ["--ros-args", "-p", "use_sim_time:=true"]
        if patience > 0.0:
            for limit in ("server", "lost", "plan", "build_map"):
                rule = f"{names.MOTION_NODE}:timeout.{limit}:={patience:.1f}"
                arguments += ["-p", rule]
        self.bringup = NodeProcess("bringup", log, arguments=arguments)
        self.client = self.probe.action_client(Navigate, names.NAVIGATE, PATIENCE)
        self.await_sim()

    def _start_sim(self) -> NodeProcess:
        self._sims += 1
        log = self._folder / f"sim_{self._sims}.log"
        return NodeProcess("sim", log, parameters=SIM | {"seed": self._seed})

    def await_sim(self) -> None:
        self.truth.clear()
        self.truth.wait_for(timeout=PATIENCE)

    def contacts(self) -> int:
        """Return how often the robot has touched something since the simulator began."""
        self.status["sim"].forget()
        return int(self.status["sim"].wait(lambda _: True, "the simulator")["contacts"])

    def kill(self, name: str) -> None:
        """Kill a node; the simulator is started anew at once, the others by bringup."""
        if name == "sim":
            self.sim.send(signal.SIGKILL)
            self.sim.wait()
            self.sim = self._start_sim()
        else:
            os.kill(children(self.bringup.pid)[name], signal.SIGKILL)

    def send(self, goal: tuple[float, float]) -> Any:
        """Send a goal and return the future of its result."""
        handle = self.probe.send_goal(self.client, Navigate.Goal(goal=goal_at(*goal)))
        return handle.get_result_async()

    def await_motion(self) -> None:
        """Wait for a motion without a goal."""
        self.status["motion"].forget()
        self.status["motion"].wait(lambda v: v["active"] == "False", "a new motion", PATIENCE)

    def close(self) -> None:
        self.bringup.send(signal.SIGINT)
        self.bringup.wait(PATIENCE)
        self.sim.close()
        self.bringup.close()
        self.probe.close()


def stood_after(stack: Stack) -> float:
    """Return how long after the last command the robot moved, after motion was killed [s]."""
    # The simulator waits for the command that does not come: the last one is a tick old then.
    wait_until(lambda: silent(stack.truth, 1.0), "the simulator to wait")
    commanded = stamp(stack.truth.last) - TICK
    stack.truth.wait_for(lambda message: stamp(message) > commanded + 2.0, PATIENCE)
    moving = [t for t, v in speeds(stack.truth.messages) if v > 0.0 and t > commanded]
    return max(moving, default=commanded) - commanded


def play(stack: Stack, name: str, goal: tuple[float, float], delay: float, fate: Fate) -> bool:
    """Kill a node on a way; return whether the mission was still on."""
    touched = stack.contacts()
    result = stack.send(goal)
    began = stamp(stack.truth.last)
    stack.truth.clear()
    wait_until(
        lambda: result.done() or (len(stack.truth) and stamp(stack.truth.last) > began + delay),
        "the moment",
        PATIENCE,
    )
    if result.done():
        return False
    killed = time.monotonic()
    stack.kill(name)
    if name == "motion":
        fate.standing.append(stood_after(stack))
        stack.await_motion()
        fate.lost += not result.done()
        result = stack.send(goal)
    if name == "sim":
        stack.await_sim()
        touched = 0
    verdict = stack.probe.result_of(result, "a verdict", PATIENCE).result
    fate.waits.append(time.monotonic() - killed)
    fate.verdicts.append(Outcome(verdict.outcome).name.lower())
    fate.contacts += stack.contacts() - touched
    print(f"{name} killed after {delay:.1f} s: {fate.verdicts[-1]}, {verdict.message}", flush=True)
    return True


def table(fates: dict[str, Fate]) -> Sequence[str]:
    lines = [
        "| killed | times | reached | other verdicts | goal lost | moved on for | contacts |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, fate in fates.items():
        others = [v for v in fate.verdicts if v != "reached"]
        text = ", ".join(f"{others.count(v)} {v}" for v in sorted(set(others))) or "-"
        moved = f"{max(fate.standing):.2f} s" if fate.standing else "-"
        lines.append(
            f"| {name} | {len(fate.verdicts)} | {fate.verdicts.count('reached')} | {text} | "
            f"{fate.lost} | {moved} | {fate.contacts} |"
        )
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one kill of each node")
    parser.add_argument("--kills", type=int, default=10, help="of each node (default: 10)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--patience", type=float, default=0.0, help="of the motion [s]")
    parser.add_argument("--concurrent", action="store_true", help="map while moving")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    fates = {name: Fate() for name in NODES}
    kills = 1 if options.quick else options.kills
    began, number = time.monotonic(), 0
    with tempfile.TemporaryDirectory(prefix="process_faults_") as folder:
        stack = Stack(Path(folder), options.seed, options.patience, options.concurrent)
        try:
            for _ in range(kills):
                for name in rng.sample(NODES, len(NODES)):
                    # A way that was over too soon is gone again, the other way.
                    done = False
                    while not done:
                        delay = rng.uniform(0.0, WITHIN)
                        done = play(stack, name, ENDS[number % 2], delay, fates[name])
                        number += 1
        except AssertionError as failure:
            print(f"! broken off: {failure}\n{stack.bringup.output()[-3000:]}", flush=True)
            return 1
        finally:
            stack.close()
            print("\n".join(["", *table(fates), ""]), flush=True)
    for name, fate in fates.items():
        print(
            f"{name}: {statistics.median(fate.waits):.0f} s of wall time to the verdict (median)"
        )
    print(f"seed {options.seed}, {time.monotonic() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
