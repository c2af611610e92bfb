# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How soon planner and motion know what a packet told the mapper, on a large map over ROS.

``.ci/in_environment python3 test/benchmarks/window_latency.py [--cells N] [--resolution M]
[--packets N]`` starts mapper, planner and motion as processes, on a square map of N x N cells,
sends packets of 48 sonar readings, 16 at a time as a ring fires, and prints the time from the
last reading of a packet, as it is handed to the middleware, to the moment when the planner holds
the window of the planning map and the motion that of the motion map.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from builtin_interfaces.msg import Time

from fuzzy_map_building.ros.clock import stamp_from_nanoseconds
from fuzzy_map_building.ros.conversions import pose_to_msg
from fuzzy_map_building.ros.names import MOTION_NODE, PLANNER_NODE
from fuzzy_map_building.types import Pose2
from ros.fake_robot import Talker, joint_to_msg, range_to_msg
from ros.harness import NodeProcess, Probe, wait_until
from ros.stack import Status

#: Has a node say when it holds a window, on a clock that all processes share.
PATCH = """
import time
from fuzzy_navigation.ros import {module} as module
taken = module.{node}._on_window
def timed(self, new):
    taken(self, new)
    print("held", time.monotonic_ns(), flush=True)
module.{node}._on_window = timed
"""
#: The processes that follow the maps: module and class of their nodes.
FOLLOWERS = {
    "planner": ("planner_node", "PlannerNode"),
    "motion": ("motion_node", "MotionNode"),
}
BURSTS, SONARS = 3, 16
#: Time from one firing of the ring to the next, and from one packet to the next [s].
FIRING, REST = 0.05, 0.35


def held(process: NodeProcess) -> list[int]:
    """Return when a process held each window so far [ns]."""
    return [int(at) for at in re.findall(r"held (\d+)", process.output())]


def send_packet(talker: Talker, pose: Pose2, generator: np.random.Generator) -> int:
    """Send a packet and return when its last reading was sent [ns]."""
    sent = 0
    for _ in range(BURSTS):
        time.sleep(FIRING)
        stamp: Time = stamp_from_nanoseconds(time.time_ns())
        talker.pose(pose_to_msg(pose, stamp))
        talker.joint(joint_to_msg(stamp, 0.0))
        for sensor in range(SONARS):
            reading = range_to_msg(sensor, stamp, float(generator.uniform(0.5, 4.0)))
            sent = time.monotonic_ns()
            talker.range(reading)
    return sent


def measure(cells: int, resolution: float, packets: int) -> dict[str, list[float]]:
    """Return the times of each follower, and of the later one of both [ms]."""
    generator = np.random.default_rng(1)
    side = cells * resolution
    area = {"area.size_x": side, "area.size_y": side, "area.resolution": resolution}
    mapper: dict[str, Any] = {"mode": "continuous", **area}
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        probe = Probe("benchmark")
        stack.callback(probe.close)
        nodes = {"mapper": NodeProcess("mapper", folder / "mapper.log", parameters=mapper)}
        stack.callback(nodes["mapper"].close)
        for name, (module, node) in FOLLOWERS.items():
            patch = PATCH.format(module=module, node=node)
            nodes[name] = NodeProcess(name, folder / f"{name}.log", patch=patch)
            stack.callback(nodes[name].close)
        nodes["mapper"].wait_for_output("mapping")
        for node in (PLANNER_NODE, MOTION_NODE):
            Status(probe, node).wait(lambda values: "map_stamp" in values, f"the map of {node}")
        talker = Talker(probe)
        # The motion's robot stands: it hears poses, and no goal is sent.
        sent: list[int] = []
        while len(sent) < packets:
            pose = Pose2(*generator.uniform(0.4 * side, 0.6 * side, 2), 0.0)
            before = [len(held(nodes[name])) for name in FOLLOWERS]
            at = send_packet(talker, pose, generator)

            def came(before: Sequence[int] = before) -> bool:
                now = [len(held(nodes[name])) for name in FOLLOWERS]
                return all(n > b for n, b in zip(now, before, strict=True))

            wait_until(came, "the windows of a packet", 60.0, step=0.02)
            sent.append(at)
            time.sleep(REST)
        times = {
            name: [1e-6 * (h - s) for h, s in zip(held(nodes[name]), sent, strict=True)]
            for name in FOLLOWERS
        }
    times["both"] = [max(each) for each in zip(*times.values(), strict=True)]
    return times


def main(argv: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Time from a packet to the followers' maps.")
    parser.add_argument("--cells", type=int, default=4000, help="cells of a side of the map")
    parser.add_argument("--resolution", type=float, default=0.1, help="side of a cell [m]")
    parser.add_argument("--packets", type=int, default=40, help="packets sent")
    options = parser.parse_args(argv)
    times = measure(options.cells, options.resolution, options.packets)
    size = f"{options.cells} x {options.cells} cells of {options.resolution:g} m"
    print(f"{size}, load average {os.getloadavg()[0]:.1f}")
    for name, each in times.items():
        rank = sorted(each)
        later = rank[math.ceil(0.95 * len(rank)) - 1]
        print(
            f"{name:8s} median {statistics.median(each):6.2f} ms, 95 % below {later:7.2f} ms, "
            f"least {rank[0]:5.2f} ms, {len(each)} packets"
        )


if __name__ == "__main__":
    main()
