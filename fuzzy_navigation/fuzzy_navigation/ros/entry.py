# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the executables begin."""

from __future__ import annotations

from fuzzy_map_building.ros.entry import start

__all__ = ["bringup", "motion", "planner"]


def planner() -> int:
    """Run the node ``fuzzy_planner``."""
    return start("fuzzy_navigation.ros.planner_node")


def motion() -> int:
    """Run the node ``fuzzy_motion``."""
    return start("fuzzy_navigation.ros.motion_node")


def bringup() -> int:
    """Start the nodes of a real robot."""
    return start("fuzzy_navigation.ros.bringup")
