# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the sensors: where they sit, what they measure, how one guards the other."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzy_map_building.parameter_schema import ParameterError, parameter, validate

__all__ = ["InfraredParameters", "SonarGuardParameters", "SonarParameters"]

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
class InfraredParameters:
    """The ring of infrared proximity sensors: where they sit and what they can measure."""

    frame_ids: tuple[str, ...] = parameter(
        tuple(f"infrared_{i}" for i in range(16)),
        doc="frame of each sensor, in the order of the bearings; empty, as those, where there are "
        "none: the sonars then guard the robot alone",
        read_only=True,
        source=f"{_PAPER}, section IV-B",
    )
    bearings: tuple[float, ...] = parameter(
        tuple(i * 2.0 * math.pi / 16 for i in range(16)),
        doc="direction of each sensor from the robot's heading",
        unit="rad",
        minimum=-2.0 * math.pi,
        maximum=2.0 * math.pi,
        read_only=True,
        source=f"{_PAPER}, section IV-B",
    )
    mount_radius: float = parameter(
        0.23,
        doc="distance of the sensors' faces from the robot's centre",
        unit="m",
        minimum=0.0,
        maximum=5.0,
        source=f"{_PAPER}, section II",
    )
    min_range: float = parameter(
        0.0, doc="smallest range that counts", unit="m", minimum=0.0, maximum=10.0
    )
    max_range: float = parameter(
        0.6, doc="largest range that counts", unit="m", minimum=0.01, maximum=20.0
    )

    def __post_init__(self) -> None:
        validate(self)
        if len(self.frame_ids) != len(self.bearings):
            raise ParameterError(
                f"'infrared.frame_ids' ({len(self.frame_ids)}) and 'infrared.bearings' "
                f"({len(self.bearings)}) must have the same length"
            )
        if len(set(self.frame_ids)) != len(self.frame_ids):
            raise ParameterError("'infrared.frame_ids' names a frame twice")
        if self.min_range >= self.max_range:
            raise ParameterError(
                f"'infrared.min_range' ({self.min_range} m) must be below "
                f"'infrared.max_range' ({self.max_range} m)"
            )


@dataclass(frozen=True)
class SonarGuardParameters:
    """What short sonar returns say where infrared light may go through, as through glass."""

    enabled: bool = parameter(
        True,
        doc="whether a short sonar return that no infrared hit explains counts as a hit",
    )
    perception_reach: float = parameter(
        0.6,
        doc="returns from closer to the body than this count at a perception",
        unit="m",
        minimum=0.0,
        maximum=20.0,
        source="measured",
    )
    motion_reach: float = parameter(
        0.25,
        doc="returns from closer to the body than this count while the robot moves, and once it "
        "is so close those that it heard twice on the way from as far as perception_reach",
        unit="m",
        minimum=0.0,
        maximum=20.0,
        source="measured",
    )
    angle: float = parameter(
        math.radians(15.0),
        doc="an infrared hit within this angle of a return explains it; an infrared ray within "
        "this angle of a return that nothing explains is cut",
        unit="rad",
        minimum=0.0,
        maximum=math.pi,
        source="measured",
    )
    slack: float = parameter(
        0.08,
        doc="an infrared hit that explains a return lies at most this much farther away",
        unit="m",
        minimum=0.0,
        maximum=10.0,
        source="measured",
    )
    spread: float = parameter(
        math.radians(6.0),
        doc="a return stands for a hit on its axis and one at this angle on either side",
        unit="rad",
        minimum=0.0,
        maximum=math.pi,
        source="measured",
    )
    margin: float = parameter(
        0.05,
        doc="an infrared ray is cut this far before the return",
        unit="m",
        minimum=0.0,
        maximum=10.0,
        source="measured",
    )
    veto_angle: float = parameter(
        math.radians(8.0),
        doc="a sonar reading that is longer takes away the hits within this angle of its axis, "
        "unless none were left; not less than the angle from one reading to the next",
        unit="rad",
        minimum=0.0,
        maximum=math.pi,
        source="measured",
    )
    veto_excess: float = parameter(
        0.15,
        doc="by how much a sonar reading has to be longer to take a hit away",
        unit="m",
        minimum=0.0,
        maximum=100.0,
        source="measured",
    )

    def __post_init__(self) -> None:
        validate(self)
