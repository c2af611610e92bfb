# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the node ``nomad_sim``: those of the simulator, and how it is run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from fuzzy_map_building.parameter_schema import from_mapping, parameter, validate
from fuzzy_map_building.types import Pose2
from nomad_sim.params import SimulatorParameters
from nomad_sim.world_io import load_world

__all__ = ["EPOCH", "SimulationParameters", "StartParameters", "simulation_parameters"]

#: Stamp of the simulator's time 0 [ns]: a stamp of 0 would mean that there is none.
EPOCH: Final = 1_000_000_000


@dataclass(frozen=True)
class StartParameters:
    """Where the robot starts."""

    override: bool = parameter(
        False,
        doc="whether the robot starts at the pose given here instead of where the world says",
        read_only=True,
    )
    x: float = parameter(
        0.0, doc="x of the start", unit="m", minimum=-1000.0, maximum=1000.0, read_only=True
    )
    y: float = parameter(
        0.0, doc="y of the start", unit="m", minimum=-1000.0, maximum=1000.0, read_only=True
    )
    theta: float = parameter(
        0.0,
        doc="heading at the start",
        unit="rad",
        minimum=-2.0 * math.pi,
        maximum=2.0 * math.pi,
        read_only=True,
    )

    def __post_init__(self) -> None:
        validate(self)

    def pose(self) -> Pose2 | None:
        """Return the pose given here, None where the world's start counts."""
        return Pose2(self.x, self.y, self.theta) if self.override else None


@dataclass(frozen=True)
class SimulationParameters(SimulatorParameters):
    """All parameters of the node."""

    world: str = parameter(
        "lab", doc="name of a world that comes with the package, or a file", read_only=True
    )
    start: StartParameters = field(default_factory=StartParameters)
    rate: float = parameter(
        1.0,
        doc="simulated seconds a second; 0: as fast as the machine allows, which without "
        "lockstep is faster than the other nodes can follow",
        minimum=0.0,
        maximum=1000.0,
    )
    lockstep: bool = parameter(
        False,
        doc="whether, while somebody commands by 'cmd_vel_stamped', each tick waits for the "
        "command with the stamp of the last pose, so that a slow machine controls the robot as a "
        "fast one does",
    )
    lockstep_timeout: float = parameter(
        1.0,
        doc="longest wait of a tick for its command, in wall time; then the ticks go on without "
        "waiting until the next command",
        unit="s",
        minimum=0.01,
        maximum=60.0,
    )
    command_timeout: float = parameter(
        0.5,
        doc="simulated time after which the robot stands when no command comes: it brakes before",
        unit="s",
        minimum=0.05,
        maximum=60.0,
    )
    sonar_field_of_view: float = parameter(
        math.radians(25.0),
        doc="full angle that the sonars' messages give, which is the sensors' nominal one; what "
        "echoes is decided by sonar.beam_half_angle",
        unit="rad",
        minimum=0.0,
        maximum=math.pi,
        read_only=True,
        source="paper, section III-A",
    )
    ground_truth_resolution: float = parameter(
        0.1,
        doc="side of the cells of ground_truth/map",
        unit="m",
        minimum=0.01,
        maximum=10.0,
        read_only=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()


def simulation_parameters(overrides: Mapping[str, Any]) -> SimulationParameters:
    """Return the parameters of the node: the defaults, then the world's, then those given.

    Parameters
    ----------
    overrides : mapping
        Values by dotted name; the last word.

    Raises
    ------
    ValueError
        For an unknown name, a refused value or a world that cannot be loaded.
    """
    world = load_world(from_mapping(SimulationParameters(), overrides).world)
    return from_mapping(from_mapping(SimulationParameters(), world.parameters), overrides)
