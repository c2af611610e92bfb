# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What trials amount to: in all, by what was drawn, and marginal goals apart."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from fuzzy_navigation.mission_types import Outcome
from nomad_sim.campaign_table import wilson_interval
from nomad_sim.ground_truth import Reachability
from nomad_sim.trials import TrialResult

__all__ = ["Tally", "report", "report_lines", "tally"]

#: Borders of the classes of door widths [m].
_DOORS = (0.7, 0.8, 0.9)


@dataclass(frozen=True)
class Tally:
    """Counts and averages of trials that have something in common.

    Parameters
    ----------
    group, value : str
        What they have in common.
    missions : int
        All of them.
    reachable, reached : int
        Goals that can be reached, marginal ones included, and those that were.
    reached_low, reached_high : float
        95 % interval of the probability to reach one that can be; NaN without any.
    false_unreachable : int
        Goals that can be reached and were called unreachable.
    unreachable, called_unreachable, false_reached : int
        Goals that cannot be reached, those that were called so, those that were called reached.
    contacts, touching : int
        Touches, and missions with any.
    mean_perceptions, median_perceptions : float
        Of the missions that reached their goal; NaN without any.
    median_ratio, mean_ratio, p95_ratio : float
        Path driven in shortest true ways, of the missions that reached their goal; the last is
        the least value that 95 % of them do not exceed. NaN without any.
    min_clearance : float
        Least of all missions' clearances [m].
    """

    group: str
    value: str
    missions: int
    reachable: int
    reached: int
    reached_low: float
    reached_high: float
    false_unreachable: int
    unreachable: int
    called_unreachable: int
    false_reached: int
    contacts: int
    touching: int
    mean_perceptions: float
    median_perceptions: float
    median_ratio: float
    mean_ratio: float
    p95_ratio: float
    min_clearance: float


def _of(average: Callable[[list[float]], float], values: Iterable[float]) -> float:
    numbers = list(values)
    return float(average(numbers)) if numbers else math.nan


def _p95(values: Sequence[float]) -> float:
    """Return the least value that at least 95 % of the values do not exceed."""
    return sorted(values)[math.ceil(0.95 * len(values)) - 1]


def tally(group: str, value: str, results: Sequence[TrialResult]) -> Tally:
    """Return what trials amount to.

    Raises
    ------
    ValueError
        If there is none.
    """
    if not results:
        raise ValueError("no trial, nothing to count")
    can = [r for r in results if r.truth != Reachability.UNREACHABLE.value]
    cannot = [r for r in results if r.truth == Reachability.UNREACHABLE.value]
    reached = [r for r in can if r.mission.reached]
    low, high = wilson_interval(len(reached), len(can)) if can else (math.nan, math.nan)
    perceptions = [float(r.mission.perceptions) for r in reached]
    ratios = [r.path_ratio for r in reached if r.path_ratio is not None]
    return Tally(
        group=group,
        value=value,
        missions=len(results),
        reachable=len(can),
        reached=len(reached),
        reached_low=low,
        reached_high=high,
        false_unreachable=sum(r.false_unreachable for r in can),
        unreachable=len(cannot),
        called_unreachable=sum(r.mission.outcome == Outcome.UNREACHABLE.name for r in cannot),
        false_reached=sum(r.false_reached for r in cannot),
        contacts=sum(r.mission.contacts for r in results),
        touching=sum(r.mission.contacts > 0 for r in results),
        mean_perceptions=_of(statistics.fmean, perceptions),
        median_perceptions=_of(statistics.median, perceptions),
        median_ratio=_of(statistics.median, ratios),
        mean_ratio=_of(statistics.fmean, ratios),
        p95_ratio=_of(_p95, ratios),
        min_clearance=min(r.mission.min_clearance for r in results),
    )


def _door(result: TrialResult) -> str:
    if result.door is None:
        return "none"
    borders = [border for border in _DOORS if border <= result.door]
    if not borders:
        return f"< {_DOORS[0]:.2f} m"
    above = _DOORS[len(borders) :]
    return f"{borders[-1]:.2f} to {above[0]:.2f} m" if above else f">= {borders[-1]:.2f} m"


_GROUPS: tuple[tuple[str, Callable[[TrialResult], str]], ...] = (
    ("kind", lambda r: r.kind),
    ("material", lambda r: r.material),
    ("beam", lambda r: f"{r.beam:g} deg"),
    ("door", _door),
    ("glass", lambda r: r.glass),
    ("people", lambda r: "some" if r.people else "none"),
)


def report(results: Sequence[TrialResult]) -> tuple[Tally, ...]:
    """Return the tally of all trials but those with marginal goals, by what was drawn, and theirs.

    The first has the group ``all``, the last, if there is any such goal, ``marginal``; groups of
    one value are left out.

    Raises
    ------
    ValueError
        If there is no trial.
    """
    clear = [r for r in results if r.truth != Reachability.MARGINAL.value]
    marginal = [r for r in results if r.truth == Reachability.MARGINAL.value]
    tallies = [tally("all", "", clear)] if clear else []
    for group, value_of in _GROUPS:
        values: dict[str, list[TrialResult]] = {}
        for result in clear:
            values.setdefault(value_of(result), []).append(result)
        if len(values) > 1:
            order = sorted(values, key=lambda value: (_number(value), value))
            tallies += [tally(group, value, values[value]) for value in order]
    if marginal or not clear:
        tallies.append(tally("marginal", "", marginal))
    return tuple(tallies)


def _number(text: str) -> float:
    """Return the first number of a text, by which it is sorted: infinity without one."""
    for word in text.split():
        try:
            return float(word) + 1e-9 * (text.startswith(">") - text.startswith("<"))
        except ValueError:
            continue
    return math.inf


def _text(value: float, digits: int) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def _columns(t: Tally) -> dict[str, Any]:
    interval = "-"
    if t.reachable:
        interval = f"{100.0 * t.reached_low:.1f}-{100.0 * t.reached_high:.1f}"
    ratio = "/".join(_text(v, 2) for v in (t.median_ratio, t.mean_ratio, t.p95_ratio))
    return {
        "": f"{t.group} {t.value}".strip(),
        "reached": f"{t.reached} of {t.reachable}",
        "95 % interval": interval,
        "false unr.": t.false_unreachable,
        "called unr.": f"{t.called_unreachable} of {t.unreachable}",
        "false reached": t.false_reached,
        "contacts": t.contacts,
        "perceptions": f"{_text(t.mean_perceptions, 1)}/{_text(t.median_perceptions, 1)}",
        "path/shortest": ratio,
        "clearance": _text(t.min_clearance, 3),
    }


def report_lines(tallies: Sequence[Tally]) -> list[str]:
    """Return a table with one line for each tally, and what its columns say."""
    rows = [{name: str(value) for name, value in _columns(t).items()} for t in tallies]
    widths = {name: max(len(name), *(len(row[name]) for row in rows)) for name in rows[0]}
    first = next(iter(widths))

    def line(cells: dict[str, str]) -> str:
        return "  ".join(
            f"{cells[name]:<{width}}" if name == first else f"{cells[name]:>{width}}"
            for name, width in widths.items()
        ).rstrip()

    return [
        line({name: name for name in widths}),
        *(line(row) for row in rows),
        "reached: goals that can be; false unr.: of those, called unreachable; called unr.: goals "
        "that cannot be reached and were called so;",
        "perceptions: mean/median, path/shortest: median/mean/95th percentile, of the missions "
        "that arrived; clearance: the least [m]",
    ]
