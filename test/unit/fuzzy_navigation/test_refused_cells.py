# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the motion remembers of the places that it could not enter."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_navigation.refused_cells import RefusedCells

GEOMETRY = GridGeometry(20, 15, 0.1, (-0.5, 0.3))


def test_an_obstacle_refuses_the_cells_where_the_body_has_no_room() -> None:
    refused = RefusedCells(40, 0.28)
    hits = np.array([(0.42, 0.91), (1.37, 1.02)])
    refused.add_obstacle(1, hits, GEOMETRY)
    by_hand = {
        GEOMETRY.centre_of(row, column)
        for row in range(15)
        for column in range(20)
        if min(math.dist(GEOMETRY.centre_of(row, column), hit) for hit in hits) < 0.28
    }
    found = refused.barred(1)
    assert len(found) == len(by_hand)
    np.testing.assert_allclose(sorted(found), sorted(by_hand))


def test_cells_are_forgotten_after_some_perceptions() -> None:
    refused = RefusedCells(3, 0.28)
    refused.add(5, 1.05, 2.05)
    refused.add(6, 1.15, 2.05)
    refused.add(6, 1.05, 2.05)
    refused.add(7, 1.25, 2.05)
    assert len(refused.barred(7)) == 3
    assert len(refused.barred(8)) == 3
    assert refused.barred(9) == ((1.25, 2.05),)
    assert refused.barred(10) == ()


def test_without_memory_nothing_is_refused() -> None:
    refused = RefusedCells(0, 0.28)
    refused.add(1, 1.05, 2.05)
    assert refused.barred(1) == ()


@pytest.mark.parametrize("known", [False, True])
def test_all_are_given_free_once_a_mission(known: bool) -> None:
    refused = RefusedCells(40, 0.28)
    if known:
        refused.add(1, 1.05, 2.05)
    assert refused.release() is known
    assert refused.barred(1) == ()
    refused.add(2, 1.05, 2.05)
    assert refused.release() is False
    refused.forget()
    refused.add(3, 1.05, 2.05)
    assert refused.release() is True
