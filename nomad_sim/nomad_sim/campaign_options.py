# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the campaign is asked for on its command line."""

from __future__ import annotations

import os
import secrets
import shlex
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.params import DEFAULT_PRESET, PRESETS
from fuzzy_navigation.params import MOTION_PRESETS, PLANNER_PRESETS
from nomad_sim.missions import MissionSpec
from nomad_sim.output_folder import made_folder
from nomad_sim.overrides import critical_angles, parameter_overrides
from nomad_sim.reference import MISSIONS, ROWS
from nomad_sim.world import World
from nomad_sim.world_io import load_world, world_names

__all__ = ["PROGRAM", "Batch", "Options", "parse_options"]

PROGRAM = "campaign"
_COMMAND = ("ros2", "run", "nomad_sim", PROGRAM)
#: Most missions of one batch.
_MOST_SEEDS = 100_000
#: A first seed drawn anew stays short enough to be typed.
_FRESH_SEEDS = 2**31
_LAST_SEED = 2**63 - 1

_EPILOG = """examples:
  campaign --world lab --seeds 20 --jobs 2
  campaign --world office --set simulator.sonar.beam_half_angle=12.5deg --output results
  campaign --world office --replay 7 --output seed7 --figures every
  campaign --reference --row clutter --row office --seeds 20 --output results

exit code: 0 if every verdict was true and nothing was touched (--reference: if each row
reached at least the method's share and nothing was touched), 1 if not, 2 if the options
cannot be, 130 after Ctrl-C.
"""


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
        The missions.
    jobs : int
        Most processes at a time.
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
    jobs: int
    output: Path | None
    as_json: bool
    replay: bool
    every_figure: bool


class _Parser(ArgumentParser):
    """An argument parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")

    def known_options(self) -> list[str]:
        return [name for name in self._option_string_actions if name.startswith("--")]


def _parser() -> _Parser:
    parser = _Parser(
        PROGRAM,
        description="Run many missions without ROS, one for each seed, and sum them up.",
        epilog=_EPILOG,
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    what = parser.add_argument_group("what to run")
    what.add_argument("--world", help=f"a world file, or one of {', '.join(world_names())}")
    what.add_argument(
        "--reference", action="store_true", help="the worlds that the method was measured in"
    )
    what.add_argument(
        "--row", action="append", metavar="NAME", help="only this row of --reference; repeatable"
    )
    what.add_argument("--seeds", type=int, default=MISSIONS, metavar="N", help="missions (20)")
    what.add_argument("--first-seed", type=int, metavar="N", help="seed of the first (1)")
    what.add_argument("--fresh", action="store_true", help="draw the first seed, and say it")
    what.add_argument(
        "--start-spread",
        type=float,
        default=0.3,
        metavar="M",
        help="how far a start is from the world's in x and y at most, in metres, at any "
        "heading; 0: the world's start (0.3)",
    )
    rules = parser.add_argument_group("rules and world")
    rules.add_argument("--preset", default=DEFAULT_PRESET, help=f"rule set ({DEFAULT_PRESET})")
    rules.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a parameter of mapper, planner, motion or simulator, such as "
        "mapper.evidence.k_empty=0.3; angles with deg behind them; repeatable",
    )
    rules.add_argument(
        "--critical-angle",
        action="append",
        default=[],
        metavar="MATERIAL=DEG",
        help="critical angle of a material, such as painted_wall=25; repeatable",
    )
    how = parser.add_argument_group("how")
    how.add_argument(
        "--jobs",
        type=int,
        default=len(os.sched_getaffinity(0)),
        metavar="N",
        help="missions at a time (all cores)",
    )
    how.add_argument("--output", metavar="FOLDER", help="write CSV and JSON there")
    how.add_argument("--json", action="store_true", help="print JSON in place of tables")
    how.add_argument(
        "--replay", type=int, metavar="SEED", help="run one mission and tell its perceptions"
    )
    how.add_argument(
        "--figures",
        choices=("last", "every"),
        help="draw a replay into --output at its end or at every perception (last)",
    )
    return parser


def _chosen(kind: str, name: str, known: Collection[str]) -> str:
    if name not in known:
        raise ValueError(f"unknown {kind} '{name}'{suggest(name, known)}")
    return name


def _seeds(given: Namespace) -> range:
    if given.replay is not None:
        if given.fresh or given.first_seed is not None:
            raise ValueError("--replay names its seed: without --first-seed and --fresh")
        first, count = given.replay, 1
    else:
        if given.fresh and given.first_seed is not None:
            raise ValueError("either --first-seed or --fresh")
        first, count = given.first_seed, given.seeds
        if given.fresh:
            first = secrets.randbelow(_FRESH_SEEDS)
        elif first is None:
            first = 1
    if not 1 <= count <= _MOST_SEEDS:
        raise ValueError(f"--seeds must be from 1 to {_MOST_SEEDS}, got {count}")
    if not 0 <= first <= _LAST_SEED - count:
        raise ValueError(f"a seed must be from 0 to {_LAST_SEED - count}, got {first}")
    return range(first, first + count)


def _command(given: Namespace, *what: str) -> tuple[str, ...]:
    """Return the command that the batch's missions come from, without seeds."""
    words = [*_COMMAND, *what, "--preset", given.preset]
    words += ["--start-spread", repr(given.start_spread)]
    for assignment in given.set:
        words += ["--set", assignment]
    for assignment in given.critical_angle:
        words += ["--critical-angle", assignment]
    return tuple(words)


def _batches(given: Namespace) -> tuple[Batch, ...]:
    seeds = _seeds(given)
    everywhere = set(PRESETS) & set(PLANNER_PRESETS) & set(MOTION_PRESETS)
    preset = _chosen("preset", given.preset, everywhere)
    values = parameter_overrides(given.set)
    angles = critical_angles(given.critical_angle)
    if not 0.0 <= given.start_spread <= 1000.0:
        raise ValueError(f"--start-spread must be from 0 to 1000 m, got {given.start_spread:g}")

    @cache
    def changed(world: World) -> World:
        return world.with_critical_angles(angles)

    def spec(world: World, seed: int, simulator: Mapping[str, Any]) -> MissionSpec:
        return MissionSpec(
            changed(world),
            seed,
            preset,
            given.start_spread,
            values["mapper"],
            values["planner"],
            values["motion"],
            {**simulator, **values["simulator"]},
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
            ROWS[name].reached,
            _command(given, "--reference", "--row", name),
        )
        for name in names
    )


def _options(given: Namespace) -> Options:
    if given.reference == (given.world is not None):
        raise ValueError("either --world or --reference says what to run")
    if given.row is not None and not given.reference:
        raise ValueError("--row chooses among the rows of --reference")
    if given.replay is not None and given.reference and len(given.row or ()) != 1:
        raise ValueError("--replay runs one mission: with --reference it needs one --row")
    if given.figures is not None and (given.replay is None or given.output is None):
        raise ValueError("--figures draws what --replay runs into the folder of --output")
    if given.jobs < 1:
        raise ValueError(f"--jobs must be at least 1, got {given.jobs}")
    output = None if given.output is None else made_folder(given.output)
    batches = _batches(given)
    for batch in batches:
        batch.specs[0].mission()  # refuses what cannot be before anything has been run
    return Options(
        batches=batches,
        jobs=given.jobs,
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
    parser = _parser()
    given, unknown = parser.parse_known_args(arguments)
    if unknown:
        name = unknown[0].partition("=")[0]
        hint = suggest(name, parser.known_options()) if name.startswith("-") else ""
        parser.error(f"unknown argument '{name}'{hint}")
    try:
        return _options(given)
    except ValueError as error:
        parser.error(str(error))
