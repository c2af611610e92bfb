# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The demonstration's command line, checked to the end before anything starts."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.params import DEFAULT_PRESET, mapper_parameters
from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.addressed import section_parameters
from fuzzy_map_building.types import Pose2
from fuzzy_map_building.wording import real_number, whole_number
from fuzzy_navigation.params import motion_parameters, planner_parameters
from nomad_sim.ground_truth import Reachability, reachability
from nomad_sim.output_folder import made_folder
from nomad_sim.ros.domain import DOMAINS, RESERVED
from nomad_sim.ros.params import simulation_parameters
from nomad_sim.simulator import Simulator
from nomad_sim.world import World
from nomad_sim.world_io import load_world, world_names

__all__ = ["NODES", "DemoOptions", "parse_options"]

#: Names of the nodes that the demonstration starts, by process.
NODES: Final[Mapping[str, str]] = {
    "sim": names.SIMULATOR_NODE,
    "mapper": names.MAPPER_NODE,
    "planner": names.PLANNER_NODE,
    "motion": names.MOTION_NODE,
}
#: Simulated seconds a second: what two cores keep up with in lockstep.
DEFAULT_RATE: Final = 8.0

_EPILOG: Final = """\
exit codes:
  0    the verdict is the true one and the robot touched nothing
  1    another verdict, a contact, or no verdict within --timeout
  2    refused before anything was started, or a file could not be written: the line says why
  3    a node could not start, or ended before its time
  130  stopped by SIGINT (Ctrl-C) or SIGTERM
No process is left running in any case.
"""


@dataclass(frozen=True)
class DemoOptions:
    """What to demonstrate.

    Parameters
    ----------
    world : World
        With the start and the goal that were asked for.
    world_source : str
        Name or file that it comes from.
    expected : tuple of str
        True verdicts: ``reached`` or ``unreachable``, and of a marginal goal either.
    seed : int
        Seed of the simulator.
    rate : float
        Simulated seconds a second, 0: as fast as possible.
    lockstep : bool
        Whether each tick of the simulator waits for the motion's answer.
    output : Path
        Folder for figures, summary and logs.
    preset : str
        Rule set of mapper, planner and motion.
    concurrent : bool
        Whether the robot maps while it moves.
    params_file : Path, optional
        Parameters for any of the nodes.
    timeout : float
        Wall time after which the run is given up [s].
    domain : int, optional
        ROS domain; None: a free one.
    """

    world: World
    world_source: str
    expected: tuple[str, ...]
    seed: int
    rate: float
    lockstep: bool
    output: Path
    preset: str
    concurrent: bool
    params_file: Path | None
    timeout: float
    domain: int | None


def parse_options(arguments: Sequence[str] | None = None) -> DemoOptions:
    """Return what the command line asks for.

    Raises
    ------
    ValueError
        If it cannot be done, with a sentence that says why.
    SystemExit
        For ``--help``, and for a command line that cannot be read.
    """
    args = _parser().parse_args(arguments)
    world = load_world(args.world)
    expected: tuple[str, ...] = (world.expected,)
    motion = motion_parameters(args.preset)
    planner_parameters(args.preset)
    mapper_parameters(args.preset)
    if args.params_file is not None:
        _check_parameter_file(args.params_file)
    else:  # a file may ask for larger cells
        size = dict(zip(("area.size_x", "area.size_y"), world.size, strict=True))
        mapper_parameters(args.preset, size)
    if args.start is not None or args.goal is not None:
        world = _moved(world, args.start, args.goal)
    # Refuses a start in an obstacle, and parameters that the world does not take.
    values = simulation_parameters({"world": args.world, "seed": args.seed, "rate": args.rate})
    Simulator(world, values)
    if args.goal is not None:
        world.check_free(*world.goal, "--goal")
    if args.start is not None or args.goal is not None:
        truth = reachability(world, values.robot.radius, motion.goal_tolerance)
        either = truth is Reachability.MARGINAL
        expected = ("reached", "unreachable") if either else (truth.expected,)
    return DemoOptions(
        world=world,
        world_source=args.world,
        expected=expected,
        seed=args.seed,
        rate=args.rate,
        lockstep=args.lockstep,
        output=made_folder(args.output),
        preset=args.preset,
        concurrent=args.concurrent,
        params_file=args.params_file,
        timeout=args.timeout,
        domain=args.domain,
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="demo",
        description="A simulated robot crosses an unknown world to its goal, driven by the nodes "
        "sim, mapper, planner and motion over ROS 2. Leaves figures of the maps and summary.json.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    known = ", ".join(world_names())
    parser.add_argument("--world", default="lab", help=f"{known}, or a file (default: lab)")
    parser.add_argument(
        "--start",
        nargs=3,
        type=real_number,
        metavar=("X", "Y", "THETA"),
        help="start [m, m, rad] (default: the world's)",
    )
    parser.add_argument(
        "--goal",
        nargs=2,
        type=real_number,
        metavar=("X", "Y"),
        help="goal [m] (default: the world's)",
    )
    parser.add_argument("--seed", type=whole_number, default=0, help="of all noise (default: 0)")
    parser.add_argument(
        "--rate",
        type=real_number,
        default=DEFAULT_RATE,
        help="simulated seconds a second, 0: as fast as the machine allows "
        f"(default: {DEFAULT_RATE:g})",
    )
    parser.add_argument("--output", default="demo", help="folder for results (default: demo)")
    parser.add_argument(
        "--preset",
        default=DEFAULT_PRESET,
        help=f"rule set of mapper, planner and motion (default: {DEFAULT_PRESET})",
    )
    parser.add_argument(
        "--concurrent",
        action="store_true",
        help="map while moving, instead of standing for each perception",
    )
    parser.add_argument(
        "--lockstep",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="whether simulated time waits for the motion's answers, so that the robot is "
        "controlled on a slow machine as on a fast one (default: yes)",
    )
    parser.add_argument(
        "--timeout",
        type=_positive,
        default=600.0,
        help="wall time after which the run is given up [s] (default: 600)",
    )
    parser.add_argument(
        "--params-file", type=Path, help="ROS 2 parameter file, for any of the four nodes"
    )
    parser.add_argument(
        "--domain",
        type=_domain,
        help=f"ROS_DOMAIN_ID from {DOMAINS[0]} to {DOMAINS[-1]}, e.g. to watch with RViz "
        f"(default: one from {RESERVED[0]} to {RESERVED[-1]} that nobody uses)",
    )
    return parser


def _positive(text: str) -> float:
    value = real_number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"must be above 0, got {text}")
    return value


def _domain(text: str) -> int:
    value = whole_number(text)
    if value not in DOMAINS:
        raise argparse.ArgumentTypeError(f"must be from {DOMAINS[0]} to {DOMAINS[-1]}, got {text}")
    return value


def _moved(world: World, start: list[float] | None, goal: list[float] | None) -> World:
    """Return the world with another start or goal, both in its area."""
    for name, place in (("--start", start), ("--goal", goal)):
        if place is not None:
            world.check_inside(place[0], place[1], name)
    return replace(
        world,
        start=world.start if start is None else Pose2(*start),
        goal=world.goal if goal is None else (goal[0], goal[1]),
    )


def _check_parameter_file(path: Path) -> None:
    """Refuse a file that ROS would refuse later, or would silently not use."""
    known = set(NODES.values())
    try:
        sections = section_parameters(path)
    except ValueError as error:
        raise ValueError(f"--params-file {error}") from error
    if not sections:
        nodes = ", ".join(sorted(known))
        raise ValueError(f"--params-file {path} is empty: it has no section for any of {nodes}")
    for name in sections:
        node = name.rsplit("/", 1)[-1]
        if node not in known and "*" not in node:
            raise ValueError(f"--params-file {path}: unknown node '{node}'{suggest(node, known)}")
