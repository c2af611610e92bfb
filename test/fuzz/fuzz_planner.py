# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The planner's callbacks: any maps and requests, in any order."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from collections.abc import Iterator

import numpy as np
from fuzzy_msgs.srv import PlanPath
from nav_msgs.srv import GetPlan

from fuzz import messages
from fuzz.draw import Draw
from fuzz.nodes import Bench, node_of
from fuzz.surface import Surface, Target
from fuzzy_map_building.parameter_schema import flatten
from fuzzy_map_building.ros import clock
from fuzzy_map_building.ros.conversions import Refused
from fuzzy_map_building.ros.map_conversions import risk_from_msg, window_from_msg
from fuzzy_navigation.planner import Planner
from fuzzy_navigation.risk import augment
from fuzzy_navigation.ros import planner_node
from fuzzy_navigation.ros.planner_node import PlannerNode

__all__ = ["SURFACES"]

MOST_CALLS = 8
#: Most memory that a planner may keep for the maps drawn here [bytes].
MOST_MEMORY = 50_000_000


class Case:
    """One case: a planner without a map, and whatever it is asked."""

    def __init__(self, node: PlannerNode, bench: Bench, counts: Counter[str]) -> None:
        self.node = node
        self.bench = bench
        self.counts = counts
        node._planner = Planner(planner_node._NOWHERE, node._settings.values)
        node._map_stamp = None
        node._followed.forget()
        self.windows = 0
        bench.begin()

    def map(self, draw: Draw) -> None:
        self.counts["planning_map"] += 1
        width, height = 1 + draw.below(16), 1 + draw.below(16)
        values = draw.choice(((0, 20, 0, 0), (0, 65, 100, 0), (100,), (0, 59, 60, 61)))
        resolution = draw.choice((0.1, 0.1, 0.05, 1.0, 1e-3, 1e-6))
        message = messages.grid(draw, self.bench.now, width, height, resolution, values)
        try:
            risk_from_msg(message)
            refused = False
        except Refused:
            refused = True
        stamp = clock.nanoseconds_from_stamp(message.header.stamp)
        refused &= not self.node._followed._follower.outdated(stamp)
        rejected, planner = self.bench.rejected(), self.node._planner
        before = None if planner.augmented_risk is None else planner.augmented_risk.copy()
        self.node._followed.on_map(message)
        if refused:
            assert self.bench.rejected() == rejected + 1
            assert self.node._planner is planner
            assert np.array_equal(planner.augmented_risk, before)  # type: ignore[arg-type]
        risk = self.node._planner.augmented_risk
        if risk is not None:
            assert ((risk >= 0.0) & (risk <= 1.0)).all()
        assert self.node._planner.nbytes < MOST_MEMORY

    def window(self, draw: Draw) -> None:
        """A window, mostly one that goes on from the map: only its cells change, or none."""
        follower, planner = self.node._followed._follower, self.node._planner
        geometry, kept = planner.geometry, planner._map._coded
        self.windows += 1
        now = self.bench.now + 0.01 * self.windows
        message = messages.window(draw, now, geometry.width, geometry.height)
        expected = None if kept is None else kept.codes.copy()
        taken, rejected = follower.taken, self.bench.rejected()
        self.node._followed.on_window(message, messages.window_info(draw, follower._number))
        self.counts["window" if follower.taken > taken else "window that did not fit"] += 1
        assert self.bench.rejected() <= rejected + 1
        if expected is None or kept is None:
            assert follower.taken == taken
            return
        if follower.taken > taken:
            assert self.bench.rejected() == rejected
            window = window_from_msg(message)
            expected[window.window.slices] = window.cells
        assert np.array_equal(kept.codes, expected)
        p = self.node._settings.values
        radius, footprint = p.robot_radius, p.augmentation
        risk = augment(expected / 100.0, radius, geometry.resolution, footprint)
        assert np.array_equal(planner.augmented_risk, risk)  # type: ignore[arg-type]

    def plan(self, draw: Draw) -> None:
        self.counts["plan_path"] += 1
        x0, y0, x1, y1 = self.node._planner.geometry.bounds
        request = PlanPath.Request()
        for name in ("start", "goal"):
            x, y = draw.between(x0, x1), draw.between(y0, y1)
            setattr(request, name, messages.stamped_pose(draw, self.bench.now, x, y))
        request.cost = draw.byte() if draw.one_in(8) else draw.below(4)
        request.alpha = messages.float32(draw.number(lambda: draw.choice((0.0, 0.6, 0.9, 1.0))))
        request.adjacency = draw.byte() if draw.one_in(8) else draw.choice((0, 4, 8))
        request.tolerance = messages.float32(draw.number(lambda: draw.choice((0.0, 0.1, 10.0))))
        many = 3000 if draw.one_in(24) else 1
        request.barred = [messages.point(draw, x0, y0) for _ in range(draw.below(5))] * many
        request.hits = [messages.point(draw, x0, y0) for _ in range(draw.below(5))] * many
        if draw.one_in(3):
            request.slim_radius = messages.float32(draw.number(lambda: draw.between(0.0, 0.2)))
            request.slim_above = messages.float32(draw.number(lambda: draw.choice((0.6, 1.0))))
        request.any_angle = draw.one_in(2)
        rejected = self.bench.rejected()
        answer = self.node._on_plan_path(request, PlanPath.Response())
        assert 0 < len(answer.message) < 3000
        bad = answer.status == PlanPath.Response.BAD_REQUEST
        assert self.bench.rejected() == rejected + bad
        assert bool(answer.path.poses) == (answer.status == PlanPath.Response.FOUND)
        risks = (answer.g1, answer.g2, answer.g3)
        assert all(map(math.isfinite, risks)) or not answer.path.poses
        assert 0.0 <= answer.alpha <= 1.0
        self._check_path(answer.path, request.barred)

    def _check_path(self, path: object, barred: object) -> None:
        geometry = self.node._planner.geometry
        points = [(p.pose.position.x, p.pose.position.y) for p in path.poses]  # type: ignore[attr-defined]
        cells, inside = geometry.cells_of(points)
        assert inside.all()
        steps = np.abs(np.diff(cells, axis=0))
        assert (steps.max(axis=1, initial=0) <= 1).all()
        shut, known = geometry.cells_of([(p.x, p.y) for p in barred])  # type: ignore[attr-defined]
        entered = {tuple(cell) for cell in cells[1:].tolist()}
        start = {tuple(cell) for cell in cells[:1].tolist()}
        assert not (entered - start) & {tuple(cell) for cell in shut[known].tolist()}

    def get_plan(self, draw: Draw) -> None:
        self.counts["get_plan"] += 1
        request = GetPlan.Request()
        request.start = messages.stamped_pose(draw, self.bench.now, 0.3, 0.3)
        request.goal = messages.stamped_pose(draw, self.bench.now, 0.8, 0.8)
        request.tolerance = messages.float32(draw.number(lambda: 0.0))
        self._check_path(self.node._on_get_plan(request, GetPlan.Response()).plan, [])


@contextlib.contextmanager
def _opened(counts: Counter[str]) -> Iterator[Target]:
    parameters = {"preset": "consistent"}
    with node_of(PlannerNode, parameters, [clock, planner_node]) as (node, bench):
        names = [*flatten(node._settings.values), "preset"]
        start = node._settings.values
        good = [p.to_parameter_msg() for p in node.get_parameters(list(flatten(start)))]

        def target(data: bytes) -> None:
            draw = Draw(data)
            if node._settings.values != start:
                bench.set_parameters(good)
            case = Case(node, bench, counts)
            case.map(draw)
            for _ in range(MOST_CALLS):
                if not draw.left:
                    break
                kind = draw.byte() % 15
                if kind <= 5:
                    case.plan(draw)
                elif kind <= 7:
                    case.map(draw)
                elif kind == 8:
                    case.get_plan(draw)
                elif kind == 9:
                    bench.ask_parameters(draw, names, counts)
                elif kind == 10:
                    bench.wait(draw)
                elif kind >= 12:
                    case.window(draw)
                else:
                    node._diagnostics.publish()

        yield target


def _seeds() -> list[bytes]:
    return [
        bytes(80),
        bytes([15, 15]) + bytes(20) + bytes([0]) + bytes(40),
        bytes([9, 9, 1, 0, 0]) + bytes(range(200)),
        bytes(range(255, 0, -1)),
        bytes([9, 9, 1, 0, 0]) + bytes(26) + bytes([12, 3, 2, 1] + 20 * [0]) * 6,
        bytes([12, 12, 0, 5]) + bytes(30) + bytes([0] * 30 + [6] + [7] * 30),
    ]


_COUNTS: Counter[str] = Counter()
SURFACES = (Surface("planner", lambda: _opened(_COUNTS), _seeds, longest=256, counts=_COUNTS),)
