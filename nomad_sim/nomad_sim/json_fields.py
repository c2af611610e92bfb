# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a JSON file holds: one meaning only, and values of a dataclass of its types, or refused."""

from __future__ import annotations

import dataclasses
import json
import math
import typing
from collections.abc import Callable, Mapping
from typing import Any

from fuzzy_map_building.plain_yaml import shown

__all__ = ["checked_fields", "parse_json"]

#: No count is larger, and no number that a float does not hold.
_LARGEST = 2**63
#: No number that means something has more digits.
_MOST_DIGITS = 400


def parse_json(text: bytes) -> Any:
    """Return the value of a JSON text.

    Raises
    ------
    ValueError
        If it is none in UTF-8 without a byte order mark, has a key twice, or a whole number of
        hundreds of digits.
    RecursionError
        If it is nested too deeply.
    """
    return json.loads(text.decode(), object_pairs_hook=_mapping, parse_int=_integer)


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{shown(twice)} is there twice")
    return values


def _integer(digits: str) -> int:
    if len(digits) > _MOST_DIGITS:
        raise ValueError(f"a whole number of {len(digits)} digits")
    return int(digits)


def _whole(value: Any) -> bool:
    return type(value) is int and abs(value) < _LARGEST


def _number(value: Any) -> bool:
    return (type(value) is float and not math.isnan(value)) or _whole(value)


#: What a value must be, by the field's declared type; others are left to the caller.
_CHECKS: Mapping[Any, tuple[str, Callable[[Any], bool]]] = {
    int: ("a whole number", _whole),
    float: ("a number", _number),
    float | None: ("a number or null", lambda value: value is None or _number(value)),
    # What a terminal takes for a command, or what no file can be written with, is no text.
    str: ("a printable text", lambda value: type(value) is str and value.isprintable()),
    bool: ("true or false", lambda value: type(value) is bool),
}


def checked_fields(cls: type, values: Any) -> dict[str, Any]:
    """Return the values of a dataclass's fields.

    Parameters
    ----------
    cls : type
        The dataclass; fields of other types than int, float, str and bool are not looked at.
    values : Any
        What JSON gave for it.

    Raises
    ------
    ValueError
        If it is no mapping, has more or fewer names, or a value is not of its type; NaN is no
        number.

    Examples
    --------
    >>> @dataclasses.dataclass
    ... class Size:
    ...     width: float
    >>> checked_fields(Size, {"width": 3})
    {'width': 3}
    """
    names = [field.name for field in dataclasses.fields(cls)]
    if not isinstance(values, dict) or set(values) != set(names):
        raise ValueError(f"{cls.__name__} has the fields {', '.join(names)}, got {shown(values)}")
    hints = typing.get_type_hints(cls)
    for name in names:
        what, fits = _CHECKS.get(hints[name], ("", lambda _: True))
        if not fits(values[name]):
            raise ValueError(f"{cls.__name__}.{name} must be {what}, got {shown(values[name])}")
    return values
