# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""All surfaces by name; what a surface needs is imported when it is asked for."""

from __future__ import annotations

import importlib

from fuzz.surface import Surface

__all__ = ["surface_named", "surface_names"]

#: Where each one is defined.
_MODULES = {
    "map_file": "fuzz_map_file",
    "map_name": "fuzz_map_file",
    "floor_plan": "fuzz_floor_plan",
    "world": "fuzz_world",
    "parameters": "fuzz_parameters",
    "parameter_file": "fuzz_parameters",
    "command_line": "fuzz_parameters",
    "trials": "fuzz_trials",
    "wire": "fuzz_wire",
    "mapper": "fuzz_mapper",
    "mapper_continuous": "fuzz_mapper",
    "mapper_parameters": "fuzz_mapper",
    "planner": "fuzz_planner",
    "motion": "fuzz_motion",
    "simulator": "fuzz_simulator",
}


def surface_names() -> list[str]:
    """Return the names of all surfaces."""
    return list(_MODULES)


def surface_named(name: str) -> Surface:
    """Return a surface."""
    module = importlib.import_module(f"fuzz.{_MODULES[name]}")
    (found,) = (surface for surface in module.SURFACES if surface.name == name)
    assert isinstance(found, Surface)
    return found
