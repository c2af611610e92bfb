# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The life of a process: start, spin, and a clean stop on SIGINT or SIGTERM.

A node's ``main`` is one line::

    def main() -> int:
        return spin_node(MapperNode)

rclpy's own signal handlers shut the context down under the feet of a running callback,
which then raises; under load most stops end in a traceback. Here a handler only raises a
flag, and everything is taken down in order by the thread that spins.
"""

from __future__ import annotations

import contextlib
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

__all__ = ["EXIT_REFUSED", "StopRequest", "spin_node", "stop_on_signals"]

#: Exit code of a process that could not start: a parameter or an argument was refused.
EXIT_REFUSED: Final = 2

#: Longest wait for work before the stop flag is looked at again [s].
SPIN_PERIOD: Final = 0.1

#: Time that a node gets after `on_stop` to send its last messages [s].
DRAIN_TIME: Final = 0.3


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


def spin_node(factory: Callable[[], Node], args: Sequence[str] | None = None) -> int:
    """Create a node, spin it until SIGINT or SIGTERM, and take it down in order.

    A node with a method ``on_stop()`` has it called once before it is destroyed, with the
    executor still spinning for `DRAIN_TIME` afterwards: the place to end actions and to
    stop the robot.

    Parameters
    ----------
    factory : callable
        Returns the node; called once after ``rclpy.init``.
    args : sequence of str, optional
        Command line, the program's name first; that of the process when None.

    Returns
    -------
    int
        Exit code: 0 after a signal, or when a callback has shut rclpy down; `EXIT_REFUSED`
        when the node could not start because the command line, a parameter or a file was
        refused. The reason is then one line on stderr.

    Raises
    ------
    Exception
        Whatever a callback raises: a fault in the program must not pass for a stop.
    """
    argv = list(sys.argv if args is None else args)
    with stop_on_signals() as stop:
        try:
            node = _start(factory, argv)
        except (ValueError, OSError) as error:
            rclpy.try_shutdown()
            return _refuse(argv, error)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        try:
            while not stop.requested and rclpy.ok():
                executor.spin_once(timeout_sec=SPIN_PERIOD)
            _drain(node, executor)
        finally:
            executor.shutdown()
            node.destroy_node()
            rclpy.try_shutdown()
    return 0


def _start(factory: Callable[[], Node], argv: list[str]) -> Node:
    """Return the node, or raise ValueError for a command line that rcl refuses."""
    try:
        unknown = remove_ros_args(args=argv)[1:]
        if not unknown:
            rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy raises several unrelated types for a bad command line
        raise ValueError(f"the command line was refused: {error}") from error
    if unknown:
        raise ValueError(
            f"unknown argument '{unknown[0]}'; parameters are given as "
            "--ros-args -p <name>:=<value> or --params-file <file>"
        )
    return factory()


def _drain(node: Node, executor: SingleThreadedExecutor) -> None:
    on_stop = getattr(node, "on_stop", None)
    if on_stop is None or not rclpy.ok():
        return
    on_stop()
    end = time.monotonic() + DRAIN_TIME
    while (left := end - time.monotonic()) > 0.0:
        executor.spin_once(timeout_sec=left)


def _refuse(argv: list[str], error: Exception) -> int:
    program = argv[0].rsplit("/", 1)[-1] if argv else "node"
    reason = " ".join(str(error).split())
    print(f"{program}: cannot start: {reason}", file=sys.stderr, flush=True)
    return EXIT_REFUSED
