# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper's callbacks: any messages, requests and times, in any order."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from fuzzy_msgs.srv import MapFile
from nav_msgs.srv import GetMap
from rclpy.action import GoalResponse
from std_srvs.srv import Trigger

from fuzz import messages
from fuzz.draw import Draw
from fuzz.followed import Followed
from fuzz.nodes import Bench, GoalHandle, finished, node_of
from fuzz.surface import Surface, Target, check_words, scratch_folder
from fuzzy_map_building.infrared_gathering import InfraredGatherer
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.parameter_schema import flatten
from fuzzy_map_building.ros import clock, conversions
from fuzzy_map_building.ros.mapper_node import MapperNode

__all__ = ["SURFACES"]

#: More calls a case find no more.
MOST_CALLS = 12
#: Ranges that may wait: twice the limit of a ring.
MOST_WAITING = 20_000
ARRAYS = ("empty", "occupied", "motion_risk", "planning_risk", "count")


class Case:
    """One case: a mapper that knows nothing, and whatever happens to it."""

    def __init__(
        self, node: MapperNode, bench: Bench, counts: Counter[str], followed: Sequence[Followed]
    ) -> None:
        self.followed = followed
        self.node = node
        self.bench = bench
        self.counts = counts
        p = node._settings.values
        self.p = p
        node._mapper = FuzzyMapper(p.area.geometry(), p)
        node._assembler = ReadingAssembler(p)
        node._gatherer = InfraredGatherer(p)
        node._packet = []
        node._build_map._goal = None
        node._build_map._outcomes.clear()
        bench.begin()
        node._maps.publish(node._mapper)
        self.pose = (0.6, 0.5)
        self.angle = 0.0
        self.goals: list[GoalHandle] = []
        self.asked = 0
        self.before = self._maps()
        self.may_change = False

    def _maps(self) -> tuple[Any, ...]:
        mapper = self.node._mapper
        return (mapper.perceptions, *(getattr(mapper, name).copy() for name in ARRAYS))

    def check(self) -> None:
        """Hold what must be true after every call."""
        self.node._maps.advance()
        now = self._maps()
        if now[0] == self.before[0] and not self.may_change:
            for name, old, new in zip(ARRAYS, self.before[1:], now[1:], strict=True):
                assert np.array_equal(old, new), f"{name} changed without a perception"
        for name, values in zip(ARRAYS[:4], now[1:5], strict=True):
            assert ((values >= 0.0) & (values <= 1.0)).all(), f"{name} left [0, 1]"
        assert (now[5] <= now[0]).all()
        assert self.node._assembler.waiting <= MOST_WAITING
        for followed in self.followed:
            followed.check()
        self.before = now
        self.may_change = False

    def message(self, name: str, message: Any, refused_by: Any) -> None:
        """Hand a message to its callback; what conversions refuse is counted, once."""
        self.counts[name] += 1
        try:
            refused_by(message)
            refused = False
        except conversions.Refused as error:
            check_words(error)
            refused = True
        # What waited before may be given up meanwhile, and is counted as well.
        rejected, waiting = self.bench.rejected(name), self.node._assembler.waiting
        getattr(self.node, f"_on_{name}")(message)
        if refused:
            assert self.bench.rejected(name) == rejected + 1, f"{name} was not counted"
            assert self.node._assembler.waiting <= waiting

    def send_pose(self, draw: Draw, after: float) -> None:
        message = messages.stamped_pose(draw, self.bench.now + after, *self.pose)
        self.message("pose", message, conversions.stamped_pose_from_msg)

    def send_joint(self, draw: Draw, after: float) -> None:
        joint = self.p.turret.joint
        message = messages.joint_state(draw, self.bench.now + after, joint, self.angle)
        self.message(
            "joint_state", message, lambda m: conversions.joint_position(m, joint, "joint state")
        )

    def send_range(self, draw: Draw, after: float, sensor: int) -> None:
        sonar = self.p.sonar
        message = messages.range_of(
            draw, self.bench.now + after, sonar.frame_ids[sensor], sonar.field_of_view
        )
        self.message(
            "sonar",
            message,
            lambda m: conversions.range_from_msg(m, sonar.frame_ids, sonar.field_of_view),
        )

    def send_infrared(self, draw: Draw, after: float) -> None:
        frames = self.p.infrared.frame_ids
        message = messages.range_of(draw, self.bench.now + after, draw.choice(frames), 0.1)
        self.message("infrared", message, lambda m: conversions.range_from_msg(m, frames))

    def packet(self, draw: Draw) -> None:
        """What a robot sends, mostly."""
        x, y = self.pose
        self.pose = (x + draw.between(-0.2, 0.2), y + draw.between(-0.2, 0.2))
        if self.node._build_map.sequence is not None:
            self.angle = draw.choice(self.p.turret.angles)
        self.bench.set(self.bench.now + 0.2)
        for after in (-0.2, 0.0):
            self.send_pose(draw, after)
            self.send_joint(draw, after)
            if after:
                for sensor in range(draw.below(len(self.p.sonar.frame_ids) + 1)):
                    self.send_range(draw, -0.1, sensor)
                self.send_infrared(draw, -0.1)

    def build_map(self, draw: Draw) -> None:
        server = self.node._build_map
        self.asked += 1
        self.counts["build_map"] += 1
        if server._on_goal(None) is GoalResponse.ACCEPT:
            handle = GoalHandle(self.asked)
            handle.start = server._execute
            self.goals.append(handle)
            server._on_accepted(handle)

    def cancel(self) -> None:
        self.counts["cancel"] += 1
        for goal in self.goals:
            if goal.is_active:
                goal.state = "canceling"

    def service(self, draw: Draw) -> None:
        """Reset, save, load, get."""
        kind = draw.byte() % 6
        if kind == 0:
            self.counts["reset_map"] += 1
            self.may_change = True
            services = self.node._map_services
            assert self.served(services._on_reset(Trigger.Request(), Trigger.Response())).success
            assert self.node._mapper.perceptions == 0
        elif kind <= 3:
            # Only good names: those that are not have a surface of their own.
            path = draw.choice(("a", "b", "other", "junk", "", "..", "x/y"))
            name = "save" if kind == 1 and path not in ("other", "junk") else "load"
            self.counts[f"{name}_map"] += 1
            rejected = self.bench.rejected()
            request = MapFile.Request(path=path)
            callback = getattr(self.node._map_services, f"_on_{name}")
            answer = self.served(callback(request, MapFile.Response()))
            assert 0 < len(answer.message) < 3000
            assert answer.success or self.bench.rejected() == rejected + 1
            self.may_change = answer.success and name == "load"
        else:
            self.counts["get_map"] += 1
            for service in (s for s in self.node.services if s.srv_type is GetMap):
                answer = service.callback(GetMap.Request(), GetMap.Response())
                values = np.asarray(answer.map.data)
                assert values.min() >= 0
                assert values.max() <= 100

    def served(self, work: Any) -> Any:
        """Return the answer of a service's coroutine, whose files a thread sees to."""
        done, answer = finished(work)
        while not done:
            self.node._map_services.finish()
            done, answer = finished(work)
        return answer

    def step(self, draw: Draw) -> None:
        """One thing that happens."""
        kind = draw.byte() % 16
        if kind <= 3:
            self.packet(draw)
        elif kind <= 6:
            sender = draw.choice((self.send_pose, self.send_joint, self.send_infrared))
            sender(draw, draw.choice((0.0, 0.0, -0.1, 0.1)))
        elif kind <= 9:
            self.send_range(draw, -0.05, draw.below(len(self.p.sonar.frame_ids)))
        elif kind == 10:
            self.build_map(draw)
        elif kind == 11:
            self.cancel()
        elif kind == 12:
            self.service(draw)
        elif kind <= 14:
            self.bench.wait(draw)
            self.node._advance()
        else:
            self.counts["diagnostics"] += 1
            self.node._diagnostics.publish()
        self.check()

    def end(self) -> None:
        """Whatever went before, a perception ends, and each goal has one result."""
        self.node.on_stop()
        for goal in self.goals:
            assert not goal.is_active
            assert goal.work is not None
            done, result = finished(goal.work)
            assert done
            assert result.message or goal.state == "succeeded"
        self.check()


@contextlib.contextmanager
def _opened(mode: str, counts: Counter[str]) -> Iterator[Target]:
    with scratch_folder() as folder:
        parameters = {
            "mode": mode,
            "preset": "consistent",
            "packet_size": 5,
            "area.size_x": 1.8,
            "area.size_y": 1.5,
            "area.resolution": 0.15,
            "map_folder": folder,
            # On demand the map is a small one, else each packet's window is published.
            "publishing.small_map": 1000 if mode == "on_demand" else 0,
        }
        with node_of(MapperNode, parameters, [clock]) as (node, bench):
            node._turret.publish = _TurretCheck(node, node._turret.publish)
            followed = [Followed(each) for each in node._maps._maps[:2]]
            (folder / "junk").write_bytes(b"PK")
            (folder / "a").write_bytes(b"")

            def target(data: bytes) -> None:
                draw = Draw(data)
                case = Case(node, bench, counts, followed)
                for _ in range(MOST_CALLS):
                    if not draw.left:
                        break
                    case.step(draw)
                case.end()

            yield target


class _TurretCheck:
    """Publishes, if the turret is sent to one of its angles."""

    def __init__(self, node: MapperNode, publish: Any) -> None:
        self._node = node
        self._publish = publish

    def __call__(self, message: Any) -> None:
        assert message.data in self._node._settings.values.turret.angles
        self._publish(message)


@contextlib.contextmanager
def _parameters_opened(counts: Counter[str]) -> Iterator[Target]:
    parameters = {"preset": "consistent", "area.size_x": 1.8, "area.size_y": 1.5}
    with node_of(MapperNode, parameters, [clock]) as (node, bench):
        followed = [Followed(each) for each in node._maps._maps[:2]]
        names = [*flatten(node._settings.values), "preset", "use_sim_time"]
        start = node._settings.values
        good = [p.to_parameter_msg() for p in node.get_parameters(list(flatten(start)))]

        def target(data: bytes) -> None:
            draw = Draw(data)
            changeable = [p for p in good if not _read_only(node, p.name)]
            if node._settings.values != start:
                bench.set_parameters(changeable)
            case = Case(node, bench, counts, followed)
            for _ in range(4):
                if not draw.left:
                    break
                before = node._settings.values
                rejected = bench.rejected()
                bench.ask_parameters(draw, names, counts)
                if node._settings.values == before:
                    assert bench.rejected() >= rejected
                case.p = node._settings.values
                case.may_change = node._settings.values != before
                case.check()
                case.packet(draw)
                case.check()
            case.end()

        yield target


def _read_only(node: Any, name: str) -> bool:
    return bool(node.describe_parameter(name).read_only)


def _seeds() -> list[bytes]:
    packet = bytes([0]) + bytes(60)
    return [
        packet * 3,
        bytes([10]) + packet * 4,
        bytes([10, 13, 0, 0, 10, 11, 13, 9]),
        bytes(range(256)),
        bytes(range(255, -1, -1)) * 2,
        bytes([12, 1, 0, 12, 2, 0, 12, 0]) + packet + bytes([12, 1, 1, 12, 3, 1]),
    ]


_COUNTS = {name: Counter[str]() for name in ("on_demand", "continuous", "parameters")}
SURFACES = (
    Surface(
        "mapper",
        lambda: _opened("on_demand", _COUNTS["on_demand"]),
        _seeds,
        longest=256,
        counts=_COUNTS["on_demand"],
    ),
    Surface(
        "mapper_continuous",
        lambda: _opened("continuous", _COUNTS["continuous"]),
        _seeds,
        longest=256,
        counts=_COUNTS["continuous"],
    ),
    Surface(
        "mapper_parameters",
        lambda: _parameters_opened(_COUNTS["parameters"]),
        _seeds,
        longest=256,
        counts=_COUNTS["parameters"],
    ),
)
