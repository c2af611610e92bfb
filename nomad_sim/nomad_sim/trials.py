# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Trials: missions whose world is drawn by their seed, and what came of them.

Unlike a `missions.MissionSpec`, a trial carries no world but what the world follows from: ten
thousand of them are made at once and sent to other processes and machines for little.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from fuzzy_map_building.plain_yaml import shown
from fuzzy_navigation.mission_types import Outcome
from nomad_sim.ground_truth import Reachability
from nomad_sim.json_fields import checked_fields
from nomad_sim.missions import MissionResult, MissionSpec, run_spec
from nomad_sim.shortest_way import length_of, shortest_way
from nomad_sim.world import World
from nomad_sim.worlds import KINDS, generate
from nomad_sim.worlds.draws import MATERIAL_CLASSES
from nomad_sim.worlds.floor_plan import PLAN_KIND, load_floor_plan, plan_world

__all__ = ["Rules", "Trial", "TrialBatch", "TrialResult", "run_trial"]

# What texts of a trial can be.
_CHOICES: Mapping[str, Collection[str]] = {
    "kind": (*KINDS, PLAN_KIND),
    "material": tuple(MATERIAL_CLASSES),
    "glass": ("none", "seen", "unseen"),
    "truth": tuple(truth.value for truth in Reachability),
    "outcome": tuple(Outcome.__members__),
}
# No mission measures or counts more of anything [m, rad, s, times].
_MANY = 1e9
# What numbers of a trial can be, ends included, where that is not from -_MANY to _MANY.
_BOUNDS: Mapping[str, tuple[float, float]] = {
    "beam": (0.0, 90.0),
    "door": (0.0, _MANY),
    "people": (0, _MANY),
    # Without a way, and without a wall that could be heard, they are infinite.
    "way_clearance": (-math.inf, math.inf),
    "min_clearance": (-1.0, math.inf),
    "shortest": (1e-3, _MANY),
    "seed": (0, math.inf),
    "perceptions": (0, _MANY),
    "path_length": (0.0, _MANY),
    "contacts": (0, _MANY),
    "duration": (0.0, _MANY),
    "wall_time": (0.0, _MANY),
}


def _check_possible(values: Mapping[str, Any]) -> None:
    """Raise ValueError for a value of the right type that no trial has."""
    for name, value in values.items():
        if name in _CHOICES and value not in _CHOICES[name]:
            raise ValueError(
                f"{name} must be one of {', '.join(_CHOICES[name])}, got {shown(value)}"
            )
        low, high = _BOUNDS.get(name, (-_MANY, _MANY))
        if isinstance(value, (int, float)) and not low <= value <= high:
            raise ValueError(f"{name} must be from {low:g} to {high:g}, got {shown(value)}")


@dataclass(frozen=True)
class Rules:
    """What the missions of a campaign have in common.

    Parameters
    ----------
    preset : str
        Rule set of mapper, planner and motion.
    mapper, planner, motion, simulator : mapping
        Single parameters by dotted name.
    critical_angles : mapping
        Critical angles [rad] by material, in place of those drawn.
    """

    preset: str
    mapper: Mapping[str, Any] = field(default_factory=dict)
    planner: Mapping[str, Any] = field(default_factory=dict)
    motion: Mapping[str, Any] = field(default_factory=dict)
    simulator: Mapping[str, Any] = field(default_factory=dict)
    critical_angles: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Trial:
    """A mission in a world that its seed draws.

    Parameters
    ----------
    kind : str
        Kind of the world: one of `worlds.KINDS`, or `worlds.floor_plan.PLAN_KIND`.
    seed : int
        Seed of the world, of start and goal, and of all noise.
    rules : Rules
        What the mission is run with.
    plan : str or None
        File of the floor plan.
    """

    kind: str
    seed: int
    rules: Rules
    plan: str | None = None

    def world(self) -> World:
        """Return the world, drawn anew."""
        if self.plan is None:
            world = generate(self.kind, self.seed)
        else:
            world = plan_world(load_floor_plan(self.plan), self.seed)
        return world.with_critical_angles(self.rules.critical_angles)

    def spec(self, world: World | None = None) -> MissionSpec:
        """Return the mission.

        Parameters
        ----------
        world : World, optional
            That of `world`, where it is there already.
        """
        r = self.rules
        return MissionSpec(
            world if world is not None else self.world(),
            self.seed,
            r.preset,
            start_spread=0.0,
            mapper=r.mapper,
            planner=r.planner,
            motion=r.motion,
            simulator=r.simulator,
        )


@dataclass(frozen=True)
class TrialBatch:
    """The trials of a campaign.

    Parameters
    ----------
    name, description : str
        What they are.
    trials : tuple of Trial
        All with the same rules.
    origin : mapping
        What the worlds come from, but for kinds and seeds; in JSON's types.
    command : tuple of str
        Words of the command that they come from, without kinds and seeds.
    """

    name: str
    description: str
    trials: tuple[Trial, ...]
    origin: Mapping[str, Any]
    command: tuple[str, ...]

    @property
    def configuration(self) -> dict[str, Any]:
        """What results must have in common to belong together, in JSON's types."""
        return {"origin": dict(self.origin), "rules": asdict(self.trials[0].rules)}

    def command_for(self, kind: str) -> tuple[str, ...]:
        """Return the command that trials of one kind come from."""
        return self.command if kind == PLAN_KIND else (*self.command, "--kind", kind)

    def replay_command(self, kind: str, seed: int) -> str:
        """Return the command that runs one trial again and draws it."""
        words = [*self.command_for(kind), "--replay", str(seed)]
        return shlex.join([*words, "--output", f"{kind}_{seed}"])


@dataclass(frozen=True)
class TrialResult:
    """A trial's numbers, with what was drawn.

    Parameters
    ----------
    kind : str
        Kind of the world.
    material : str
        Class of its materials.
    beam : float
        Half angle of the sonars' beam [deg].
    door : float or None
        Width of the narrowest door or opening drawn [m].
    glass : str
        ``none``, ``seen`` or ``unseen`` by the infrared sensors.
    people : int
        How many stood in the way at first.
    truth : str
        Value of `ground_truth.Reachability`.
    way_clearance : float
        Room on the best way [m], a lower bound.
    shortest : float or None
        Length of the shortest true way [m], None if there is none.
    mission : MissionResult
        What came of it.
    """

    kind: str
    material: str
    beam: float
    door: float | None
    glass: str
    people: int
    truth: str
    way_clearance: float
    shortest: float | None
    mission: MissionResult

    @property
    def path_ratio(self) -> float | None:
        """Path driven in shortest true ways; None where the goal was not reached."""
        if not self.mission.reached or self.shortest is None:
            return None
        return self.mission.path_length / self.shortest

    @property
    def false_unreachable(self) -> bool:
        """Whether a goal was called unreachable that is not."""
        called = self.mission.outcome == Outcome.UNREACHABLE.name
        return called and self.truth != Reachability.UNREACHABLE.value

    @property
    def false_reached(self) -> bool:
        """Whether a goal was called reached that cannot be."""
        return self.mission.reached and self.truth == Reachability.UNREACHABLE.value

    @property
    def flawless(self) -> bool:
        """Whether nothing was touched and the verdict is true; of a marginal goal, any is."""
        marginal = self.truth == Reachability.MARGINAL.value
        return self.mission.contacts == 0 and (marginal or self.mission.truthful)

    def row(self) -> dict[str, Any]:
        """Return everything as one flat mapping."""
        values = asdict(self)
        mission = values.pop("mission")
        return {**values, **mission, "path_ratio": self.path_ratio}

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> TrialResult:
        """Return the result that `dataclasses.asdict` made a mapping of.

        Raises
        ------
        ValueError
            If there is more or less in the mapping, a value that no trial has, or values that
            contradict each other.
        """
        values = checked_fields(cls, values)
        mission = MissionResult(**checked_fields(MissionResult, values["mission"]))
        _check_possible({**values, **asdict(mission)})
        result = cls(**{**values, "mission": mission})
        _check_consistent(result)
        return result


def _check_consistent(result: TrialResult) -> None:
    """Raise ValueError for values that contradict each other."""
    truth, mission = Reachability(result.truth), result.mission
    true = Outcome[mission.outcome] is Outcome[truth.expected.upper()]
    if mission.truthful is not true:
        raise ValueError(
            f"truthful must be {str(true).lower()} where truth is {truth.value} and outcome "
            f"{mission.outcome}"
        )
    # Of marginal goals neither is certain.
    wayless = {Reachability.REACHABLE: False, Reachability.UNREACHABLE: True}
    if wayless.get(truth, result.shortest is None) is not (result.shortest is None):
        raise ValueError(f"shortest cannot be {result.shortest} where truth is {truth.value}")


def run_trial(trial: Trial) -> TrialResult:
    """Draw a trial's world, run the mission in it and return its numbers."""
    world = trial.world()
    drawn = world.properties
    way = None
    if drawn["truth"] != Reachability.UNREACHABLE.value:
        way = shortest_way(world)
    return TrialResult(
        kind=trial.kind,
        material=drawn["material"],
        beam=drawn["beam"],
        door=drawn["door"],
        glass=drawn["glass"],
        people=drawn["people"],
        truth=drawn["truth"],
        way_clearance=drawn["way_clearance"],
        shortest=length_of(way) if way is not None else None,
        mission=run_spec(trial.spec(world)),
    )
