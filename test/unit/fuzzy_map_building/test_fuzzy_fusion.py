# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Aggregation and risk maps, against the operators applied one by one."""

import numpy as np
import pytest

from fuzzy_map_building.evidence.fuzzy import FuzzyFusion
from fuzzy_map_building.params import EvidenceParameters, FusionParameters


def rule(aggregation: str = "mean", **values: int) -> FuzzyFusion:
    return FuzzyFusion(EvidenceParameters(), FusionParameters(aggregation=aggregation, **values))


def union(a: float, b: float, lam: float = 0.4) -> float:
    if 0.0 in (a, b):
        return max(a, b)
    if 1.0 in (a, b):
        return 1.0
    return 1 / (1 + ((1 / a - 1) ** -lam + (1 / b - 1) ** -lam) ** (-1 / lam))


def fuse(fusion: FuzzyFusion, e: float, o: float, n: int, e_k: float, o_k: float) -> tuple:
    arrays = [np.array([v]) for v in (e, o)]
    out = fusion.fuse(*arrays, np.array([n], np.int32), np.array([e_k]), np.array([o_k]))
    return tuple(float(v[0]) for v in out)


def test_mean_with_a_saturated_count() -> None:
    fusion = rule("mean", max_count=3)
    assert fuse(fusion, 0.0, 0.0, 1, 0.6, 0.2) == pytest.approx((0.6, 0.2))
    assert fuse(fusion, 0.6, 0.2, 2, 0.0, 0.4) == pytest.approx((0.3, 0.3))
    assert fuse(fusion, 0.3, 0.3, 3, 0.9, 0.0) == pytest.approx((0.5, 0.2))
    # From N_max on, (10), every perception weighs a third.
    assert fuse(fusion, 0.3, 0.3, 100, 0.9, 0.0) == pytest.approx((0.5, 0.2))


def test_the_mean_follows_a_change_and_the_union_does_not() -> None:
    for aggregation, forgets in (("mean", True), ("dombi", False), ("max", False)):
        e, o = 0.0, 0.0
        for n in range(1, 12):
            e, o = fuse(rule(aggregation), e, o, n, 0.05 if n < 5 else 0.9, 0.9 if n < 5 else 0.0)
        assert (o < 0.1) == forgets


def test_dombi_and_max() -> None:
    assert fuse(rule("dombi"), 0.3, 0.5, 7, 0.4, 0.0) == pytest.approx((union(0.3, 0.4), 0.5))
    assert fuse(rule("max"), 0.3, 0.5, 7, 0.4, 0.1) == (0.4, 0.5)


def test_risks_are_the_operators_one_by_one() -> None:
    grid = np.linspace(0.0, 1.0, 21)
    e, o = (v.ravel() for v in np.meshgrid(grid, grid))
    motion, planning = rule().risks(e, o)
    for ei, oi, m, p in zip(e.tolist(), o.tolist(), motion, planning, strict=True):
        ambiguous = max(0.0, ei + oi - 1.0)
        indeterminate = max(0.0, 1.0 - ei - oi)
        # The closed forms that the bounded product (17) comes to.
        assert m == pytest.approx(1 - max(0, ei**2 - oi - ambiguous - indeterminate), abs=1e-12)
        safe = max(0.0, ei**2 - oi - ambiguous)
        if min(safe, indeterminate) > 1e-9 or max(safe, indeterminate) < 1e-9:
            assert p == pytest.approx(1 - union(safe, indeterminate), abs=1e-9)
    assert motion.min() >= 0.0
    assert motion.max() <= 1.0
    assert planning.min() >= 0.0
    assert planning.max() <= 1.0


@pytest.mark.parametrize(
    ("e", "o", "motion", "planning"),
    [
        (0.0, 0.0, 1.0, 0.0),  # unexplored: a risk for motion, none for planning
        (1.0, 0.0, 0.0, 0.0),  # surely free
        (0.0, 1.0, 1.0, 1.0),  # surely occupied
        (1.0, 1.0, 1.0, 1.0),  # contradiction
    ],
)
def test_the_corners(e: float, o: float, motion: float, planning: float) -> None:
    m, p = rule().risks(np.array([e]), np.array([o]))
    assert (m[0], p[0]) == (motion, planning)


def test_what_opens_the_beta_cut() -> None:
    # M_m <= 0.9 needs e^2 + e >= 1.1 when nothing speaks of an obstacle: e >= 0.662.
    motion, _ = rule().risks(np.array([0.661, 0.663]), np.zeros(2))
    assert motion[0] > 0.9 > motion[1]
