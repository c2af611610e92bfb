# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""When the control may act: a pose, and what each infrared sensor saw there.

Poses and ranges come one by one, in any order. A tick is due as soon as every sensor has
delivered a reading of the pose's stamp or a newer one; at the latest when the next pose
comes or a silence says that nothing will, for a sensor that fell silent must not silence the
robot's control.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fuzzy_map_building.pose_buffer import PoseBuffer
from fuzzy_map_building.types import InfraredReading, Pose2

__all__ = ["ControlTicks", "Tick", "Untimely"]

#: A stamp farther ahead of the clock than this [s] is refused.
FUTURE_TOLERANCE = 0.5
#: A clock that shows less than before by more than this [s] was set back.
CLOCK_SLACK = 0.5
#: Without a tick for so long [s of wall time] whoever acts on ticks has to let time pass.
SILENCE = 0.2
#: Poses farther apart than this [s] are not joined by interpolation.
MAX_POSE_GAP = 0.5
#: Poses older than this [s] are forgotten; after a silence of this length older stamps are taken
#: for those of a source that was started anew.
HORIZON = 2.0


class Untimely(ValueError):
    """A pose or a range whose stamp cannot be.

    Attributes
    ----------
    reason : str
        ``future``, ``late``, ``duplicate`` or ``out_of_order``.
    """

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(message)
        self.reason = reason


@dataclass(frozen=True)
class Tick:
    """One step of the control.

    Parameters
    ----------
    stamp : float
        Stamp of the pose [s].
    pose : Pose2
        Where the robot was then.
    readings : tuple of InfraredReading
        What came from the sensors since the last tick, the newest of each.
    complete : bool
        Whether every sensor had delivered a reading of the pose's stamp or a newer one.
    """

    stamp: float
    pose: Pose2
    readings: tuple[InfraredReading, ...]
    complete: bool


class ControlTicks:
    """Joins poses and infrared ranges to ticks.

    Parameters
    ----------
    bearings : sequence of float
        Direction of each sensor from the robot's heading [rad].
    max_age : float
        A pose that comes later than this after its stamp [s] is refused: the robot is elsewhere.

    Examples
    --------
    >>> ticks = ControlTicks([0.0])
    >>> ticks.on_pose(5.0, 5.0, Pose2(1.0, 2.0, 0.0)) is None
    True
    >>> ticks.on_range(5.0, 0, 5.0, 0.4).stamp
    5.0
    """

    def __init__(self, bearings: Sequence[float], max_age: float = math.inf) -> None:
        self.max_age = max_age
        self._bearings = tuple(bearings)
        self._poses = PoseBuffer(MAX_POSE_GAP, HORIZON)
        self._pose_came = 0.0
        self._pending: tuple[float, Pose2] | None = None
        # Newest (stamp, range) of each sensor, when it came, and which no tick has brought yet.
        self._newest: dict[int, tuple[float, float]] = {}
        self._range_came: dict[int, float] = {}
        self._unused: set[int] = set()

    def on_pose(self, now: float, stamp: float, pose: Pose2) -> Tick | None:
        """Take a pose and return the tick that is due, if one is.

        Parameters
        ----------
        now : float
            Time of the clock [s]; infinite when it is not known yet.
        stamp : float
            When the robot was there [s].
        pose : Pose2
            Where it was.

        Raises
        ------
        Untimely
            If the stamp lies in the future or too long ago, or is not after the pose before,
            unless the clock was set back or poses begin anew: then everything older is forgotten.
        """
        if stamp > now + FUTURE_TOLERANCE:
            raise _early(now, stamp, "pose")
        if self.max_age < now - stamp < math.inf:
            raise Untimely(
                "late",
                f"pose is stamped {stamp:.3f} s, {now - stamp:.3f} s behind the clock, more than "
                f"{self.max_age:g} s: synchronise the clocks (is use_sim_time set alike?), or "
                "find what delays it",
            )
        newest = self._poses.newest
        if newest is not None and stamp <= newest:
            if not _begins_anew(now, self._pose_came):
                raise _late(stamp, newest, "pose")
            self._forget()
        self._poses.add(stamp, pose)
        self._pose_came = now
        waiting, self._pending = self._pending, (stamp, pose)
        # A sensor that has not reached the pose before has not reached this one either.
        return self._due() if waiting is None else self._release(*waiting, complete=False)

    def on_range(self, now: float, sensor: int, stamp: float, distance: float) -> Tick | None:
        """Take a sensor's range and return the tick that is due, if one is.

        Parameters
        ----------
        now : float
            Time of the clock [s]; infinite when it is not known yet.
        sensor : int
            Index of the sensor in the ring.
        stamp : float
            When it measured [s].
        distance : float
            Range [m], REP 117.

        Raises
        ------
        Untimely
            If the stamp lies in the future, or is not after the sensor's last, unless the
            clock was set back or the sensor begins anew.
        ValueError
            If the ring has no such sensor.
        """
        if not 0 <= sensor < len(self._bearings):
            raise ValueError(
                f"the ring has infrared sensors 0 to {len(self._bearings) - 1}, got {sensor}"
            )
        if stamp > now + FUTURE_TOLERANCE:
            raise _early(now, stamp, _range_of(sensor))
        before = self._newest.get(sensor)
        late = before is not None and stamp <= before[0]
        if late and not _begins_anew(now, self._range_came[sensor]):
            raise _late(stamp, self._newest[sensor][0], _range_of(sensor))
        self._newest[sensor] = (stamp, distance)
        self._range_came[sensor] = now
        self._unused.add(sensor)
        return self._due() if self._pending is not None else None

    def overdue(self) -> Tick | None:
        """Return the tick of a pose that waits for ranges, if one does: it waits no longer."""
        waiting, self._pending = self._pending, None
        return None if waiting is None else self._release(*waiting, complete=False)

    def _due(self) -> Tick | None:
        if self._pending is None or len(self._newest) < len(self._bearings):
            return None
        stamp, pose = self._pending
        if any(measured < stamp for measured, _ in self._newest.values()):
            return None
        self._pending = None
        return self._release(stamp, pose, complete=True)

    def _release(self, stamp: float, pose: Pose2, complete: bool) -> Tick:
        readings = []
        # Sensors that measured together share their place.
        last: float = math.nan
        place: Pose2 | None = None
        for sensor in sorted(self._unused):
            measured, distance = self._newest[sensor]
            if measured != last:
                last, place = measured, self._poses.at(measured)
                if place is None and measured > stamp:
                    place = pose  # measured since: the robot has hardly moved
            if place is not None:
                readings.append(
                    InfraredReading(place, self._bearings[sensor], distance, measured, sensor)
                )
        self._unused.clear()
        return Tick(stamp, pose, tuple(readings), complete)

    def _forget(self) -> None:
        self._poses.clear()
        self._pending = None
        self._newest.clear()
        self._unused.clear()


def _begins_anew(now: float, before: float) -> bool:
    """Whether older stamps are to be expected: after a silence, or on a clock set back."""
    return now - before > HORIZON or now - before < -CLOCK_SLACK


def _range_of(sensor: int) -> str:
    return f"range of infrared sensor {sensor}"


def _early(now: float, stamp: float, what: str) -> Untimely:
    return Untimely(
        "future",
        f"{what} is stamped {stamp:.3f} s, {stamp - now:.3f} s ahead of the clock: "
        "synchronise the clocks; is use_sim_time set alike?",
    )


def _late(stamp: float, newest: float, what: str) -> Untimely:
    if stamp == newest:
        return Untimely(
            "duplicate",
            f"{what} of {stamp:.3f} s came twice: are there two publishers, or does one repeat "
            "its stamps?",
        )
    return Untimely(
        "out_of_order",
        f"{what} of {stamp:.3f} s came after that of {newest:.3f} s: are there two publishers?",
    )
