# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How far nodes look for each other, and how soon they find each other."""

from __future__ import annotations

import os
from collections.abc import MutableMapping
from pathlib import Path
from typing import Final

__all__ = ["DISCOVERY_RANGE", "PROFILES", "set_discovery"]

#: Variable that says how far nodes look for each other.
DISCOVERY_RANGE: Final = "ROS_AUTOMATIC_DISCOVERY_RANGE"

#: Variable that names Fast DDS's file of profiles.
PROFILES: Final = "FASTRTPS_DEFAULT_PROFILES_FILE"


def set_discovery(environment: MutableMapping[str, str] | None = None) -> None:
    """Set what the middleware asks the environment for, but for what the user has set.

    Nothing leaves this machine: whoever reaches a node can drive the robot. And nodes announce
    themselves twice a second, not every three: one that starts and loses their first answer, as
    happens where all are on one machine, otherwise waits that long to hear of them.

    Parameters
    ----------
    environment : mutable mapping of str, optional
        That of a process to be started; None: of this one, before it begins with ROS.
    """
    variables = os.environ if environment is None else environment
    variables.setdefault(DISCOVERY_RANGE, "LOCALHOST")
    variables.setdefault(PROFILES, str(Path(__file__).with_name("discovery.xml")))
