# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""YAML read with suspicion: every value is asked for by kind, and refused with its place."""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.plain_yaml import PlainLoader, load_plain, number_hint, shown

__all__ = [
    "MAX_BYTES",
    "MAX_COORDINATE",
    "MAX_ENTRIES",
    "SHORTEST",
    "Node",
    "WorldError",
    "read_document",
]

FloatArray = NDArray[np.float64]

# A whole number that YAML 1.1 reads in base 8.
_OCTAL = re.compile(r"[-+]?0[0-7_]+")

#: Largest file [bytes], most entries of a list, farthest coordinate and shortest length [m]:
#: they bound what a file can make the simulator do.
MAX_BYTES = 256_000
MAX_ENTRIES = 4_000
MAX_COORDINATE = 1_000.0
SHORTEST = 1e-3


class WorldError(ValueError):
    """A world file says something that cannot be understood or cannot be."""


class Loader(PlainLoader):
    """YAML without what a world does not need: merged keys, and keys that are no texts."""

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        for key, _ in node.value:
            if not isinstance(self.construct_object(key, deep=True), str):
                raise WorldError(f"line {key.start_mark.line + 1}: a key must be a text")
        return super().construct_mapping(node, deep)

    def construct_number(self, node: Any) -> float:
        """Return a number; not one that YAML reads otherwise than people do."""
        text: str = node.value
        base = "60" if ":" in text else "8" if _OCTAL.fullmatch(text) else ""
        kind = node.tag.rpartition(":")[2]
        value: float = getattr(super(), f"construct_yaml_{kind}")(node)
        if base:
            raise WorldError(
                f"line {node.start_mark.line + 1}: {text} is {value:g} to YAML, which reads it "
                f"in base {base}; write {value:g} if it is that number, '{text}' if it is a text"
            )
        return value


for _kind in ("int", "float"):
    Loader.add_constructor(f"tag:yaml.org,2002:{_kind}", Loader.construct_number)


class Node:
    """A piece of the file and where it stands, for messages that say where to look."""

    def __init__(self, value: Any, where: str) -> None:
        self.value = value
        self.where = where

    def fail(self, problem: str) -> NoReturn:
        """Raise WorldError with the place and the problem."""
        raise WorldError(f"{self.where or 'the world'}: {problem}")

    def refuse(self, wanted: str, hint: str = "") -> NoReturn:
        """Raise WorldError with what is wanted instead of the value, and a hint."""
        found = "nothing" if self.value is None else shown(self.value)
        self.fail(f"{wanted} expected, got {found}{hint}")

    def mapping(self, required: Sequence[str], optional: Sequence[str] = ()) -> dict[str, Node]:
        """Return the values of a mapping that has all required and no unknown keys."""
        if not isinstance(self.value, Mapping):
            self.refuse(f"a mapping with the keys {', '.join([*required, *optional])}")
        known = [*required, *optional]
        for key in self.value:
            if key not in known:
                self.fail(f"unknown key '{key[:100]}'{suggest(key[:100], known)}")
        missing = [key for key in required if key not in self.value]
        if missing:
            self.fail(f"key '{missing[0]}' is missing")
        return {key: Node(v, f"{self.where}.{key}".lstrip(".")) for key, v in self.value.items()}

    def items(self) -> list[Node]:
        """Return the entries of a list."""
        if not isinstance(self.value, list):
            self.refuse("a list")
        if len(self.value) > MAX_ENTRIES:
            self.fail(f"{len(self.value)} entries are more than the {MAX_ENTRIES} allowed")
        return [Node(v, f"{self.where}[{i}]") for i, v in enumerate(self.value)]

    def number(self, low: float = -MAX_COORDINATE, high: float = MAX_COORDINATE) -> float:
        """Return a finite number from `low` to `high`."""
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)):
            self.refuse("a number", number_hint(self.value))
        # Comparing first: an int of any length is no float yet. NaN fails it too.
        if not low <= self.value <= high:
            self.refuse(f"a number from {low:g} to {high:g}")
        return float(self.value)

    def length(self) -> float:
        """Return a length [m] of at least `SHORTEST`."""
        return self.number(SHORTEST, MAX_COORDINATE)

    def numbers(self, count: int) -> list[float]:
        """Return a list of `count` numbers."""
        if not isinstance(self.value, list) or len(self.value) != count:
            self.refuse(f"a list of {count} numbers")
        return [node.number() for node in self.items()]

    def pair(self) -> tuple[float, float]:
        """Return two numbers."""
        x, y = self.numbers(2)
        return x, y

    def text(self, longest: int = 10_000) -> str:
        """Return a text that is not empty."""
        if not isinstance(self.value, str) or not self.value or len(self.value) > longest:
            self.refuse(f"a text of at most {longest} characters")
        return self.value

    def truth(self) -> bool:
        """Return true or false."""
        if not isinstance(self.value, bool):
            self.refuse("true or false")
        return self.value

    def choice(self, choices: Sequence[str]) -> str:
        """Return one of some texts."""
        if self.value not in list(choices):
            if isinstance(self.value, str):
                self.fail(f"{shown(self.value)} is unknown{suggest(self.value, choices)}")
            self.refuse(f"one of {', '.join(choices)}")
        chosen: str = self.value
        return chosen

    def points(self, least: int) -> FloatArray:
        """Return at least `least` points (x, y), shape (N, 2)."""
        nodes = self.items()
        if len(nodes) < least:
            self.refuse(f"at least {least} points [x, y]")
        return np.array([node.pair() for node in nodes])


def read_document(text: str) -> Node:
    """Return the root of a YAML text.

    Raises
    ------
    WorldError
        If it is too long, nested too deeply, or not YAML of the kind accepted here.
    """
    if len(text) > MAX_BYTES:
        raise WorldError(f"{len(text)} characters are more than the {MAX_BYTES} allowed")
    try:
        return Node(load_plain(text, Loader), "")
    except WorldError:
        raise
    except ValueError as error:
        raise WorldError(str(error)) from error
