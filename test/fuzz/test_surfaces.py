# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Some cases of every surface, the same each time; `run.py` runs as many as wanted."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from fuzz import child
from fuzz.generate import inputs, smaller
from fuzz.surfaces import surface_named, surface_names

#: Cases of the surfaces that take milliseconds each, and of the others.
FEW, MANY = 25, 200
SLOW = {
    *("mapper", "mapper_continuous", "mapper_parameters", "planner", "motion", "simulator"),
    *("world", "parameters", "floor_plan"),
}


@pytest.mark.parametrize("name", surface_names())
def test_nothing_is_found(name: str) -> None:
    surface = surface_named(name)
    with surface.opened() as target:
        drawn = inputs(surface.seeds(), surface.tokens, surface.longest, 20261122)
        for data in itertools.islice(drawn, FEW if name in SLOW else MANY):
            target(data)


def test_what_fails_is_kept_as_the_smallest_input_that_does(tmp_path: Path) -> None:
    def target(data: bytes) -> None:
        assert b"x" not in data, "there it is"

    slot = tmp_path / "slot"
    slot.write_bytes(bytes(child.SLOT))
    guard = child.Guard(target, tmp_path, slot)
    guard(b"abc")
    assert guard.findings == {}
    guard(b"some x here")
    guard(b"another x")
    (found,) = tmp_path.glob("AssertionError_*.bin")
    assert found.read_bytes() == b"x"
    assert "there it is" in "".join(guard.findings.values())


def test_inputs_repeat_for_a_seed_and_keep_to_their_length() -> None:
    seeds = [b"good one", b"x" * 99]
    first, again, other = (
        list(itertools.islice(inputs(seeds, (b"word",), 50, seed), 200)) for seed in (1, 1, 2)
    )
    assert first == again != other
    assert first[:2] == [seeds[0], seeds[1][:50]]
    assert max(map(len, first)) <= 256
    assert all(len(data) <= 3 for data in smaller(b"abc"))
