# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How a mission waits: its time, its one open request, and holds until data is back."""

from __future__ import annotations

import math

__all__ = ["LONGEST_TICK", "Hold", "MissionTime", "OpenRequest"]

#: Longest time between two ticks that the motion is laid out for [s].
LONGEST_TICK = 0.2
#: Pause before a request that failed is made again [s].
RETRY_PAUSE = 1.0
#: A clock that reads less by no more than this [s] has not stepped back.
CLOCK_SLACK = 0.5


class MissionTime:
    """Time that never runs backwards, whatever the clock does."""

    def __init__(self) -> None:
        self.clock = -math.inf
        self.elapsed = 0.0

    @staticmethod
    def check(now: float) -> None:
        """Refuse a time that is none.

        Raises
        ------
        ValueError
            If `now` is not finite.
        """
        if not math.isfinite(now):
            raise ValueError(f"the time of an event must be finite, got {now}")

    def skip(self, now: float) -> float:
        """Let time go on to `now` [s] without any passing; return how much would have [s]."""
        skipped = max(now - self.clock, 0.0) if self.clock > -math.inf else 0.0
        self.clock += skipped
        return skipped

    def advance(self, now: float) -> bool:
        """Let time pass up to `now` [s]; tell whether the clock stepped back.

        Raises
        ------
        ValueError
            If `now` is not finite.
        """
        self.check(now)
        if self.clock > -math.inf:
            self.elapsed += max(now - self.clock, 0.0)
        stepped_back = now < self.clock - CLOCK_SLACK
        self.clock = now
        return stepped_back


class OpenRequest:
    """The request whose answer the mission waits for: deadline, retries, stale answers."""

    def __init__(self) -> None:
        self._serial = 0
        self._deadline = math.inf
        self._retry_at = math.inf
        self.failures = 0

    def make(self, time: float, timeout: float) -> int:
        """Return the serial number of a new request, to be answered within `timeout` [s]."""
        self._serial += 1
        self._deadline = time + timeout
        self._retry_at = math.inf
        return self._serial

    def settle(self) -> None:
        """Take note that nothing is waited for."""
        self._deadline = self._retry_at = math.inf
        self.failures = 0

    def fail(self, time: float) -> None:
        """Take note that it failed; it becomes due again after a pause."""
        self.failures += 1
        self._deadline = math.inf
        self._retry_at = time + RETRY_PAUSE

    @property
    def open(self) -> bool:
        """Whether an answer is waited for."""
        return self._deadline < math.inf

    def answered_by(self, serial: int) -> bool:
        """Whether an answer of this serial number is the one that is waited for."""
        return serial == self._serial and self._retry_at == math.inf

    def due(self, time: float) -> bool:
        """Whether to make it again."""
        return time >= self._retry_at

    def overdue(self, time: float) -> bool:
        """Whether its answer did not come in time."""
        return time > self._deadline


class Hold:
    """Why the robot has to stand, and since when."""

    def __init__(self) -> None:
        self.reason = ""
        self._since = 0.0

    def begin(self, time: float, reason: str) -> None:
        """Hold for a reason; a hold that goes on keeps its beginning."""
        if not self.reason:
            self._since = time
        self.reason = reason

    def end(self) -> None:
        """Hold no longer."""
        self.reason = ""

    def lasted(self, time: float) -> float:
        """Return for how long it has lasted [s]."""
        return time - self._since if self.reason else 0.0
