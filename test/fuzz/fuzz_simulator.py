# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The simulator's callbacks: any commands, in any order; the robot keeps to its limits."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from collections.abc import Iterator

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from unique_identifier_msgs.msg import UUID

from fuzz import messages
from fuzz.draw import Draw
from fuzz.nodes import Bench, node_of
from fuzz.surface import Surface, Target
from fuzzy_map_building.parameter_schema import flatten
from fuzzy_map_building.ros import clock
from fuzzy_map_building.ros.conversions import Refused, stamped_twist_from_msg, twist_from_msg
from nomad_sim.ros import sim_node
from nomad_sim.ros.sim_node import SimNode

__all__ = ["SURFACES"]

MOST_CALLS = 12


class Case:
    """One case: a simulator at its start, and whatever it is told."""

    def __init__(self, node: SimNode, bench: Bench, counts: Counter[str]) -> None:
        self.node = node
        self.bench = bench
        self.counts = counts
        bench.begin()
        node._simulator.reset()
        node._command = (0.0, 0.0)
        node._commanded_at = 0
        node._judged = set()

    def check(self) -> None:
        simulator = self.node._simulator
        robot = simulator.parameters.robot
        linear, angular = simulator.velocity.linear, simulator.velocity.angular
        assert abs(linear) <= robot.max_linear * (1.0 + 1e-9)
        assert abs(angular) <= robot.max_angular * (1.0 + 1e-9)
        pose = simulator.pose
        assert all(map(math.isfinite, (pose.x, pose.y, pose.theta, simulator.turret_angle)))
        assert simulator.world.surfaces().distance(pose.x, pose.y) >= robot.radius - 1e-6

    def command(self, draw: Draw) -> None:
        stamped = draw.one_in(2)
        self.counts["cmd_vel_stamped" if stamped else "cmd_vel"] += 1
        message = messages.stamped_twist(draw) if stamped else messages.twist(draw)
        robot = self.node._simulator.parameters.robot
        try:
            linear, angular = (
                stamped_twist_from_msg(message)[1] if stamped else twist_from_msg(message)
            )
            refused = abs(linear) > sim_node.ABSURD * robot.max_linear
            refused |= abs(angular) > sim_node.ABSURD * robot.max_angular
        except Refused:
            refused = True
        before = (self.node._command, self.node._commanded_at, self.node._simulator.nanoseconds)
        rejected = self.bench.rejected()
        (self.node._on_stamped_cmd_vel if stamped else self.node._on_cmd_vel)(message)
        if refused:
            node = self.node
            assert before == (node._command, node._commanded_at, node._simulator.nanoseconds)
            assert self.bench.rejected() == rejected + 1

    def turret(self, draw: Draw) -> None:
        self.counts["turret"] += 1
        message = Float64(data=draw.number(lambda: draw.between(-1.0, 1.0)))
        rejected = self.bench.rejected()
        self.node._on_turret(message)
        if not math.isfinite(message.data):
            assert self.bench.rejected() == rejected + 1

    def status(self, draw: Draw) -> None:
        self.counts["build_map_status"] += 1
        before = self.node._simulator.perceptions
        message = GoalStatusArray()
        for _ in range(draw.below(4)):
            info = GoalInfo(goal_id=UUID(uuid=[draw.below(3)] * 16))
            info.stamp.sec = draw.choice((0, 1, 2, 1000, -1, 2**31 - 1))
            info.stamp.nanosec = draw.choice((0, 1, 2**32 - 1))
            status = max(-128, min(127, draw.byte() - 128 if draw.one_in(4) else draw.below(7)))
            message.status_list.append(GoalStatus(goal_info=info, status=status))
        self.node._on_build_map_status(message)
        assert before <= self.node._simulator.perceptions <= before + 3

    def tick(self, draw: Draw) -> None:
        self.counts["ticks"] += 1
        self.bench.wall += draw.choice((0.05, 0.05, 0.1, 2.0, 0.0))
        self.node._advance()

    def reset(self) -> None:
        self.counts["reset"] += 1
        stamp = self.node._epoch + self.node._simulator.nanoseconds
        assert self.node._on_reset(Trigger.Request(), Trigger.Response()).success
        assert self.node._epoch > stamp
        assert self.node._command == (0.0, 0.0)


@contextlib.contextmanager
def _opened(counts: Counter[str]) -> Iterator[Target]:
    with node_of(SimNode, {"world": "lab_person"}, [clock, sim_node]) as (node, bench):
        names = [*flatten(node._settings.values), "use_sim_time"]
        start = node._settings.values
        known = [name for name in flatten(start) if not node.describe_parameter(name).read_only]
        good = [p.to_parameter_msg() for p in node.get_parameters(known)]
        epoch = node._epoch

        def target(data: bytes) -> None:
            draw = Draw(data)
            if node._settings.values != start:
                bench.set_parameters(good)
                node._on_reset(Trigger.Request(), Trigger.Response())
            node._epoch = epoch
            case = Case(node, bench, counts)
            for _ in range(MOST_CALLS):
                if not draw.left:
                    break
                kind = draw.byte() % 16
                if kind <= 5:
                    case.command(draw)
                elif kind <= 8:
                    case.turret(draw)
                elif kind <= 10:
                    case.status(draw)
                elif kind <= 12:
                    case.tick(draw)
                elif kind == 13:
                    bench.ask_parameters(draw, names, counts)
                elif kind == 14 and draw.one_in(4):
                    case.reset()
                elif kind == 15:
                    node._diagnostics.publish()
                case.check()

        yield target


def _seeds() -> list[bytes]:
    return [
        bytes([0, 0, 255, 255, 0, 0, 0] * 5 + [11, 0] * 5),
        bytes([0, 5, 6, 7, 8, 9, 10] * 6),
        bytes(range(256)),
        bytes([14, 3, 11, 0, 0, 0, 13, 0, 1, 2, 3]),
    ]


_COUNTS: Counter[str] = Counter()
SURFACES = (Surface("simulator", lambda: _opened(_COUNTS), _seeds, longest=192, counts=_COUNTS),)
