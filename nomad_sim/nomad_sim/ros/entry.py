# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the executables begin."""

from __future__ import annotations

from typing import Final

from fuzzy_map_building.ros.entry import start

__all__ = ["campaign", "demo", "sim"]

#: Exit code of a demonstration that was stopped.
_STOPPED: Final = 130


def sim() -> int:
    """Run the node ``nomad_sim``."""
    return start("nomad_sim.ros.sim_node")


def demo() -> int:
    """Run the demonstration."""
    return start("nomad_sim.ros.demo", _STOPPED)


def campaign() -> int:
    """Run a campaign, which needs no ROS."""
    return start("nomad_sim.campaign", None)
