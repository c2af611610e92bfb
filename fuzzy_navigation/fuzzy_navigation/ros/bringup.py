# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Starts mapper, planner and motion for a real robot, and keeps the three together.

The robot's own drivers run elsewhere; topics are brought together by remapping::

    bringup --preset consistent --params-file robot.yaml --namespace robot1 \
        --ros-args -r pose:=/localisation/pose

With ``--respawn`` a node that ends is started anew. The mapper then goes on from a snapshot in
a folder that lives as long as bringup, unless a parameter file names another; the goal of a
motion that has ended is gone.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.params import PRESETS as MAPPER_PRESETS
from fuzzy_map_building.plain_yaml import shown
from fuzzy_map_building.ros.readiness import ReadyWatch, tell_ready
from fuzzy_map_building.ros.run import EXIT_REFUSED, check_arguments, stop_on_signals
from fuzzy_map_building.wording import whole_number
from fuzzy_navigation.concurrent_mission import SETTINGS
from fuzzy_navigation.params import MOTION_PRESETS, PLANNER_PRESETS
from fuzzy_navigation.ros.declarations import DECLARATIONS, refusals
from fuzzy_navigation.ros.processes import (
    CLEAN_ENDS,
    Ended,
    ProcessGroup,
    child_environment,
    python_module,
)
from fuzzy_navigation.ros.respawn import DEFAULT_LIMIT, STEADY, keep_running

__all__ = ["NODES", "main", "node_commands"]

_ROS_ARGS: Final = "--ros-args"

_NAMESPACE: Final = re.compile(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)

#: Module of each node, and the presets that it knows.
NODES: Final[Mapping[str, tuple[str, Mapping[str, Mapping[str, Any]]]]] = {
    "mapper": ("fuzzy_map_building.ros.mapper_node", MAPPER_PRESETS),
    "planner": ("fuzzy_navigation.ros.planner_node", PLANNER_PRESETS),
    "motion": ("fuzzy_navigation.ros.motion_node", MOTION_PRESETS),
}


def node_commands(
    preset: str = "",
    params_files: Sequence[str | Path] = (),
    namespace: str = "",
    ros_arguments: Sequence[str] = (),
    snapshot: str | Path = "",
    *,
    concurrent: bool = False,
) -> dict[str, list[str]]:
    """Return the command of each of the three nodes by name.

    Parameters
    ----------
    preset : str
        Preset of every node that knows one of this name; empty: the nodes' defaults.
    params_files : sequence of str or Path
        Parameter files, given to all nodes; a later file overrides an earlier one.
    namespace : str
        Namespace of the nodes, with or without the slash in front; empty: none.
    ros_arguments : sequence of str
        What else to give to all of them, as after ``--ros-args``.
    snapshot : str or Path
        File that the mapper keeps its state in unless the parameter files name another;
        empty: none.
    concurrent : bool
        Whether the robot maps while it moves; the parameter files may change how.

    Raises
    ------
    ValueError
        If no node knows the preset, a file does not exist, or no namespace is called so.
    """
    known = sorted({name for _, presets in NODES.values() for name in presets})
    if preset and preset not in known:
        raise ValueError(f"unknown preset '{preset}'{suggest(preset, known)}")
    common: list[str] = []
    for file in params_files:
        if not Path(file).is_file():
            raise ValueError(f"there is no parameter file '{file}'")
        common += ["--params-file", str(file)]
    if namespace:
        if not _NAMESPACE.fullmatch(namespace.strip("/")):
            raise ValueError(
                f"namespace {shown(namespace)}: letters, digits, '_' and '/' between names, none "
                "beginning with a digit, such as robot1"
            )
        common += ["-r", f"__ns:=/{namespace.strip('/')}"]
    commands = {}
    for name, (module, presets) in NODES.items():
        chosen = ["-p", f"preset:={preset}"] if preset in presets else []
        kept = ["-p", f"snapshot.file:={snapshot}"] if snapshot and name == "mapper" else []
        moving = SETTINGS.get(name, {}) if concurrent else {}
        mode = [part for rule in moving.items() for part in ("-p", _assignment(*rule))]
        arguments = [*kept, *mode, *common, *chosen, *ros_arguments]
        commands[name] = python_module(module, *([_ROS_ARGS, *arguments] if arguments else []))
    return commands


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the three nodes until SIGINT or SIGTERM, or until one of them ends for good.

    Parameters
    ----------
    arguments : sequence of str, optional
        Command line without the program's name; that of the process when None.

    Returns
    -------
    int
        0 if all nodes ran until the signal and then ended cleanly; 2 if the command line or
        a node's parameters were refused, before any node was started; else the exit code of
        the node that failed, 1 if a signal killed it.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    split = given.index(_ROS_ARGS) if _ROS_ARGS in given else len(given)
    options = _parser().parse_args(given[:split])
    with stop_on_signals() as stop, contextlib.ExitStack() as stack:
        snapshot: str | Path = ""
        if options.respawn:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="bringup_"))
            snapshot = Path(folder) / "mapper.map"
        try:
            commands = node_commands(
                options.preset,
                options.params_file,
                options.namespace,
                given[split + 1 :],
                snapshot,
                concurrent=options.concurrent,
            )
            # What all three would refuse is told once.
            files = [part for file in options.params_file for part in ("--params-file", file)]
            check_arguments([*files, *given[split + 1 :]])
        except ValueError as error:
            _say(str(error))
            return EXIT_REFUSED
        refused = refusals({name: _ros_arguments(c) for name, c in commands.items()}, DECLARATIONS)
        if refused:
            print("\n".join(refused), file=sys.stderr, flush=True)
            return EXIT_REFUSED
        group = stack.enter_context(ProcessGroup())
        ready = stack.enter_context(ReadyWatch(commands))
        for name, command in commands.items():
            group.start(name, command, env=child_environment(**ready.environment(name)))
        told = False

        def until() -> bool:
            nonlocal told
            if not told and ready.all_up:
                told = True
                print(f"bringup: started {', '.join(commands)}; Ctrl-C stops them", flush=True)
                tell_ready()
            return stop.requested

        first = keep_running(group, options.respawn, until, _say)
        if first is not None:
            _say(f"{first}; stopping the others")
        group.stop()
    return _exit_code(first, group.ended)


def _ros_arguments(command: Sequence[str]) -> Sequence[str]:
    return command[command.index(_ROS_ARGS) + 1 :] if _ROS_ARGS in command else []


def _assignment(name: str, value: object) -> str:
    return f"{name}:={str(value).lower() if isinstance(value, bool) else value}"


def _say(sentence: str) -> None:
    print(f"bringup: {sentence}", file=sys.stderr, flush=True)


def _exit_code(first: Ended | None, ends: Sequence[Ended]) -> int:
    if first is not None:
        return first.code if first.code > 0 else 1
    failed = [ended for ended in ends if ended.code not in CLEAN_ENDS]
    for ended in failed:
        _say(str(ended))
    return 1 if failed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="bringup",
        description="Starts mapper, planner and motion for a real robot.",
        epilog="What follows --ros-args goes to all three nodes, e.g. -r pose:=/localisation/pose",
    )
    parser.add_argument("--preset", default="", help="set of values that parameters start from")
    parser.add_argument(
        "--params-file",
        action="append",
        default=[],
        metavar="FILE",
        help="YAML file with parameters; may be given several times",
    )
    parser.add_argument(
        "--concurrent",
        action="store_true",
        help="map while moving, instead of standing for each perception; parameter files win",
    )
    parser.add_argument("--namespace", default="", help="namespace of the robot")
    parser.add_argument(
        "--respawn",
        nargs="?",
        type=_count,
        const=DEFAULT_LIMIT,
        default=0,
        metavar="N",
        help="start a node anew that ends, at most N times (default: %(const)s) without "
        f"{STEADY:g} s of running in between; the mapper goes on from its snapshot",
    )
    return parser


def _count(text: str) -> int:
    count = whole_number(text)
    if count < 1:
        raise argparse.ArgumentTypeError(f"must be at least 1, got {text}")
    return count


if __name__ == "__main__":
    sys.exit(main())
