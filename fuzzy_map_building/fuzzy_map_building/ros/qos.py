# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Quality-of-service profiles by the kind of data, used by publishers and subscribers alike."""

from __future__ import annotations

from typing import Final

from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
)


def _profile(
    depth: int,
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE,
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE,
) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=reliability,
        durability=durability,
    )


#: ``sonar`` and ``infrared``: a late range is worth less than the next one. The depth holds a
#: packet, so that nothing is lost while the maps are computed and published.
RANGES: Final = _profile(50, ReliabilityPolicy.BEST_EFFORT)

#: ``joint_states``: sensor data, as deep as the ranges that are placed by it.
JOINT_STATES: Final = _profile(50, ReliabilityPolicy.BEST_EFFORT)

#: Commands, poses, odometry, goals, diagnostics: nothing may get lost.
RELIABLE: Final = _profile(10)

#: Maps, plans: whoever subscribes later receives the last one.
LATCHED: Final = _profile(1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

#: Windows of maps: each goes on from the one before.
WINDOWS: Final = _profile(50)

#: Requests of services and actions: so many may wait while one is served. The default of ROS
#: is 10; what comes on top of a full queue is lost without a word to anybody.
REQUESTS: Final = _profile(200)

#: ``/clock``: only the newest time matters. Reliable satisfies every subscriber.
CLOCK: Final = _profile(1)
