# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Names of nodes, frames, topics, services and actions, in one place.

All names are relative, so that a namespace makes a second robot; only ``/clock`` is
absolute, because rclpy subscribes to it there.
"""

from __future__ import annotations

from typing import Final

# Nodes.
MAPPER_NODE: Final = "fuzzy_mapper"
PLANNER_NODE: Final = "fuzzy_planner"
MOTION_NODE: Final = "fuzzy_motion"
SIMULATOR_NODE: Final = "nomad_sim"

# Frames (REP 105).
MAP_FRAME: Final = "map"
ODOM_FRAME: Final = "odom"
BASE_FRAME: Final = "base_link"
TURRET_FRAME: Final = "turret_link"

# Topics from the robot.
SONAR: Final = "sonar"
INFRARED: Final = "infrared"
JOINT_STATES: Final = "joint_states"
POSE: Final = "pose"
ODOM: Final = "odom"
CLOCK: Final = "/clock"

# Topics to the robot.
CMD_VEL: Final = "cmd_vel"
STAMPED_CMD_VEL: Final = "cmd_vel_stamped"
TURRET_COMMAND: Final = "turret/command"
GOAL_POSE: Final = "goal_pose"

# Topics of the mapper and the planner.
MOTION_MAP: Final = "motion_map"
PLANNING_MAP: Final = "planning_map"
MAP: Final = "map"
PLAN: Final = "plan"
DIAGNOSTICS: Final = "diagnostics"

# Topics for evaluation only: no node of the method may subscribe to them.
GROUND_TRUTH_MAP: Final = "ground_truth/map"
GROUND_TRUTH_POSE: Final = "ground_truth/pose"
CONTACT: Final = "contact"

# Services.
GET_MOTION_MAP: Final = "motion_map/get"
GET_PLANNING_MAP: Final = "planning_map/get"
RESET_MAP: Final = "reset_map"
SAVE_MAP: Final = "save_map"
LOAD_MAP: Final = "load_map"
GET_PLAN: Final = "get_plan"
PLAN_PATH: Final = "plan_path"
RESET_SIMULATOR: Final = "reset"

# Actions.
BUILD_MAP: Final = "build_map"
NAVIGATE: Final = "navigate"


def updates_of(topic: str) -> str:
    """Return the topic of the windows of a map, ``<topic>_updates``."""
    return f"{topic}_updates"


def sonar_frame(index: int) -> str:
    """Return the frame of sonar number `index`, ``sonar_<index>``."""
    return f"sonar_{index}"


def infrared_frame(index: int) -> str:
    """Return the frame of infrared sensor number `index`, ``infrared_<index>``."""
    return f"infrared_{index}"
