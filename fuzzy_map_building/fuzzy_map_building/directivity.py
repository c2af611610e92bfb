# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The radiation directivity of a sonar's transducer, equation (1): closed form and table."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy_map_building.jit import njit
from fuzzy_map_building.sensor_params import SonarParameters

__all__ = ["Lobe", "directivity", "lobe_at"]

FloatArray = NDArray[np.float64]

#: First positive zero of the Bessel function J1: the border of the main lobe, in z.
_FIRST_ZERO = 3.831705970207512
#: Terms of the power series of 2 J1(z)/z; at the first zero the next one is below 1e-20.
_SERIES = tuple(
    (-1.0) ** k / (math.factorial(k) * math.factorial(k + 1)) for k in reversed(range(18))
)
#: Pieces of the table, each a parabola. For the widest lobe the error stays below 2e-11, the
#: third derivative of the series, 1/24, times the cube of a piece's width over 124.
_PIECES = 1024


def _lobe(quarter_z_squared: FloatArray) -> FloatArray:
    """Return ``2 J1(z)/z`` for ``z <= 3.83`` from ``(z/2)^2``, exact to rounding."""
    out = np.full_like(quarter_z_squared, _SERIES[0])
    for coefficient in _SERIES[1:]:
        out *= quarter_z_squared
        out += coefficient
    return out


def directivity(theta: ArrayLike, sonar: SonarParameters | None = None) -> FloatArray:
    """Return the radiation directivity of the transducer in its main lobe, equation (1).

    Parameters
    ----------
    theta : array_like
        Angle from the axis [rad].
    sonar : SonarParameters, optional
        Gives piston radius, frequency and speed of sound.

    Returns
    -------
    ndarray of float64
        D in [0, 1]; 0 beyond the main lobe.

    Examples
    --------
    >>> [round(float(directivity(math.radians(t))), 3) for t in (0.0, 7.5, 11.25, 12.5)]
    [1.0, 0.48, 0.108, 0.015]
    """
    angle = np.abs(np.asarray(theta, dtype=np.float64))
    z = _wave_number_radius(sonar or SonarParameters()) * np.sin(angle)
    inside = (z < _FIRST_ZERO) & (angle < 0.5 * math.pi)
    return np.where(inside, _lobe(np.where(inside, 0.5 * z, 0.0) ** 2), 0.0)


def _wave_number_radius(sonar: SonarParameters) -> float:
    """Return the factor of sin(theta) in z, equation (1)."""
    return 2.0 * math.pi * sonar.frequency / sonar.speed_of_sound * sonar.piston_radius


@dataclass(frozen=True, eq=False)
class Lobe:
    """The cone of a sonar and a table of D within it.

    Attributes
    ----------
    half_angle : float
        Half of the cone's angle [rad]: the parameter's, but no more than the main lobe's.
    table : ndarray of float64, shape (3 pieces,)
        Parabolas over the square of sin(theta), for `lobe_at`.
    fineness : float
        Pieces of the table to a unit of the square of sin(theta).
    """

    half_angle: float
    table: FloatArray
    fineness: float

    @classmethod
    def of(cls, sonar: SonarParameters) -> Lobe:
        """Return the lobe of a sonar."""
        factor = _wave_number_radius(sonar)
        # m(theta) is D within the cone, and only the main lobe of D is used (section III-A).
        main = math.asin(_FIRST_ZERO / factor) if factor > _FIRST_ZERO else 0.5 * math.pi
        half = min(0.5 * sonar.field_of_view, main)
        # A little more than the cone, so that its border lies inside the last piece.
        width = math.sin(half) ** 2 * (1.0 + 1e-9) / _PIECES
        ends: FloatArray = (0.5 * factor) ** 2 * width / 2.0 * np.arange(2.0 * _PIECES + 1.0)
        value = _lobe(ends)
        first, middle, last = value[:-1:2], value[1::2], value[2::2]
        table = np.column_stack(
            (first, 4.0 * middle - 3.0 * first - last, 2.0 * (first + last) - 4.0 * middle)
        )
        return cls(half, table.reshape(-1), 1.0 / width)


@njit
def lobe_at(table: FloatArray, fineness: float, sine_squared: float) -> float:
    """Return D from the table and fineness of a `Lobe`, for an angle within its cone."""
    place = sine_squared * fineness
    piece = int(place)
    part = place - piece
    piece *= 3
    value: float = table[piece] + part * (table[piece + 1] + part * table[piece + 2])
    return value
