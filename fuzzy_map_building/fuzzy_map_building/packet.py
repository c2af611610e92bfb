# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""ReadingAssembler: raw ranges in, readings placed at their own stamp out.

A sonar says at which time it measured what range. Where it stood then is known when a
pose and, with a turret, a joint angle on either side of that time have arrived; until
then the range waits, and after a limit it is given up and counted.
"""

from __future__ import annotations

import heapq
import math

from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.pose_buffer import AngleBuffer, PoseBuffer
from fuzzy_map_building.types import Pose2, SonarReading

__all__ = ["ReadingAssembler"]

#: Ranges that may wait at a time; bounds the memory that a flood of messages can take.
_MAX_WAITING = 10_000


class ReadingAssembler:
    """Places the ranges of a ring of sonars.

    All times are of one clock [s]; `now` is what it shows at the call.

    Parameters
    ----------
    parameters : MapperParameters
        The ring, the turret and the limits of waiting.

    Attributes
    ----------
    poses : PoseBuffer
        Poses of the robot; its ``rejected`` counts those out of order.
    turret : AngleBuffer
        Angles of the turret; unused without one.
    rejected : dict of str to int
        Ranges given up, by reason: ``future``, ``duplicate``, ``out_of_order``,
        ``no_pose``, ``no_turret``, ``overflow``.
    """

    def __init__(self, parameters: MapperParameters) -> None:
        p = parameters.perception
        horizon = p.pose_timeout + p.max_pose_gap + p.future_tolerance + 1.0
        self._bearings = parameters.sonar.bearings
        self._has_turret = parameters.turret.joint != ""
        self._limits = p
        self._waiting: list[tuple[float, int, int, float]] = []
        self._arrivals = 0
        self._last: dict[int, float] = {}
        self.poses = PoseBuffer(p.max_pose_gap, horizon)
        self.turret = AngleBuffer(p.max_pose_gap, horizon)
        self.rejected: dict[str, int] = {}

    @property
    def waiting(self) -> int:
        """Number of ranges that wait for a pose or a turret angle."""
        return len(self._waiting)

    def clear(self) -> None:
        """Forget poses, angles and waiting ranges, e.g. after the clock was set back."""
        self.poses.clear()
        self.turret.clear()
        self._waiting.clear()
        self._last.clear()

    def add_pose(self, stamp: float, pose: Pose2, now: float) -> bool:
        """Take a pose of the robot; False if it was refused (counted in ``poses``)."""
        return self._in_time(stamp, now, self.poses.rejected) and self.poses.add(stamp, pose)

    def add_turret(self, stamp: float, angle: float, now: float) -> bool:
        """Take an angle of the turret [rad]; False if refused (counted in ``turret``)."""
        return self._in_time(stamp, now, self.turret.rejected) and self.turret.add(stamp, angle)

    def add_range(self, sensor: int, stamp: float, value: float, now: float) -> bool:
        """Take a range.

        Parameters
        ----------
        sensor : int
            Index of the sonar in the ring.
        stamp : float
            Time of the measurement [s].
        value : float
            The range [m] as measured, REP 117; it is judged by the sensor model.
        now : float
            Present time [s].

        Returns
        -------
        bool
            False if it was refused, which is counted in `rejected`.

        Raises
        ------
        ValueError
            If there is no such sonar or the stamp is not finite.
        """
        if not 0 <= sensor < len(self._bearings):
            raise ValueError(
                f"there is no sonar {sensor}: the ring has sonars 0 to {len(self._bearings) - 1}"
            )
        if not math.isfinite(stamp):
            raise ValueError(f"the stamp of a range of sonar {sensor} must be finite, got {stamp}")
        if not self._in_time(stamp, now, self.rejected):
            return False
        last = self._last.get(sensor, -math.inf)
        if stamp <= last:
            return self._reject("duplicate" if stamp == last else "out_of_order")
        if len(self._waiting) >= _MAX_WAITING:
            return self._reject("overflow")
        self._last[sensor] = stamp
        heapq.heappush(self._waiting, (stamp, self._arrivals, sensor, value))
        self._arrivals += 1
        return True

    def release(self, now: float) -> list[SonarReading]:
        """Return the readings whose place is known by now, in the order of their stamps."""
        released: list[SonarReading] = []
        while self._waiting:
            stamp, _, sensor, value = self._waiting[0]
            pose = self.poses.at(stamp)
            angle = self.turret.at(stamp) if self._has_turret else 0.0
            if pose is not None and angle is not None:
                bearing = self._bearings[sensor] + angle
                released.append(SonarReading(pose, bearing, value, stamp, sensor))
            else:
                overdue = now - stamp > self._limits.pose_timeout
                if pose is None and (overdue or self.poses.missed(stamp)):
                    self._reject("no_pose")
                elif angle is None and (overdue or self.turret.missed(stamp)):
                    self._reject("no_turret")
                else:
                    break  # whatever comes later waits for the same samples
            heapq.heappop(self._waiting)
        return released

    def _in_time(self, stamp: float, now: float, counts: dict[str, int]) -> bool:
        if stamp - now > self._limits.future_tolerance:
            counts["future"] = counts.get("future", 0) + 1
            return False
        return True

    def _reject(self, reason: str) -> bool:
        self.rejected[reason] = self.rejected.get(reason, 0) + 1
        return False
