# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""From when on parameters hold that are changed while a mission runs."""

from __future__ import annotations

from collections.abc import Iterable

from fuzzy_map_building.parameter_schema import flatten, from_mapping
from fuzzy_navigation.params import MotionParameters

__all__ = ["AT_ONCE", "ParameterChange"]

#: What a mission that runs goes by as soon as it changes, single ones and groups. On the others
#: rest the path that the robot is on, the border of what is explored, or what is remembered.
AT_ONCE = ("attempts", "perception_cap", "follower.max_linear", "timeout.", "watch.")
#: Names that are listed one by one; of more the others are counted.
NAMED = 4


class ParameterChange:
    """The parameters that a mission goes by, and those that it will go by.

    Parameters
    ----------
    parameters : MotionParameters
        What holds from the beginning.

    Attributes
    ----------
    in_force : MotionParameters
        What the mission goes by.
    waiting : tuple of str
        Names of the changed parameters that wait for its end.

    Examples
    --------
    >>> from fuzzy_navigation.params import motion_parameters
    >>> change = ParameterChange(motion_parameters())
    >>> change.want(motion_parameters(overrides={"beta": 0.8, "attempts": 5}), active=True)
    True
    >>> change.in_force.attempts, change.in_force.beta, change.waiting
    (5, 0.9, ('beta',))
    """

    def __init__(self, parameters: MotionParameters) -> None:
        self.in_force = parameters
        self.waiting: tuple[str, ...] = ()

    def want(self, parameters: MotionParameters, active: bool) -> bool:
        """Take other parameters, all of them or those that can be taken while a mission runs.

        Parameters
        ----------
        parameters : MotionParameters
            What is wanted.
        active : bool
            Whether a mission runs.

        Returns
        -------
        bool
            Whether other parameters hold than before.
        """
        before, wanted = flatten(self.in_force), flatten(parameters)
        changed = {name: value for name, value in wanted.items() if value != before[name]}
        now = {n: v for n, v in changed.items() if not active or _at_once(n)}
        self.waiting = tuple(name for name in changed if name not in now)
        self.in_force = from_mapping(self.in_force, now) if self.waiting else parameters
        return bool(now)

    def remark(self, names: Iterable[str]) -> str:
        """Return from when on parameters hold that were just set; empty: from now on."""
        late = [name for name in names if name in self.waiting]
        if not late:
            return ""
        return (
            f"taken, but {self.listed(late)} will hold only when the goal that the robot serves "
            "is reached or given up"
        )

    @staticmethod
    def listed(names: Iterable[str]) -> str:
        """Return names of parameters as a text that is not too long."""
        every = sorted(names)
        more = len(every) - NAMED
        return ", ".join(every[:NAMED]) + (f" and {more} more" if more > 0 else "")


def _at_once(name: str) -> bool:
    return any(name == each or (each.endswith(".") and name.startswith(each)) for each in AT_ONCE)
