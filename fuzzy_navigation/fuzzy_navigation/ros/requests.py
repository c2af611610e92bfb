# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Positions that requests and goals name, checked."""

from __future__ import annotations

from geometry_msgs.msg import PoseStamped

from fuzzy_map_building.plain_yaml import shown
from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.conversions import Refused, pose_from_msg
from fuzzy_map_building.types import Pose2

__all__ = ["requested_pose"]


def requested_pose(message: PoseStamped, what: str) -> Pose2:
    """Return a pose that somebody asked for; its stamp is not looked at.

    Parameters
    ----------
    message : PoseStamped
        In the frame ``map``; an empty frame means the same.
    what : str
        What to call it in the message of a refusal.

    Raises
    ------
    Refused
        ``wrong_frame``, ``not_finite``, ``too_far``, ``quaternion_norm`` or ``tilted``.
    """
    frame = message.header.frame_id
    if frame not in ("", names.MAP_FRAME):
        raise Refused(
            "wrong_frame",
            f"{what} is in frame {shown(frame)}, expected '{names.MAP_FRAME}': transform it first",
        )
    return pose_from_msg(message.pose, what)
