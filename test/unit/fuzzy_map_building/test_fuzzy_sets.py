# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Operators on fuzzy sets, against values worked out by hand."""

import math

import numpy as np
import pytest

from fuzzy_map_building.fuzzy_sets import (
    bounded_product,
    complement,
    dombi_t,
    dombi_t_inverse,
    dombi_union,
    weighted_mean,
)


def test_complement_and_bounded_product() -> None:
    assert complement(0.3) == pytest.approx(0.7)
    assert bounded_product(0.6, 0.7) == pytest.approx(0.3)
    assert bounded_product(0.3, 0.7) == pytest.approx(0.0)
    assert bounded_product(0.1, 0.1) == 0.0
    # Associative: max(0, sum - (n - 1)).
    assert bounded_product(bounded_product(0.9, 0.8), 0.7) == pytest.approx(0.4)
    assert bounded_product(0.9, bounded_product(0.1, 1.0)) == pytest.approx(0.0)


@pytest.mark.parametrize("lam", [0.4, 1.0, 2.0])
def test_dombi_union_is_equation_18(lam: float) -> None:
    a, b = 0.25, 0.6
    by_hand = 1 / (1 + ((1 / a - 1) ** -lam + (1 / b - 1) ** -lam) ** (-1 / lam))
    assert dombi_union(a, b, lam) == pytest.approx(by_hand, abs=1e-15)


def test_dombi_union_of_the_paper_s_figure_grows_as_lambda_falls() -> None:
    # Fig. 21: 0.25 applied again and again, for several lambda.
    for lam, after_two in ((2.0, 0.3204), (1.0, 0.4), (0.5, 4 / 7)):
        assert dombi_union(0.25, 0.25, lam) == pytest.approx(after_two, abs=1e-4)


@pytest.mark.parametrize("lam", [0.05, 0.4, 1.0, 20.0])
def test_zero_is_neutral_to_the_last_bit_and_one_absorbs(lam: float) -> None:
    for u in np.random.default_rng(0).random(100).tolist():
        assert dombi_union(u, 0.0, lam) == u
        assert dombi_union(0.0, u, lam) == u
        assert dombi_union(u, 1.0, lam) == 1.0
    assert dombi_union(0.0, 0.0, lam) == 0.0


def test_dombi_t_and_its_inverse_reach_both_ends() -> None:
    assert [dombi_t(u, 0.4) for u in (0.0, 1.0)] == [0.0, math.inf]
    assert [dombi_t_inverse(s, 0.4) for s in (0.0, math.inf)] == [0.0, 1.0]
    for u in np.linspace(0.001, 0.999, 50).tolist():
        assert dombi_t(u, 0.4) == pytest.approx((u / (1 - u)) ** 0.4, rel=1e-13)
        assert dombi_t_inverse(dombi_t(u, 0.4), 0.4) == pytest.approx(u, rel=1e-13)


def test_weighted_mean_is_a_running_mean() -> None:
    values = [0.2, 0.9, 0.4, 0.4]
    mean = 0.0
    for n, value in enumerate(values, start=1):
        mean = float(weighted_mean(mean, value, n))
        assert mean == pytest.approx(sum(values[:n]) / n)
