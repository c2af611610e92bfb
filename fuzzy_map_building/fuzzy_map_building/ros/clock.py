# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Two times: the node's (simulated or not), and one that always runs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Final

from builtin_interfaces.msg import Time
from rclpy.clock import Clock, JumpHandle, JumpThreshold, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.timer import Timer

__all__ = [
    "PatientTime",
    "StallWatch",
    "create_steady_timer",
    "known_seconds",
    "nanoseconds_from_stamp",
    "now_seconds",
    "on_clock_set_back",
    "seconds_from_stamp",
    "stamp_from_nanoseconds",
    "stamp_from_seconds",
]

_NANOSECONDS = 1_000_000_000
#: A clock that goes back by more than this [s] was set back; less is jitter on the network.
_SET_BACK: Final = 0.5


def now_seconds(node: Node) -> float:
    """Return the node's time [s]; 0 while simulated time has not begun."""
    return float(node.get_clock().now().nanoseconds) / _NANOSECONDS


def known_seconds(node: Node) -> float:
    """Return the node's time [s]; infinite while simulated time has not begun."""
    return now_seconds(node) or math.inf


def seconds_from_stamp(stamp: Time) -> float:
    """Return a message's stamp [s]."""
    return float(stamp.sec) + float(stamp.nanosec) / _NANOSECONDS


def stamp_from_seconds(seconds: float) -> Time:
    """Return the stamp of a time [s], to the nearest nanosecond.

    Raises
    ------
    ValueError
        If the time is not finite, negative or beyond the range of a stamp.
    """
    if not 0.0 <= seconds < 2**31:
        raise ValueError(f"a stamp lies in [0, 2^31) s, got {seconds}")
    whole = int(seconds)
    # The product of the whole time would lose the nanoseconds of a wall clock.
    carry, nanoseconds = divmod(round((seconds - whole) * _NANOSECONDS), _NANOSECONDS)
    return Time(sec=whole + carry, nanosec=nanoseconds)


def nanoseconds_from_stamp(stamp: Time) -> int:
    """Return a message's stamp [ns], exactly."""
    return int(stamp.sec) * _NANOSECONDS + int(stamp.nanosec)


def stamp_from_nanoseconds(nanoseconds: int) -> Time:
    """Return the stamp of a time that is not negative [ns]."""
    seconds, rest = divmod(nanoseconds, _NANOSECONDS)
    return Time(sec=seconds, nanosec=rest)


def on_clock_set_back(node: Node, callback: Callable[[TimeJump], None]) -> JumpHandle:
    """Call back whenever the node's clock was set back.

    Parameters
    ----------
    node : Node
        Whose clock.
    callback : callable
        Takes the jump.

    Returns
    -------
    JumpHandle
        To be kept; ``unregister`` ends it.
    """
    threshold = JumpThreshold(
        min_forward=None, min_backward=Duration(seconds=-_SET_BACK), on_clock_change=False
    )
    return node.get_clock().create_jump_callback(threshold, post_callback=callback)


def create_steady_timer(node: Node, period: float, callback: Callable[[], None]) -> Timer:
    """Return a timer with a period [s] of wall time, which runs also while /clock stands."""
    return node.create_timer(period, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))


class PatientTime:
    """The node's time for limits of waiting, which a slow process must not meet.

    Simulated time may run many times faster than wall time, and a busy machine may hold
    the process up while messages queue: a limit of two seconds is then over in an instant,
    and what was waited for lies in the queue. This time goes no faster than wall time, and
    not at all while the process is held up.

    Parameters
    ----------
    now : float
        The node's time when the waiting begins [s].
    """

    #: Longest time between two looks for which the process counts as awake [s of wall time].
    AWAKE: Final = 0.1

    def __init__(self, now: float) -> None:
        self._start = now
        self._awake = 0.0
        self._last = time.monotonic()

    def read(self, now: float) -> float:
        """Return the time [s] to compare with a limit, at most the node's time `now`."""
        wall = time.monotonic()
        self._awake += min(wall - self._last, self.AWAKE)
        self._last = wall
        return min(now, self._start + self._awake)


class StallWatch:
    """Notices that simulated time stands still, where waits of simulated time never end.

    Parameters
    ----------
    limit : float
        Wall time [s] that the node's time may stand.
    """

    def __init__(self, limit: float) -> None:
        self.limit = limit
        self.restart()

    def restart(self) -> None:
        """Begin anew, as if time had just advanced."""
        self._last = -1.0
        self._since = time.monotonic()

    def stalled(self, now: float) -> bool:
        """Return whether the node's time `now` [s] has stood for longer than the limit."""
        if now != self._last:
            self._last = now
            self._since = time.monotonic()
        return time.monotonic() - self._since > self.limit
