# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Values out of bytes: what a fuzzer mutates becomes numbers, texts and trees."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

__all__ = ["FLOATS", "TEXTS", "Draw", "spoilt"]

T = TypeVar("T")

#: Numbers that programs trip over.
FLOATS = (
    *(math.nan, math.inf, -math.inf, 0.0, -0.0, 1.0, -1.0, 0.5, 1e-3, -1e-3, 1e-6, 1e-9),
    *(5e-324, 2.2e-308, 1e-300, 1e-160, 1e160, 1e300, 1.7976931348623157e308, -1e308),
    *(1e7, -1e7, 10000001.0, 1e8, 1e9, 2.0**31, 2.0**32, 2.0**53, 2.0**63, -(2.0**63), 1e19),
    *(math.pi, -math.pi, 2.0 * math.pi, 0.1, 0.23, 0.7853981633974483, 3.4e38, 1e39),
)
TEXTS = (
    *("", " ", "a", "map", "odom", "..", "../x", "/etc/passwd", "~", "nan", "inf", "-1", "1e999"),
    *("\0", "\n", "\x1b[2J", "é", "\u202e", "𝔘", "%s%n", "{}", "{0}", "[", "&a", "*a", "<<"),
    *("0777", "1:30", "null", "true", "2001-01-01", "x" * 300, "0x7fffffffffffffff", "9" * 5000),
)
WHOLE = (
    *(0, 1, -1, 2, 3, 7, 8, 16, 100, 127, 128, 255, 256, 2**15, 2**16, 2**31 - 1, 2**31),
    *(-(2**31), 2**32 - 1, 2**32, 2**63 - 1, 2**63, -(2**63), 2**64, 10**30, 10**400),
)


class Draw:
    """Reads values from bytes, one after the other; zeros when they are used up.

    Parameters
    ----------
    data : bytes
        What a fuzzer has made up.
    """

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._place = 0

    @property
    def left(self) -> int:
        """Number of bytes not used yet."""
        return max(0, len(self._data) - self._place)

    def take(self, count: int) -> bytes:
        """Return the next bytes, filled up with zeros."""
        taken = self._data[self._place : self._place + count]
        self._place += count
        return taken.ljust(count, b"\0")

    def rest(self) -> bytes:
        """Return all bytes that are left."""
        return self.take(self.left)

    def byte(self) -> int:
        """Return a number from 0 to 255."""
        place = self._place
        self._place = place + 1
        return self._data[place] if place < len(self._data) else 0

    def below(self, count: int) -> int:
        """Return a number from 0 to count - 1."""
        if count <= 256:
            return self.byte() % count
        return int.from_bytes(self.take(4), "little") % count

    def one_in(self, count: int) -> bool:
        """Return True once in a while; never when the bytes are used up."""
        return self.byte() % count == count - 1

    def choice(self, values: Sequence[T]) -> T:
        """Return one of some values."""
        return values[self.below(len(values))]

    def between(self, low: float, high: float) -> float:
        """Return a number of a range."""
        return low + (high - low) * int.from_bytes(self.take(2), "little") / 65535.0

    def float64(self) -> float:
        """Return any number, mostly one that programs trip over."""
        kind = self.byte()
        if kind < 150:
            return self.choice(FLOATS)
        if kind < 200:
            return self.between(-10.0, 10.0)
        (value,) = struct.unpack("<d", self.take(8))
        return float(value)

    def number(self, good: Callable[[], float]) -> float:
        """Return a good number five times out of six, else any."""
        return self.float64() if self.one_in(6) else good()

    def whole(self) -> int:
        """Return any whole number."""
        if self.byte() % 2:
            return self.choice(WHOLE)
        return int.from_bytes(self.take(4), "little", signed=True)

    def text(self) -> str:
        """Return any text."""
        if self.byte() % 4:
            return self.choice(TEXTS)
        return self.take(self.below(24)).decode("utf-8", "replace")

    def value(self, depth: int = 0) -> Any:
        """Return any value that JSON or YAML can hold."""
        kind = self.byte() % 12
        if kind == 0:
            return None
        if kind <= 2:
            return self.float64()
        if kind <= 4:
            return self.whole()
        if kind <= 6:
            return self.text()
        if kind == 7:
            return bool(self.byte() % 2)
        if depth > 4:
            return [] if kind % 2 else {}
        if kind <= 9:
            return [self.value(depth + 1) for _ in range(self.below(4))]
        return {self.text(): self.value(depth + 1) for _ in range(self.below(3))}


def spoilt(draw: Draw, tree: Any) -> Any:
    """Return a tree of mappings, lists and values with a few things in it changed.

    Parameters
    ----------
    draw : Draw
        Says where and what.
    tree : Any
        As JSON or YAML gives it; it stays as it is.
    """
    for _ in range(1 + draw.below(3)):
        tree = _spoil(draw, tree)
    return tree


def _spoil(draw: Draw, tree: Any) -> Any:
    # Down into it most of the time: at the top there is little to spoil.
    if isinstance(tree, dict) and tree and not draw.one_in(8):
        key = draw.choice(list(tree))
        kind = draw.byte() % 10
        if kind == 8:
            return {k: v for k, v in tree.items() if k != key}
        if kind == 9:
            return {**tree, draw.text(): draw.value()}
        return {**tree, key: _spoil(draw, tree[key])}
    if isinstance(tree, list) and tree and not draw.one_in(8):
        place = draw.below(len(tree))
        kind = draw.byte() % 10
        if kind == 8:
            return tree[:place] + tree[place + 1 :]
        if kind == 9:
            return tree[: place + 1] * (1 + draw.below(3)) + tree[place:]
        return [*tree[:place], _spoil(draw, tree[place]), *tree[place + 1 :]]
    if isinstance(tree, float) and draw.byte() % 2:
        return draw.float64()
    if isinstance(tree, str) and draw.byte() % 2:
        return draw.text()
    return draw.value()
