# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the simulated robot and its sensors, declared once.

"Paper" in a source is Oriolo, Ulivi, Vendittelli, IEEE Trans. SMC-B 28(3), 1998. What
neither the paper nor the NOMAD 200's published limits give is marked as assumed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fuzzy_map_building.parameter_schema import from_mapping, parameter, validate
from nomad_sim.faults import Fault, parse_faults
from nomad_sim.sensor_params import ROBOT_RADIUS, InfraredParameters, SonarParameters

__all__ = [
    "ROBOT_RADIUS",
    "InfraredParameters",
    "OdometryParameters",
    "RobotParameters",
    "SimulatorParameters",
    "SonarParameters",
    "TurretParameters",
    "simulator_parameters",
]


@dataclass(frozen=True)
class RobotParameters:
    """The body and what its drives can do."""

    radius: float = parameter(
        ROBOT_RADIUS,
        doc="radius of the body",
        unit="m",
        minimum=0.01,
        maximum=5.0,
        read_only=True,
        source="paper, section II",
    )
    max_linear: float = parameter(
        0.6,
        doc="largest speed",
        unit="m/s",
        minimum=0.01,
        maximum=10.0,
        source="NOMAD 200: 24 inches a second",
    )
    max_angular: float = parameter(
        math.radians(60.0),
        doc="largest turning rate",
        unit="rad/s",
        minimum=0.01,
        maximum=20.0,
        source="NOMAD 200: 60 deg a second",
    )
    linear_acceleration: float = parameter(
        1.0,
        doc="largest gain of speed a second",
        unit="m/s^2",
        minimum=0.01,
        maximum=100.0,
        source="assumed",
    )
    linear_deceleration: float = parameter(
        6.0,
        doc="largest loss of speed a second; from full speed the robot stands after 0.1 s",
        unit="m/s^2",
        minimum=0.01,
        maximum=100.0,
        source="assumed",
    )
    angular_acceleration: float = parameter(
        10.0,
        doc="largest change of the turning rate a second",
        unit="rad/s^2",
        minimum=0.01,
        maximum=1000.0,
        source="assumed",
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class TurretParameters:
    """The turret that carries the sonars."""

    joint: str = parameter("turret_joint", doc="name of its joint", read_only=True)
    max_rate: float = parameter(
        math.radians(60.0),
        doc="rate at which it turns",
        unit="rad/s",
        minimum=0.01,
        maximum=20.0,
        source="NOMAD 200: 60 deg a second",
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class OdometryParameters:
    """Drift of the odometry, a random walk in the distance driven and the angle turned."""

    distance_noise: float = parameter(
        0.02,
        doc="standard deviation of the distance after one metre; grows with its square root",
        unit="m/sqrt(m)",
        minimum=0.0,
        maximum=1.0,
        source="assumed",
    )
    turning_noise: float = parameter(
        math.radians(1.0),
        doc="standard deviation of the heading after turning by one radian",
        unit="rad/sqrt(rad)",
        minimum=0.0,
        maximum=1.0,
        source="assumed",
    )
    heading_drift: float = parameter(
        math.radians(1.0),
        doc="standard deviation of the heading after driving one metre",
        unit="rad/sqrt(m)",
        minimum=0.0,
        maximum=1.0,
        source="assumed",
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class SimulatorParameters:
    """All parameters of the simulator."""

    seed: int = parameter(
        0,
        doc="from it come all random numbers; the same seed and commands give the same run",
        minimum=0,
        maximum=2**63 - 1,
        read_only=True,
    )
    noise: bool = parameter(
        True,
        doc="whether anything is random; if not, ranges are exact, there are no outliers and "
        "the odometry does not drift",
        read_only=True,
    )
    sonar: SonarParameters = field(default_factory=SonarParameters)
    infrared: InfraredParameters = field(default_factory=InfraredParameters)
    robot: RobotParameters = field(default_factory=RobotParameters)
    turret: TurretParameters = field(default_factory=TurretParameters)
    odometry: OdometryParameters = field(default_factory=OdometryParameters)
    faults: str = parameter(
        "",
        doc="faults of sensors, messages, pose and clock, separated by ';', each as KIND TARGET "
        "NAME=VALUE ..., see Faults; empty: none",
    )

    def __post_init__(self) -> None:
        validate(self)
        self.fault_list()

    def fault_list(self) -> tuple[Fault, ...]:
        """Return the faults that `faults` describes."""
        return parse_faults(self.faults, len(self.sonar.bearings), len(self.infrared.bearings))


def simulator_parameters(
    overrides: Mapping[str, Any] | None = None, world_overrides: Mapping[str, Any] | None = None
) -> SimulatorParameters:
    """Return the parameters of a simulator.

    Parameters
    ----------
    overrides : mapping, optional
        Values that differ from the defaults, by dotted name or nested; the last word.
    world_overrides : mapping, optional
        `World.parameters`, what the world's file asks for.

    Raises
    ------
    ParameterError
        For an unknown name (with the nearest known one) or a refused value.

    Examples
    --------
    >>> simulator_parameters({"sonar.reflections": 0}).sonar.reflections
    0
    """
    base = from_mapping(SimulatorParameters(), world_overrides or {})
    return from_mapping(base, overrides or {})
