# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Stand-ins for the clients by which the motion asks its partners."""

from __future__ import annotations

from typing import Any

from rclpy.task import Future

__all__ = ["Partner", "Perception"]


class Partner:
    """Stands in for a client of the mapper or the planner: keeps what it is asked."""

    def __init__(self) -> None:
        self.ready = True
        self.asked: list[tuple[Any, Future]] = []

    def service_is_ready(self) -> bool:
        return self.ready

    server_is_ready = service_is_ready

    def call_async(self, request: Any) -> Future:
        self.asked.append((request, Future()))
        return self.asked[-1][1]

    send_goal_async = call_async

    def remove_pending_request(self, future: Future) -> None:
        """The real client forgets it; here it may be answered all the same."""


class Perception:
    """A goal that the mapper has taken or not."""

    def __init__(self, accepted: bool) -> None:
        self.accepted = accepted
        self.result = Future()

    def get_result_async(self) -> Future:
        return self.result

    def cancel_goal_async(self) -> None:
        """Whether it is cancelled the case says."""
