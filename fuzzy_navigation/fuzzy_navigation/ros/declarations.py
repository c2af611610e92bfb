# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What planner and motion declare, and for who starts all nodes whether each takes it."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, TypeAlias

from rclpy.node import Node

from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.declarations import declare_mapper
from fuzzy_map_building.ros.parameters import NodeParameters, declare_parameters
from fuzzy_map_building.ros.rehearsal import check_parameters
from fuzzy_navigation.agreement import disagreement, shared_parameters
from fuzzy_navigation.params import (
    MOTION_PRESETS,
    PLANNER_PRESETS,
    motion_parameters,
    planner_parameters,
)

__all__ = ["DECLARATIONS", "Declaration", "declare_motion", "declare_planner", "refusals"]

#: Name of a node, and what declares its parameters.
Declaration: TypeAlias = tuple[str, Callable[[Node], NodeParameters[Any]]]

#: `declare_parameters` of a node that is a planner, or the motion.
declare_planner = functools.partial(
    declare_parameters, factory=planner_parameters, presets=PLANNER_PRESETS
)
declare_motion = functools.partial(
    declare_parameters, factory=motion_parameters, presets=MOTION_PRESETS
)

#: By process.
DECLARATIONS: Final[Mapping[str, Declaration]] = {
    "mapper": (names.MAPPER_NODE, declare_mapper),
    "planner": (names.PLANNER_NODE, declare_planner),
    "motion": (names.MOTION_NODE, declare_motion),
}


def refusals(
    arguments: Mapping[str, Sequence[str]],
    declarations: Mapping[str, Declaration],
    domain: int | None = None,
) -> list[str]:
    """Return what nodes would say that refuse their parameters; empty if all take them.

    Planner and motion that do not agree would do so only when the first path is planned.

    Parameters
    ----------
    arguments : mapping of str to sequence of str
        What follows ``--ros-args`` on the command line of each process.
    declarations : mapping
        As `DECLARATIONS`, for the same processes.
    domain : int, optional
        ROS domain; None: that of this process.
    """
    told = []
    taken = {}
    for process, (name, declare) in declarations.items():
        try:
            taken[process] = check_parameters(name, declare, arguments[process], domain).values
        except ValueError as error:
            told.append(" ".join(str(error).split()))
    if "motion" in taken and "planner" in taken:
        both = shared_parameters(taken["motion"]), shared_parameters(taken["planner"])
        told += filter(None, [disagreement(*both)])
    return told
