# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parameters that planner and motion have in common and have to agree on.

Where they differ the motion stops where the planner leads it, or the planner leads it where
the motion does not look: the robot stands, and the verdict is not true.
"""

from __future__ import annotations

from collections.abc import Sequence

from fuzzy_map_building.parameter_schema import flatten
from fuzzy_navigation.params import MotionParameters, PlannerParameters

__all__ = ["disagreement", "shared_parameters"]

_ALWAYS = ("robot_radius", "augmentation", "layer.enabled")
#: What makes the layer's risk; its cost is the planner's alone, its slack the motion's.
_WITH_LAYER = ("layer.closed", "layer.limit", "layer.free", "layer.shift")
#: Longest value that is repeated to the user.
_SHOWN = 40


def shared_parameters(parameters: PlannerParameters | MotionParameters) -> tuple[str, ...]:
    """Return what both have to agree on, each as ``name=value``.

    Without the layer its measures do not count.

    Examples
    --------
    >>> from fuzzy_navigation.params import planner_parameters
    >>> shared_parameters(planner_parameters("oriolo1998"))
    ('robot_radius=0.23', 'augmentation=square', 'layer.enabled=false')
    """
    values = flatten(parameters)
    names = (*_ALWAYS, *(_WITH_LAYER if parameters.layer.enabled else ()))
    return tuple(f"{name}={_text(values[name])}" for name in names)


def disagreement(motion: Sequence[str], planner: Sequence[str]) -> str:
    """Return in which parameters motion and planner differ, in words; empty if in none.

    Parameters
    ----------
    motion, planner : sequence of str
        As `shared_parameters` gives them. What only one of the two tells is not compared: a
        planner of somebody else tells nothing.
    """
    there = dict(_split(entry) for entry in planner)
    differences = [
        f"{name} is {there[name][:_SHOWN]} in the planner and {here} in the motion"
        for name, here in map(_split, motion)
        if there.get(name, here) != here
    ]
    if not differences:
        return ""
    return f"planner and motion do not agree: {', '.join(differences)}; give both the same"


def _split(entry: str) -> tuple[str, str]:
    name, _, value = entry.partition("=")
    return name, value


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
