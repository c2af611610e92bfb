# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a mission knows and shows: its parts, and everything that can be asked of it."""

from __future__ import annotations

import math
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.doubts import Doubts
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.look_turn import LookTurn
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.mission_types import Feedback, LogEntry, Phase
from fuzzy_navigation.mission_waiting import Hold, MissionTime, OpenRequest
from fuzzy_navigation.motion import Motion
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.pose_watch import PoseWatch
from fuzzy_navigation.surroundings import Surroundings
from fuzzy_navigation.tried_places import TriedPlaces

__all__ = ["MissionState", "State"]

#: Why a robot stands that has yet to hear what came in a time without a look; see `resume`.
HELD_UP = "the motion itself was held up, or the clock set: what is of now is yet to be heard"
#: What a mission is about.
State = Enum("State", ["IDLE", "WAITING", "PERCEIVING", "PLANNING", "MOVING", "TURNING"])


class MissionState:
    """The parts of a mission, and what they tell of it; the events are `Mission`'s.

    Parameters
    ----------
    parameters : MotionParameters, optional
        Rules and limits.
    """

    def __init__(self, parameters: MotionParameters | None = None) -> None:
        self._p = parameters if parameters is not None else MotionParameters()
        self._around = Surroundings(self._p)
        self._motion = Motion(self._p)
        self._poses = PoseWatch(self._p.watch, self._p.follower)
        self._area: ExploredArea | None = None
        self._pose: Pose2 | None = None
        self._pose_time = self._resumed = -math.inf
        self._pose_refusal = ""
        self._time = MissionTime()
        self._state = State.IDLE
        self._record = MissionRecord(0, Pose2(0.0, 0.0), 0.0, 0.0)
        self._request = OpenRequest()
        self._hold = Hold()
        self._asked_at, self._answered, self._map_seen = 0.0, False, False
        self._tried = TriedPlaces(self._p)
        self._doubts = Doubts()
        self._turn = LookTurn(self._p.look_turn, self._p.follower)
        #: Maps that came while the robot was on its way.
        self.maps_on_the_way = 0

    def adopt(self, parameters: MotionParameters) -> None:
        """Go by other parameters, knowing what is known.

        Parameters
        ----------
        parameters : MotionParameters
            Of the same sensors. While a mission runs they may differ in nothing but what
            `ParameterChange` lets through.
        """
        before, self._p = self._p, parameters
        self._around.adopt(parameters)
        self._motion.adopt(parameters)
        self._poses.adopt(parameters.watch, parameters.follower)
        if self.active:
            return
        self._tried = TriedPlaces(parameters)
        self._turn = LookTurn(parameters.look_turn, parameters.follower)
        if self._area is not None and _body(parameters) != _body(before):
            geometry, codes = self._area.geometry, self._area.codes
            rules = _body(parameters)
            # Of a map that is not at hand any more it cannot be told anew what may be entered.
            self._area = ExploredArea(geometry, codes, *rules, self._pose) if codes else None

    def take_over(self, before: MissionState) -> None:
        """Know and go on counting all that another, which is idle and given up, did."""
        self._around, self._motion, self._poses = before._around, before._motion, before._poses
        self._area, self._pose, self._pose_time = before._area, before._pose, before._pose_time
        self._time, self._record, self._request = before._time, before._record, before._request
        self._p, self.maps_on_the_way = before._p, before.maps_on_the_way
        self._pose_refusal = before._pose_refusal

    def resume(self, now: float) -> None:
        """Go on after a time in which nobody looked, or that was none: it counts for no wait.

        Parameters
        ----------
        now : float
            Time [s].
        """
        skipped = self._time.skip(now)
        # The goal and the pose are so much older all the same.
        self._record.started -= skipped
        self._pose_time -= skipped
        self._resumed = self._time.elapsed
        if skipped > self._p.timeout.pose:
            self._motion.halt()  # without commands it has come to stand

    def pose_refused(self, why: str) -> None:
        """Take note of a pose that cannot be used, so that it can be told why none came."""
        self._pose_refusal = why

    @property
    def active(self) -> bool:
        """Whether a mission runs."""
        return self._state is not State.IDLE

    @property
    def phase(self) -> Phase:
        """What the robot is doing."""
        moving = dict.fromkeys((State.MOVING, State.TURNING), Phase.MOVING)
        return {State.PLANNING: Phase.PLANNING, **moving}.get(self._state, Phase.PERCEIVING)

    @property
    def log(self) -> tuple[LogEntry, ...]:
        """One entry for each perception of the newest mission."""
        return tuple(self._record.log)

    @property
    def travelled(self) -> NDArray[np.float64]:
        """Positions (x, y) [m] along the way of the newest mission, shape (m, 2)."""
        return self._record.travelled

    @property
    def plan_path(self) -> NDArray[np.float64]:
        """Cell centres (x, y) [m] of the newest plan, shape (n, 2)."""
        return self._motion.path.points

    @property
    def motion_map(self) -> Hundredths | None:
        """The newest motion map, if it came in hundredths."""
        return None if self._area is None else self._area.codes

    def feedback(self) -> Feedback:
        """Return the state of the mission."""
        r, left = self._record, self._distance_remaining()
        return Feedback(
            self.phase, r.last_stop, r.perceptions, r.alpha, left, self._pose, self._hold.reason
        )

    @property
    def advice(self) -> str:
        """Why the mission cannot be done as it is meant, though it goes on; empty if it can."""
        return self._around.advice

    def _forget(self) -> None:
        """Forget what belongs to the mission before."""
        for memory in (self._motion, self._tried, self._doubts):
            memory.forget()

    def _stand_at(self, pose: Pose2) -> None:
        self._pose, self._pose_time, self._pose_refusal = pose, self._time.elapsed, ""

    def _poseless(self, since: str) -> str:
        """Return that there is no pose and why, as far as it is known."""
        if self._pose_refusal:
            return f"no usable pose {since}; the last was refused: {self._pose_refusal}"
        return f"no pose {since}: is 'pose' published?"

    def _pose_age(self) -> float:
        return self._time.elapsed - self._pose_time

    def _blamed(self, reason: str) -> str:
        """Return why the robot stands: nobody else is late when nobody has looked."""
        return HELD_UP if self._time.elapsed == self._resumed else reason

    def _awaits(self, state: State, request: int) -> bool:
        return self._state is state and self._request.answered_by(request)

    @property
    def _here(self) -> Pose2:
        assert self._pose is not None
        return self._pose

    @property
    def _known(self) -> ExploredArea:
        assert self._area is not None
        return self._area

    @property
    def _look_place(self) -> Pose2 | None:
        """Where a perception is made that renews what can be seen from there; None: all."""
        return None

    def _distance_remaining(self) -> float:
        if self._record.alpha > 0.0:
            return self._motion.remaining
        if self._pose is None or self._record.mission == 0:
            return math.nan
        return self._pose.distance_to(self._record.goal.x, self._record.goal.y)


def _body(parameters: MotionParameters) -> tuple[float, float, str]:
    """Return what says which cells of a motion map the robot may enter."""
    return parameters.beta, parameters.robot_radius, parameters.augmentation
