# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the planner and of the motion, declared once.

The groups of the motion are declared in `motion_params`.

"Paper" in a source is Oriolo, Ulivi, Vendittelli, IEEE Trans. SMC-B 28(3), 1998.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from fuzzy_map_building.parameter_schema import (
    ParameterError,
    from_mapping,
    parameter,
    suggest,
    validate,
)
from fuzzy_map_building.params import DEFAULT_PRESET, PAPER_PRESET, TurretParameters
from fuzzy_map_building.sensor_params import (
    InfraredParameters,
    SonarGuardParameters,
    SonarParameters,
)
from fuzzy_navigation.layer_params import LayerParameters
from fuzzy_navigation.motion_params import (
    ROBOT_RADIUS,
    ClearanceParameters,
    FollowerParameters,
    TimeoutParameters,
    WatchParameters,
)
from fuzzy_navigation.plan_types import MAX_TOLERANCE

__all__ = [
    "DEFAULT_PRESET",
    "MOTION_PRESETS",
    "PAPER_PRESET",
    "PLANNER_PRESETS",
    "ClearanceParameters",
    "FollowerParameters",
    "InfraredParameters",
    "LayerParameters",
    "MotionParameters",
    "PlannerParameters",
    "SonarGuardParameters",
    "SonarParameters",
    "TimeoutParameters",
    "TurretParameters",
    "WatchParameters",
    "motion_parameters",
    "planner_parameters",
]

T = TypeVar("T")


@dataclass(frozen=True)
class PlannerParameters:
    """How paths are planned on the planning map M_p (paper, section IV-A).

    Raises
    ------
    ParameterError
        For a value out of its range, or a ladder that does not rise.
    """

    cost: str = parameter(
        "g2",
        doc="path cost: sum of the risks (g1, algorithm A1), of their squares (g2, A2) "
        "or their maximum (g3, A3)",
        choices=("g1", "g2", "g3"),
        source="paper, section IV-A",
    )
    alpha_ladder: tuple[float, ...] = parameter(
        (0.6, 0.7, 0.8, 0.9, 1.0),
        doc="largest admissible risk, tried in this order until a path is found",
        minimum=0.0,
        maximum=1.0,
        source="paper, sections IV-A and V",
    )
    rung_choice: str = parameter(
        "cheapest",
        doc="rung of the ladder whose path is taken: the lowest one that has a path (first), or "
        "the lowest one whose path costs no more than rung_factor times that of the highest "
        "rung, which admits what the others do (cheapest)",
        choices=("first", "cheapest"),
        source="paper, section V: first",
    )
    rung_factor: float = parameter(
        1.1,
        doc="how many times the cheapest path a path on a lower rung may cost",
        minimum=1.0,
        maximum=1e6,
    )
    adjacency: int = parameter(
        0,
        doc="neighbours of a cell: 4 or 8; 0 means 8 for g1 and g2 and 4 for g3",
        choices=(0, 4, 8),
        source="paper, section IV-A",
    )
    tolerance: float = parameter(
        0.3,
        doc="distance from the goal within which a path may end; 0: only in the goal's cell",
        unit="m",
        minimum=0.0,
        maximum=MAX_TOLERANCE,
    )
    epsilon: float = parameter(
        0.01,
        doc="constant added to the risk of each cell: where least_risk is 0, how much a path "
        "through cells that nobody has explored is preferred to one through free cells",
        minimum=1e-9,
        maximum=1.0,
    )
    least_risk: float = parameter(
        0.3,
        doc="risk that every cell of a path costs at least: below that of ground that is free, "
        "though little is known of it, the shorter path is the better one",
        minimum=0.0,
        maximum=1.0,
    )
    robot_radius: float = parameter(
        ROBOT_RADIUS,
        doc="radius by which the planning map is augmented",
        unit="m",
        minimum=0.0,
        maximum=5.0,
        source="paper, section II",
    )
    augmentation: str = parameter(
        "disc",
        doc="footprint of the augmentation: square of 2 round(radius / cell) + 1 cells, or disc "
        "of the cells whose centres are no farther than the radius",
        choices=("square", "disc"),
        source="paper, section IV-A",
    )
    diagonal: str = parameter(
        "sqrt2",
        doc="cost of a diagonal step: that of a straight one (unit) or sqrt(2) times it (sqrt2)",
        choices=("unit", "sqrt2"),
        source="paper, section IV-A",
    )
    corner_cutting: bool = parameter(
        True,
        doc="whether a diagonal step may pass between cells that are not admissible; "
        "if not, both cells beside the step have to be",
    )
    layer: LayerParameters = field(default_factory=LayerParameters)

    def __post_init__(self) -> None:
        validate(self)
        ladder = self.alpha_ladder
        if not ladder:
            raise ParameterError("parameter 'alpha_ladder' needs at least one rung, got none")
        if ladder[0] <= 0.0 or any(b <= a for a, b in itertools.pairwise(ladder)):
            raise ParameterError(
                "parameter 'alpha_ladder' must start above 0 and rise from rung to rung, "
                f"got {list(ladder)}"
            )


@dataclass(frozen=True)
class MotionParameters:
    """When the motion stops, asks for a map, and gives up (paper, section IV-B)."""

    concurrent: bool = parameter(
        False,
        doc="whether the robot maps while it moves: the path is planned anew with every map that "
        "comes on the way, and it stops for a perception only where a stop condition asks for it "
        "and no path leads on. The mapper has to be in its mode 'continuous'",
        source="paper, section II",
    )
    beta: float = parameter(
        0.9,
        doc="largest augmented motion risk of a cell that the robot enters",
        minimum=0.0,
        maximum=1.0,
        source="paper, section V",
    )
    robot_radius: float = parameter(
        ROBOT_RADIUS,
        doc="radius by which the motion map is augmented, and of the body in clearances",
        unit="m",
        minimum=0.0,
        maximum=5.0,
        source="paper, section II",
    )
    augmentation: str = parameter(
        "disc",
        doc="footprint of the augmentation, as the planner's",
        choices=("square", "disc"),
        source="paper, section IV-A",
    )
    perception_cap: int = parameter(
        80, doc="perceptions after which the goal is unreachable", minimum=1, maximum=100_000
    )
    livelock_limit: int = parameter(
        6,
        doc="perceptions in a row without progress that make a livelock",
        minimum=1,
        maximum=100_000,
    )
    refusal_memory: int = parameter(
        40,
        doc="perceptions for which the planner is kept from cells that the motion could not "
        "enter; 0: not at all, as in the paper",
        minimum=0,
        maximum=100_000,
    )
    frontier_looks: int = parameter(
        8,
        doc="looks from within frontier_reach after which a cell at the border of the explored "
        "area that has not opened is not worth another, and barred; 0: never",
        minimum=0,
        maximum=100_000,
    )
    frontier_reach: float = parameter(
        1.3,
        doc="distance within which a perception is a close look at a cell in sight",
        unit="m",
        minimum=0.0,
        maximum=100.0,
    )
    look_turn: float = parameter(
        0.618 * math.radians(22.5),
        doc="angle by which the robot turns before it looks again from a place where the last "
        "perception brought no progress: the golden section of the angle between two infrareds, "
        "so that none looks where another did; 0: it does not",
        unit="rad",
        minimum=0.0,
        maximum=math.pi,
    )
    patience: int = parameter(
        25,
        doc="perceptions before which everything that is barred is looked at over and over "
        "before the goal is called unreachable; after them once more",
        minimum=0,
        maximum=100_000,
    )
    attempts: int = parameter(
        3,
        doc="how often in a row a perception or a plan may fail before the mission does",
        minimum=1,
        maximum=1000,
    )
    believed_free_alpha: float = parameter(
        0.6,
        doc="rung of the planner's ladder up to which a path leads through cells that are not "
        "believed occupied: no progress on such paths is a livelock, on riskier ones the goal is "
        "unreachable",
        minimum=0.0,
        maximum=1.0,
        source="paper, section V",
    )
    slim_radius: float = parameter(
        0.0,
        doc="radius of a slimmer robot whose path is followed to where it leaves the explored "
        "area when the true one has none up to believed_free_alpha: wide cones make openings "
        "look narrower than they are, and from close by they look wider; 0: none",
        unit="m",
        minimum=0.0,
        maximum=5.0,
    )
    any_angle: bool = parameter(
        True,
        doc="whether the planner is asked to join the cells of its path by straight lines at any "
        "angle where that costs no more; if not, paths run in the eight directions of the cells' "
        "neighbours",
    )
    goal_tolerance: float = parameter(
        0.3,
        doc="distance from the goal that counts as reached",
        unit="m",
        minimum=0.02,
        maximum=MAX_TOLERANCE,
    )
    subcell_target: bool = parameter(
        True,
        doc="whether the robot drives through each cell of its path where the hit points leave it "
        "most room, at one of the nine places of layer.shift; if not, through its centre",
    )
    clearance: ClearanceParameters = field(default_factory=ClearanceParameters)
    layer: LayerParameters = field(default_factory=LayerParameters)
    follower: FollowerParameters = field(default_factory=FollowerParameters)
    infrared: InfraredParameters = field(default_factory=InfraredParameters)
    sonar: SonarParameters = field(default_factory=SonarParameters)
    turret: TurretParameters = field(default_factory=TurretParameters)
    # A corner beside an opening echoes off the sonar's axis: points aside would close it.
    sonar_guard: SonarGuardParameters = field(
        default_factory=lambda: SonarGuardParameters(spread=0.0)
    )
    watch: WatchParameters = field(default_factory=WatchParameters)
    timeout: TimeoutParameters = field(default_factory=TimeoutParameters)

    def __post_init__(self) -> None:
        validate(self)
        if not (self.infrared.frame_ids or self.sonar_guard.enabled):
            raise ParameterError(
                "without infrareds ('infrared.frame_ids' is empty) only the sonars can keep the "
                "robot from what is near: 'sonar_guard.enabled' must be true"
            )


#: What each preset changes of the defaults, by dotted name: the rules beyond the paper are the
#: defaults (``consistent``), those of the paper, mended, are ``oriolo1998``.
PLANNER_PRESETS: Mapping[str, Mapping[str, Any]] = {
    DEFAULT_PRESET: {},
    PAPER_PRESET: {
        "augmentation": "square",
        "diagonal": "unit",
        "epsilon": 0.2,
        "least_risk": 0.0,
        "rung_choice": "first",
        "layer.enabled": False,
    },
}
MOTION_PRESETS: Mapping[str, Mapping[str, Any]] = {
    DEFAULT_PRESET: {},
    PAPER_PRESET: {
        "any_angle": False,
        "augmentation": "square",
        "clearance.impasse": 0.0,
        "clearance.rule": "closing",
        "frontier_looks": 0,
        "look_turn": 0.0,
        "layer.enabled": False,
        # Without infrared evidence openings look closed.
        "slim_radius": 0.12,
        "sonar_guard.enabled": False,
        "subcell_target": False,
    },
}


def _resolve(
    base: T,
    presets: Mapping[str, Mapping[str, Any]],
    preset: str,
    overrides: Mapping[str, Any] | None,
) -> T:
    if preset not in presets:
        raise ParameterError(f"unknown preset {preset!r}{suggest(str(preset), presets)}")
    return from_mapping(from_mapping(base, presets[preset]), overrides or {})


def planner_parameters(
    preset: str = DEFAULT_PRESET, overrides: Mapping[str, Any] | None = None
) -> PlannerParameters:
    """Return the parameters of a planner.

    Parameters
    ----------
    preset : str
        One of `PLANNER_PRESETS`.
    overrides : mapping, optional
        Values that differ from the preset, by name.

    Raises
    ------
    ParameterError
        For an unknown preset or name, or a refused value.

    Examples
    --------
    >>> planner_parameters(overrides={"cost": "g1"}).cost
    'g1'
    """
    return _resolve(PlannerParameters(), PLANNER_PRESETS, preset, overrides)


def motion_parameters(
    preset: str = DEFAULT_PRESET, overrides: Mapping[str, Any] | None = None
) -> MotionParameters:
    """Return the parameters of the motion.

    Parameters
    ----------
    preset : str
        One of `MOTION_PRESETS`.
    overrides : mapping, optional
        Values that differ from the preset, by dotted name or nested.

    Raises
    ------
    ParameterError
        For an unknown preset or name, or a refused value.

    Examples
    --------
    >>> motion_parameters(overrides={"clearance.rule": "strict"}).clearance.rule
    'strict'
    """
    return _resolve(MotionParameters(), MOTION_PRESETS, preset, overrides)
