# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What many missions amount to, in numbers and as text."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from nomad_sim.missions import MissionResult

__all__ = [
    "ROW_HEADER",
    "Summary",
    "result_lines",
    "row_line",
    "summarise",
    "summary_lines",
    "wilson_interval",
]

# Two-sided 95 % of the standard normal distribution.
_Z = 1.959963984540054

_HEADER = (
    f"{'seed':>10}  {'verdict':<11} {'true':<4} {'perceptions':>11} {'path':>7} "
    f"{'clearance':>9} {'contacts':>8} {'robot':>7} {'computed':>8}"
)
_UNITS = f"{'':>10}  {'':<11} {'':<4} {'':>11} {'[m]':>7} {'[m]':>9} {'':>8} {'[s]':>7} {'[s]':>8}"

#: Head of the table whose lines `row_line` gives.
ROW_HEADER = (
    f"{'row':<26} {'method':>8} {'reached':>9} {'95 % interval':>14} {'perceptions':>11} "
    f"{'path [m]':>8} {'clearance [m]':>13} {'contacts':>8}"
)


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % interval of a probability after so many successes.

    Parameters
    ----------
    successes, trials : int
        With 0 <= successes <= trials and at least one trial.

    Returns
    -------
    tuple of float
        Lower and upper bound (E. B. Wilson, JASA 22, 1927); unlike the normal
        approximation they are right for 0 and for all successes, too.

    Raises
    ------
    ValueError
        For other counts.
    """
    if not 0 <= successes <= trials or trials < 1:
        raise ValueError(f"{successes} successes in {trials} trials cannot be")
    share, square = successes / trials, _Z**2 / trials
    middle = (share + 0.5 * square) / (1.0 + square)
    half = _Z * math.sqrt((share * (1.0 - share) + 0.25 * square) / trials) / (1.0 + square)
    low = 0.0 if successes == 0 else middle - half
    high = 1.0 if successes == trials else middle + half
    return low, high


@dataclass(frozen=True)
class Summary:
    """Sums and averages of missions.

    Averages are over the missions with a true verdict alone: how far a robot drove until it
    was lost says nothing of the way. Contacts and clearances are those of all missions.

    Parameters
    ----------
    missions, reached, truthful, contacts : int
        Missions, those that reached the goal, those with a true verdict, touches of all.
    reached_low, reached_high : float
        95 % interval of the probability to reach the goal.
    mean_perceptions, median_perceptions, mean_path_length, median_path_length, mean_duration, \
    median_duration : float
        Averages [m, s]; NaN where no verdict was true.
    min_clearance, median_clearance : float
        Least and middle one of the missions' least clearances [m].
    wall_time : float
        Time to compute all missions, one after the other [s].
    """

    missions: int
    reached: int
    reached_low: float
    reached_high: float
    truthful: int
    contacts: int
    mean_perceptions: float
    median_perceptions: float
    mean_path_length: float
    median_path_length: float
    mean_duration: float
    median_duration: float
    min_clearance: float
    median_clearance: float
    wall_time: float


def _averages(values: Sequence[float]) -> tuple[float, float]:
    if not values:
        return math.nan, math.nan
    return statistics.fmean(values), float(statistics.median(values))


def summarise(results: Sequence[MissionResult]) -> Summary:
    """Return what missions amount to.

    Raises
    ------
    ValueError
        If there is none.
    """
    if not results:
        raise ValueError("no mission, nothing to sum up")
    true = [r for r in results if r.truthful]
    reached = sum(r.reached for r in results)
    low, high = wilson_interval(reached, len(results))
    perceptions = _averages([r.perceptions for r in true])
    path_length = _averages([r.path_length for r in true])
    duration = _averages([r.duration for r in true])
    return Summary(
        missions=len(results),
        reached=reached,
        reached_low=low,
        reached_high=high,
        truthful=len(true),
        contacts=sum(r.contacts for r in results),
        mean_perceptions=perceptions[0],
        median_perceptions=perceptions[1],
        mean_path_length=path_length[0],
        median_path_length=path_length[1],
        mean_duration=duration[0],
        median_duration=duration[1],
        min_clearance=min(r.min_clearance for r in results),
        median_clearance=statistics.median(r.min_clearance for r in results),
        wall_time=math.fsum(r.wall_time for r in results),
    )


def result_lines(results: Sequence[MissionResult]) -> list[str]:
    """Return a table with one line for each mission."""
    return [_HEADER, _UNITS] + [
        f"{r.seed:>10}  {r.outcome:<11} {'yes' if r.truthful else 'NO':<4} {r.perceptions:>11} "
        f"{r.path_length:>7.2f} {r.min_clearance:>9.3f} {r.contacts:>8} {r.duration:>7.1f} "
        f"{r.wall_time:>8.1f}"
        for r in results
    ]


def _number(value: float, digits: int) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def summary_lines(summary: Summary) -> list[str]:
    """Return a summary in words."""
    s = summary
    averages = [
        f"{label} {_number(mean, digits)} / {_number(median, digits)}{unit}"
        for label, mean, median, digits, unit in (
            ("perceptions", s.mean_perceptions, s.median_perceptions, 1, ""),
            ("path", s.mean_path_length, s.median_path_length, 2, " m"),
            ("robot's time", s.mean_duration, s.median_duration, 0, " s"),
        )
    ]
    return [
        f"reached {s.reached} of {s.missions} (95 % interval {100.0 * s.reached_low:.0f} to "
        f"{100.0 * s.reached_high:.0f} %), true verdicts {s.truthful} of {s.missions}, "
        f"contacts {s.contacts}",
        f"mean / median of the {s.truthful} with a true verdict: {', '.join(averages)}",
        f"clearance: least {s.min_clearance:.3f} m, median of the missions' least "
        f"{s.median_clearance:.3f} m; computed in {s.wall_time:.0f} s",
    ]


def row_line(name: str, method: int, method_missions: int, summary: Summary) -> str:
    """Return the line of a reference row: what the method reached, and what was reached here."""
    s = summary
    interval = f"{100.0 * s.reached_low:.0f} to {100.0 * s.reached_high:.0f} %"
    return (
        f"{name:<26} {f'{method} of {method_missions}':>8} {f'{s.reached} of {s.missions}':>9} "
        f"{interval:>14} {_number(s.mean_perceptions, 1):>11} "
        f"{_number(s.mean_path_length, 1):>8} {s.min_clearance:>13.3f} {s.contacts:>8}"
    )
