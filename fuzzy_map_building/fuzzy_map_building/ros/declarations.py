# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the mapper declares: for the node itself, and for who asks before it is started."""

from __future__ import annotations

import functools

from fuzzy_map_building.params import DEFAULT_PRESET, PRESETS, mapper_parameters
from fuzzy_map_building.ros.parameters import declare_parameters

__all__ = ["declare_mapper"]

#: `declare_parameters` of a node that is a mapper.
declare_mapper = functools.partial(
    declare_parameters,
    factory=mapper_parameters,
    presets=PRESETS,
    default_preset=DEFAULT_PRESET,
)
