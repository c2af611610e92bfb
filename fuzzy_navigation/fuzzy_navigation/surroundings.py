# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Everything that the robot's sensors tell of what is close to it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.sonar_guard import guard_points, rim_points
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation.clearance import InfraredRing, clearance_at, hit_points
from fuzzy_navigation.earlier_hits import EarlierHits
from fuzzy_navigation.echo_loss import WINDOW, EchoLoss
from fuzzy_navigation.heard_echoes import HeardEchoes
from fuzzy_navigation.hearing_watch import HearingWatch
from fuzzy_navigation.hit_memory import HitMemory
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.ring_watch import RingWatch

__all__ = ["Surroundings"]

Points = NDArray[np.float64]

#: Remembered points farther from the robot than this did not stop it [m].
NEAR = 0.5
#: Stops in a row without progress after which points whose distance is a guess are remembered.
GUESSES_BELIEVED = 2
#: Infrareds of one perception that tell now of this, now of that, from which on there is a doubt.
UNSTEADY = 3

#: Sensors that are named one by one; of more the others are counted.
NAMED = 4

_Phase = Enum("_Phase", ["IDLE", "STANDING", "MOVING"])


class Surroundings:
    """The newest readings of the rings, and with the clearance layer or the guard a memory.

    Parameters
    ----------
    parameters : MotionParameters
        Rings, layer and guard.
    """

    def __init__(self, parameters: MotionParameters) -> None:
        self._p = parameters
        self._ring = InfraredRing(parameters.infrared)
        self._memory = HitMemory(parameters.infrared)
        self._echoes: dict[int, SonarReading] = {}
        self._heard = HeardEchoes(parameters.sonar.mount_radius)
        self._earlier, self._place = EarlierHits(), Pose2(0.0, 0.0)
        self._phase = _Phase.IDLE
        near, far = parameters.infrared, parameters.sonar
        self._hearing = HearingWatch(far)
        self._loss = EchoLoss(far)
        self._both = tuple(RingWatch(r.frame_ids, r.min_range, r.max_range) for r in (near, far))

    def adopt(self, parameters: MotionParameters) -> None:
        """Go by other parameters of the same sensors; what they told stays."""
        self._p = parameters
        for memory in (self._ring, self._memory):
            memory.adopt(parameters.infrared)
        self._heard.adopt(parameters.sonar.mount_radius)
        near, far = parameters.infrared, parameters.sonar
        self._hearing.adopt(far)
        self._loss.adopt(far)
        if not parameters.sonar_guard.enabled:
            # What they did when they were last heard must not hold for ever.
            self._hearing.clear()
            self._loss.clear()
        self._both[0].adopt(near.min_range, near.max_range)
        self._both[1].adopt(far.min_range, far.max_range)

    @property
    def _watches(self) -> Sequence[RingWatch]:
        """Those of the rings that guard the robot."""
        return self._both if self._p.sonar_guard.enabled else self._both[:1]

    def clear(self) -> None:
        """Forget all readings."""
        self._ring.clear()
        self._memory.forget()
        self._echoes.clear()
        self._heard.forget()
        self._earlier.forget()
        self._hearing.clear()
        self._loss.clear()
        for watch in self._both:
            watch.clear()

    def update(
        self,
        now: float,
        pose: Pose2,
        infrared: Sequence[InfraredReading],
        sonar: Sequence[SonarReading],
    ) -> None:
        """Take what the sensors saw.

        Parameters
        ----------
        now : float
            Time [s].
        pose : Pose2
            Where the robot is.
        infrared : sequence of InfraredReading
            New readings of the ring.
        sonar : sequence of SonarReading
            New readings of the sonars; they count with the guard alone.

        Raises
        ------
        ValueError
            If an infrared's sensor is not one of the ring's; then nothing is taken.
        """
        self._ring.update(infrared)
        self._place = pose
        for watch, readings in zip(self._watches, (infrared, sonar), strict=False):
            watch.update(readings)
        layer, guard = self._p.layer, self._p.sonar_guard
        if guard.enabled:
            self._hearing.update(sonar)
            self._loss.update(sonar)
        if self._phase is _Phase.STANDING and (layer.enabled or guard.enabled):
            self._memory.stand(infrared, sonar)
        elif self._phase is _Phase.MOVING:
            limit = self._p.timeout.infrared
            if guard.enabled:
                self._echoes.update((echo.sensor, echo) for echo in sonar)
                seen = self._ring.hits(now, limit)
                far = [echo for echo in sonar if echo.range > -math.inf]
                self._memory.add(self._unseen(far, seen, guard.motion_reach))
                self._memory.add(self._heard_before(pose, far, seen))
                self._memory.add(self._touching(sonar, seen), guessed=True)
            if layer.enabled:
                self._memory.pass_by(pose, self._ring.hits(now, limit))

    def begin_perception(self, place: Pose2 | None = None) -> None:
        """Forget what was remembered: the robot stands and looks anew.

        Parameters
        ----------
        place : Pose2, optional
            What the infrareds cannot see from here is kept, until `forget_kept`.
        """
        self._earlier.keep(self._memory.measured, self._place, self._p.clearance.recall)
        if place is None:
            self._memory.forget()
        else:
            near = self._p.infrared
            self._memory.forget_near(place, near.mount_radius + near.max_range)
        self._phase = _Phase.STANDING

    def forget_kept(self) -> bool:
        """Forget what the last perception could not see; return whether there was anything."""
        return self._memory.forget_kept()

    def end_perception(self) -> None:
        """Take short sonar echoes for hits that infrareds do not see; the robot moves on."""
        self._phase = _Phase.MOVING
        self._echoes.clear()
        self._heard.forget()
        memory, guard = self._memory, self._p.sonar_guard
        if guard.enabled:
            memory.add(self._earlier.confirmed(memory.sonar, self._p.sonar, guard.angle))
            far = [echo for echo in memory.sonar if echo.range > -math.inf]
            memory.add(self._unseen(far, memory.standing, guard.perception_reach))
            memory.add(
                self._unseen(memory.sonar, memory.standing, guard.perception_reach), guessed=True
            )

    def move_on(self) -> None:
        """Remember from now on what is seen on the way, with what is remembered."""
        self._phase = _Phase.MOVING

    def look(self) -> None:
        """Take note of a look on the way: what was seen long ago is forgotten."""
        self._memory.outdate()

    def rest(self) -> None:
        """Remember nothing until the next perception."""
        self._phase = _Phase.IDLE

    def clearance(self, now: float, pose: Pose2) -> float:
        """Return the clearance of the body [m] from what the infrareds see now."""
        return float(clearance_at((pose.x, pose.y), self.seen(now), self._p.robot_radius)[0])

    def distrusted(self, now: float) -> str:
        """Return why the sensors that guard the robot cannot be trusted; empty if they can."""
        limits = self._p.timeout.infrared, self._p.timeout.sonar
        silent: list[str] = []
        stuck: list[str] = []
        for watch, limit in zip(self._watches, limits, strict=False):
            silent += watch.silent(now, limit)
            stuck += watch.stuck(self._p.watch.stuck_turn)
        if silent:
            return f"no readings from {_listed(silent)}"
        if stuck:
            turn = math.degrees(self._p.watch.stuck_turn)
            return f"the same range for a turn of {turn:.0f} deg or more from {_listed(stuck)}"
        return ""

    def deaf(self, now: float) -> str:
        """Return why the sonars that guard the robot must be deaf; empty if they need not be."""
        return self._hearing.deaf(self.seen(now), self._p.watch.open_space) or self._loss.deaf

    @property
    def max_speed(self) -> float:
        """The largest speed [m/s] at which the sonars hear in time what they are to guard from."""
        return self._p.watch.lossy_speed if self._loss.lost else math.inf

    @property
    def advice(self) -> str:
        """What is wrong with the sonars, and what the robot does about it; empty if nothing is."""
        if not self._loss.lost:
            return ""
        speed = min(self.max_speed, self._p.follower.max_linear)
        share = f"{self._loss.lost} of {WINDOW}"
        return f"sonars lose echoes ({share}): driving at no more than {speed:g} m/s"

    def nearest(self, now: float, pose: Pose2) -> str:
        """Return which sensor sees what is nearest to the body, and where; empty if none does."""
        p = self._p
        limit = p.timeout.infrared
        echoes = [e for e in self._echoes.values() if now - e.stamp <= p.timeout.sonar]
        seen = [
            (float(clearance_at((pose.x, pose.y), hit, p.robot_radius)[0]), frames[reading.sensor])
            for ring, frames, readings in (
                (p.infrared, p.infrared.frame_ids, self._ring.present(now, limit)),
                (p.sonar, p.sonar.frame_ids, echoes),
            )
            for reading in readings
            if len(hit := hit_points([reading], ring.mount_radius, ring.min_range, ring.max_range))
        ]
        if not seen:
            return ""
        clearance, frame = min(seen)
        return f"{frame} sees something {clearance:.2f} m from the body"

    def seen(self, now: float) -> Points:
        """Return the hit points (x, y) [m] that the infrareds see now, shape (n, 2)."""
        return self._ring.hits(now, self._p.timeout.infrared)

    @property
    def remembered(self) -> Points:
        """The hit points (x, y) [m] since the perception began, shape (n, 2)."""
        return self._memory.points if self._p.layer.enabled else self._memory.added

    @property
    def surfaces(self) -> Points:
        """The points (x, y) [m] that the infrareds hit at the perception, shape (n, 2).

        None where there is a doubt.
        """
        if self.doubt:
            return np.empty((0, 2))
        p = self._p.infrared
        return hit_points(self._memory.infrared, p.mount_radius, p.min_range, p.max_range)

    @property
    def doubt(self) -> str:
        """Why what was seen at the perception is not to be believed; empty if it is."""
        count = self._memory.unsteady
        return f"{count} infrareds told now of this, now of that" if count >= UNSTEADY else ""

    def known(self, now: float) -> Points:
        """Return all hit points (x, y) [m] to keep clear of, shape (n, 2)."""
        return np.concatenate((self.seen(now), self.remembered))

    def near(self, now: float, pose: Pose2, without_progress: int = 0) -> Points:
        """Return the hit points (x, y) [m] that may have stopped the robot, shape (n, 2).

        Parameters
        ----------
        now, pose
            Time [s] and where the robot is.
        without_progress : int
            Stops in a row that brought it no farther: those points whose distance is a guess
            count from `GUESSES_BELIEVED` on. Until then a look along other rays may explain them.
        """
        remembered = self.remembered
        if without_progress < GUESSES_BELIEVED:
            remembered = remembered[: len(remembered) - self._memory.guesses]
        near = np.hypot(remembered[:, 0] - pose.x, remembered[:, 1] - pose.y) <= NEAR
        return np.vstack([self.seen(now), remembered[near]])

    def suspected(self, now: float) -> Points:
        """Return points (x, y) [m] that sonars hear and infrareds do not see, shape (n, 2).

        On the way such echoes count as hits only from close by, for many come from elsewhere.
        Up to there the robot has to be slow enough to stop.
        """
        p = self._p
        if not p.sonar_guard.enabled:
            return np.empty((0, 2))
        limit = p.timeout.infrared
        echoes = [echo for echo in self._echoes.values() if now - echo.stamp <= limit]
        return self._unseen(echoes, self._ring.hits(now, limit), p.sonar_guard.perception_reach)

    def _heard_before(self, pose: Pose2, far: Sequence[SonarReading], seen: Points) -> Points:
        """Return points (x, y) [m] for what was heard from afar and is close by now."""
        p, guard, radius = self._p, self._p.sonar_guard, self._p.robot_radius
        self._heard.take(far, guard.perception_reach + radius)
        due = self._heard.due(pose, guard.motion_reach + radius)
        if not due:
            return np.empty((0, 2))
        below = guard.perception_reach + radius - p.sonar.mount_radius
        longer = [echo for echo in self._echoes.values() if echo.range >= below]
        known = np.vstack([seen, self._memory.measured])
        return guard_points([*due, *longer], known, p.sonar, guard, guard.perception_reach, radius)

    def _touching(self, sonar: Sequence[SonarReading], seen: Points) -> Points:
        p = self._p
        if all(echo.range > -math.inf for echo in sonar):
            return np.empty((0, 2))
        self._memory.add(self._earlier.confirmed(sonar, p.sonar, p.sonar_guard.angle))
        known = np.vstack([seen, self._memory.measured])
        return rim_points(sonar, known, p.sonar, p.sonar_guard, p.robot_radius)

    def _unseen(self, sonar: Sequence[SonarReading], seen: Points, reach: float) -> Points:
        p = self._p
        # Most are far: asked first, since this happens at every tick.
        below = p.robot_radius + reach - p.sonar.mount_radius
        short = [echo for echo in sonar if echo.range < below]
        if not short:
            return np.empty((0, 2))
        return guard_points(short, seen, p.sonar, p.sonar_guard, reach, p.robot_radius)


def _listed(frames: Sequence[str]) -> str:
    named = ", ".join(frames[:NAMED])
    more = len(frames) - NAMED
    return f"{named} and {more} more" if more > 0 else named
