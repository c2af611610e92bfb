# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What comes before the node's time has begun.

With ``use_sim_time`` a node's time is 0 until the first message on ``/clock``, which may come a
little after the first pose: nothing is wrong then, but no stamp can be judged.
"""

from __future__ import annotations

import time
from typing import Final

from rclpy.node import Node

from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.clock import now_seconds
from fuzzy_map_building.ros.diagnostics import Diagnostics

__all__ = ["ClockGate"]

#: So long after the first message the time should have begun [s of wall time].
PATIENCE: Final = 5.0


class ClockGate:
    """Lets messages with stamps through as soon as the node's time has begun.

    Parameters
    ----------
    node : Node
        Whose time.
    diagnostics : Diagnostics
        Counts what is kept out; a warning only when it has lasted for longer than `PATIENCE`.
    """

    def __init__(self, node: Node, diagnostics: Diagnostics) -> None:
        self._node = node
        self._diagnostics = diagnostics
        self._since: float | None = None

    def admits(self, source: str) -> bool:
        """Return whether a message that has come by `source` can be judged by its stamp."""
        if now_seconds(self._node) > 0.0:
            self._since = None
            return True
        wall = time.monotonic()
        if self._since is None:
            self._since = wall
        if wall - self._since < PATIENCE:
            self._diagnostics.note(source, "before_clock")
        else:
            self._diagnostics.reject(
                source,
                "no_clock",
                f"use_sim_time is true, but nothing comes by '{names.CLOCK}': start the "
                "simulator, or leave use_sim_time out where the stamps are of the wall's clock",
            )
        return False
