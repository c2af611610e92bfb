# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the executable `mapper` begins, and how any node's does.

Importing rclpy, numpy and scipy takes a second or two. A signal that comes meanwhile must end
the process as cleanly as one that comes later: this module imports nothing that takes time.
"""

from __future__ import annotations

import importlib
import os
import signal
from types import FrameType

__all__ = ["mapper", "start"]


def start(module: str) -> int:
    """Import a node's module and run its ``main``, which takes the signals over.

    Parameters
    ----------
    module : str
        Full name of the module.

    Returns
    -------
    int
        Exit code of ``main``; SIGINT or SIGTERM during the import ends the process with 0.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _leave)
    code: int = importlib.import_module(module).main()
    return code


def _leave(_number: int, _frame: FrameType | None) -> None:
    # Nothing has been opened yet that would have to be closed.
    os._exit(0)


def mapper() -> int:
    """Run the node ``fuzzy_mapper``."""
    return start("fuzzy_map_building.ros.mapper_node")
