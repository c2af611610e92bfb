# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Single parameters as they are written on a command line."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.plain_yaml import load_plain

__all__ = ["GROUPS", "critical_angles", "parameter_overrides"]

#: What a parameter's name begins with: the part that it belongs to.
GROUPS = ("mapper", "planner", "motion", "simulator")

_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?) *(deg)?")


def _value(raw: Any) -> Any:
    """Read what YAML takes for a text: angles in degrees, and numbers such as 1e-3."""
    if isinstance(raw, list):
        return [_value(entry) for entry in raw]
    match = _NUMBER.fullmatch(raw) if isinstance(raw, str) else None
    if match is None:
        return raw
    number = float(match[1])
    return math.radians(number) if match[2] else number


def _pair(option: str, text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name.strip() and equals and value.strip()):
        raise ValueError(f"{option} {text}: NAME=VALUE expected")
    return name.strip(), value.strip()


def parameter_overrides(assignments: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return parameters by part and dotted name.

    Parameters
    ----------
    assignments : sequence of str
        Such as ``mapper.evidence.k_empty=0.3``. Values are YAML; an angle may be given in
        degrees with ``deg`` behind it.

    Returns
    -------
    dict of dict
        For each of `GROUPS`, values by the name without the part. Whether parameters of
        these names exist is left to whom they belong to.

    Raises
    ------
    ValueError
        For an assignment that cannot be read, an unknown part, or the simulator's seed.

    Examples
    --------
    >>> parameter_overrides(["planner.epsilon=0.1"])["planner"]
    {'epsilon': 0.1}
    """
    values: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for text in assignments:
        name, raw = _pair("--set", text)
        group, dot, inner = name.partition(".")
        if group not in GROUPS:
            raise ValueError(f"--set {text}: unknown part '{group}'{suggest(group, GROUPS)}")
        if not (dot and inner):
            raise ValueError(f"--set {text}: '{group}.PARAMETER=VALUE' expected")
        if name == "simulator.seed":
            raise ValueError(f"--set {text}: each mission has a seed of its own; use --first-seed")
        try:
            values[group][inner] = _value(load_plain(raw))
        except ValueError as error:
            raise ValueError(
                f"--set {text}: '{raw}' is not a value that can be read: {error}"
            ) from None
    return values


def critical_angles(assignments: Sequence[str]) -> dict[str, float]:
    """Return critical angles [rad] by material.

    Parameters
    ----------
    assignments : sequence of str
        Such as ``painted_wall=25``, in degrees.

    Raises
    ------
    ValueError
        For an assignment that cannot be read.

    Examples
    --------
    >>> critical_angles(["glass=90"])
    {'glass': 1.5707963267948966}
    """
    angles: dict[str, float] = {}
    for text in assignments:
        name, raw = _pair("--critical-angle", text)
        match = _NUMBER.fullmatch(raw)
        if match is None:
            raise ValueError(f"--critical-angle {text}: degrees expected, got '{raw}'")
        angles[name] = math.radians(float(match[1]))
    return angles
