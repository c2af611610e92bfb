# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""ReadingAssembler: raw ranges in, readings placed at their own stamp out.

A sensor says at which time it measured what range. Where it stood then is known when a
pose and, on a turret, a joint angle on either side of that time have arrived; until then
the range waits, and after a limit it is given up and counted.
"""

from __future__ import annotations

import heapq
import math

from fuzzy_map_building.params import MapperParameters, PerceptionParameters
from fuzzy_map_building.pose_buffer import AngleBuffer, PoseBuffer
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading

__all__ = ["ReadingAssembler"]

#: Ranges of a ring that may wait at a time; bounds the memory that a flood of messages can take.
_MAX_WAITING = 10_000


class ReadingAssembler:
    """Places the ranges of the ring of sonars and of the ring of infrared sensors.

    All times are of one clock [s]; `now` is what it shows at the call.

    Parameters
    ----------
    parameters : MapperParameters
        The rings, the turret and the limits of waiting.

    Attributes
    ----------
    poses : PoseBuffer
        Poses of the robot; its ``rejected`` counts those out of order.
    turret : AngleBuffer
        Angles of the turret; unused without one.
    rejected, infrared_rejected : dict of str to int
        Ranges of sonars and of infrareds given up, by reason: ``future``, ``duplicate``,
        ``out_of_order``, ``no_pose``, ``no_turret``, ``overflow``; and ``before_pose``,
        ``before_turret`` for those from before the first pose or angle was heard, as whoever
        joins a robot that runs hears some.
    examples, infrared_examples : dict of str to str
        The range given up last, in words, by reason.
    """

    def __init__(self, parameters: MapperParameters) -> None:
        p = parameters.perception
        horizon = p.pose_timeout + p.max_pose_gap + p.future_tolerance + 1.0
        self._limits = p
        self.poses = PoseBuffer(p.max_pose_gap, horizon)
        self.turret = AngleBuffer(p.max_pose_gap, horizon)
        turret = self.turret if parameters.turret.joint else None
        self._sonar = _Ring("sonar", parameters.sonar.bearings, turret, p)
        self._infrared = _Ring("infrared sensor", parameters.infrared.bearings, None, p)
        self.rejected = self._sonar.rejected
        self.infrared_rejected = self._infrared.rejected
        self.examples = self._sonar.examples
        self.infrared_examples = self._infrared.examples

    @property
    def waiting(self) -> int:
        """Number of ranges that wait for a pose or a turret angle."""
        return len(self._sonar) + len(self._infrared)

    def clear(self) -> None:
        """Forget poses, angles and waiting ranges, e.g. after the clock was set back."""
        self.poses.clear()
        self.turret.clear()
        self._sonar.clear()
        self._infrared.clear()

    def add_pose(self, stamp: float, pose: Pose2, now: float) -> bool:
        """Take a pose of the robot; False if it was refused (counted in ``poses``)."""
        if stamp - now > self._limits.future_tolerance:
            return self.poses.refuse("future", _ahead(stamp, now))
        return self.poses.add(stamp, pose)

    def add_turret(self, stamp: float, angle: float, now: float) -> bool:
        """Take an angle of the turret [rad]; False if refused (counted in ``turret``)."""
        if stamp - now > self._limits.future_tolerance:
            return self.turret.refuse("future", _ahead(stamp, now))
        return self.turret.add(stamp, angle)

    def add_range(self, sensor: int, stamp: float, value: float, now: float) -> bool:
        """Take a sonar's range.

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
        return self._sonar.add(sensor, stamp, value, now)

    def add_infrared(self, sensor: int, stamp: float, value: float, now: float) -> bool:
        """Take an infrared sensor's range: as `add_range`, counted in `infrared_rejected`."""
        return self._infrared.add(sensor, stamp, value, now)

    def release(self, now: float) -> list[SonarReading]:
        """Return the sonar readings whose place is known by now, in the order of their stamps."""
        return [SonarReading(*values) for values in self._sonar.release(now, self.poses)]

    def release_infrared(self, now: float) -> list[InfraredReading]:
        """Return the infrared readings whose place is known by now, as `release`."""
        return [InfraredReading(*values) for values in self._infrared.release(now, self.poses)]


class _Ring:
    """The ranges of one ring that wait for their place."""

    def __init__(
        self,
        kind: str,
        bearings: tuple[float, ...],
        turret: AngleBuffer | None,
        limits: PerceptionParameters,
    ) -> None:
        self._kind = kind
        self._bearings = bearings
        self._turret = turret
        self._limits = limits
        self._waiting: list[tuple[float, int, int, float]] = []
        self._arrivals = 0
        self._last: dict[int, float] = {}
        self.rejected: dict[str, int] = {}
        self.examples: dict[str, str] = {}

    def __len__(self) -> int:
        return len(self._waiting)

    def clear(self) -> None:
        self._waiting.clear()
        self._last.clear()

    def add(self, sensor: int, stamp: float, value: float, now: float) -> bool:
        if not 0 <= sensor < len(self._bearings):
            raise ValueError(
                f"there is no {self._kind} {sensor}: the ring has {self._kind}s 0 to "
                f"{len(self._bearings) - 1}"
            )
        if not math.isfinite(stamp):
            raise ValueError(
                f"the stamp of a range of {self._kind} {sensor} must be finite, got {stamp}"
            )
        if stamp - now > self._limits.future_tolerance:
            return self._reject("future", sensor, _ahead(stamp, now))
        last = self._last.get(sensor, -math.inf)
        if stamp <= last:
            reason = "duplicate" if stamp == last else "out_of_order"
            return self._reject(reason, sensor, f"stamped {stamp:.3f} s, after {last:.3f} s")
        if len(self._waiting) >= _MAX_WAITING:
            return self._reject("overflow", sensor, f"stamped {stamp:.3f} s")
        self._last[sensor] = stamp
        heapq.heappush(self._waiting, (stamp, self._arrivals, sensor, value))
        self._arrivals += 1
        return True

    def release(
        self, now: float, poses: PoseBuffer
    ) -> list[tuple[Pose2, float, float, float, int]]:
        """Return (pose, bearing, range, stamp, sensor) of what can be placed."""
        released: list[tuple[Pose2, float, float, float, int]] = []
        # Sensors that measured together share their place.
        last: float = math.nan
        pose: Pose2 | None = None
        angle: float | None = None
        while self._waiting:
            stamp, _, sensor, value = self._waiting[0]
            if stamp != last:
                last, pose = stamp, poses.at(stamp)
                angle = self._turret.at(stamp) if self._turret is not None else 0.0
            if pose is not None and angle is not None:
                released.append((pose, self._bearings[sensor] + angle, value, stamp, sensor))
            else:
                overdue = now - stamp > self._limits.pose_timeout
                if pose is None and poses.precedes(stamp):
                    self._reject("before_pose", sensor, _unplaced(stamp, now, poses.newest))
                elif angle is None and self._turret is not None and self._turret.precedes(stamp):
                    self._reject("before_turret", sensor, _unplaced(stamp, now, poses.newest))
                elif pose is None and (overdue or poses.missed(stamp)):
                    self._reject("no_pose", sensor, _unplaced(stamp, now, poses.newest))
                elif angle is None and (
                    overdue or (self._turret is not None and self._turret.missed(stamp))
                ):
                    newest = self._turret.newest if self._turret is not None else None
                    self._reject("no_turret", sensor, _unplaced(stamp, now, newest))
                else:
                    break  # whatever comes later waits for the same samples
            heapq.heappop(self._waiting)
        return released

    def _reject(self, reason: str, sensor: int, example: str) -> bool:
        self.rejected[reason] = self.rejected.get(reason, 0) + 1
        self.examples[reason] = f"{self._kind} {sensor} {example}"
        return False


def _ahead(stamp: float, now: float) -> str:
    return f"stamped {stamp:.3f} s, {stamp - now:.3f} s ahead of the clock"


def _unplaced(stamp: float, now: float, newest: float | None) -> str:
    came = "none has come" if newest is None else f"the newest of them at {newest:.3f} s"
    return f"stamped {stamp:.3f} s, the clock being at {now:.3f} s, {came}"
