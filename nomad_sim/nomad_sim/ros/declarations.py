# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the simulator declares: for the node itself, and for who asks before it is started."""

from __future__ import annotations

import functools

from fuzzy_map_building.ros.parameters import declare_parameters
from nomad_sim.ros.params import simulation_parameters

__all__ = ["declare_simulation"]

#: `declare_parameters` of a node that is the simulator.
declare_simulation = functools.partial(
    declare_parameters, factory=lambda _, given: simulation_parameters(given)
)
