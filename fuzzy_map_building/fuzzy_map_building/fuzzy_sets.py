# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Operators on fuzzy sets: arrays of memberships in, arrays of memberships out.

Equation numbers are those of Oriolo, Ulivi and Vendittelli (1998), appendix. No
operator checks its arguments; memberships lie in [0, 1] by the checks at the border.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "bounded_product",
    "complement",
    "dombi_t",
    "dombi_t_inverse",
    "dombi_union",
    "weighted_mean",
]

FloatArray = NDArray[np.float64]


def complement(a: ArrayLike) -> FloatArray:
    """Return the complement ``1 - a``, equation (16)."""
    return 1.0 - np.asarray(a, dtype=np.float64)


def bounded_product(*sets: ArrayLike) -> FloatArray:
    """Return the intersection ``max(0, a + b - 1)`` of two or more sets, equation (17).

    It is associative: n sets give ``max(0, sum - (n - 1))``.
    """
    total = np.asarray(sets[0], dtype=np.float64)
    for other in sets[1:]:
        total = np.maximum(0.0, total + np.asarray(other, dtype=np.float64) - 1.0)
    return total


def dombi_t(a: ArrayLike, lam: float) -> FloatArray:
    """Return ``(a / (1 - a))^lam``, which turns the Dombi union into a sum; inf for 1."""
    u = np.asarray(a, dtype=np.float64)
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        out: FloatArray = (u / (1.0 - u)) ** lam
    return out


def dombi_t_inverse(total: ArrayLike, lam: float) -> FloatArray:
    """Return the membership whose `dombi_t` is `total` in [0, inf]."""
    s = np.asarray(total, dtype=np.float64)
    # As s^(-1/lam) and not s^(1/lam): inf / inf is avoided where the sum is large.
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        out: FloatArray = 1.0 / (1.0 + s ** (-1.0 / lam))
    return out


def dombi_union(a: ArrayLike, b: ArrayLike, lam: float) -> FloatArray:
    """Return the union of Dombi, equation (18).

    Parameters
    ----------
    a, b : array_like
        Memberships in [0, 1], of shapes that broadcast.
    lam : float
        lambda > 0; the smaller, the larger the union.

    Returns
    -------
    ndarray of float64
        Commutative and associative; ``u`` with 0 is ``u`` exactly, with 1 it is 1.

    Examples
    --------
    >>> float(dombi_union(0.5, 0.5, 1.0))
    0.6666666666666666
    """
    u = np.asarray(a, dtype=np.float64)
    v = np.asarray(b, dtype=np.float64)
    union = dombi_t_inverse(dombi_t(u, lam) + dombi_t(v, lam), lam)
    # The neutral element is kept to the last bit: no rounding where nothing is added.
    out: FloatArray = np.where(v == 0.0, u, np.where(u == 0.0, v, union))
    return out


def weighted_mean(mean: ArrayLike, value: ArrayLike, count: ArrayLike) -> FloatArray:
    """Return ``((count - 1) mean + value) / count``, equations (8) and (9).

    Parameters
    ----------
    mean : array_like
        Mean of the values before.
    value : array_like
        The new value.
    count : array_like
        Number of values, the new one included, at least 1.
    """
    n = np.asarray(count, dtype=np.float64)
    m = np.asarray(mean, dtype=np.float64)
    out: FloatArray = ((n - 1.0) * m + np.asarray(value, dtype=np.float64)) / n
    return out
