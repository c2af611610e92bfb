# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The groups of the motion's parameters: clearance, follower, waiting times.

"Paper" in a source is Oriolo, Ulivi, Vendittelli, IEEE Trans. SMC-B 28(3), 1998.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzy_map_building.parameter_schema import ParameterError, parameter, validate

__all__ = [
    "ROBOT_RADIUS",
    "ClearanceParameters",
    "FollowerParameters",
    "TimeoutParameters",
    "WatchParameters",
]

#: Radius of the NOMAD 200's cylindrical body [m] (paper, section II).
ROBOT_RADIUS = 0.23


@dataclass(frozen=True)
class ClearanceParameters:
    """When the motion stops in front of an obstacle that the infrareds see."""

    rule: str = parameter(
        "layer",
        doc="stop where the clearance at the next cell is below the limit and smaller than now "
        "(closing), wherever it is below the limit (strict, the paper's wording), or where it is "
        "smaller than now and its risk in the clearance layer is above the rung that the path was "
        "found on (layer)",
        choices=("closing", "strict", "layer"),
        source="paper, section IV-B",
    )
    limit: float = parameter(
        0.12,
        doc="least clearance of the body",
        unit="m",
        minimum=0.0,
        maximum=2.0,
        source="paper, section V",
    )
    override: float = parameter(
        0.05,
        doc="least clearance allowed once after a perception that brought no progress; "
        "equal to the limit: never less than the limit",
        unit="m",
        minimum=0.0,
        maximum=2.0,
    )
    impasse: float = parameter(
        0.15,
        doc="distance from a cell within which all are barred, for refusal_memory, when "
        "livelock_limit perceptions in a row found no room to enter it, though a path seems "
        "free; 0: that is a livelock",
        unit="m",
        minimum=0.0,
        maximum=2.0,
    )
    recall: float = parameter(
        0.5,
        doc="distance from the robot within which points measured before it looked anew are hits "
        "again where a sonar's echo that is too close to measure confirms them, for sonar_guard; "
        "0: it forgets all of them",
        unit="m",
        minimum=0.0,
        maximum=2.0,
    )

    def __post_init__(self) -> None:
        validate(self)
        if self.override > self.limit:
            raise ParameterError(
                f"parameter 'clearance.override' ({self.override} m) must not exceed "
                f"'clearance.limit' ({self.limit} m)"
            )


@dataclass(frozen=True)
class FollowerParameters:
    """Limits of the robot and how closely it follows a path."""

    max_linear: float = parameter(
        0.6, doc="largest speed", unit="m/s", minimum=0.01, maximum=5.0, source="NOMAD 200"
    )
    max_angular: float = parameter(
        math.radians(60.0),
        doc="largest turning rate",
        unit="rad/s",
        minimum=0.01,
        maximum=10.0,
        source="NOMAD 200",
    )
    linear_acceleration: float = parameter(
        0.6, doc="largest change of the speed", unit="m/s^2", minimum=0.01, maximum=20.0
    )
    angular_acceleration: float = parameter(
        2.0, doc="largest change of the turning rate", unit="rad/s^2", minimum=0.01, maximum=50.0
    )
    max_deviation: float = parameter(
        0.05,
        doc="largest distance from the path; half a cell",
        unit="m",
        minimum=0.005,
        maximum=1.0,
    )
    turn_in_place: float = parameter(
        math.radians(30.0),
        doc="heading error beyond which a robot on its way stops and turns on the spot; before it "
        "sets out it always does",
        unit="rad",
        minimum=0.05,
        maximum=math.pi,
    )
    arrival: float = parameter(
        0.005,
        doc="distance from the path's last point at which the robot has arrived",
        unit="m",
        minimum=0.0005,
        maximum=0.5,
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class WatchParameters:
    """What sensors and poses that can be trusted do."""

    stuck_turn: float = parameter(
        math.radians(45.0),
        doc="a sensor that goes on telling exactly the same distance while it turns by this angle "
        "is stuck, and the robot stands; 2 pi: never",
        unit="rad",
        minimum=math.radians(5.0),
        maximum=2.0 * math.pi,
    )
    pose_jump: float = parameter(
        0.3,
        doc="by how much a pose may lie farther from the one before than the robot can have come; "
        "beyond, the robot stands and perceives anew",
        unit="m",
        minimum=0.01,
        maximum=1000.0,
    )
    pose_turn: float = parameter(
        math.radians(20.0),
        doc="the same for the heading",
        unit="rad",
        minimum=math.radians(1.0),
        maximum=2.0 * math.pi,
    )
    pose_frozen: float = parameter(
        0.2,
        doc="way for which the robot is driven without its pose changing, after which it stands",
        unit="m",
        minimum=0.03,
        maximum=1000.0,
    )
    lossy_speed: float = parameter(
        0.15,
        doc="largest speed while a quarter of what sonars that guard the robot hear from close by "
        "is missing from their next reading",
        unit="m/s",
        minimum=0.01,
        maximum=5.0,
    )
    open_space: bool = parameter(
        False,
        doc="whether sonars that hear hardly anything may be in open space wider than their "
        "reach; if not they count as deaf where echoes came from before or, if they look all "
        "around, where none ever came, and the robot that they guard stands",
    )

    def __post_init__(self) -> None:
        validate(self)


@dataclass(frozen=True)
class TimeoutParameters:
    """How long the motion waits for others before it stops or gives up."""

    pose: float = parameter(
        0.5, doc="age of the pose at which the robot stops", unit="s", minimum=0.05, maximum=60.0
    )
    infrared: float = parameter(
        0.5,
        doc="age of the infrared readings at which the robot stops",
        unit="s",
        minimum=0.05,
        maximum=60.0,
    )
    sonar: float = parameter(
        0.5,
        doc="age of the sonars' readings at which a robot that they guard stops (see sonar_guard)",
        unit="s",
        minimum=0.05,
        maximum=60.0,
    )
    plan: float = parameter(10.0, doc="wait for a plan", unit="s", minimum=0.1, maximum=600.0)
    build_map: float = parameter(
        60.0, doc="wait for a perception to end", unit="s", minimum=0.1, maximum=3600.0
    )
    server: float = parameter(
        5.0,
        doc="wait, in wall time, for the mapper or the planner to be there, and for the planner "
        "to know the newest map",
        unit="s",
        minimum=0.1,
        maximum=600.0,
    )
    lost: float = parameter(
        10.0,
        doc="how long the robot stands and waits for lost poses or readings, or for sensors or "
        "poses that cannot be trusted, before the mission fails",
        unit="s",
        minimum=0.1,
        maximum=3600.0,
    )

    def __post_init__(self) -> None:
        validate(self)
