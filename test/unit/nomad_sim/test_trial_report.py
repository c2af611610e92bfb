# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of the report on trials, by hand."""

import math
from typing import Any

import pytest

from nomad_sim.campaign_table import wilson_interval
from nomad_sim.missions import MissionResult
from nomad_sim.trial_report import report, report_lines, tally
from nomad_sim.trials import TrialResult


def trial(
    seed: int, outcome: str = "REACHED", truth: str = "reachable", **values: Any
) -> TrialResult:
    of_mission = {"perceptions": 10, "path_length": 6.0, "min_clearance": 0.1, "contacts": 0}
    for name in of_mission:
        of_mission[name] = values.pop(name, of_mission[name])
    expected = "UNREACHABLE" if truth == "unreachable" else "REACHED"
    mission = MissionResult(
        seed=seed, start_x=1.0, start_y=1.0, start_heading=0.0, outcome=outcome,
        truthful=outcome == expected, duration=60.0, wall_time=1.0, message="so",
        **of_mission,  # type: ignore[arg-type]
    )  # fmt: skip
    drawn: dict[str, Any] = {
        "kind": "office", "material": "plain", "beam": 10.0, "door": None, "glass": "none",
        "people": 0, "way_clearance": 0.2, "shortest": 5.0,
    }  # fmt: skip
    return TrialResult(**{**drawn, **values}, truth=truth, mission=mission)


MIXED = [
    trial(1, perceptions=4, path_length=5.0),
    trial(2, perceptions=8, path_length=10.0, contacts=3, min_clearance=0.0),
    trial(3, perceptions=9, path_length=7.5),
    trial(4, "UNREACHABLE", perceptions=80, path_length=90.0),
    trial(5, "LIVELOCK", perceptions=30, path_length=70.0, min_clearance=0.03),
    trial(6, "UNREACHABLE", "unreachable", perceptions=36, shortest=None),
    trial(7, "LIVELOCK", "unreachable", shortest=None),
    trial(8, "REACHED", "unreachable", shortest=None),
]


def test_goals_that_can_be_reached_and_others_are_counted_apart() -> None:
    t = tally("all", "", MIXED)
    assert (t.missions, t.reachable, t.reached, t.false_unreachable) == (8, 5, 3, 1)
    assert (t.unreachable, t.called_unreachable, t.false_reached) == (3, 1, 1)
    assert (t.contacts, t.touching, t.min_clearance) == (3, 1, 0.0)
    assert (t.reached_low, t.reached_high) == wilson_interval(3, 5)


def test_averages_are_of_those_that_arrived() -> None:
    t = tally("all", "", MIXED)
    assert (t.mean_perceptions, t.median_perceptions) == (7.0, 8.0)
    # 5, 10 and 7.5 m where 5 m would have done.
    assert (t.median_ratio, t.mean_ratio, t.p95_ratio) == (1.5, 1.5, 2.0)


@pytest.mark.parametrize(("count", "rank"), [(1, 1), (19, 19), (20, 19), (21, 20), (100, 95)])
def test_the_95th_percentile_is_exceeded_by_five_percent_at_most(count: int, rank: int) -> None:
    results = [trial(n, path_length=5.0 * n) for n in range(count, 0, -1)]
    assert tally("all", "", results).p95_ratio == float(rank)


def test_without_an_arrival_there_is_no_average() -> None:
    t = tally("all", "", [trial(1, "UNREACHABLE", "unreachable", shortest=None)])
    assert math.isnan(t.median_ratio)
    assert math.isnan(t.reached_low)
    assert "0 of 0" in report_lines([t])[1]
    with pytest.raises(ValueError, match="no trial"):
        tally("all", "", [])


def test_groups_are_by_what_was_drawn_and_marginal_goals_apart() -> None:
    results = [
        trial(1, door=0.69, kind="maze"),
        trial(2, "LIVELOCK", door=0.7),
        trial(3, door=0.85),
        trial(4, door=0.9, beam=9.0),
        trial(5),
        trial(6, "UNREACHABLE", "marginal", door=0.65, contacts=1),
        trial(7, "REACHED", "marginal", door=0.65),
    ]
    tallies = {(t.group, t.value): t for t in report(results)}
    assert list(tallies) == [
        ("all", ""), ("kind", "maze"), ("kind", "office"), ("beam", "9 deg"), ("beam", "10 deg"),
        ("door", "< 0.70 m"), ("door", "0.70 to 0.80 m"), ("door", "0.80 to 0.90 m"),
        ("door", ">= 0.90 m"), ("door", "none"), ("marginal", ""),
    ]  # fmt: skip
    assert (tallies["all", ""].reached, tallies["all", ""].reachable) == (4, 5)
    assert tallies["door", "0.70 to 0.80 m"].reached == 0
    assert tallies["kind", "office"].missions == 4
    marginal = tallies["marginal", ""]
    assert (marginal.reached, marginal.reachable, marginal.contacts) == (1, 2, 1)
    assert marginal.false_unreachable == 1


def test_flaws_are_contacts_and_false_verdicts_but_of_marginal_goals() -> None:
    assert [r.flawless for r in MIXED] == [True, False, True, False, False, True, False, False]
    assert trial(1, "UNREACHABLE", "marginal").flawless
    assert not trial(1, "REACHED", "marginal", contacts=1).flawless


def test_the_table_stands_in_columns() -> None:
    head, *rows = report_lines(report([*MIXED, trial(9, kind="maze")]))[:-2]
    assert head.split()[:2] == ["reached", "95"]
    assert rows[0].startswith("all ")
    assert "4 of 6" in rows[0]
    assert "1 of 3" in rows[0]
    assert "1.35/1.43/2.00" in rows[0]
