# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Two times: the node's (simulated or not), and one that always runs."""

from __future__ import annotations

from collections.abc import Callable

from builtin_interfaces.msg import Time
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.timer import Timer

__all__ = ["create_steady_timer", "now_seconds", "seconds_from_stamp", "stamp_from_seconds"]

_NANOSECONDS = 1_000_000_000


def now_seconds(node: Node) -> float:
    """Return the node's time [s]; 0 while simulated time has not begun."""
    return float(node.get_clock().now().nanoseconds) / _NANOSECONDS


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
    whole, nanoseconds = divmod(round(seconds * _NANOSECONDS), _NANOSECONDS)
    return Time(sec=whole, nanosec=nanoseconds)


def create_steady_timer(node: Node, period: float, callback: Callable[[], None]) -> Timer:
    """Return a timer with a period [s] of wall time, which runs also while /clock stands."""
    return node.create_timer(period, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))
