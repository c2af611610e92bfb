# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sums and averages of missions, by hand."""

import math

import pytest

from nomad_sim.campaign_table import (
    result_lines,
    row_line,
    summarise,
    summary_lines,
    wilson_interval,
)
from nomad_sim.missions import MissionResult


def result(seed: int, outcome: str, truthful: bool, **numbers: float) -> MissionResult:
    values = {
        "perceptions": 10,
        "path_length": 12.0,
        "min_clearance": 0.15,
        "contacts": 0,
        "duration": 100.0,
        "wall_time": 2.0,
    }
    return MissionResult(
        seed=seed,
        start_x=1.0,
        start_y=2.0,
        start_heading=0.5,
        outcome=outcome,
        truthful=truthful,
        message="as it is",
        **(values | numbers),  # type: ignore[arg-type]
    )


RESULTS = [
    result(3, "REACHED", True, perceptions=10, path_length=12.0, min_clearance=0.2),
    result(4, "LIVELOCK", False, perceptions=80, path_length=90.0, min_clearance=0.05),
    result(5, "REACHED", True, perceptions=14, path_length=13.0, duration=130.0),
    result(6, "REACHED", True, perceptions=30, path_length=20.0, contacts=2, wall_time=5.0),
]


@pytest.mark.parametrize(("successes", "trials"), [(17, 20), (1, 3), (5, 20), (620, 621)])
def test_the_interval_ends_where_the_deviation_is_196_standard_errors(
    successes: int, trials: int
) -> None:
    """The definition: both ends p solve |share - p| = z sqrt(p (1 - p) / n)."""
    share = successes / trials
    for p in wilson_interval(successes, trials):
        deviation = abs(share - p) / math.sqrt(p * (1.0 - p) / trials)
        assert deviation == pytest.approx(1.959964, abs=1e-6)


def test_the_interval_of_none_and_of_all() -> None:
    low, high = wilson_interval(0, 20)
    # With 0 successes the upper end is z^2 / (n + z^2).
    assert (low, high) == (0.0, pytest.approx(1.959964**2 / (20 + 1.959964**2), abs=1e-6))
    assert wilson_interval(20, 20) == (pytest.approx(1.0 - high), 1.0)


@pytest.mark.parametrize(("successes", "trials"), [(0, 0), (-1, 3), (4, 3)])
def test_counts_that_cannot_be_are_refused(successes: int, trials: int) -> None:
    with pytest.raises(ValueError, match="cannot be"):
        wilson_interval(successes, trials)


def test_averages_are_of_true_verdicts_and_extremes_of_all() -> None:
    s = summarise(RESULTS)
    assert (s.missions, s.reached, s.truthful, s.contacts) == (4, 3, 3, 2)
    assert (s.reached_low, s.reached_high) == wilson_interval(3, 4)
    assert (s.mean_perceptions, s.median_perceptions) == (18.0, 14.0)
    assert (s.mean_path_length, s.median_path_length) == (15.0, 13.0)
    assert (s.mean_duration, s.median_duration) == (110.0, 100.0)
    assert s.min_clearance == 0.05
    assert s.median_clearance == pytest.approx(0.15)
    assert s.wall_time == 11.0


def test_a_true_unreachable_counts_as_true_and_not_as_reached() -> None:
    s = summarise([result(1, "UNREACHABLE", True, perceptions=7)])
    assert (s.reached, s.truthful, s.mean_perceptions) == (0, 1, 7.0)


def test_without_a_true_verdict_there_is_no_average() -> None:
    s = summarise([RESULTS[1]])
    assert math.isnan(s.mean_perceptions)
    assert "perceptions - / -" in "\n".join(summary_lines(s))
    assert " - " in row_line("lab", 20, 20, s)
    with pytest.raises(ValueError, match="no mission"):
        summarise([])


def test_flawless_is_true_and_untouched() -> None:
    assert [r.flawless for r in RESULTS] == [True, False, True, False]
    assert [r.reached for r in RESULTS] == [True, False, True, True]


def test_tables_say_what_there_is() -> None:
    lines = result_lines(RESULTS)
    assert len({len(line) for line in lines}) == 1  # columns stand under each other
    assert lines[3].split() == ["4", "LIVELOCK", "NO", "80", "90.00", "0.050", "0", "100.0", "2.0"]
    words = "\n".join(summary_lines(summarise(RESULTS)))
    assert "reached 3 of 4 (95 % interval 30 to 95 %), true verdicts 3 of 4" in words
    assert "contacts 2" in words
    assert "perceptions 18.0 / 14.0, path 15.00 / 13.00 m, robot's time 110 / 100 s" in words
    row = row_line("gaps_0.75", 17, 20, summarise(RESULTS))
    assert "17 of 20" in row
    assert "3 of 4" in row
    assert row.split()[-4:] == ["18.0", "15.0", "0.050", "2"]
