# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A state that is copied later, against one that was copied at once."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np
import pytest

from fuzzy_map_building import frozen_state
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.types import Pose2, SonarReading

GRID = GridGeometry(76, 63, 0.1)


def ring(seed: int) -> list[SonarReading]:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(2.0, 4.0, 2).tolist()  # so near together that their windows overlap
    ranges = rng.uniform(0.3, 2.5, 48).tolist()
    return [SonarReading(Pose2(x, y), 0.1309 * i, r) for i, r in enumerate(ranges)]


def mapper_after(packets: int) -> FuzzyMapper:
    mapper = FuzzyMapper(GRID)
    for seed in range(packets):
        mapper.update(ring(seed))
    return mapper


def assert_same(state: MapState, wanted: MapState) -> None:
    for name in ("empty", "occupied", "count"):
        np.testing.assert_array_equal(getattr(state, name), getattr(wanted, name))
    assert state.perceptions == wanted.perceptions


def other_parameters(mapper: FuzzyMapper) -> FuzzyMapper:
    return mapper.with_parameters(mapper_parameters(overrides={"evidence.k_empty": 0.3}))


def reset(mapper: FuzzyMapper) -> FuzzyMapper:
    mapper.reset()
    return mapper


def load(mapper: FuzzyMapper) -> FuzzyMapper:
    mapper.adopt(mapper_after(7).state())
    return mapper


@pytest.mark.parametrize("change", [lambda mapper: mapper, other_parameters, reset, load])
def test_what_comes_later_is_not_in_it(change: Callable[[FuzzyMapper], FuzzyMapper]) -> None:
    mapper = mapper_after(3)
    first, frozen = mapper.state(), mapper.freeze()
    mapper.update(ring(10))
    second, later = mapper.state(), mapper.freeze()
    mapper = change(mapper)
    for seed in (11, 12, 13):
        mapper.update(ring(seed))
    assert_same(frozen.state(), first)
    mapper.update(ring(14))
    assert_same(later.state(), second)


def test_what_comes_while_it_is_copied_is_not_in_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frozen_state, "_CELLS_A_BAND", 1)  # row by row
    mapper = mapper_after(3)
    for _ in range(20):
        before, frozen = mapper.state(), mapper.freeze()
        copies: list[MapState] = []
        copying = threading.Thread(target=lambda f=frozen, c=copies: c.append(f.state()))
        copying.start()
        packets = 0
        while copying.is_alive() or not packets:
            mapper.update(ring(mapper.perceptions))
            packets += 1
        copying.join()
        assert_same(copies[0], before)
        assert mapper.perceptions == before.perceptions + packets


def test_nothing_is_put_aside_for_what_has_been_copied() -> None:
    mapper = mapper_after(1)
    frozen = mapper.freeze()
    frozen.state()
    mapper.update(ring(5))
    assert frozen.copied
    assert frozen._aside == []
    assert mapper._frozen == []


def test_a_mapper_with_other_parameters_goes_on_with_the_map() -> None:
    mapper = mapper_after(3)
    before = mapper.state()
    other = other_parameters(mapper)
    assert_same(other.state(), before)
    assert other.parameters.evidence.k_empty == 0.3
    restored = FuzzyMapper(GRID, other.parameters)
    restored.restore(before)
    assert other.update(ring(8)) == restored.update(ring(8))
    assert_same(other.state(), restored.state())
