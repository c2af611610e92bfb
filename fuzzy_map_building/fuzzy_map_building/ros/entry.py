# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the executable `mapper` begins, and how any other does.

Importing rclpy, numpy and scipy takes a second or two. A signal that comes meanwhile must end
the process as cleanly as one that comes later: this module imports nothing that takes time.
"""

from __future__ import annotations

import importlib
import os
import signal
from types import FrameType

__all__ = ["mapper", "start"]


def start(module: str, stopped: int | None = 0) -> int:
    """Import a module and run its ``main``, which takes the signals over.

    Parameters
    ----------
    module : str
        Full name of the module.
    stopped : int, optional
        Exit code of the process if SIGINT or SIGTERM comes before ``main`` has taken them over,
        or after it has given them back; None: 128 and the signal's number.

    Returns
    -------
    int
        Exit code of ``main``.
    """

    def leave(number: int, _frame: FrameType | None) -> None:
        # Nothing has been opened yet that would have to be closed.
        os._exit(128 + number if stopped is None else stopped)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, leave)
    code: int = importlib.import_module(module).main()
    return code


def mapper() -> int:
    """Run the node ``fuzzy_mapper``."""
    return start("fuzzy_map_building.ros.mapper_node")
