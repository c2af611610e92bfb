# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Inputs without a coverage-guided fuzzer: seeds, cut, joined, overwritten, or anything."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

__all__ = ["inputs", "smaller"]

#: Bytes at the edges of what a byte or a part of a number can be.
EDGES = (0, 1, 2, 7, 8, 9, 10, 31, 32, 127, 128, 254, 255)


def inputs(
    seeds: Sequence[bytes], tokens: Sequence[bytes], longest: int, seed: int
) -> Iterator[bytes]:
    """Yield the seeds, then mutations of them without end; the same for the same `seed`."""
    yield from (data[:longest] for data in seeds)
    draw = random.Random(seed)
    while True:
        if not seeds or draw.random() < 0.25:
            yield draw.randbytes(draw.choice((4, 16, 64, 256, longest)))
            continue
        data = bytearray(draw.choice(seeds))
        for _ in range(draw.choice((1, 1, 2, 4, 12))):
            _mutate(draw, data, seeds, tokens)
        yield bytes(data[:longest])


def _mutate(
    draw: random.Random, data: bytearray, seeds: Sequence[bytes], tokens: Sequence[bytes]
) -> None:
    place = draw.randrange(len(data) + 1)
    end = min(len(data), place + draw.choice((1, 2, 4, 8, 40)))
    kind = draw.randrange(8 if tokens else 7)
    if kind == 0:
        data[place:end] = draw.randbytes(end - place)
    elif kind == 1:
        data[place:end] = bytes([draw.choice(EDGES)]) * (end - place)
    elif kind == 2:
        del data[place:end]
    elif kind == 3:
        data[place:place] = draw.randbytes(draw.choice((1, 2, 8)))
    elif kind == 4:
        data[place:place] = data[place:end] * draw.choice((1, 2, 10))
    elif kind == 5:
        other = draw.choice(seeds)
        start = draw.randrange(len(other) + 1)
        data[place:end] = other[start : start + draw.choice((4, 32, 200))]
    elif kind == 6 and place < len(data):
        data[place] ^= 1 << draw.randrange(8)
    elif kind == 7:
        data[place:end] = draw.choice(tokens)


def smaller(data: bytes) -> Iterator[bytes]:
    """Yield simpler variants of an input, the simplest first."""
    size = len(data) // 2
    while size:
        for place in range(0, len(data), size):
            yield data[:place] + data[place + size :]
        size //= 2
    for place, value in enumerate(data):
        for simple in (0, ord("0"), ord(" ")):
            if value > simple:
                yield data[:place] + bytes([simple]) + data[place + 1 :]
