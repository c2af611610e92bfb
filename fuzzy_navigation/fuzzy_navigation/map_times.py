# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Stamps of maps that cannot be: of the future, or of long before the newest map."""

from __future__ import annotations

from fuzzy_navigation.control_tick import Untimely

__all__ = ["MapTimes"]

#: A map stamped farther ahead of the clock than this [s] is refused. It is generous because
#: simulated time, which may run a hundred times as fast as a clock on the wall, comes by a
#: topic of its own: a good map may well be heard of seconds before its time is.
FUTURE_TOLERANCE = 60.0
#: A map stamped longer than this before the newest one [s] is refused. Longer than the other, so
#: that after the clock was set back a map of its present is never taken for outdated.
LONGEST_STEP_BACK = 120.0


class MapTimes:
    """Judges the stamps of maps by the clock and by the newest map.

    Examples
    --------
    >>> times = MapTimes("the map")
    >>> times.check(200.0, 199.0)
    >>> times.check(200.0, 5.0)
    Traceback (most recent call last):
        ...
    fuzzy_navigation.control_tick.Untimely: the map is stamped 5.000 s, 194.000 s before the ...
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._newest: float | None = None

    def check(self, now: float, stamp: float) -> None:
        """Take note of a map, or refuse it.

        Parameters
        ----------
        now : float
            Time of the clock [s]; infinite when it is not known yet.
        stamp : float
            Stamp of the map [s].

        Raises
        ------
        Untimely
            ``future`` or ``outdated``. A clock that was set back makes older maps welcome.
        """
        if stamp > now + FUTURE_TOLERANCE:
            raise Untimely(
                "future",
                f"{self._what} is stamped {stamp:.3f} s, {stamp - now:.3f} s ahead of the clock: "
                "synchronise the clocks; is use_sim_time set alike?",
            )
        newest = self._newest
        if newest is not None and newest > now + FUTURE_TOLERANCE:
            newest = None  # the clock was set back since
        if newest is not None and stamp < newest - LONGEST_STEP_BACK:
            raise Untimely(
                "outdated",
                f"{self._what} is stamped {stamp:.3f} s, {newest - stamp:.3f} s before the newest "
                "one: does somebody else publish maps?",
            )
        self._newest = stamp if newest is None else max(stamp, newest)
