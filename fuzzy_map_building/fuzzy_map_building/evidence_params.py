# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the evidence: what readings say of cells, and how that is fused."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzy_map_building.parameter_schema import parameter, validate

__all__ = [
    "ConsistencyParameters",
    "EvidenceParameters",
    "FusionParameters",
    "InfraredEvidenceParameters",
]

_PAPER = "Oriolo 1998"


@dataclass(frozen=True)
class EvidenceParameters:
    """What one reading says of a cell, equations (1)-(5)."""

    # Few cones look through a doorway from before it, and the mean of perceptions does not grow:
    # with the paper's 0.4 what was seen to be free through a narrow door did not open it.
    k_empty: float = parameter(
        0.6,
        doc="k_E: greatest belief of empty that one reading gives",
        minimum=0.0,
        maximum=1.0,
        source=f"{_PAPER}, equation (2), with 0.4 in section V; measured",
    )
    k_occupied: float = parameter(
        0.4,
        doc="k_O: greatest belief of occupied that one reading gives",
        minimum=0.0,
        maximum=1.0,
        source=f"{_PAPER}, equation (3) and section V",
    )
    range_margin: float = parameter(
        0.1,
        doc="Delta r: half width of the band around the range that counts as its arc",
        unit="m",
        minimum=1e-3,
        maximum=10.0,
        source=f"{_PAPER}, equations (2), (3), with 0.15 in section V; measured",
    )
    visibility_radius: float = parameter(
        1.5,
        doc="rho_v: farther than this from the sensor a reading says nothing",
        unit="m",
        minimum=0.01,
        maximum=100.0,
        source=f"{_PAPER}, sections III-B and V",
    )
    dombi_lambda: float = parameter(
        0.4,
        doc="lambda of the Dombi union; the smaller, the more concordant readings add up",
        minimum=0.05,
        maximum=20.0,
        source=f"{_PAPER}, equation (18) and section V",
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class ConsistencyParameters:
    """Which part of an arc the other readings of the packet leave occupied."""

    enabled: bool = parameter(
        True,
        doc="whether a longer reading vetoes the arc of a shorter one where it looks, and what "
        "remains of the arc is rescaled to 1",
    )
    half_width: float = parameter(
        math.radians(8.0),
        doc="a reading looks this far to either side of its axis; not less than the angle from "
        "one reading to the next",
        unit="rad",
        minimum=0.0,
        maximum=math.pi,
        source="measured",
    )
    threshold: float = parameter(
        0.05,
        doc="a reading that is longer by less than this vetoes nothing",
        unit="m",
        minimum=0.0,
        maximum=10.0,
        source="measured",
    )
    ramp: float = parameter(
        0.1,
        doc="a reading that is longer by the threshold and this vetoes wholly",
        unit="m",
        minimum=1e-3,
        maximum=10.0,
        source="measured",
    )
    floor: float = parameter(
        0.05,
        doc="an arc of which no more than this remains anywhere is believed as it is",
        minimum=0.0,
        maximum=1.0,
        source="measured",
    )
    max_offset: float = parameter(
        0.1,
        doc="readings taken farther apart than this, across the shorter one's axis, do not look "
        "along the same way",
        unit="m",
        minimum=0.0,
        maximum=10.0,
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class InfraredEvidenceParameters:
    """What infrared readings say of cells, and which of them enter a packet."""

    enabled: bool = parameter(
        True,
        doc="whether infrared readings give evidence besides the sonars'",
        read_only=True,
    )
    certainty: float = parameter(
        0.9,
        doc="k_I: greatest belief of empty and of occupied that a reading gives",
        minimum=0.0,
        maximum=1.0,
        source="measured",
    )
    range_margin: float = parameter(
        0.06,
        doc="Delta r_I: half width of the band around the range that counts as the surface",
        unit="m",
        minimum=1e-3,
        maximum=10.0,
        source="measured",
    )
    widening: float = parameter(
        0.07,
        doc="half the width of a ray, as a share of the distance; at least half a cell",
        minimum=0.0,
        maximum=10.0,
        source="measured",
    )
    sweep_spacing: float = parameter(
        0.1,
        doc="way from one sweep of the ring to the next while the robot moves",
        unit="m",
        minimum=1e-3,
        maximum=100.0,
        source="measured",
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class FusionParameters:
    """How the evidence of a packet enters the map, equations (6)-(10)."""

    rule: str = parameter(
        "fuzzy",
        doc="theory by which evidence is fused into the map",
        choices=("fuzzy",),
        source=f"{_PAPER}, section III-C",
    )
    aggregation: str = parameter(
        "mean",
        doc="weighted mean over the perceptions ('mean': a map that follows changes), Dombi "
        "union ('dombi') or greatest value ('max'), both for a world that stays as it is",
        choices=("mean", "dombi", "max"),
        source=f"{_PAPER}, equations (6)-(9); 'max': Lachekhab et al.",
    )
    max_count: int = parameter(
        3,
        doc="N_max: the weighted mean counts no more perceptions of a cell than this; the "
        "smaller, the sooner the map follows a change",
        minimum=1,
        maximum=1_000_000,
        source=f"{_PAPER}, equation (10) and section V",
    )

    def __post_init__(self) -> None:
        validate(self)
