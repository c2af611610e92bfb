# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the words mean that the core counts refused readings and poses under, for the log."""

from __future__ import annotations

from fuzzy_map_building.params import PerceptionParameters

__all__ = ["explanations"]


def explanations(limits: PerceptionParameters, *, named: bool = True) -> dict[str, str]:
    """Return the sentence for each word; an empty one where nothing is wrong.

    Parameters
    ----------
    limits : PerceptionParameters
        The limits that readings and poses are held to.
    named : bool
        Whether the limits are parameters of the node.
    """

    def limit(name: str) -> str:
        value = f"{getattr(limits, name):g} s"
        return f"{value} (parameter 'perception.{name}')" if named else value

    unplaced = (
        f"bracketed the stamp within {limit('pose_timeout')}, at most "
        f"{limit('max_pose_gap')} apart; do they come often enough, stamped by the same clock?"
    )
    return {
        "future": f"stamped ahead of the clock by more than {limit('future_tolerance')}; "
        "are all clocks the same, and is use_sim_time set alike?",
        "duplicate": "a stamp came twice from one source; are there two publishers, or does one "
        "repeat its stamps?",
        "out_of_order": "a stamp lies before the one that came last from the same source; are "
        "there two publishers?",
        "before_pose": "",
        "before_turret": "",
        "no_pose": f"no two poses {unplaced}",
        "no_turret": f"no two turret angles {unplaced}",
        "overflow": "too many readings wait for poses; do these come?",
        "nan": "the sensor reported a faulty measurement (NaN); without an echo REP 117 has +inf",
        "out_of_range": "the range lies outside the limits sonar.min_range and sonar.max_range "
        "or infrared.min_range and infrared.max_range",
        "outside_map": "the reading was taken outside the map's area (parameters 'area.*')",
        "lost_echo": "no echo, and sonar.lost_echo says to ignore such readings",
        "no_sonar": "infrared readings only add to what sonars say, and no sonar reading was "
        "usable",
    }
