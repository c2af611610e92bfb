# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a node refused and what it is doing, once a second on ``diagnostics``.

In a node::

    self._diagnostics = Diagnostics(self, values=lambda: {"perceptions": self._count})
    ...
    try:
        reading = conversions.range_from_msg(message, ...)
    except Refused as refusal:
        self._diagnostics.reject("sonar", refusal.reason, str(refusal))
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import create_steady_timer
from fuzzy_map_building.ros.rivals import Rivals

__all__ = ["LOG_PERIOD", "Diagnostics"]

#: Time between two messages [s of wall time]; a standing /clock must not silence them.
PERIOD: Final = 1.0
#: Least time between two log lines about the same kind of refusal or problem [s of wall time].
LOG_PERIOD: Final = 5.0


class Diagnostics:
    """Counts refusals by reason and publishes them with the node's own values.

    The status is named after the node. Its level is OK when nothing was refused in the
    last period, `problem` names none and there are no `rivals`, WARN otherwise.

    Parameters
    ----------
    node : Node
        Whose status this is.
    values : callable, optional
        Returns what else to publish, called once a period; values are shown as text.
    problem : callable, optional
        Returns why the node cannot do its work now, or '' when it can.
    rivals : Rivals, optional
        Looked at once a period.
    """

    def __init__(
        self,
        node: Node,
        values: Callable[[], Mapping[str, object]] | None = None,
        problem: Callable[[], str] | None = None,
        rivals: Rivals | None = None,
    ) -> None:
        self._node = node
        self._values = values
        self._problem = problem
        self._rivals = rivals
        self._counts: Counter[str] = Counter()
        self._new = 0
        self._last = ""
        self._latest: dict[str, str] = {}
        self._next_log: dict[str, float] = {}
        self._followed: dict[str, dict[str, int]] = {}
        self._publisher = node.create_publisher(DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE)
        self._timer = create_steady_timer(node, PERIOD, self.publish)

    def total(self, source: str) -> int:
        """Return how much of what came from `source` was refused so far."""
        start = source + "."
        return sum(n for key, n in self._counts.items() if key.startswith(start))

    def latest(self, source: str) -> str:
        """Return the sentence for what was refused last of what came from `source`; or empty."""
        return self._latest.get(source, "")

    def reject(self, source: str, reason: str, message: str, count: int = 1) -> None:
        """Count refused input and log it, at most one line in `LOG_PERIOD` of each kind.

        Parameters
        ----------
        source : str
            Topic, service, action or parameter that the input came by.
        reason : str
            One or two words that name the kind, e.g. ``unknown_frame``.
        message : str
            The sentence for the log: what was refused, why, and what to do.
        count : int
            How many at once.
        """
        if count < 1:
            return
        key = f"{source}.{reason}"
        self._counts[key] += count
        self._new += count
        self._last = f"{source}: {message}"
        self._latest[source] = message
        now = time.monotonic()
        if now >= self._next_log.get(key, 0.0):
            self._next_log[key] = now + LOG_PERIOD
            self._node.get_logger().warning(
                f"refused on {self._last} ({self._counts[key]} so far)"
            )

    def note(self, source: str, reason: str, count: int = 1) -> None:
        """Count what was not used although nothing is wrong: no line in the log, no warning.

        Parameters
        ----------
        source, reason, count
            As `reject` takes them.
        """
        self._counts[f"{source}.{reason}"] += count

    def follow(
        self,
        source: str,
        totals: Mapping[str, int],
        explanations: Mapping[str, str],
        examples: Mapping[str, str],
    ) -> None:
        """Take over what has been added to a counter of the core since the last call.

        Parameters
        ----------
        source : str
            Topic that the input came by.
        totals : mapping of str to int
            Running totals by reason; one that shrinks is taken for a new counter's.
        explanations : mapping of str to str
            The sentence for the log by reason; empty for what is only noted.
        examples : mapping of str to str
            What was refused last, in words, by reason.
        """
        seen = self._followed.setdefault(source, {})
        if totals == seen:
            return
        for reason, total in totals.items():
            before = seen.get(reason, 0)
            count = total - before if total >= before else total
            if count and not explanations[reason]:
                self.note(source, reason, count)
            elif count:
                text = f"{examples[reason]}: {explanations[reason]}"
                self.reject(source, reason, text, count)
        self._followed[source] = dict(totals)

    def publish(self) -> None:
        """Publish the status now."""
        status = DiagnosticStatus(name=self._node.get_name(), level=DiagnosticStatus.OK)
        # What is missing may be what was refused: both are told.
        problems = (
            self._problem() if self._problem is not None else "",
            self._rivals.look() if self._rivals is not None else "",
            f"{self._new} refused, last: {self._last}" if self._new else "",
        )
        self._new = 0
        if any(problems):
            status.level = DiagnosticStatus.WARN
        status.message = "; ".join(filter(None, problems)) or "ok"
        values = dict(self._values()) if self._values is not None else {}
        values.update((f"rejected.{key}", n) for key, n in sorted(self._counts.items()))
        status.values = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(array)
