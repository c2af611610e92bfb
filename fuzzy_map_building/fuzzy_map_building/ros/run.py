# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The life of a process: start, spin, and a clean stop on SIGINT or SIGTERM.

A node's ``main`` is one line::

    def main() -> int:
        return spin_node(MapperNode, name="fuzzy_mapper")

rclpy's own signal handlers shut the context down under the feet of a running callback,
which then raises; under load most stops end in a traceback. Here a handler only raises a
flag, and everything is taken down in order by the thread that spins.
"""

from __future__ import annotations

import contextlib
import gc
import itertools
import re
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from fuzzy_map_building import jit
from fuzzy_map_building.parameter_schema import ParameterError
from fuzzy_map_building.ros.addressed import Addressed
from fuzzy_map_building.ros.discovery import set_discovery
from fuzzy_map_building.ros.readiness import tell_ready
from fuzzy_map_building.ros.usage import USAGES

__all__ = [
    "EXIT_FAULT",
    "EXIT_REFUSED",
    "StopRequest",
    "check_arguments",
    "spin_node",
    "stop_on_signals",
]

#: Exit code of a process that a fault in the program has ended.
EXIT_FAULT: Final = 1
#: Exit code of a process that could not start: a parameter or an argument was refused.
EXIT_REFUSED: Final = 2

#: Longest wait for work before the stop flag is looked at again [s].
SPIN_PERIOD: Final = 0.1

#: Time that a node gets after `on_stop` to send its last messages [s].
DRAIN_TIME: Final = 0.3

#: Where in the sources of rcl an error came up, which helps nobody who reads its text.
_RCL_SOURCE: Final = re.compile(r", at \S+:\d+")


class StopRequest:
    """A flag that a signal raises.

    A plain attribute: `threading.Event.set` takes a lock, and a second signal that
    arrives while the first one's handler holds it would never return.
    """

    def __init__(self) -> None:
        self.requested = False

    def raise_flag(self, *_: object) -> None:
        """Ask for the stop; has the signature of a signal handler."""
        self.requested = True


@contextlib.contextmanager
def stop_on_signals() -> Iterator[StopRequest]:
    """Turn SIGINT and SIGTERM into a flag while the context is open.

    For processes that spin no node themselves, e.g. one that starts others.

    Yields
    ------
    StopRequest
        ``requested`` becomes True with the first signal.
    """
    stop = StopRequest()
    numbers = (signal.SIGINT, signal.SIGTERM)
    previous = {number: signal.signal(number, stop.raise_flag) for number in numbers}
    try:
        yield stop
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)


def spin_node(
    factory: Callable[[], Node], args: Sequence[str] | None = None, name: str = ""
) -> int:
    """Create a node, spin it until SIGINT or SIGTERM, and take it down in order.

    A node with a method ``on_stop()`` has it called once before it is destroyed, with the
    executor still spinning for `DRAIN_TIME` afterwards: the place to end actions and to
    stop the robot. When a callback raises, a method ``on_fault()`` is called before, the
    place for what must be done whatever state the node is in. Once the node is there, its
    parameters taken, whoever started the process is told; see `readiness`.

    Parameters
    ----------
    factory : callable
        Returns the node; called once after ``rclpy.init``.
    args : sequence of str, optional
        Command line, the program's name first; that of the process when None.
    name : str
        What to call the node when it cannot start or fails; empty: as the program is called.

    Returns
    -------
    int
        Exit code: 0 after ``--help``, after a signal, or when a callback has shut rclpy down;
        `EXIT_REFUSED` when the node could not start because the command line, a parameter or a
        file was refused, the reason then being one line on stderr; `EXIT_FAULT` when a callback
        has raised, which is told in the last line on stderr, after the traceback.
    """
    argv = list(sys.argv if args is None else args)
    called = name or _program(argv)
    if name in USAGES and _asks_for_help(argv):
        print(USAGES[name])
        return 0
    with stop_on_signals() as stop:
        try:
            node = _start(factory, argv, called)
        except (ValueError, OSError) as error:
            _refuse(called, error)
            _let_go(error)
            rclpy.try_shutdown()
            return EXIT_REFUSED
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        tell_ready()
        try:
            while not stop.requested and rclpy.ok():
                executor.spin_once(timeout_sec=SPIN_PERIOD)
            _drain(node, executor)
        except Exception as fault:
            _last_words(node, executor)
            return _report(called, fault)
        finally:
            executor.shutdown()
            node.destroy_node()
            rclpy.try_shutdown()
    return 0


def _asks_for_help(argv: Sequence[str]) -> bool:
    own = itertools.takewhile(lambda word: word != "--ros-args", argv[1:])
    return any(word in ("-h", "--help") for word in own)


def _start(factory: Callable[[], Node], argv: list[str], called: str) -> Node:
    """Return the node, or raise ValueError for a command line that cannot be meant."""
    addressed = Addressed(argv)  # before rcl, whose sentences name neither key nor node
    try:
        unknown = remove_ros_args(args=argv)[1:]
    except Exception as error:  # rclpy raises several unrelated types for a bad command line
        raise _refused(error) from error
    if unknown:
        raise ValueError(
            f"unknown argument '{unknown[0]}'; parameters are given as "
            "--ros-args -p <name>:=<value> or --params-file <file>"
        )
    set_discovery()
    try:
        rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # as above
        raise _refused(error) from error
    try:
        node = factory()
    except (ParameterError, InvalidParameterTypeException) as error:  # the latter: use_sim_time
        raise ParameterError(f"{error}{addressed.origin(str(error), called)}") from error
    for problem in addressed.unheard(node.get_name()):
        node.get_logger().warning(problem)
    if slow := jit.remark():
        node.get_logger().info(slow)
    return node


def check_arguments(arguments: Sequence[str]) -> None:
    """Refuse ROS arguments that every node would refuse, whatever its parameters are.

    Parameters
    ----------
    arguments : sequence of str
        What follows ``--ros-args``.

    Raises
    ------
    ValueError
        If a parameter file cannot be read or speaks to a node that does not exist, or rcl
        cannot make sense of the arguments.
    """
    argv = ["nodes", "--ros-args", *arguments]
    Addressed(argv)
    context = Context()
    try:
        context.init(args=argv)
    except Exception as error:  # as in `_start`
        raise _refused(error) from error
    finally:
        context.try_shutdown()


def _refused(error: Exception) -> ValueError:
    reason = _RCL_SOURCE.sub("", str(error))
    if "initialize logging" in reason:
        return ValueError(
            f"ROS cannot keep a log ({reason}): set ROS_LOG_DIR to a folder that can be written; "
            "the default lies in HOME, which a service has not"
        )
    return ValueError(f"the command line was refused: {reason}")


def _drain(node: Node, executor: SingleThreadedExecutor) -> None:
    on_stop = getattr(node, "on_stop", None)
    if on_stop is None or not rclpy.ok():
        return
    on_stop()
    end = time.monotonic() + DRAIN_TIME
    while (left := end - time.monotonic()) > 0.0:
        executor.spin_once(timeout_sec=left)


def _last_words(node: Node, executor: SingleThreadedExecutor) -> None:
    """Let a node whose callback has raised stop the robot and end its actions, if it still can."""
    # The first fault is the one to tell of, and nothing may keep the process from ending.
    with contextlib.suppress(Exception):
        on_fault = getattr(node, "on_fault", None)
        if on_fault is not None:
            on_fault()
    with contextlib.suppress(Exception):
        _drain(node, executor)


def _report(called: str, fault: Exception) -> int:
    traceback.print_exception(fault)
    reason = " ".join(f"{type(fault).__name__}: {fault}".split())
    print(f"{called}: ended by a fault in the program: {reason}", file=sys.stderr, flush=True)
    return EXIT_FAULT


def _program(argv: list[str]) -> str:
    return argv[0].rsplit("/", 1)[-1] if argv else "node"


def _refuse(called: str, error: Exception) -> None:
    reason = " ".join(str(error).split())
    print(f"{called}: cannot start: {reason}", file=sys.stderr, flush=True)


def _let_go(error: Exception) -> None:
    """Destroy a half-made node, which lives on in the frames of the traceback.

    Left to the end of the interpreter, its participant is taken down beside the middleware's
    own statics, and now and then the process does not end.
    """
    traceback.clear_frames(error.__traceback__)
    gc.collect()
