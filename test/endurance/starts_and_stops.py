# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Starts and stops of every executable under load, and what each of them leaves behind.

Three scenes take turns: the four nodes in the middle of a mission; ``bringup`` beside a
simulator, in the middle of a mission; ``demo``. In each, every process gets SIGINT or SIGTERM
at a moment of its own. Counted is a stop without fault: the exit code of a clean stop (0; 130
of ``demo``, whose run is not over), no traceback, no process left, nothing left in the folder
for temporary files, and no file of its own left in /dev/shm. Other programs that use ROS on the
same machine would show there as well; where the kernel allows it, run it with a /dev/shm of its
own: ``unshare --mount sh -c 'mount -t tmpfs none /dev/shm && exec python3 ...'``.

    .ci/in_environment python3 test/endurance/starts_and_stops.py --stops 1000
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from diagnostic_msgs.msg import DiagnosticArray
from fuzzy_msgs.action import BuildMap, Navigate
from geometry_msgs.msg import Twist

from fuzzy_map_building.ros import names, qos
from ros.harness import NodeProcess, Probe, Received, wait_until
from ros.motion_scene import goal_at

SIM = {"world": "lab", "rate": 0.0, "lockstep": True}
GOAL = (5.35, 5.45)
DOMAIN = os.environ.get("ROS_DOMAIN_ID", "0")
SHARED_MEMORY = Path("/dev/shm")
#: Exit code of a stop that is as it should be.
CLEAN = {"demo": 130}
#: Words that no output of a clean stop has.
FAULTS = ("Traceback", "terminate called", "Segmentation", "never retrieved", "Exception ignored")
#: Longest time to wait for the end of a process, and for a mission to begin [s].
PATIENCE, DEADLINE = 120.0, 300.0
NODES = {names.SIMULATOR_NODE, names.MAPPER_NODE, names.PLANNER_NODE, names.MOTION_NODE}


class Tally:
    """How often each executable was started and stopped, and what went wrong."""

    def __init__(self) -> None:
        self.stops: Counter[str] = Counter()
        self.clean: Counter[str] = Counter()
        self.problems: list[str] = []

    def note(self, executable: str, problem: str) -> None:
        self.stops[executable] += 1
        if problem:
            self.problem(f"{executable}: {problem}")
        else:
            self.clean[executable] += 1

    def problem(self, text: str) -> None:
        self.problems.append(text)
        print(f"! {text}", flush=True)


class Round:
    """One scene, with a folder of its own for everything that its processes write."""

    def __init__(self, rng: random.Random, tally: Tally) -> None:
        self.rng = rng
        self.tally = tally
        self.folder = Path(tempfile.mkdtemp(prefix="stops_"))
        self.temporary = self.folder / "tmp"
        self.temporary.mkdir()
        self._number = 0

    def start(
        self, executable: str, parameters: dict[str, object] | None = None, *arguments: str
    ) -> NodeProcess:
        self._number += 1
        return NodeProcess(
            executable,
            self.folder / f"{self._number}_{executable}.log",
            arguments=arguments,
            parameters=parameters,
            environment={"TMPDIR": str(self.temporary)},
        )

    def stop(self, processes: Sequence[NodeProcess]) -> None:
        """Stop processes in any order, one soon after the other, and judge each."""
        order = list(processes)
        self.rng.shuffle(order)
        numbers = {}
        for process in order:
            time.sleep(self.rng.uniform(0.0, 0.2))
            numbers[process] = self.rng.choice((signal.SIGINT, signal.SIGTERM))
            if process.running:
                process.send(numbers[process])
        for process in order:
            self.tally.note(process.executable, self._fault(process, numbers[process]))

    def _fault(self, process: NodeProcess, number: signal.Signals) -> str:
        """Return what was wrong with a stop; empty if nothing was."""
        try:
            code = process.wait(PATIENCE)
        except AssertionError:
            process.close()
            return f"did not end within {PATIENCE:g} s of {number.name}"
        wanted = CLEAN.get(process.executable, 0)
        output = process.output()
        found = [f"'{fault}' in its output" for fault in FAULTS if fault in output]
        if code != wanted:
            found.append(f"exit code {code} on {number.name}")
        if process.group_alive():
            found.append("left processes of its group")
            process.close()
        if not found:
            return ""
        kept = Path(tempfile.mkdtemp(prefix="fault_")) / process.log.name
        kept.write_text(output)
        return f"{'; '.join(found)}; its output is in {kept}"

    def end(self) -> None:
        """Look at what is left, then remove the folder."""
        marker = f"TMPDIR={self.temporary}".encode()
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                if marker in (entry / "environ").read_bytes().split(b"\0"):
                    self.tally.problem(f"process {entry.name} was left: {_command(entry)}")
                    os.kill(int(entry.name), signal.SIGKILL)
            except OSError:
                continue  # it has ended, or is another's
        for file in self.temporary.rglob("*"):
            self.tally.problem(f"left on disk: {file.relative_to(self.temporary)}")
        for file in sorted(self.folder.rglob("*"), reverse=True):
            file.rmdir() if file.is_dir() and not file.is_symlink() else file.unlink()
        self.folder.rmdir()


def _command(entry: Path) -> str:
    return (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()


def _speakers(said: Received[DiagnosticArray]) -> set[str]:
    return {status.name for message in list(said.messages) for status in message.status}


@contextmanager
def _mission(probe: Probe, play: Round) -> Iterator[None]:
    """Send the robot off, and go on at a moment of its mission."""
    built = probe.subscribe(
        BuildMap.Impl.FeedbackMessage, "build_map/_action/feedback", qos.RELIABLE
    )
    driven = probe.subscribe(Twist, names.CMD_VEL, qos.RELIABLE)
    said = probe.subscribe(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
    wait_until(lambda: _speakers(said) == NODES, "all nodes", DEADLINE)
    said.clear()
    client = probe.action_client(Navigate, names.NAVIGATE, DEADLINE)
    probe.send_goal(client, Navigate.Goal(goal=goal_at(*GOAL)))
    wait_until(lambda: len(built) > 0 and len(driven) > 0, "the mission to begin", DEADLINE)
    time.sleep(play.rng.uniform(0.0, 3.0))
    yield


def _stop_in_mission(play: Round, processes: Sequence[NodeProcess]) -> None:
    """Stop processes at a moment of the mission that they are at."""
    probe = Probe()
    try:
        with _mission(probe, play):
            play.stop(processes)
    finally:
        for process in processes:
            process.close()
        probe.close()


def four_nodes(play: Round) -> None:
    """Stop simulator, mapper, planner and motion in the middle of a mission."""
    clock = {"use_sim_time": True}
    processes = [play.start("sim", dict(SIM))]
    processes += [play.start(name, dict(clock)) for name in ("mapper", "planner", "motion")]
    _stop_in_mission(play, processes)


def with_bringup(play: Round) -> None:
    """Stop bringup, that has a temporary folder, beside a simulator."""
    processes = [play.start("sim", dict(SIM))]
    processes.append(play.start("bringup", {"use_sim_time": True}, "--respawn"))
    _stop_in_mission(play, processes)


def with_demo(play: Round) -> None:
    """Stop the demonstration in its mission."""
    demo = play.start(
        "demo", None, "--rate", "0", "--domain", DOMAIN, "--output", str(play.folder / "demo")
    )
    try:
        demo.wait_for_output("perception", DEADLINE)
        time.sleep(play.rng.uniform(0.0, 2.0))
        play.stop([demo])
    finally:
        if demo.running:
            demo.send(signal.SIGTERM)
            demo.wait(PATIENCE)
        demo.close()


#: The scenes by turns: most stops are those of single nodes.
SCENES: Sequence[Callable[[Round], None]] = (four_nodes, with_bringup, four_nodes, with_demo)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one turn of every scene")
    parser.add_argument("--stops", type=int, default=1000, help="how many (default: 1000)")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng, tally = random.Random(options.seed), Tally()
    before, began, number = set(os.listdir(SHARED_MEMORY)), time.monotonic(), 0
    while sum(tally.stops.values()) < options.stops:
        play = Round(rng, tally)
        scene = SCENES[number % len(SCENES)]
        number += 1
        try:
            scene(play)
        except AssertionError as failure:
            tally.problem(f"{scene.__name__}: {str(failure).splitlines()[0]}")
        play.end()
        left = set(os.listdir(SHARED_MEMORY)) - before
        if left:
            tally.problem(f"left in shared memory: {', '.join(sorted(left))}")
            before |= left
        done = sum(tally.stops.values())
        print(f"{done} stops, {sum(tally.clean.values())} clean, round {number}", flush=True)
        if options.quick and number == len(SCENES):
            break
    print("\n| executable | stops | clean |\n|---|---|---|")
    for name, stops in sorted(tally.stops.items()):
        print(f"| {name} | {stops} | {tally.clean[name]} |")
    stops, clean = sum(tally.stops.values()), sum(tally.clean.values())
    print(
        f"\n{clean} of {stops} clean, {len(tally.problems)} problems, seed {options.seed}, "
        f"{time.monotonic() - began:.0f} s"
    )
    return 0 if not tally.problems else 1


if __name__ == "__main__":
    sys.exit(main())
