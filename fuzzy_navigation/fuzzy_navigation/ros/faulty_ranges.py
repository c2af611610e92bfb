# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Ranges that say nothing but that their sensor is faulty."""

from __future__ import annotations

import math

from fuzzy_map_building.ros.conversions import RangeSample, Refused

__all__ = ["usable"]


def usable(sample: RangeSample, what: str = "infrared sensor") -> RangeSample:
    """Return a sample that REP 117 allows and that is no fault.

    Raises
    ------
    Refused
        ``faulty``: NaN, or negative.
    """
    if sample.range >= 0.0 or sample.range == -math.inf:
        return sample
    raise Refused(
        "faulty",
        f"{what} {sample.sensor} reports a range of {sample.range} m; REP 117 has "
        "distances, +inf for none and -inf for too close",
    )
