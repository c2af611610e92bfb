# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages of one topic taken all at once.

The executor takes one message of each topic a round. Where a topic brings sixteen
messages for one of another, it falls behind the other for good as soon as both have a
backlog, and a round for each message costs more than the message.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rclpy.subscription import Subscription

__all__ = ["take_waiting"]


def take_waiting(subscription: Subscription) -> Iterator[Any]:
    """Yield the messages that wait in a subscription's queue, oldest first.

    Call it in a callback of the subscription's own executor only.
    """
    while True:
        with subscription.handle:
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        if taken is None:
            return
        yield taken[0]
