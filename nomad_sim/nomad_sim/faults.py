# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Faults of sensors, messages, pose and clock, as values that can be written in one line.

A fault is written ``KIND TARGET NAME=VALUE ...``, for instance
``stuck sonar sensors=3,4 start=10 end=20``; several are separated by semicolons. What a kind
does is said in `KINDS`; how it is done is in `fault_injection`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from fuzzy_map_building.parameter_schema import ParameterError, suggest

__all__ = ["COMMON", "KINDS", "ON_THE_WAY", "Fault", "Kind", "Value", "parse_faults"]

RINGS = ("sonar", "infrared")
MESSAGES = ("sonar", "infrared", "turret", "pose")
#: Kinds that are of messages on their way, not of what they say.
ON_THE_WAY = ("lost", "late", "duplicated", "reordered")
#: Most faults at a time.
MOST = 100


@dataclass(frozen=True)
class Value:
    """A number that a kind of fault takes: default, bounds, unit and meaning."""

    default: float
    minimum: float
    maximum: float
    unit: str
    doc: str


@dataclass(frozen=True)
class Kind:
    """A kind of fault: what it does, to what, and which numbers it takes."""

    doc: str
    targets: tuple[str, ...]
    values: Mapping[str, Value] = field(default_factory=dict)


def _share(default: float, doc: str) -> dict[str, Value]:
    return {"share": Value(default, 0.0, 1.0, "", doc)}


def _metres(default: float, doc: str) -> Value:
    return Value(default, -100.0, 100.0, "m", doc)


#: Numbers that every fault takes.
COMMON: Mapping[str, Value] = {
    "start": Value(0.0, 0.0, 1e9, "s", "time at which it begins"),
    "end": Value(math.inf, 0.0, math.inf, "s", "time at which it is over"),
    "every": Value(0.0, 0.0, 1e9, "s", "time after which it begins again; 0: once"),
}

KINDS: Mapping[str, Kind] = {
    "dead": Kind("sends nothing", RINGS),
    "faulty": Kind(
        "reports a faulty measurement (NaN)", RINGS, _share(1.0, "probability for a reading")
    ),
    "deaf": Kind(
        "hears no echo, sees nothing (+inf)", RINGS, _share(1.0, "probability for a reading")
    ),
    "stuck": Kind(
        "goes on telling what it told first, with new stamps", (*RINGS, "turret", "pose")
    ),
    "biased": Kind(
        "measures too long or too short",
        RINGS,
        {"offset": _metres(0.1, "what is added to each range")},
    ),
    "dazzled": Kind(
        "sees something near that is not there",
        RINGS,
        {
            "range": Value(0.05, 0.0, 100.0, "m", "where"),
            **_share(1.0, "probability for a reading"),
        },
    ),
    "noisy": Kind(
        "reads anything between 0 and a range",
        RINGS,
        {
            "range": Value(6.5, 0.0, 100.0, "m", "the range"),
            **_share(0.3, "probability for a reading"),
        },
    ),
    "lost": Kind("messages get lost", MESSAGES, _share(0.3, "probability for a message")),
    "late": Kind(
        "messages arrive late", MESSAGES, {"delay": Value(0.3, 0.0, 100.0, "s", "how late")}
    ),
    "duplicated": Kind("messages come twice", MESSAGES, _share(0.3, "probability for a message")),
    "reordered": Kind(
        "messages come after those of the next tick",
        MESSAGES,
        _share(0.3, "probability for a message"),
    ),
    "jumping": Kind(
        "is off by a constant",
        ("pose",),
        {
            "x": _metres(0.5, "in x"),
            "y": _metres(0.0, "in y"),
            "theta": Value(0.0, -7.0, 7.0, "rad", "in heading"),
        },
    ),
    "drifting": Kind(
        "strays in a random walk with the way",
        ("pose",),
        {
            "distance": Value(
                0.02, 0.0, 10.0, "m/sqrt(m)", "standard deviation in x and y after one metre"
            ),
            "theta": Value(
                0.0, 0.0, 10.0, "rad/sqrt(m)", "standard deviation in heading after one metre"
            ),
        },
    ),
    "set_back": Kind(
        "shows less than it should, as do all stamps",
        ("clock",),
        {"by": Value(2.0, 0.0, 1e6, "s", "how much less")},
    ),
}


@dataclass(frozen=True)
class Fault:
    """One fault.

    Parameters
    ----------
    kind, target : str
        One of `KINDS`, and one of its targets.
    sensors : tuple of int
        Sensors of the ring that have it; empty: all, or none where the target is no ring.
    values : mapping of str to float
        All numbers that the kind takes, and those of `COMMON`.
    """

    kind: str
    target: str
    sensors: tuple[int, ...]
    values: Mapping[str, float]

    def active(self, time: float) -> bool:
        """Whether it is there at a true time [s]."""
        start, end, every = (self.values[name] for name in COMMON)
        if every > 0.0 and time >= start:
            return (time - start) % every < end - start
        return start <= time < end

    def affects(self, sensor: int) -> bool:
        """Whether a sensor of the ring has it."""
        return not self.sensors or sensor in self.sensors


def parse_faults(text: str, sonars: int, infrareds: int) -> tuple[Fault, ...]:
    """Return the faults that a text describes.

    Parameters
    ----------
    text : str
        Faults separated by ``;``; empty: none.
    sonars, infrareds : int
        Number of sensors in the rings.

    Raises
    ------
    ParameterError
        For an unknown kind, target or name, a number that cannot be, or a sensor that the ring
        has not.

    Examples
    --------
    >>> stuck, jump = parse_faults("stuck sonar sensors=3,4; jumping pose x=0.3 start=9", 16, 16)
    >>> stuck.sensors, jump.values["x"], jump.active(8.0), jump.active(9.0)
    ((3, 4), 0.3, False, True)
    """
    entries = [entry.split() for entry in text.split(";") if entry.strip()]
    if len(entries) > MOST:
        raise ParameterError(f"'faults' holds {len(entries)} faults, more than {MOST}")
    return tuple(_fault(words, {"sonar": sonars, "infrared": infrareds}) for words in entries)


def _fault(words: list[str], rings: Mapping[str, int]) -> Fault:
    where = f"'faults', '{' '.join(words)[:100]}'"
    if len(words) < 2:
        raise ParameterError(f"{where}: KIND TARGET NAME=VALUE ... expected")
    name, target, *settings = words
    kind = KINDS.get(name)
    if kind is None:
        raise ParameterError(f"{where}: unknown kind '{name[:40]}'{suggest(name[:40], KINDS)}")
    if target not in kind.targets:
        raise ParameterError(
            f"{where}: '{name}' is of {' or '.join(kind.targets)}, got '{target[:40]}'"
        )
    known = {**COMMON, **kind.values}
    values = {key: value.default for key, value in known.items()}
    sensors: tuple[int, ...] = ()
    for setting in settings:
        key, equals, number = setting.partition("=")
        if key == "sensors" and target in rings:
            sensors = _sensors(where, number, rings[target])
        elif key not in known or not equals:
            raise ParameterError(
                f"{where}: unknown name '{key[:40]}'{suggest(key[:40], [*known, 'sensors'])}"
            )
        else:
            values[key] = _number(f"{where}: {key}", number, known[key])
    if not values["start"] < values["end"]:
        raise ParameterError(f"{where}: start must be before end")
    return Fault(name, target, sensors, values)


def _sensors(where: str, text: str, count: int) -> tuple[int, ...]:
    entries = text.split(",")
    if not all(entry.isdecimal() and int(entry[:6]) < count for entry in entries):
        raise ParameterError(
            f"{where}: sensors are numbers from 0 to {count - 1} with commas between them, "
            f"got '{text[:60]}'"
        )
    return tuple(sorted({int(entry) for entry in entries}))


def _number(what: str, text: str, value: Value) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not value.minimum <= number <= value.maximum:
        raise ParameterError(
            f"{what} is a number from {value.minimum:g} to {value.maximum:g}"
            f"{' ' + value.unit if value.unit else ''}, got '{text[:40]}'"
        )
    return number
