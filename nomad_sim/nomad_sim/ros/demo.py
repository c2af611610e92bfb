# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The demonstration: starts the four nodes, sends the robot to a goal, watches, draws.

The nodes run as processes in a ROS domain of their own, and none is left afterwards,
however the demonstration ends. What they write goes to ``logs/`` in the output folder.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Final

from fuzzy_map_building.parameter_schema import describe
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.ros.discovery import DISCOVERY_RANGE, set_discovery
from fuzzy_map_building.ros.parameters import PRESET
from fuzzy_map_building.ros.run import EXIT_REFUSED, StopRequest, stop_on_signals
from fuzzy_navigation.concurrent_mission import SETTINGS
from fuzzy_navigation.mission_types import LogEntry, Phase
from fuzzy_navigation.params import MotionParameters, PlannerParameters
from fuzzy_navigation.ros.declarations import DECLARATIONS, Declaration, refusals
from fuzzy_navigation.ros.processes import (
    ProcessGroup,
    child_environment,
    python_module,
)
from nomad_sim.ros.declarations import declare_simulation
from nomad_sim.ros.demo_options import NODES, DemoOptions, parse_options
from nomad_sim.ros.demo_report import clear_output, summarise, write_figures
from nomad_sim.ros.demo_text import print_end, print_perception, print_start
from nomad_sim.ros.domain import reserved_domain
from nomad_sim.ros.mission_record import MissionRecord
from nomad_sim.ros.mission_watch import spinning
from nomad_sim.ros.params import SimulationParameters

__all__ = ["main"]

EXIT_NOT_TRUE: Final = 1
EXIT_NODE_FAILED: Final = 3
EXIT_STOPPED: Final = 130

#: Modules of the nodes, by process.
MODULES: Final[Mapping[str, str]] = {
    "sim": "nomad_sim.ros.sim_node",
    "mapper": "fuzzy_map_building.ros.mapper_node",
    "planner": "fuzzy_navigation.ros.planner_node",
    "motion": "fuzzy_navigation.ros.motion_node",
}
PARAMETERS: Final = {
    "sim": SimulationParameters,
    "mapper": MapperParameters,
    "planner": PlannerParameters,
    "motion": MotionParameters,
}
_DECLARATIONS: Final[Mapping[str, Declaration]] = {
    **DECLARATIONS,
    "sim": (NODES["sim"], declare_simulation),
}
#: Longest wait for the nodes [s]: the first start on a machine compiles loops in each of them.
START_TIMEOUT: Final = 120.0
#: Longest wait for the simulator's last word on contacts, and the mission's on perceptions [s].
LAST_WORD_TIMEOUT: Final = 10.0
#: Lines of a failed node's log that are shown.
LOG_LINES: Final = 5


class NodeFailedError(RuntimeError):
    """A node could not start, or ended before its time."""


class RefusedError(ValueError):
    """A node would refuse its parameters."""


class StoppedError(RuntimeError):
    """A signal has asked for the end."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demonstration; `demo_options` lists the exit codes."""
    # What the command line asks for takes seconds to look at, when loops are compiled; nothing
    # is running yet, and a signal ends the process at once: see `entry`.
    try:
        options = parse_options(arguments)
        clear_output(options.output)
    except (ValueError, OSError) as error:
        print(f"demo: {' '.join(str(error).split())}", file=sys.stderr)
        return EXIT_REFUSED
    with stop_on_signals() as stop:
        try:
            return _demonstrate(options, stop)
        except RefusedError as error:
            print(error, file=sys.stderr)
            return EXIT_REFUSED
        except NodeFailedError as error:
            print(f"demo: {error}", file=sys.stderr)
            return EXIT_NODE_FAILED
        except OSError as error:
            print(f"demo: {error}", file=sys.stderr)
            return EXIT_REFUSED
        except StoppedError:
            print("demo: stopped", file=sys.stderr)
            return EXIT_STOPPED


def _demonstrate(options: DemoOptions, stop: StopRequest) -> int:
    began = time.monotonic()
    record, problem, durations = _run(options, stop)
    durations["all"] = time.monotonic() - began
    print_end(record, options, problem, durations)
    figures: list[str] = []
    unwritten: OSError | None = None
    try:
        figures = write_figures(record, options)
    except OSError as error:
        unwritten = error  # the summary needs less room
    success = summarise(record, options, problem, durations, figures)
    if unwritten is not None:
        raise unwritten
    print(f"figures and summary: {options.output}", flush=True)
    return 0 if success else EXIT_NOT_TRUE


def _run(options: DemoOptions, stop: StopRequest) -> tuple[MissionRecord, str, dict[str, float]]:
    """Run the mission; return what was seen, why there is no verdict, and wall times [s]."""
    logs = options.output / "logs"
    logs.mkdir(exist_ok=True)
    wanted = {NODES[name]: list(describe(kind)) for name, kind in PARAMETERS.items()}
    for name in ("mapper", "planner", "motion"):
        wanted[NODES[name]].append(PRESET)
    with ExitStack() as stack:
        domain = stack.enter_context(reserved_domain(options.domain))
        set_discovery()
        environment = child_environment(ROS_DOMAIN_ID=str(domain), ROS_LOG_DIR=str(logs.resolve()))
        refused = refusals(_arguments(options), _DECLARATIONS, domain)
        if refused:
            raise RefusedError("\n".join(refused))
        print_start(options, domain, environment[DISCOVERY_RANGE])
        began = time.monotonic()
        nodes = _Nodes(stack.enter_context(ProcessGroup()), stop, logs)
        for name, arguments in _arguments(options).items():
            nodes.start(name, arguments, environment)

        def tell(entry: LogEntry, phase: Phase) -> None:
            print_perception(entry, phase, watch.record.started)

        watch = stack.enter_context(spinning(tell, wanted, domain))
        nodes.wait(lambda: not watch.missing, START_TIMEOUT)
        if watch.missing:
            raise NodeFailedError(f"after {START_TIMEOUT:g} s still missing: {watch.missing}")
        started = time.monotonic()
        watch.ask_parameters()
        watch.send_goal(options.world.goal)
        nodes.wait(watch.over.is_set, options.timeout)
        ended = time.monotonic()
        record, problem = watch.record, watch.failure
        if not watch.over.is_set():
            problem = f"no verdict within {options.timeout:g} s"
        # The simulator tells of contacts in its diagnostics: those from after the end count.
        # And the mission's last word may be overtaken by its verdict.
        end = record.time
        made = record.verdict.perceptions if record.verdict else 0
        nodes.wait(
            lambda: float(record.simulator["time"]) >= end and record.perceptions >= made,
            LAST_WORD_TIMEOUT,
        )
    return record, problem, {"start": started - began, "mission": ended - started}


class _Nodes:
    """The four processes, and what to do when one ends or the user has had enough."""

    def __init__(self, group: ProcessGroup, stop: StopRequest, logs: Path) -> None:
        self._group = group
        self._stop = stop
        self._logs = logs

    def start(self, name: str, arguments: Sequence[str], environment: Mapping[str, str]) -> None:
        command = python_module(MODULES[name], "--ros-args", *arguments)
        with self._log(name).open("wb") as log:
            self._group.start(name, command, env=environment, stdout=log, stderr=log)

    def wait(self, until: Callable[[], bool], timeout: float) -> None:
        """Wait until something has happened, at most `timeout` [s]."""
        ended = self._group.wait(lambda: self._stop.requested or until(), timeout)
        if self._stop.requested:
            raise StoppedError
        if ended is not None:
            log = self._log(ended.name)
            lines = log.read_text(errors="replace").strip().splitlines()[-LOG_LINES:]
            raise NodeFailedError("\n  ".join([f"{ended}; the end of {log}:", *lines]))

    def _log(self, name: str) -> Path:
        return self._logs / f"{name}.log"


def _arguments(options: DemoOptions) -> dict[str, list[str]]:
    """Return the ROS arguments of each process.

    What the command line says comes after the parameter file and wins over it; only the
    mapped area and the preset are defaults that the file may change.
    """
    world, start = options.world, options.world.start
    area = {"size_x": world.size[0], "size_y": world.size[1]}
    area |= {"origin_x": world.origin[0], "origin_y": world.origin[1]}
    preset = {"preset": options.preset}
    moving = SETTINGS if options.concurrent else {}
    before: dict[str, Mapping[str, object]] = {
        "sim": {},
        "mapper": preset | {f"area.{name}": value for name, value in area.items()},
        "planner": preset,
        "motion": preset,
    }
    before = {name: {**values, **moving.get(name, {})} for name, values in before.items()}
    after: dict[str, Mapping[str, object]] = {name: {"use_sim_time": True} for name in NODES}
    after["sim"] = {
        "world": options.world_source,
        "seed": options.seed,
        "rate": options.rate,
        "lockstep": options.lockstep,
        "start.override": True,
        "start.x": start.x,
        "start.y": start.y,
        "start.theta": start.theta,
    }
    file = [] if options.params_file is None else ["--params-file", str(options.params_file)]
    return {
        name: [
            *_rules(node, before[name]),
            *file,
            *_rules(node, after[name]),
        ]
        for name, node in NODES.items()
    }


def _rules(node: str, values: Mapping[str, object]) -> list[str]:
    """Return parameters as arguments for a node of this name, in YAML."""

    def text(value: object) -> str:
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, float):
            return f"{value:.9f}"
        # In YAML's single quotes everything stands for itself but the quote.
        return str(value) if isinstance(value, int) else "'" + str(value).replace("'", "''") + "'"

    return [part for name, v in values.items() for part in ("-p", f"{node}:{name}:={text(v)}")]


if __name__ == "__main__":
    sys.exit(main())
