# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Operators on fuzzy sets: memberships in, a membership out; kernels for loops over cells.

Equation numbers are those of Oriolo, Ulivi and Vendittelli (1998), appendix. No
operator checks its arguments; memberships lie in [0, 1] by the checks at the border.
"""

from __future__ import annotations

import math

from fuzzy_map_building.jit import njit

__all__ = [
    "bounded_product",
    "complement",
    "dombi_t",
    "dombi_t_inverse",
    "dombi_union",
    "weighted_mean",
]

#: Logarithm beyond which a power is taken for infinite: e^709 is the largest that a float holds.
_LARGEST = 709.0


@njit
def complement(a: float) -> float:
    """Return the complement ``1 - a``, equation (16)."""
    return 1.0 - a


@njit
def bounded_product(a: float, b: float) -> float:
    """Return the intersection ``max(0, a + b - 1)``, equation (17); it is associative."""
    rest = a + b - 1.0
    return rest if rest > 0.0 else 0.0


@njit
def dombi_t(u: float, lam: float) -> float:
    """Return ``(u / (1 - u))^lam``, which turns the Dombi union into a sum; inf for 1."""
    if u <= 0.0:
        return 0.0
    if u >= 1.0:
        return math.inf
    power = lam * math.log(u / (1.0 - u))
    return math.exp(power) if power < _LARGEST else math.inf


@njit
def dombi_t_inverse(total: float, lam: float) -> float:
    """Return the membership whose `dombi_t` is `total` in [0, inf]."""
    if total <= 0.0:
        return 0.0
    # As s^(-1/lam) and not s^(1/lam): inf / inf is avoided where the sum is large.
    power = -math.log(total) / lam
    return 1.0 / (1.0 + math.exp(power)) if power < _LARGEST else 0.0


@njit
def dombi_union(u: float, v: float, lam: float) -> float:
    """Return the union of Dombi, equation (18).

    Parameters
    ----------
    u, v : float
        Memberships in [0, 1].
    lam : float
        lambda > 0; the smaller, the larger the union.

    Returns
    -------
    float
        Commutative and associative; ``u`` with 0 is ``u`` exactly, with 1 it is 1.

    Examples
    --------
    >>> round(dombi_union(0.5, 0.5, 1.0), 12)
    0.666666666667
    """
    # The neutral element is kept to the last bit: no rounding where nothing is added.
    if v == 0.0:
        return u
    if u == 0.0:
        return v
    return dombi_t_inverse(dombi_t(u, lam) + dombi_t(v, lam), lam)


@njit
def weighted_mean(mean: float, value: float, count: int) -> float:
    """Return ``((count - 1) mean + value) / count``, equations (8) and (9).

    Parameters
    ----------
    mean : float
        Mean of the values before.
    value : float
        The new value.
    count : int
        Number of values, the new one included, at least 1.
    """
    return ((count - 1.0) * mean + value) / count
