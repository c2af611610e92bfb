# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the simulated rings of sensors, declared once.

"Paper" in a source is Oriolo, Ulivi, Vendittelli, IEEE Trans. SMC-B 28(3), 1998. What
neither the paper nor the NOMAD 200's published limits give is marked as assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from fuzzy_map_building.parameter_schema import ParameterError, parameter, validate

__all__ = ["ROBOT_RADIUS", "InfraredParameters", "SonarParameters"]

#: Radius of the NOMAD 200's cylindrical body [m] (paper, section II).
ROBOT_RADIUS = 0.23
#: Sensors in each of the NOMAD 200's rings (paper, sections III-A and IV-B).
RING_COUNT = 16


def _frames(kind: str, source: str) -> Any:
    return parameter(
        tuple(f"{kind}_{i}" for i in range(RING_COUNT)),
        doc=f"frame of each {kind} sensor, in the order of the bearings",
        read_only=True,
        source=source,
    )


def _bearings(origin: str, source: str) -> Any:
    return parameter(
        tuple(i * 2.0 * math.pi / RING_COUNT for i in range(RING_COUNT)),
        doc=f"direction of each sensor, counter-clockwise from {origin}",
        unit="rad",
        minimum=-2.0 * math.pi,
        maximum=2.0 * math.pi,
        read_only=True,
        source=source,
    )


def _mount_radius() -> Any:
    return parameter(
        ROBOT_RADIUS,
        doc="distance of the sensors' faces from the robot's centre",
        unit="m",
        minimum=0.0,
        maximum=5.0,
        read_only=True,
        source="paper, section II",
    )


def _check_ring(group: str, frame_ids: tuple[str, ...], count: int) -> None:
    if len(frame_ids) != count:
        raise ParameterError(
            f"'{group}.frame_ids' names {len(frame_ids)} sensors but '{group}.bearings' gives "
            f"{count} directions; give both for every sensor"
        )
    if len(set(frame_ids)) != len(frame_ids):
        raise ParameterError(f"'{group}.frame_ids' names a frame twice")


def _check_limits(group: str, low: float, high: float) -> None:
    if low >= high:
        raise ParameterError(
            f"'{group}.min_range' ({low} m) must be below '{group}.max_range' ({high} m)"
        )


@dataclass(frozen=True)
class SonarParameters:
    """The ring of ultrasonic range finders on the turret."""

    frame_ids: tuple[str, ...] = _frames("sonar", "paper, section III-A")
    bearings: tuple[float, ...] = _bearings("the turret's x axis", "paper, section III-A")
    mount_radius: float = _mount_radius()
    beam_half_angle: float = parameter(
        math.radians(10.0),
        doc="half angle of the beam inside which a surface gives an echo; narrower than the "
        "12.5 deg of the main lobe since the sound fades towards its border",
        unit="rad",
        minimum=math.radians(0.1),
        maximum=math.radians(60.0),
        source="assumed; paper, section III-A: main lobe of 25 deg in all",
    )
    min_range: float = parameter(
        0.12,
        doc="an echo from nearer reads as -inf (REP 117)",
        unit="m",
        minimum=0.0,
        maximum=10.0,
        source="paper, section III-A",
    )
    max_range: float = parameter(
        6.5,
        doc="an echo from farther away is lost and reads as +inf (REP 117)",
        unit="m",
        minimum=0.01,
        maximum=100.0,
        source="paper, section III-A",
    )
    range_noise: float = parameter(
        0.01,
        doc="standard deviation of the range, as a share of it",
        minimum=0.0,
        maximum=1.0,
        source="paper, section III-A: 1 % accuracy",
    )
    edge_echo: bool = parameter(
        True,
        doc="whether edges, corners and free wall ends send an echo back in every direction",
        source="method; corners and edges are the features of Kuc and Siegel, IEEE PAMI 9(6), "
        "1987",
    )
    reflections: int = parameter(
        1,
        doc="most specular reflections after which an echo still comes back, longer than the "
        "way to the surface in the beam; 0: what falls in beyond the critical angle is lost",
        minimum=0,
        maximum=4,
        source="paper, section III-A and Fig. 4b",
    )
    firing_slots: tuple[int, ...] = parameter(
        tuple(i % 4 for i in range(RING_COUNT)),
        doc="slot of the firing cycle in which each sonar fires; those of one slot fire at the "
        "same time. The default fires four sonars 90 deg apart",
        minimum=0,
        maximum=1023,
        read_only=True,
        source="assumed; paper, section III-A: fired in a sequence of least interference",
    )
    firing_interval: float = parameter(
        0.04,
        doc="time from one slot to the next; an echo from max_range takes 38 ms",
        unit="s",
        minimum=0.001,
        maximum=10.0,
        read_only=True,
        source="assumed",
    )
    crosstalk_reflections: int = parameter(
        0,
        doc="most specular reflections of a pulse on its way to another sonar fired at the same "
        "time, which takes it for its own; 0: no crosstalk",
        minimum=0,
        maximum=4,
    )
    short_outliers: float = parameter(
        0.0,
        doc="probability that a reading is replaced by a shorter one, anywhere between "
        "min_range and the range it would have had",
        minimum=0.0,
        maximum=1.0,
    )
    lost_outliers: float = parameter(
        0.0, doc="probability that an echo is not detected", minimum=0.0, maximum=1.0
    )

    def __post_init__(self) -> None:
        validate(self)
        if not self.frame_ids:
            raise ParameterError("parameter 'sonar.frame_ids' must name at least one sensor")
        _check_ring("sonar", self.frame_ids, len(self.bearings))
        _check_limits("sonar", self.min_range, self.max_range)
        if self.short_outliers + self.lost_outliers > 1.0:
            raise ParameterError(
                f"'sonar.short_outliers' ({self.short_outliers}) and 'sonar.lost_outliers' "
                f"({self.lost_outliers}) exclude each other: their sum must not exceed 1"
            )
        if len(self.firing_slots) != len(self.bearings):
            raise ParameterError(
                f"'sonar.firing_slots' gives {len(self.firing_slots)} slots for "
                f"{len(self.bearings)} sonars; give one for every sonar"
            )


@dataclass(frozen=True)
class InfraredParameters:
    """The ring of infrared proximity sensors on the base."""

    frame_ids: tuple[str, ...] = _frames("infrared", "paper, section IV-B")
    bearings: tuple[float, ...] = _bearings("the robot's heading", "paper, section IV-B")
    mount_radius: float = _mount_radius()
    min_range: float = parameter(
        0.0,
        doc="a surface nearer than this reads as -inf (REP 117)",
        unit="m",
        minimum=0.0,
        maximum=10.0,
        source="assumed",
    )
    max_range: float = parameter(
        0.6,
        doc="a surface farther away is not seen and reads as +inf (REP 117)",
        unit="m",
        minimum=0.01,
        maximum=20.0,
        source="assumed: 24 inches",
    )
    range_noise: float = parameter(
        0.005,
        doc="standard deviation of the range at distance 0",
        unit="m",
        minimum=0.0,
        maximum=1.0,
        source="method, section 4",
    )
    relative_noise: float = parameter(
        0.02,
        doc="what the standard deviation grows by, as a share of the range",
        minimum=0.0,
        maximum=1.0,
        source="method, section 4",
    )
    sees_glass: bool = parameter(
        True,
        doc="whether materials that let infrared light through (glass) are seen all the same; "
        "if not, nothing but the sonars tells of them",
    )

    def __post_init__(self) -> None:
        validate(self)
        _check_ring("infrared", self.frame_ids, len(self.bearings))
        _check_limits("infrared", self.min_range, self.max_range)
