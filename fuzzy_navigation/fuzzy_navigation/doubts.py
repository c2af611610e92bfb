# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Reasons to doubt what a mission has learnt, and how often they make it look again.

A pose that jumps puts what is seen from then on beside what was seen before; bursts of noise
put obstacles where there are none. What follows from either is remembered as if it were true,
and may close every way. A goal is therefore not called unreachable as long as there is a doubt:
the robot forgets what it has tried in vain, and looks again.
"""

from __future__ import annotations

__all__ = ["Doubts"]

#: How often a mission begins to look again; its perceptions run out sooner or later.
MOST_TIMES = 10


class Doubts:
    """The doubts of a mission, each good for one more look at everything."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Have no doubt: a mission begins."""
        self._times = 0
        self._open = False
        self._reason = ""

    @property
    def reason(self) -> str:
        """The last reason for a doubt; empty if there was none."""
        return self._reason

    def note(self, reason: str) -> None:
        """Take note of a reason for a doubt, in words; an empty one is none."""
        if reason:
            self._open = True
            self._reason = reason

    def look_again(self) -> bool:
        """Tell whether something happened since the last time that is worth another look."""
        again = self._open and self._times < MOST_TIMES
        self._times += again
        self._open = False
        return again
