# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Axioms that the operators on fuzzy sets keep for any memberships."""

import math

from hypothesis import example, given
from hypothesis import strategies as st

from fuzzy_map_building.fuzzy_sets import bounded_product, complement, dombi_union

MEMBERSHIP = st.floats(0.0, 1.0)
LAMBDA = st.floats(0.05, 20.0)
CLOSE = 1e-9


def near(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=CLOSE, abs_tol=CLOSE)


@given(MEMBERSHIP, MEMBERSHIP, MEMBERSHIP)
def test_bounded_product_is_a_t_norm(a: float, b: float, c: float) -> None:
    product = float(bounded_product(a, b))
    assert 0.0 <= product <= min(a, b) + CLOSE
    assert product == float(bounded_product(b, a))
    assert near(float(bounded_product(a, 1.0)), a)
    assert float(bounded_product(a, 0.0)) == 0.0
    assert near(
        float(bounded_product(bounded_product(a, b), c)),
        float(bounded_product(a, bounded_product(b, c))),
    )
    if b <= c:
        assert product <= float(bounded_product(a, c)) + CLOSE


@given(MEMBERSHIP, MEMBERSHIP, MEMBERSHIP, LAMBDA)
@example(5e-324, 1.0, 0.5, 0.05)
@example(0.0, 0.0, 0.0, 20.0)
@example(1.0, 1.0, 1.0, 0.4)
@example(math.nextafter(1.0, 0.0), 1e-300, 0.5, 0.05)
def test_dombi_union_is_a_t_conorm(a: float, b: float, c: float, lam: float) -> None:
    union = float(dombi_union(a, b, lam))
    assert max(a, b) - CLOSE <= union <= 1.0
    assert union == float(dombi_union(b, a, lam))
    assert float(dombi_union(a, 0.0, lam)) == a
    assert float(dombi_union(a, 1.0, lam)) == 1.0
    assert near(
        float(dombi_union(dombi_union(a, b, lam), c, lam)),
        float(dombi_union(a, dombi_union(b, c, lam), lam)),
    )
    if b <= c:
        assert union <= float(dombi_union(a, c, lam)) + CLOSE


@given(MEMBERSHIP, MEMBERSHIP, st.floats(0.1, 5.0), st.floats(1.0, 3.0))
def test_the_dombi_union_grows_as_lambda_falls(
    a: float, b: float, lam: float, factor: float
) -> None:
    weaker = float(dombi_union(a, b, lam * factor))
    assert float(dombi_union(a, b, lam)) >= weaker - CLOSE


@given(MEMBERSHIP)
def test_the_complement_is_an_involution(a: float) -> None:
    assert near(float(complement(complement(a))), a)
