# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the campaign is asked for on its command line."""

from __future__ import annotations

import os
import secrets
import shlex
from argparse import Namespace
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.params import PRESETS
from fuzzy_navigation.params import MOTION_PRESETS, PLANNER_PRESETS
from nomad_sim.campaign_parser import PROGRAM, campaign_parser
from nomad_sim.missions import MissionSpec
from nomad_sim.output_folder import made_folder
from nomad_sim.overrides import critical_angles, parameter_overrides
from nomad_sim.reference import MISSIONS, ROWS
from nomad_sim.trials import Rules, Trial, TrialBatch
from nomad_sim.world import World
from nomad_sim.world_io import load_world
from nomad_sim.worlds import KINDS
from nomad_sim.worlds.floor_plan import PLAN_KIND, PLAN_RECIPE, load_floor_plan
from nomad_sim.worlds.generated import RECIPE

__all__ = ["PROGRAM", "Batch", "Options", "parse_options"]

_COMMAND = ("ros2", "run", "nomad_sim", PROGRAM)
#: Most missions of one batch.
_MOST_SEEDS = 100_000
#: A first seed drawn anew stays short enough to be typed.
_FRESH_SEEDS = 2**31
_LAST_SEED = 2**63 - 1


@dataclass(frozen=True)
class Batch:
    """Missions that differ in their seed alone.

    Parameters
    ----------
    name, description : str
        What they are.
    specs : tuple of MissionSpec
        One for each seed.
    method : int or None
        How many of `reference.MISSIONS` the method reached there, None for a world that it
        was not measured in.
    command : tuple of str
        Words that run a mission again when its seed is put behind them.
    """

    name: str
    description: str
    specs: tuple[MissionSpec, ...]
    method: int | None
    command: tuple[str, ...]

    def replay_command(self, seed: int) -> str:
        """Return the command that runs one mission again and draws it."""
        return shlex.join([*self.command, "--replay", str(seed), "--output", f"seed_{seed}"])


@dataclass(frozen=True)
class Options:
    """What is to be done.

    Parameters
    ----------
    batches : tuple of Batch
        The missions; of trials the first alone.
    trials : TrialBatch or None
        Missions in worlds that are drawn.
    jobs : int
        Most processes at a time.
    cluster : str or None
        Address of the Dask scheduler that is to run trials.
    output : Path or None
        Folder for results.
    as_json : bool
        Whether standard output gets JSON in place of tables.
    replay : bool
        Whether the one mission there is is to be told and drawn perception by perception.
    every_figure : bool
        Whether it is drawn at every perception, not at the last alone.
    """

    batches: tuple[Batch, ...]
    trials: TrialBatch | None
    jobs: int
    cluster: str | None
    output: Path | None
    as_json: bool
    replay: bool
    every_figure: bool


def _chosen(kind: str, name: str, known: Collection[str]) -> str:
    if name not in known:
        raise ValueError(f"unknown {kind} '{name}'{suggest(name, known)}")
    return name


def _drawn(given: Namespace) -> bool:
    """Whether each mission has a world of its own, drawn by its seed."""
    return given.generated is not None or given.floor_plan is not None


def _count(given: Namespace) -> int:
    if given.generated is not None:
        return int(given.generated)
    if given.missions is not None:
        return int(given.missions)
    return int(given.seeds) if given.seeds is not None else MISSIONS


def _seeds(given: Namespace) -> range:
    if given.replay is not None:
        if given.fresh or given.first_seed is not None:
            raise ValueError("--replay names its seed: without --first-seed and --fresh")
        first, count = given.replay, 1
    else:
        if given.fresh and given.first_seed is not None:
            raise ValueError("either --first-seed or --fresh")
        first, count = given.first_seed, _count(given)
        if given.fresh:
            first = secrets.randbelow(_FRESH_SEEDS)
        elif first is None:
            first = 1
    if not 1 <= count <= _MOST_SEEDS:
        option = "--seeds"
        if _drawn(given):
            option = "--generated" if given.generated is not None else "--missions"
        raise ValueError(f"{option} must be from 1 to {_MOST_SEEDS}, got {count}")
    if not 0 <= first <= _LAST_SEED - count:
        raise ValueError(f"a seed must be from 0 to {_LAST_SEED - count}, got {first}")
    return range(first, first + count)


def _command(given: Namespace, *what: str) -> tuple[str, ...]:
    """Return the command that missions come from, without seeds."""
    words = [*_COMMAND, *what, "--preset", given.preset]
    if not _drawn(given):
        words += ["--start-spread", repr(_spread(given))]
    for assignment in given.set:
        words += ["--set", assignment]
    for assignment in given.critical_angle:
        words += ["--critical-angle", assignment]
    return tuple(words)


def _spread(given: Namespace) -> float:
    spread = 0.3 if given.start_spread is None else float(given.start_spread)
    if not 0.0 <= spread <= 1000.0:
        raise ValueError(f"--start-spread must be from 0 to 1000 m, got {spread:g}")
    return spread


def _rules(given: Namespace) -> Rules:
    everywhere = set(PRESETS) & set(PLANNER_PRESETS) & set(MOTION_PRESETS)
    values = parameter_overrides(given.set)
    return Rules(
        _chosen("preset", given.preset, everywhere),
        **values,
        critical_angles=critical_angles(given.critical_angle),
    )


def _trials(given: Namespace) -> TrialBatch:
    rules, seeds = _rules(given), _seeds(given)
    if "robot.radius" in rules.simulator or "goal_tolerance" in rules.motion:
        raise ValueError(
            "what is true of a drawn world holds for the robot's radius and the goal's tolerance "
            "as they are: without --set simulator.robot.radius and motion.goal_tolerance"
        )
    if given.floor_plan is not None:
        plan = load_floor_plan(given.floor_plan)
        return TrialBatch(
            plan.name,
            f"start and goal in a floor plan, drawn by seeds {seeds[0]} to {seeds[-1]}",
            tuple(Trial(PLAN_KIND, seed, rules, given.floor_plan) for seed in seeds),
            {"floor_plan": plan.digest, "recipe": PLAN_RECIPE},
            _command(given, "--floor-plan", given.floor_plan),
        )
    kinds = [_chosen("kind of world", name, KINDS) for name in given.kind or KINDS]
    # The seed says which, so that one more mission leaves the others as they were.
    trials = tuple(Trial(kinds[seed % len(kinds)], seed, rules) for seed in seeds)
    return TrialBatch(
        "generated",
        f"worlds drawn by seeds {seeds[0]} to {seeds[-1]}: {', '.join(kinds)}",
        trials,
        {"generated": RECIPE},
        _command(given, "--generated"),
    )


def _single(batch: TrialBatch) -> Batch:
    """Return the one trial there is as a mission of its own."""
    (trial,) = batch.trials
    world = trial.world()
    command = batch.command_for(trial.kind)
    return Batch(world.name, world.description, (trial.spec(world),), None, command)


def _batches(given: Namespace) -> tuple[Batch, ...]:
    seeds, spread, rules = _seeds(given), _spread(given), _rules(given)

    @cache
    def changed(world: World) -> World:
        return world.with_critical_angles(rules.critical_angles)

    def spec(world: World, seed: int, simulator: Mapping[str, Any]) -> MissionSpec:
        return MissionSpec(
            changed(world),
            seed,
            rules.preset,
            spread,
            rules.mapper,
            rules.planner,
            rules.motion,
            {**simulator, **rules.simulator},
        )

    if given.world is not None:
        world = load_world(given.world)
        return (
            Batch(
                world.name,
                world.description,
                tuple(spec(world, seed, {}) for seed in seeds),
                None,
                _command(given, "--world", given.world),
            ),
        )
    names = [_chosen("row", name, ROWS) for name in given.row or ROWS]
    return tuple(
        Batch(
            name,
            ROWS[name].description,
            tuple(spec(ROWS[name].world(seed), seed, ROWS[name].simulator) for seed in seeds),
            ROWS[name].reached[rules.preset],
            _command(given, "--reference", "--row", name),
        )
        for name in names
    )


def _check_trials(given: Namespace) -> None:
    """Refuse options that do not go with worlds that are drawn, or only with those."""
    drawn = _drawn(given)
    if given.generated is not None and given.floor_plan is not None:
        raise ValueError("either --generated or --floor-plan")
    if given.kind is not None and given.generated is None:
        raise ValueError("--kind chooses among the worlds of --generated")
    if given.missions is not None and given.floor_plan is None:
        raise ValueError("--missions says how many with --floor-plan")
    if drawn and given.seeds is not None:
        raise ValueError("--seeds goes with --world and --reference; see --help")
    if drawn and given.start_spread is not None:
        raise ValueError("the seed draws the start: without --start-spread")
    if given.dask is not None:
        if not drawn or given.replay is not None:
            raise ValueError("--dask runs many missions of --generated or --floor-plan")
        if given.jobs is not None:
            raise ValueError("either --jobs on this machine or --dask")


def _options(given: Namespace) -> Options:
    if given.reference + (given.world is not None) + _drawn(given) != 1:
        raise ValueError(
            "either --world, --reference, --generated or --floor-plan says what to run"
        )
    if given.row is not None and not given.reference:
        raise ValueError("--row chooses among the rows of --reference")
    if given.replay is not None and given.reference and len(given.row or ()) != 1:
        raise ValueError("--replay runs one mission: with --reference it needs one --row")
    if given.figures is not None and (given.replay is None or given.output is None):
        raise ValueError("--figures draws what --replay runs into the folder of --output")
    _check_trials(given)
    jobs = given.jobs if given.jobs is not None else len(os.sched_getaffinity(0))
    if jobs < 1:
        raise ValueError(f"--jobs must be at least 1, got {jobs}")
    output = None if given.output is None else made_folder(given.output)
    trials = _trials(given) if _drawn(given) else None
    if trials is None:
        batches = _batches(given)
    else:
        # A replay is of this one; otherwise it stands for all.
        first = replace(trials, trials=trials.trials[:1])
        batches = (_single(first),)
    for batch in batches:
        batch.specs[0].mission()  # refuses what cannot be before anything has been run
    return Options(
        batches=batches,
        trials=trials,
        jobs=jobs,
        cluster=given.dask,
        output=output,
        as_json=given.json,
        replay=given.replay is not None,
        every_figure=given.figures == "every",
    )


def parse_options(arguments: Sequence[str] | None = None) -> Options:
    """Return what a command line asks for; leave with code 2 and one line if it cannot be.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of the process.
    """
    parser = campaign_parser()
    given, unknown = parser.parse_known_args(arguments)
    if unknown:
        name = unknown[0].partition("=")[0]
        hint = suggest(name, parser.known_options()) if name.startswith("-") else ""
        parser.error(f"unknown argument '{name}'{hint}")
    try:
        return _options(given)
    except ValueError as error:
        parser.error(str(error))
