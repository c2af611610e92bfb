# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Positions that requests name, checked."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.types import Pose2

__all__ = ["position", "positions"]


def position(value: Pose2 | tuple[float, float], name: str) -> tuple[float, float]:
    """Return a position (x, y) [m].

    Parameters
    ----------
    value : Pose2 or tuple of float
        The position.
    name : str
        What to call it in messages.

    Raises
    ------
    ValueError
        If it is none, or not finite.
    """
    try:
        x, y = (value.x, value.y) if isinstance(value, Pose2) else value
        finite = math.isfinite(x) and math.isfinite(y)
    except (TypeError, ValueError):
        raise ValueError(f"the {name} must be a position (x, y) [m], got {value!r}") from None
    if not finite:
        raise ValueError(f"the {name} must be finite [m], got ({x}, {y})")
    return float(x), float(y)


def positions(values: ArrayLike, name: str, most: int) -> NDArray[np.float64]:
    """Return positions as an array of shape (n, 2) [m].

    Parameters
    ----------
    values : array_like, shape (n, 2)
        Positions (x, y) [m].
    name : str
        What to call them in messages.
    most : int
        Largest number of them.

    Raises
    ------
    ValueError
        If they have another shape, are too many, or one is not finite.
    """
    xy = np.asarray(values, dtype=np.float64)
    if xy.size == 0:
        return np.empty((0, 2))
    if xy.ndim != 2 or xy.shape[1] != 2:
        raise ValueError(f"{name} positions have the shape (any, 2), got {xy.shape}")
    if len(xy) > most:
        raise ValueError(f"{name} positions may be {most} at most, got {len(xy)}")
    if not np.isfinite(xy).all():
        raise ValueError(f"{name} positions must be finite [m]")
    return xy
