# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the simulator's executable begins."""

from __future__ import annotations

from fuzzy_map_building.ros.entry import start

__all__ = ["sim"]


def sim() -> int:
    """Run the node ``nomad_sim``."""
    return start("nomad_sim.ros.sim_node")
