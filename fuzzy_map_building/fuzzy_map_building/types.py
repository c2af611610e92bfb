# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Frozen values that cross module borders: poses and range readings.

They come by the hundred at each tick of the control. The constructors that dataclasses write
for frozen values take twice as long as these, which write to the slots of the fields directly.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

__all__ = ["InfraredReading", "Pose2", "RangeReading", "SonarReading", "wrap_angle"]


def wrap_angle(angle: float) -> float:
    """Return `angle` [rad] brought into [-pi, pi)."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def _slot(kind: type, name: str) -> Callable[[Any, object], None]:
    """Return what writes a field of a new value of a kind."""
    write: Callable[[Any, object], None] = kind.__dict__[name].__set__
    return write


@dataclass(frozen=True, init=False, slots=True)
class Pose2:
    """Position and heading in the plane.

    Parameters
    ----------
    x, y : float
        Position in the frame ``map`` [m].
    theta : float
        Heading [rad], counter-clockwise from the x axis.

    Raises
    ------
    ValueError
        If a value is no finite number.
    """

    x: float
    y: float
    theta: float

    def __init__(self, x: float, y: float, theta: float = 0.0) -> None:
        _write_x(self, x)
        _write_y(self, y)
        _write_theta(self, theta)
        try:
            if math.isfinite(x) and math.isfinite(y) and math.isfinite(theta):
                return
        except (TypeError, ValueError, OverflowError):
            pass  # no numbers: said below
        raise _not_finite(self, ("x", "y", "theta"))

    def distance_to(self, x: float, y: float) -> float:
        """Return the distance [m] from this position to (x, y) [m]."""
        return math.hypot(x - self.x, y - self.y)


_write_x, _write_y, _write_theta = (_slot(Pose2, name) for name in ("x", "y", "theta"))


def _is_number(value: object) -> bool:
    return hasattr(value, "__float__") and not isinstance(value, (str, bytes))


def _not_finite(owner: object, names: Sequence[str]) -> ValueError:
    """Return the error of the first of the fields that is no finite number; one has to be."""
    for name in names:
        value, finite = getattr(owner, name), False
        with contextlib.suppress(TypeError, ValueError, OverflowError):
            finite = math.isfinite(value)
        if not finite:
            what = "finite" if isinstance(value, float) else "a finite number"
            return ValueError(f"{type(owner).__name__}.{name} must be {what}, got {value!r}")
    raise AssertionError("all are finite")


@dataclass(frozen=True, init=False, slots=True)
class RangeReading:
    """One range measurement, placed at the pose the robot had at its stamp.

    Parameters
    ----------
    pose : Pose2
        Pose of the robot's centre in ``map`` when the reading was taken.
    bearing : float
        Direction of the sensor's axis [rad] from the robot's heading,
        the angle of the turret included.
    range : float
        Distance [m] from the sensor's face. REP 117: ``+inf`` no echo, ``-inf`` an
        object closer than the sensor can measure, ``nan`` a faulty measurement.
    stamp : float
        Time of the reading [s].
    sensor : int
        Index of the sensor in its ring, -1 when unknown.

    Raises
    ------
    ValueError
        If `pose` is no pose, `range` no number, or `bearing` or `stamp` no finite number.
    """

    pose: Pose2
    bearing: float
    range: float
    stamp: float
    sensor: int

    def __init__(
        self, pose: Pose2, bearing: float, range: float, stamp: float = 0.0, sensor: int = -1
    ) -> None:
        _write_pose(self, pose)
        _write_bearing(self, bearing)
        _write_range(self, range)
        _write_stamp(self, stamp)
        _write_sensor(self, sensor)
        if not isinstance(pose, Pose2):
            raise ValueError(f"{type(self).__name__}.pose must be a Pose2, got {pose!r}")
        if type(range) is not float and not _is_number(range):
            raise ValueError(f"{type(self).__name__}.range must be a number, got {range!r}")
        try:
            if math.isfinite(bearing) and math.isfinite(stamp):
                return
        except (TypeError, ValueError, OverflowError):
            pass  # no numbers: said below
        raise _not_finite(self, ("bearing", "stamp"))


_write_pose, _write_bearing, _write_range, _write_stamp, _write_sensor = (
    _slot(RangeReading, name) for name in ("pose", "bearing", "range", "stamp", "sensor")
)


class SonarReading(RangeReading):
    """A sonar's reading: the nearest surface somewhere inside a wide cone."""

    __slots__ = ()


@dataclass(frozen=True, init=False, slots=True)
class InfraredReading(RangeReading):
    """An infrared proximity sensor's reading: a narrow ray.

    Parameters
    ----------
    pose, bearing, range, stamp, sensor
        See `RangeReading`.
    limit : float
        Distance [m] from the sensor's face beyond which the ray is not believed to be free,
        ``inf`` for no limit; it may be negative.

    Raises
    ------
    ValueError
        As `RangeReading`, or if `limit` is NaN.
    """

    limit: float

    def __init__(
        self,
        pose: Pose2,
        bearing: float,
        range: float,
        stamp: float = 0.0,
        sensor: int = -1,
        limit: float = math.inf,
    ) -> None:
        RangeReading.__init__(self, pose, bearing, range, stamp, sensor)
        _write_limit(self, limit)
        if limit != limit:
            raise ValueError("InfraredReading.limit must be a number, got nan")


_write_limit = _slot(InfraredReading, "limit")
