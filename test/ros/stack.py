# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What tests and studies ask of nodes that run together: what they say, how the robot moves."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.conversions import stamped_pose_from_msg
from ros.harness import START_DEADLINE, Probe, Received, wait_until

__all__ = ["Status", "silent", "speeds"]


class Status:
    """What one node says of itself."""

    def __init__(self, probe: Probe, node: str) -> None:
        self._node = node
        self._heard: Received[DiagnosticArray] = probe.subscribe(
            DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE
        )

    def forget(self) -> None:
        """Forget what was heard so far."""
        self._heard.clear()

    def values(self) -> list[dict[str, str]]:
        """Return what was heard since `forget`, oldest first."""
        said = [status for message in list(self._heard.messages) for status in message.status]
        return [{v.key: v.value for v in s.values} for s in said if s.name == self._node]

    def wait(
        self,
        matches: Callable[[dict[str, str]], bool],
        what: str,
        timeout: float = START_DEADLINE,
    ) -> dict[str, str]:
        """Return the first values heard since `forget` that match."""
        return wait_until(lambda: [v for v in self.values() if matches(v)][:1], what, timeout)[0]


def speeds(poses: Sequence[PoseStamped]) -> list[tuple[float, float]]:
    """Return (time [s], speed [m/s] since the pose before) of poses that differ in time."""
    known = dict(stamped_pose_from_msg(message) for message in list(poses))
    return [
        (t, known[t].distance_to(known[s].x, known[s].y) / (t - s))
        for s, t in itertools.pairwise(sorted(known))
    ]


def silent(received: Received[PoseStamped], seconds: float) -> bool:
    """Whether nothing comes for some wall time [s], waiting for it."""
    count, end = len(received), time.monotonic() + seconds
    while len(received) == count and time.monotonic() < end:
        time.sleep(0.01)
    return len(received) == count
