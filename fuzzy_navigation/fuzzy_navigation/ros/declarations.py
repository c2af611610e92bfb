# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What mapper, planner and motion declare, for who starts them as processes and asks before."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

from rclpy.node import Node

from fuzzy_map_building.params import DEFAULT_PRESET, mapper_parameters
from fuzzy_map_building.params import PRESETS as MAPPER_PRESETS
from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.parameters import declare_parameters
from fuzzy_map_building.ros.rehearsal import check_parameters
from fuzzy_navigation.params import (
    MOTION_PRESETS,
    PLANNER_PRESETS,
    motion_parameters,
    planner_parameters,
)

__all__ = ["DECLARATIONS", "refusals"]

#: Name of each node by process, and what declares its parameters.
DECLARATIONS: Final[Mapping[str, tuple[str, Callable[[Node], Any]]]] = {
    "mapper": (
        names.MAPPER_NODE,
        lambda node: declare_parameters(
            node, mapper_parameters, MAPPER_PRESETS, default_preset=DEFAULT_PRESET
        ),
    ),
    "planner": (
        names.PLANNER_NODE,
        lambda node: declare_parameters(node, planner_parameters, PLANNER_PRESETS),
    ),
    "motion": (
        names.MOTION_NODE,
        lambda node: declare_parameters(node, motion_parameters, MOTION_PRESETS),
    ),
}


def refusals(
    arguments: Mapping[str, Sequence[str]],
    declarations: Mapping[str, tuple[str, Callable[[Node], Any]]],
    domain: int | None = None,
) -> list[str]:
    """Return what nodes would say that refuse their parameters; empty if all take them.

    Parameters
    ----------
    arguments : mapping of str to sequence of str
        What follows ``--ros-args`` on the command line of each process.
    declarations : mapping
        As `DECLARATIONS`, for the same processes.
    domain : int, optional
        ROS domain; None: that of this process.
    """

    def told() -> Iterable[str]:
        for process, (name, declare) in declarations.items():
            try:
                check_parameters(name, declare, arguments[process], domain)
            except ValueError as error:
                yield " ".join(str(error).split())

    return list(told())
