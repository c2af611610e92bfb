# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters declared once, as the fields of frozen dataclasses.

A field made by `parameter` carries its unit, range, meaning and source. Groups nest:
a field ``sonar`` that is itself such a dataclass gives names with dots
(``sonar.min_range``). Everything else, validation, YAML files, ROS declarations,
the table in the README, is derived from that one declaration.
"""

from __future__ import annotations

import dataclasses
import difflib
import functools
import itertools
import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from fuzzy_map_building.plain_yaml import shown

__all__ = [
    "ParameterError",
    "ParameterInfo",
    "checked_value",
    "describe",
    "flatten",
    "from_mapping",
    "kind_of",
    "markdown_table",
    "parameter",
    "suggest",
    "unknown_parameter",
    "validate",
]

T = TypeVar("T")
_KEY = "parameter"
#: Most elements of a list and characters of a text: they bound what a request can set.
_MAX_ELEMENTS = 1024
_MAX_TEXT = 1024
#: Most known names that a message lists.
_MOST_NAMES = 25
_WORDS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}
_LISTS = {
    float: "a list of numbers",
    int: "a list of whole numbers",
    bool: "a list of true or false",
    str: "a list of texts",
}


class ParameterError(ValueError):
    """A parameter has an unknown name or a value that it must not have."""


@dataclass(frozen=True)
class ParameterInfo:
    """What is known of one parameter besides its value."""

    name: str
    type: type
    default: Any
    doc: str
    unit: str
    minimum: float | None
    maximum: float | None
    choices: tuple[Any, ...]
    source: str
    is_sequence: bool
    read_only: bool


def parameter(
    default: Any,
    *,
    doc: str,
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[Any, ...] = (),
    source: str = "",
    read_only: bool = False,
) -> Any:
    """Declare a parameter as a dataclass field.

    Parameters
    ----------
    default : bool, int, float, str or tuple of one of these
        Default; its type is the parameter's type.
    doc, unit, source : str
        Meaning, unit (empty: a pure number) and where the value comes from.
    minimum, maximum : float, optional
        Bounds, both allowed values; of each element where the parameter is a sequence.
    choices : tuple, optional
        The only allowed values.
    read_only : bool
        Whether a running node refuses to change it.
    """
    info = {
        "doc": doc,
        "unit": unit,
        "minimum": minimum,
        "maximum": maximum,
        "choices": choices,
        "source": source,
        "read_only": read_only,
    }
    return dataclasses.field(default=default, metadata={_KEY: info})


def suggest(name: str, known: typing.Iterable[str], *, told: bool = False) -> str:
    """Return '; did you mean ...?' for a misspelt name, or the list of known names.

    Parameters
    ----------
    name : str
        The name that is not known.
    known : iterable of str
        Those that are.
    told : bool
        Whether the message lists the known names already: then nothing is listed.
    """
    names = sorted(known)
    # A longer one is no misspelt name, and to compare it takes long.
    close = difflib.get_close_matches(name[:100], names, n=1, cutoff=0.6)
    if close:
        return f"; did you mean '{close[0]}'?"
    if told:
        return ""
    if len(names) > _MOST_NAMES:
        return f"; none of the {len(names)} known names is like it"
    return f"; known names: {', '.join(names)}"


def unknown_parameter(name: str, known: typing.Iterable[str]) -> str:
    """Return the sentence that refuses a name which no parameter has."""
    return f"unknown parameter {shown(name)}{suggest(name, known)}"


def kind_of(info: ParameterInfo) -> str:
    """Return in words what the value of a parameter has to be."""
    return _LISTS[info.type] if info.is_sequence else _WORDS[info.type]


@functools.cache
def _groups(cls: type) -> tuple[tuple[dataclasses.Field[Any], type | None], ...]:
    """Return the fields of a dataclass, each with its type where that is a group itself."""
    hints = typing.get_type_hints(cls)
    groups: list[tuple[dataclasses.Field[Any], type | None]] = []
    for field in dataclasses.fields(cls):
        hint = hints[field.name]
        is_group = isinstance(hint, type) and dataclasses.is_dataclass(hint)
        groups.append((field, hint if is_group else None))
    return tuple(groups)


def describe(cls: type, prefix: str = "") -> dict[str, ParameterInfo]:
    """Return the parameters of a dataclass by dotted name, in order of declaration."""
    out: dict[str, ParameterInfo] = {}
    for field, group in _groups(cls):
        name = prefix + field.name
        if group is not None:
            out.update(describe(group, name + "."))
            continue
        info = field.metadata[_KEY]
        default: Any = field.default
        sequence = isinstance(default, tuple)
        if sequence and not default:
            raise TypeError(f"{name}: the type of an empty default sequence is unknown")
        element = default[0] if sequence else default
        out[name] = ParameterInfo(
            name=name, type=type(element), default=default, is_sequence=sequence, **info
        )
    return out


def flatten(parameters: Any, prefix: str = "") -> dict[str, Any]:
    """Return the values of a parameter dataclass by dotted name."""
    out: dict[str, Any] = {}
    kind: Any = type(parameters)
    for field, group in _groups(kind):
        value = getattr(parameters, field.name)
        if group is not None:
            out.update(flatten(value, prefix + field.name + "."))
        else:
            out[prefix + field.name] = value
    return out


def checked_value(info: ParameterInfo, value: Any) -> Any:
    """Return a value in the parameter's own type, or raise ParameterError."""
    if info.is_sequence:
        if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
            raise ParameterError(f"parameter '{info.name}' is a list, got {shown(value)}")
        elements = tuple(itertools.islice(value, _MAX_ELEMENTS + 1))
        if len(elements) > _MAX_ELEMENTS:
            raise ParameterError(f"parameter '{info.name}' has more than {_MAX_ELEMENTS} elements")
        return tuple(_checked_scalar(info, element) for element in elements)
    return _checked_scalar(info, value)


def _checked_scalar(info: ParameterInfo, value: Any) -> Any:
    name = f"parameter '{info.name}'"
    if info.type is float and isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            value = float(value)
        except OverflowError:  # a whole number beyond the floats
            value = math.inf
        if not math.isfinite(value):
            raise ParameterError(f"{name} must be finite, got {value}")
    elif info.type is int and hasattr(value, "__index__") and not isinstance(value, bool):
        value = int(value)
    elif info.type is bool and type(value).__name__ in ("bool", "bool_"):
        value = bool(value)
    elif not (info.type is str and isinstance(value, str)):
        raise ParameterError(f"{name} must be {_WORDS[info.type]}, got {shown(value)}")
    elif len(value) > _MAX_TEXT:
        raise ParameterError(f"{name} is a text of more than {_MAX_TEXT} characters")
    unit = f" {info.unit}" if info.unit else ""
    if info.minimum is not None and value < info.minimum:
        raise ParameterError(f"{name} must be at least {info.minimum}{unit}, got {shown(value)}")
    if info.maximum is not None and value > info.maximum:
        raise ParameterError(f"{name} must be at most {info.maximum}{unit}, got {shown(value)}")
    if info.choices and value not in info.choices:
        hint = suggest(str(value), [str(c) for c in info.choices], told=True)
        raise ParameterError(
            f"{name} must be one of {', '.join(map(str, info.choices))}, got {shown(value)}{hint}"
        )
    return value


def validate(parameters: Any) -> None:
    """Check every value against its declaration and store it in its declared type.

    Call it in ``__post_init__`` of each group, before the cross-checks.

    Raises
    ------
    ParameterError
        Naming the parameter, the value and what is allowed.
    """
    for name, info in describe(type(parameters)).items():
        if "." in name:
            continue  # groups validate themselves
        object.__setattr__(parameters, name, checked_value(info, getattr(parameters, name)))


def from_mapping(base: T, values: Mapping[str, Any]) -> T:
    """Return a copy of `base` with the named values changed.

    Parameters
    ----------
    base : dataclass instance
        Where the values not named come from, e.g. a preset.
    values : mapping
        Dotted names, or nested mappings as a YAML file gives them.

    Raises
    ------
    ParameterError
        For an unknown name (with the nearest known one) or a refused value.
    """
    flat = _flatten_mapping(values)
    known = describe(type(base))
    for name in flat:
        if name not in known:
            raise ParameterError(unknown_parameter(name, known))
    for name, value in flat.items():
        flat[name] = checked_value(known[name], value)
    changed: T = _replace(base, flat)
    return changed


def _flatten_mapping(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, value in values.items():
        if not isinstance(key, str):
            raise ParameterError(f"parameter names are text, got {shown(key)}")
        if isinstance(value, Mapping):
            out.update(_flatten_mapping(value, prefix + key + "."))
        else:
            out[prefix + key] = value
    return out


def _replace(base: Any, flat: Mapping[str, Any]) -> Any:
    changes: dict[str, Any] = {}
    kind: Any = type(base)
    for field, group in _groups(kind):
        if group is None:
            if field.name in flat:
                changes[field.name] = flat[field.name]
            continue
        start = field.name + "."
        inner = {name[len(start) :]: v for name, v in flat.items() if name.startswith(start)}
        if inner:
            changes[field.name] = _replace(getattr(base, field.name), inner)
    return dataclasses.replace(base, **changes)


def markdown_table(parameters: Any) -> str:
    """Return the parameters of a dataclass instance as a Markdown table.

    Examples
    --------
    >>> @dataclass(frozen=True)
    ... class Example:
    ...     gap: float = parameter(0.5, doc="width", unit="m", minimum=0.1)
    >>> print(markdown_table(Example()))
    | parameter | default | unit | allowed | meaning |
    |---|---|---|---|---|
    | `gap` | 0.5 | m | >= 0.1 | width |
    """
    values = flatten(parameters)
    rows = ["| parameter | default | unit | allowed | meaning |", "|---|---|---|---|---|"]
    for name, info in describe(type(parameters)).items():
        cells = (f"`{name}`", _shown(values[name]), info.unit, _allowed(info), info.doc)
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        shown = [_shown(element) for element in value]
        return ", ".join(shown) if len(shown) <= 6 else f"{shown[0]} ... {shown[-1]}"
    return f"{value:.6g}" if isinstance(value, float) else str(value).lower()


def _allowed(info: ParameterInfo) -> str:
    if info.choices:
        return ", ".join(map(str, info.choices))
    low = "" if info.minimum is None else f">= {info.minimum:.6g}"
    high = "" if info.maximum is None else f"<= {info.maximum:.6g}"
    return ", ".join(part for part in (low, high) if part)
