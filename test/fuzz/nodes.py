# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Real nodes whose callbacks are called directly, with a clock that only the case turns."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from types import ModuleType, SimpleNamespace
from typing import Any, TypeVar

import rclpy
from rcl_interfaces.msg import Parameter
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time
from unique_identifier_msgs.msg import UUID

from fuzz import messages
from fuzz.draw import Draw

__all__ = ["START", "Bench", "GoalHandle", "finished", "node_of"]

N = TypeVar("N", bound=Node)
#: The parameter services, those that change something more often.
SERVICES = (
    *(SetParameters, SetParametersAtomically) * 3,
    *(GetParameters, DescribeParameters, GetParameterTypes, ListParameters),
)
#: What the clock shows when a case begins [s].
START = 1000.0


@contextlib.contextmanager
def node_of(
    kind: Callable[[], N], parameters: Mapping[str, object], clocks: Sequence[ModuleType]
) -> Iterator[tuple[N, Bench]]:
    """Yield a node with parameters, and the clocks of the modules given in the case's hand."""
    arguments = ["--ros-args", "--log-level", "fatal", "--disable-rosout-logs"]
    for name, value in parameters.items():
        arguments += ["-p", f"{name}:={str(value).lower() if isinstance(value, bool) else value}"]
    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    before = [module.time for module in clocks]
    bench = Bench()
    for module in clocks:
        module.time = SimpleNamespace(  # type: ignore[attr-defined]
            monotonic=lambda: bench.wall, perf_counter=lambda: bench.wall
        )
    try:
        node = kind()
        node.get_clock()._set_ros_time_is_active(True)
        bench.node = node
        yield node, bench
        node.destroy_node()
    finally:
        for module, clock in zip(clocks, before, strict=True):
            module.time = clock
        rclpy.try_shutdown()


class Bench:
    """The time that a case makes, and what all nodes have in common."""

    def __init__(self) -> None:
        self.now = START
        self.wall = 50.0
        self.node: Any = None

    def begin(self) -> None:
        """Set the clocks to where every case begins."""
        self.wall += 1000.0
        self.set(START)

    def set(self, now: float) -> None:
        """Turn the node's clock to a time [s]."""
        self.now = min(max(now, 0.001), 2.0**31 - 10.0)
        self.node.get_clock().set_ros_time_override(Time(nanoseconds=round(self.now * 1e9)))

    def wait(self, draw: Draw) -> None:
        """Let time pass, or step somewhere."""
        step = draw.choice((0.05, 0.05, 0.05, 0.2, 0.6, 1.5, 10.0, -0.3, -3.0, 200.0, -200.0))
        self.wall += max(0.0, min(step, 2.0)) if draw.byte() % 4 else 0.0
        self.set(self.now + step)

    def rejected(self, kind: str = "") -> int:
        """Return how much, or how much of a kind, the node has refused and counted so far."""
        counts = self.node._diagnostics._counts.items()
        return sum(int(count) for name, count in counts if name.startswith(kind))

    def ask_parameters(self, draw: Draw, names: Sequence[str], counts: Counter[str]) -> None:
        """Call one of the node's parameter services."""
        wanted = draw.choice(SERVICES)
        (service,) = (s for s in self.node.services if s.srv_type is wanted)
        request, response = wanted.Request(), wanted.Response()
        counts[wanted.__name__] += 1
        if wanted in (SetParameters, SetParametersAtomically):
            request.parameters = [messages.parameter(draw, names) for _ in range(draw.below(4))]
            told = service.callback(request, response)
            results = told.results if wanted is SetParameters else [told.result]
            assert all(result.successful or result.reason for result in results)
            assert all(len(result.reason) < 3000 for result in results)
        elif wanted is ListParameters:
            request.prefixes = [draw.text() for _ in range(draw.below(3))]
            request.depth = draw.choice((0, 1, 2**63, 2**64 - 1))
            service.callback(request, response)
        else:
            asked = [draw.text() if draw.one_in(3) else draw.choice(names) for _ in range(3)]
            request.names = asked
            service.callback(request, response)

    def set_parameters(self, given: Sequence[Parameter]) -> None:
        """Set parameters back, all of them together."""
        (service,) = (s for s in self.node.services if s.srv_type is SetParametersAtomically)
        request = SetParametersAtomically.Request(parameters=list(given))
        result = service.callback(request, SetParametersAtomically.Response()).result
        assert result.successful, result.reason


class GoalHandle:
    """An action server's handle of a goal, which holds its server to the states of rcl."""

    def __init__(self, number: int, request: Any = None) -> None:
        self.goal_id = UUID(uuid=list(number.to_bytes(16, "little")))
        self.request = request
        self.state = "accepted"
        self.feedback: list[Any] = []
        self.work: Coroutine[Any, Any, Any] | None = None
        self.start: Callable[[GoalHandle], Coroutine[Any, Any, Any]] | None = None

    @property
    def is_cancel_requested(self) -> bool:
        return self.state == "canceling"

    @property
    def is_active(self) -> bool:
        return self.state in ("accepted", "executing", "canceling")

    def execute(self) -> None:
        """Begin the work, as the executor does."""
        assert self.start is not None
        if self.state == "accepted":
            self.state = "executing"
        self.work = self.start(self)

    def publish_feedback(self, message: Any) -> None:
        assert self.is_active
        self.feedback.append(message)

    def _end(self, state: str, *before: str) -> None:
        assert self.state in before, f"{state} from {self.state}"
        self.state = state

    def succeed(self) -> None:
        self._end("succeeded", "executing", "canceling")

    def abort(self) -> None:
        self._end("aborted", "executing", "canceling")

    def canceled(self) -> None:
        self._end("canceled", "canceling")


def finished(work: Coroutine[Any, Any, Any]) -> tuple[bool, Any]:
    """Go on with a coroutine; return whether it is done, and its result."""
    try:
        work.send(None)
    except StopIteration as end:
        return True, end.value
    return False, None
