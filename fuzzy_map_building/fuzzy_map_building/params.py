# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parameters of map building: the one place that declares them.

Defaults are those of the navigation experiments of Oriolo, Ulivi and Vendittelli
(1998), section V, for a NOMAD 200. `PRESETS` names other sets. A node, a parameter
file or a study starts from a preset and overrides single parameters by dotted name.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.parameter_schema import (
    ParameterError,
    from_mapping,
    parameter,
    suggest,
    validate,
)

__all__ = [
    "DEFAULT_PRESET",
    "PRESETS",
    "AreaParameters",
    "EvidenceParameters",
    "FusionParameters",
    "MapperParameters",
    "PerceptionParameters",
    "SonarParameters",
    "TurretParameters",
    "mapper_parameters",
]

_PAPER = "Oriolo 1998"


@dataclass(frozen=True)
class SonarParameters:
    """The ring of sonars: where they sit and what one of them can measure."""

    frame_ids: tuple[str, ...] = parameter(
        tuple(f"sonar_{i}" for i in range(16)),
        doc="frame_id of each sonar's Range messages; its place in the list is its index",
        source=f"{_PAPER}, section III-A",
        read_only=True,
    )
    bearings: tuple[float, ...] = parameter(
        tuple(math.radians(22.5 * i) for i in range(16)),
        doc="direction of each sonar's axis, counter-clockwise from the turret's x axis",
        unit="rad",
        minimum=-2.0 * math.pi,
        maximum=2.0 * math.pi,
        source=f"{_PAPER}, section III-A",
        read_only=True,
    )
    mount_radius: float = parameter(
        0.23,
        doc="distance of the sonars' faces from the robot's centre",
        unit="m",
        minimum=0.0,
        maximum=10.0,
        source=f"{_PAPER}, section II",
    )
    apex: str = parameter(
        "center",
        doc="apex of the radiation cones: the robot's centre (the range then grows by "
        "mount_radius) or the sonar's mount. With 'mount' the cones do not overlap close to "
        "the robot and a single perception opens no way out",
        choices=("center", "mount"),
        source="measured",
    )
    field_of_view: float = parameter(
        math.radians(25.0),
        doc="full angle of the radiation cone; what lies beyond the main lobe of the "
        "directivity gives no evidence in any case",
        unit="rad",
        minimum=math.radians(0.1),
        maximum=math.pi,
        source=f"{_PAPER}, section III-A",
    )
    min_range: float = parameter(
        0.12,
        doc="least range that counts as a measurement",
        unit="m",
        minimum=0.0,
        maximum=100.0,
        source=f"{_PAPER}, section III-A",
    )
    max_range: float = parameter(
        6.5,
        doc="greatest range that counts as a measurement; never a code for a lost echo",
        unit="m",
        minimum=0.01,
        maximum=100.0,
        source=f"{_PAPER}, section III-A",
    )
    lost_echo: str = parameter(
        "neighbours",
        doc="what a reading without echo (+inf) says: emptiness out to the shorter return of "
        "its angular neighbours in the packet ('neighbours'), out to max_range ('full'), or "
        "nothing ('ignore')",
        choices=("neighbours", "full", "ignore"),
        source="measured",
    )
    piston_radius: float = parameter(
        0.01921,
        doc="radius of the transducer, of equation (1)",
        unit="m",
        minimum=1e-4,
        maximum=1.0,
        source=f"{_PAPER}, equation (1)",
    )
    frequency: float = parameter(
        49410.0,
        doc="frequency of the ultrasonic wave, of equation (1)",
        unit="Hz",
        minimum=1000.0,
        maximum=1e6,
        source=f"{_PAPER}, equation (1)",
    )
    speed_of_sound: float = parameter(
        343.0,
        doc="speed of sound, of equation (1)",
        unit="m/s",
        minimum=100.0,
        maximum=2000.0,
        source="air at 20 degrees Celsius",
    )

    def __post_init__(self) -> None:
        validate(self)
        if not self.frame_ids:
            raise ParameterError("parameter 'sonar.frame_ids' must name at least one sonar")
        if len(self.frame_ids) != len(self.bearings):
            raise ParameterError(
                f"'sonar.frame_ids' names {len(self.frame_ids)} sonars but 'sonar.bearings' "
                f"gives {len(self.bearings)} directions; give both for every sonar"
            )
        repeated = sorted({name for name in self.frame_ids if self.frame_ids.count(name) > 1})
        if repeated:
            raise ParameterError(
                f"'sonar.frame_ids' repeats {', '.join(map(repr, repeated))}; every sonar needs "
                f"a frame of its own"
            )
        if not self.min_range < self.max_range:
            raise ParameterError(
                f"'sonar.min_range' ({self.min_range} m) must be less than 'sonar.max_range' "
                f"({self.max_range} m)"
            )


@dataclass(frozen=True)
class EvidenceParameters:
    """What one reading says of a cell, equations (1)-(5)."""

    k_empty: float = parameter(
        0.4,
        doc="k_E: greatest belief of empty that one reading gives",
        minimum=0.0,
        maximum=1.0,
        source=f"{_PAPER}, equation (2) and section V",
    )
    k_occupied: float = parameter(
        0.4,
        doc="k_O: greatest belief of occupied that one reading gives",
        minimum=0.0,
        maximum=1.0,
        source=f"{_PAPER}, equation (3) and section V",
    )
    range_margin: float = parameter(
        0.15,
        doc="Delta r: half width of the band around the range that counts as its arc",
        unit="m",
        minimum=1e-3,
        maximum=10.0,
        source=f"{_PAPER}, equations (2), (3) and section V",
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


@dataclass(frozen=True)
class AreaParameters:
    """The area that the map covers."""

    size_x: float = parameter(
        7.6,
        doc="extent along x",
        unit="m",
        minimum=0.01,
        maximum=1e5,
        source=f"{_PAPER}, section V",
        read_only=True,
    )
    size_y: float = parameter(
        6.3,
        doc="extent along y",
        unit="m",
        minimum=0.01,
        maximum=1e5,
        source=f"{_PAPER}, section V",
        read_only=True,
    )
    resolution: float = parameter(
        0.1,
        doc="side of a cell",
        unit="m",
        minimum=1e-3,
        maximum=100.0,
        source=f"{_PAPER}, section V",
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
        source=f"{_PAPER}, section III-A",
    )
    tolerance: float = parameter(
        math.radians(0.5),
        doc="the turret has arrived when it is this close to the angle commanded",
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
        source=f"{_PAPER}, section III-A",
    )
    sonar: SonarParameters = field(default_factory=SonarParameters)
    evidence: EvidenceParameters = field(default_factory=EvidenceParameters)
    fusion: FusionParameters = field(default_factory=FusionParameters)
    area: AreaParameters = field(default_factory=AreaParameters)
    turret: TurretParameters = field(default_factory=TurretParameters)
    perception: PerceptionParameters = field(default_factory=PerceptionParameters)

    def __post_init__(self) -> None:
        validate(self)


#: Bearings of the eight front sonars of a Pioneer 2 [rad], from the left to the right.
_PIONEER_BEARINGS = tuple(math.radians(b) for b in (90, 50, 30, 10, -10, -30, -50, -90))

#: Named sets of parameters, as changes of the defaults.
PRESETS: dict[str, dict[str, Any]] = {
    # Section V: navigating among obstacles that may move.
    "oriolo1998": {
        "evidence.k_empty": 0.4,
        "evidence.k_occupied": 0.4,
        "evidence.range_margin": 0.15,
        "evidence.visibility_radius": 1.5,
        "evidence.dombi_lambda": 0.4,
        "fusion.aggregation": "mean",
        "fusion.max_count": 3,
    },
    # Fig. 8: 43 perceptions of a corridor. Not fit for navigating: k_E is so small that one
    # perception never opens the beta-cut.
    "map_building": {
        "evidence.k_empty": 0.1,
        "evidence.k_occupied": 0.25,
        "evidence.range_margin": 0.15,
        "evidence.visibility_radius": 1.2,
        "evidence.dombi_lambda": 0.4,
        "fusion.aggregation": "dombi",
        "area.size_x": 18.0,
        "area.size_y": 12.0,
    },
    # Lachekhab et al., Table II: a Pioneer 2 without a turret, aggregation by max.
    "lachekhab": {
        "sonar.frame_ids": tuple(f"sonar_{i}" for i in range(8)),
        "sonar.bearings": _PIONEER_BEARINGS,
        "sonar.min_range": 0.1,
        "sonar.max_range": 5.0,
        "evidence.k_empty": 0.1,
        "evidence.k_occupied": 0.1,
        "evidence.range_margin": 0.2,
        "evidence.visibility_radius": 1.2,
        "evidence.dombi_lambda": 0.4,
        "fusion.aggregation": "max",
        "area.size_x": 6.0,
        "area.size_y": 7.0,
        "turret.joint": "",
        "turret.angles": (0.0,),
        "packet_size": 8,
    },
}

DEFAULT_PRESET = "oriolo1998"


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
