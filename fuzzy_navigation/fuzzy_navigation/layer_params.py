# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the clearance layer, which planner and motion have to agree on."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzy_map_building.parameter_schema import ParameterError, parameter, validate

__all__ = ["LayerParameters"]


@dataclass(frozen=True)
class LayerParameters:
    """What the clearance from the points that the sensors hit says of a cell."""

    enabled: bool = parameter(
        True,
        doc="whether hit points, of this perception and of the cells passed since, give cells a "
        "risk of their own on top of the map's; planner and motion have to agree",
    )
    closed: float = parameter(
        0.05,
        doc="clearance of the body below which no rung of the ladder admits a cell",
        unit="m",
        minimum=0.0,
        maximum=2.0,
    )
    limit: float = parameter(
        0.12,
        doc="clearance at which a cell's risk is 0.6; from there it rises to 1 at the clearance "
        "where cells are closed",
        unit="m",
        minimum=0.0,
        maximum=2.0,
        source="paper, section V",
    )
    free: float = parameter(
        0.2,
        doc="clearance from which on a cell has no risk of its own",
        unit="m",
        minimum=0.0,
        maximum=2.0,
    )
    shift: float = parameter(
        0.045,
        doc="a cell counts by the best of nine places in it, its centre and those so far to its "
        "sides; of it counts no more than 0.45 of a cell",
        unit="m",
        minimum=0.0,
        maximum=1.0,
    )
    slack: float = parameter(
        0.015,
        doc="how much less clearance than the planner asked for stops the robot: what the "
        "infrareds' noise makes of a sweep",
        unit="m",
        minimum=0.0,
        maximum=1.0,
    )
    cost: float = parameter(
        0.8,
        doc="part of the layer's risk, of no more than 1, that a path pays",
        minimum=0.0,
        maximum=1.0,
    )

    def __post_init__(self) -> None:
        validate(self)
        if not self.closed < self.limit < self.free:
            raise ParameterError(
                "the clearances 'layer.closed', 'layer.limit' and 'layer.free' must rise, got "
                f"{self.closed}, {self.limit} and {self.free} m"
            )
