# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a fuzzer can be let loose on: a function of bytes, and inputs to begin with."""

from __future__ import annotations

import contextlib
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

__all__ = ["Surface", "Target", "check_words", "of_function", "scratch_folder"]

#: Takes any bytes; an exception is a finding.
Target = Callable[[bytes], None]
Opened = Callable[[], contextlib.AbstractContextManager[Target]]


@dataclass(frozen=True)
class Surface:
    """One way by which things come in from outside.

    Parameters
    ----------
    name : str
        What the runner calls it.
    opened : callable
        Returns a context in which the target can be called, over and over.
    seeds : callable
        Returns inputs to begin with, good ones and known bad ones.
    tokens : sequence of bytes
        Words of its language.
    longest : int
        Largest input worth trying [bytes].
    counts : Counter
        How often the target has called what, by name.
    """

    name: str
    opened: Opened
    seeds: Callable[[], Sequence[bytes]]
    tokens: Sequence[bytes] = ()
    longest: int = 1024
    counts: Counter[str] = field(default_factory=Counter)


def of_function(target: Target) -> Opened:
    """Return the context of a target that needs none."""

    @contextlib.contextmanager
    def opened() -> Iterator[Target]:
        yield target

    return opened


def check_words(error: Exception) -> None:
    """Hold that a refusal says something, and does not hand on all that was refused."""
    assert 0 < len(str(error)) < 3000, f"{type(error).__name__} of {len(str(error))} characters"


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """Yield a folder that is removed behind; in memory where the system has one there."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as folder:
        yield Path(folder)
