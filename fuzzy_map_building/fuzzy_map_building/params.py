# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parameters of map building, all groups together.

Sensors are declared in `sensor_params`, evidence and its fusion in `evidence_params`, the
other groups here.
Defaults are for a NOMAD 200 that navigates: the preset ``consistent``. `PRESETS` names other
sets, ``oriolo1998`` that of the navigation experiments of Oriolo, Ulivi and Vendittelli (1998),
section V. A node, a parameter file or a study starts from a preset and overrides single
parameters by dotted name.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fuzzy_map_building.evidence_params import (
    ConsistencyParameters,
    EvidenceParameters,
    FusionParameters,
    InfraredEvidenceParameters,
)
from fuzzy_map_building.grid import COARSEST, FINEST, GridGeometry
from fuzzy_map_building.parameter_schema import (
    ParameterError,
    from_mapping,
    parameter,
    suggest,
    validate,
)
from fuzzy_map_building.presets import DEFAULT_PRESET, PAPER_PRESET, PRESETS
from fuzzy_map_building.sensor_params import (
    InfraredParameters,
    SonarGuardParameters,
    SonarParameters,
)

__all__ = [
    "DEFAULT_PRESET",
    "PAPER_PRESET",
    "PRESETS",
    "AreaParameters",
    "ConsistencyParameters",
    "EvidenceParameters",
    "FusionParameters",
    "InfraredEvidenceParameters",
    "InfraredParameters",
    "MapperParameters",
    "PerceptionParameters",
    "PublishingParameters",
    "SnapshotParameters",
    "SonarGuardParameters",
    "SonarParameters",
    "TurretParameters",
    "mapper_parameters",
]

_LAB = "Oriolo 1998, section V"


@dataclass(frozen=True)
class AreaParameters:
    """The area that the map covers."""

    size_x: float = parameter(
        7.6, doc="extent along x", unit="m", minimum=0.01, maximum=1e5, source=_LAB, read_only=True
    )
    size_y: float = parameter(
        6.3, doc="extent along y", unit="m", minimum=0.01, maximum=1e5, source=_LAB, read_only=True
    )
    resolution: float = parameter(
        0.1,
        doc="side of a cell",
        unit="m",
        minimum=FINEST,
        maximum=COARSEST,
        source=_LAB,
        read_only=True,
    )
    origin_x: float = parameter(
        0.0,
        doc="x of the area's lower left corner in the frame map",
        unit="m",
        minimum=-1e7,
        maximum=1e7,
        read_only=True,
    )
    origin_y: float = parameter(
        0.0,
        doc="y of the area's lower left corner in the frame map",
        unit="m",
        minimum=-1e7,
        maximum=1e7,
        read_only=True,
    )

    def __post_init__(self) -> None:
        validate(self)
        try:
            self.geometry()
        except ValueError as error:
            raise ParameterError(f"parameters 'area.*': {error}") from error

    def geometry(self) -> GridGeometry:
        """Return the smallest grid that covers the area."""
        return GridGeometry.from_size(
            self.size_x, self.size_y, self.resolution, (self.origin_x, self.origin_y)
        )


@dataclass(frozen=True)
class TurretParameters:
    """The turret that carries the sonars."""

    joint: str = parameter(
        "turret_joint",
        doc="name of the turret's joint in joint_states; empty: the sonars sit on the base",
        read_only=True,
    )
    angles: tuple[float, ...] = parameter(
        (0.0, math.radians(7.5), math.radians(15.0)),
        doc="turret angles of one perception, in this order; without a turret one reading of "
        "each sonar is taken",
        unit="rad",
        minimum=-2.0 * math.pi,
        maximum=2.0 * math.pi,
        source="Oriolo 1998, section III-A",
    )
    tolerance: float = parameter(
        math.radians(0.5),
        doc="the turret has arrived when it is this close to its command",
        unit="rad",
        minimum=1e-6,
        maximum=math.pi,
    )
    timeout: float = parameter(
        5.0,
        doc="a perception fails when the turret has not arrived after this time",
        unit="s",
        minimum=0.01,
        maximum=600.0,
    )

    def __post_init__(self) -> None:
        validate(self)
        if not self.angles:
            raise ParameterError("parameter 'turret.angles' must name at least one angle")


@dataclass(frozen=True)
class PerceptionParameters:
    """How readings are gathered and placed."""

    timeout: float = parameter(
        2.0,
        doc="longest wait for the readings of one turret angle; then the perception goes on "
        "without those that did not come",
        unit="s",
        minimum=0.01,
        maximum=600.0,
    )
    settle: float = parameter(
        0.0,
        doc="the turret must have stood for this time before readings count",
        unit="s",
        minimum=0.0,
        maximum=60.0,
    )
    pose_timeout: float = parameter(
        0.5,
        doc="longest time that a reading waits for poses and turret angles on both sides of "
        "its stamp; then it is rejected",
        unit="s",
        minimum=0.0,
        maximum=60.0,
    )
    max_pose_gap: float = parameter(
        0.5,
        doc="no pose is interpolated between two that are farther apart in time",
        unit="s",
        minimum=1e-3,
        maximum=60.0,
    )
    future_tolerance: float = parameter(
        0.5,
        doc="a stamp farther ahead of the clock is rejected",
        unit="s",
        minimum=0.0,
        maximum=60.0,
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class PublishingParameters:
    """How often whole maps are published."""

    small_map: int = parameter(
        250_000,
        doc="maps of up to this many cells are published whole with every packet; of larger ones "
        "each packet's window is",
        minimum=0,
        maximum=64_000_000,
    )
    period: float = parameter(
        2.0,
        doc="a whole map that is larger is published this long after the one before, in wall "
        "time, if it has changed; at once when it is begun, reset or loaded",
        unit="s",
        minimum=0.1,
        maximum=60.0,
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class SnapshotParameters:
    """What the mapper keeps on disk for the one that takes its place."""

    file: str = parameter(
        "",
        doc="file that the mapper keeps its state in, and goes on from when it starts; of each "
        "mapper its own. Empty: none",
        read_only=True,
    )
    period: float = parameter(
        1.0,
        doc="least time from one snapshot to the next, in wall time; writing takes at most a "
        "tenth of the time all the same",
        unit="s",
        minimum=0.05,
        maximum=3600.0,
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class MapperParameters:
    """All parameters of the mapper."""

    mode: str = parameter(
        "on_demand",
        doc="fuse only what the build_map action gathers ('on_demand'), or every packet_size "
        "readings, also while the robot moves ('continuous')",
        choices=("on_demand", "continuous"),
        read_only=True,
    )
    packet_size: int = parameter(
        48,
        doc="readings of a packet in continuous mode",
        minimum=1,
        maximum=100_000,
        source="Oriolo 1998, section III-A",
    )
    map_folder: str = parameter(
        "",
        doc="the one folder that save_map and load_map work in, ~ being the user's home; made "
        "when the first map is saved. Empty: any that the process may write and read; to be set "
        "where not everybody who reaches the services is trusted",
        read_only=True,
    )
    sonar: SonarParameters = field(default_factory=SonarParameters)
    infrared: InfraredParameters = field(default_factory=InfraredParameters)
    evidence: EvidenceParameters = field(default_factory=EvidenceParameters)
    consistency: ConsistencyParameters = field(default_factory=ConsistencyParameters)
    infrared_evidence: InfraredEvidenceParameters = field(
        default_factory=InfraredEvidenceParameters
    )
    sonar_guard: SonarGuardParameters = field(default_factory=SonarGuardParameters)
    fusion: FusionParameters = field(default_factory=FusionParameters)
    area: AreaParameters = field(default_factory=AreaParameters)
    turret: TurretParameters = field(default_factory=TurretParameters)
    perception: PerceptionParameters = field(default_factory=PerceptionParameters)
    publishing: PublishingParameters = field(default_factory=PublishingParameters)
    snapshot: SnapshotParameters = field(default_factory=SnapshotParameters)

    def __post_init__(self) -> None:
        validate(self)
        if "\0" in self.map_folder:
            raise ParameterError("parameter 'map_folder' must be the name of a folder")


def mapper_parameters(
    preset: str = DEFAULT_PRESET, overrides: Mapping[str, Any] | None = None
) -> MapperParameters:
    """Return a preset with single parameters overridden.

    Parameters
    ----------
    preset : str
        A key of `PRESETS`.
    overrides : mapping, optional
        Values by dotted name (``"evidence.k_empty"``) or nested as in a YAML file.

    Raises
    ------
    ParameterError
        For an unknown preset or parameter (with the nearest known name), or a value that
        is refused.

    Examples
    --------
    >>> mapper_parameters("map_building", {"fusion.aggregation": "max"}).fusion.aggregation
    'max'
    """
    if preset not in PRESETS:
        raise ParameterError(f"unknown preset '{preset}'{suggest(preset, PRESETS)}")
    base = from_mapping(MapperParameters(), PRESETS[preset])
    return from_mapping(base, overrides) if overrides else base
