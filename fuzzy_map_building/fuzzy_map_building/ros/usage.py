# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the option ``--help`` of each node prints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from fuzzy_map_building.ros import names

__all__ = ["USAGES"]


def _usage(package: str, executable: str, node: str, job: str, example: str) -> str:
    return f"""\
usage: {executable} [--ros-args [--params-file FILE] [-p NAME:=VALUE] [-r FROM:=TO] ...]

The node '{node}' {job}.

  --params-file FILE  YAML file with parameters, in a section '/**/{node}'
                      under 'ros__parameters'; may be given several times
  -p NAME:=VALUE      one parameter, such as {example}
  -r FROM:=TO         another name for a topic, a service or an action, such as
                      -r pose:=/localisation/pose; a namespace by -r __ns:=/robot1

All parameters, their defaults and units: share/{package}/config/{executable}.yaml in
the installed package, and the tables in README.md.
'ros2 run {package} {executable}' is the same program."""


_SIMULATED: Final = "use_sim_time:=true beside a simulator"

#: Texts by name of the node.
USAGES: Final[Mapping[str, str]] = {
    node: _usage(package, executable, node, job, example)
    for node, package, executable, job, example in (
        (
            names.MAPPER_NODE,
            "fuzzy_map_building",
            "mapper",
            "makes maps of risk from ranges, poses and the angle of the turret",
            _SIMULATED,
        ),
        (
            names.PLANNER_NODE,
            "fuzzy_navigation",
            "planner",
            "finds paths of least risk on the planning map",
            _SIMULATED,
        ),
        (
            names.MOTION_NODE,
            "fuzzy_navigation",
            "motion",
            "brings the robot to goals: asks for maps and paths, follows them, stops",
            _SIMULATED,
        ),
        (
            names.SIMULATOR_NODE,
            "nomad_sim",
            "sim",
            "is the simulated robot in its world, and gives the time",
            "world:=office",
        ),
    )
}
