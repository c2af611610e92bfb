# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mission: perceive, plan, move, and again, until the goal is reached or cannot be.

A pure state machine (paper, Figs. 1 and 9): events go in, commands come out, time is an
argument. The same object runs in the motion node and headless.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum, auto

import numpy as np
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import InfraredReading, Pose2
from numpy.typing import ArrayLike, NDArray

from fuzzy_navigation.clearance import BetaCutRule, InfraredRing, clearance_at
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.mission_types import (
    Command,
    Commands,
    Drive,
    Feedback,
    LogEntry,
    Outcome,
    Perceive,
    Phase,
    Plan,
    Stop,
)
from fuzzy_navigation.motion import Motion, PlannedPath
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.planner import PlanResult, PlanStatus
from fuzzy_navigation.risk import augment

__all__ = ["Mission"]

#: Pause before a perception or a plan that failed is asked for again [s].
RETRY_PAUSE = 1.0
#: How much nearer than the tolerance a path has to end, for the robot does not stop exactly [m].
ARRIVAL_MARGIN = 0.01
#: Longest time between two ticks that the motion is laid out for [s].
LONGEST_TICK = 0.2
#: A clock that steps back by more than this [s] makes the readings held worthless.
CLOCK_SLACK = 0.5
#: A robot that came this far [m] or turned this much [rad] has moved.
MOVED = 0.02


class _State(Enum):
    IDLE = auto()
    WAITING = auto()  # for the first pose
    PERCEIVING = auto()
    PLANNING = auto()
    MOVING = auto()


class Mission:
    """Brings the robot to one goal after the other.

    Each event method returns the commands to carry out, in order. While a mission runs,
    `on_pose` answers with exactly one `Drive`; every `Finish` comes right after ``Drive(0, 0)``.

    Parameters
    ----------
    parameters : MotionParameters, optional
        Rules and limits.
    """

    def __init__(self, parameters: MotionParameters | None = None) -> None:
        self._p = parameters if parameters is not None else MotionParameters()
        self._ring = InfraredRing(self._p.infrared)
        self._motion = Motion(self._p)
        self._cut = BetaCutRule(self._p.beta)
        self._geometry: GridGeometry | None = None
        self._risk: NDArray[np.float64] | None = None
        self._pose: Pose2 | None = None
        # Time since the first event: never runs backwards, whatever the clock does.
        self._time = 0.0
        self._clock = -math.inf
        self._pose_time = -math.inf
        self._state = _State.IDLE
        self._missions = 0
        self._record = MissionRecord(0, Pose2(0.0, 0.0), 0.0, 0.0)
        self._request = 0
        self._deadline = math.inf
        self._retry_at = math.inf
        self._failures = 0
        self._answered = False
        self._asked_at = 0.0
        self._map_seen = False
        self._hold = ""
        self._hold_since = 0.0
        self._anchor = (0.0, Pose2(0.0, 0.0))

    # -- what is known from outside ---------------------------------------------------------

    @property
    def active(self) -> bool:
        """Whether a mission runs."""
        return self._state is not _State.IDLE

    @property
    def phase(self) -> Phase:
        """What the robot is doing."""
        return {_State.PLANNING: Phase.PLANNING, _State.MOVING: Phase.MOVING}.get(
            self._state, Phase.PERCEIVING
        )

    @property
    def last_stop(self) -> Stop:
        """Why the robot last stopped in this mission."""
        return self._record.last_stop

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

    def feedback(self) -> Feedback:
        """Return the state of the mission."""
        r = self._record
        return Feedback(
            self.phase,
            r.last_stop,
            r.perceptions,
            r.alpha,
            self._distance_remaining(),
            self._pose,
            self._hold,
        )

    # -- events -----------------------------------------------------------------------------

    def start(
        self, now: float, goal: Pose2 | tuple[float, float], tolerance: float = 0.0
    ) -> Commands:
        """Begin a mission; one that runs is cancelled.

        Parameters
        ----------
        now : float
            Time [s].
        goal : Pose2 or tuple of float
            Position (x, y) [m].
        tolerance : float
            Distance from it that counts as reached [m]; 0: the parameter.

        Raises
        ------
        ValueError
            If a number is not finite, or the tolerance is negative or too small for the robot's
            accuracy; a mission that runs goes on.
        """
        target = goal if isinstance(goal, Pose2) else Pose2(*goal)
        least = 2.0 * ARRIVAL_MARGIN
        if tolerance != 0.0 and not least <= tolerance < math.inf:
            raise ValueError(
                f"the goal's tolerance must be at least {least} m, or 0 for the parameter "
                f"'goal_tolerance', got {tolerance}"
            )
        self._tick(now)
        commands: list[Command] = []
        if self.active:
            commands += self._finish(Outcome.CANCELED, "a newer goal replaced this one")
        self._missions += 1
        self._record = MissionRecord(
            self._missions, target, tolerance or self._p.goal_tolerance, self._time
        )
        self._motion.forget()
        self._failures = 0
        self._hold = ""
        if self._goal_outside():
            return (*commands, *self._goal_refused())
        if self._time - self._pose_time > self._p.timeout.pose:
            self._state = _State.WAITING
            self._wait("no pose yet")
            return tuple(commands)
        return (*commands, *self._set_out())

    def cancel(self, now: float, reason: str = "cancelled on request") -> Commands:
        """End the mission, the robot standing from this call on."""
        self._tick(now)
        return tuple(self._finish(Outcome.CANCELED, reason)) if self.active else ()

    def on_pose(
        self, now: float, pose: Pose2, infrared: Sequence[InfraredReading] = ()
    ) -> Commands:
        """Take a pose and what the infrared sensors saw there: the tick of the control.

        Raises
        ------
        ValueError
            If a reading is of an unknown sensor; then nothing is taken.
        """
        self._check(now)
        self._ring.update(infrared)
        dt = min(self._tick(now, of_pose=True), LONGEST_TICK)
        self._pose = pose
        if not self.active:
            return ()
        hits = self._ring.hits()
        clearance = float(clearance_at((pose.x, pose.y), hits, self._p.robot_radius)[0])
        self._record.pass_by(pose, clearance)
        commands = self._watch()
        if self._state is _State.WAITING:
            self._hold = ""
            commands += self._set_out()
        elif self._state is _State.MOVING:
            commands += self._drive(now, pose, hits, dt)
        if self.active and not any(isinstance(c, Drive) for c in commands):
            commands.insert(0, Drive(0.0, 0.0))
        return tuple(commands)

    def on_tick(self, now: float) -> Commands:
        """Watch over what should have come by now; to be called even when nothing comes."""
        self._tick(now)
        return tuple(self._watch()) if self.active else ()

    def on_map(
        self,
        now: float,
        geometry: GridGeometry,
        motion_risk: ArrayLike,
        stamp: float | None = None,
    ) -> Commands:
        """Take a motion map.

        Parameters
        ----------
        now : float
            Time [s].
        geometry : GridGeometry
            Where its cells lie.
        motion_risk : array_like, shape (H, W)
            M_m, not augmented.
        stamp : float, optional
            When it was made [s], on the clock of `now`; `now` if not given.

        Raises
        ------
        ValueError
            If shape or values are wrong; then the map before stays.
        """
        self._check(now)
        # "To account for the actual robot dimensions": paper, section IV-B.
        risk = augment(
            motion_risk, self._p.robot_radius, geometry.resolution, self._p.augmentation
        )
        if risk.shape != geometry.shape:
            raise ValueError(
                f"the motion map has {risk.shape} (rows, columns), but its geometry has "
                f"{geometry.shape}"
            )
        self._tick(now)
        self._geometry, self._risk = geometry, risk
        if self.active and self._goal_outside():
            return tuple(self._goal_refused())
        if self._state is _State.MOVING:
            self._motion.allow(self._reach(self._motion.path))
        if self._state is _State.PERCEIVING:
            self._map_seen |= (now if stamp is None else stamp) >= self._asked_at
            return tuple(self._perceived(now))
        return ()

    def on_perception(self, now: float, request: int, ok: bool, message: str = "") -> Commands:
        """Take the end of a perception, done or failed."""
        self._tick(now)
        if self._state is not _State.PERCEIVING or request != self._request:
            return ()
        if not ok:
            return tuple(self._failed_once("the perception failed", message))
        self._answered = True
        return tuple(self._perceived(now))

    def on_plan(self, now: float, request: int, plan: PlanResult) -> Commands:
        """Take the planner's answer; of the path its poses are used."""
        self._tick(now)
        if self._state is not _State.PLANNING or request != self._request:
            return ()
        if plan.status == PlanStatus.FOUND:
            return tuple(self._move(plan))
        if plan.status == PlanStatus.NO_PATH:
            return tuple(self._finish(Outcome.UNREACHABLE, plan.message))
        if plan.status == PlanStatus.NO_MAP:
            return tuple(self._failed_once("the planner has no map", plan.message))
        return tuple(
            self._finish(Outcome.FAILED, f"the planner refused the request: {plan.message}")
        )

    def on_plan_error(self, now: float, request: int, message: str) -> Commands:
        """Take note that no answer came from the planner."""
        self._tick(now)
        if self._state is not _State.PLANNING or request != self._request:
            return ()
        return tuple(self._failed_once("the planner did not answer", message))

    # -- time -------------------------------------------------------------------------------

    @staticmethod
    def _check(now: float) -> None:
        if not math.isfinite(now):
            raise ValueError(f"the time of an event must be finite, got {now}")

    def _tick(self, now: float, of_pose: bool = False) -> float:
        """Let time pass; return the time since the last pose [s]."""
        self._check(now)
        if now < self._clock - CLOCK_SLACK:
            self._ring.clear()
            self._asked_at = now
        if self._clock > -math.inf:
            self._time += max(now - self._clock, 0.0)
        self._clock = now
        since = self._time - self._pose_time
        if of_pose:
            self._pose_time = self._time
        return since

    def _watch(self) -> list[Command]:
        """Stop, ask again or give up for what did not come in time."""
        p = self._p.timeout
        pose_age = self._time - max(self._pose_time, self._record.started)
        if pose_age > p.pose:
            commands = self._stand(f"no pose for {pose_age:.1f} s")
            if commands:
                return commands
        if self._time >= self._retry_at:
            return self._plan() if self._state is _State.PLANNING else self._perceive()
        if self._time > self._deadline:
            if self._state is _State.PERCEIVING:
                what = "its map" if self._answered else "an answer"
                return self._failed_once(
                    "the perception failed", f"{what} did not come within {p.build_map:g} s"
                )
            return self._failed_once(
                "the planner did not answer", f"nothing came within {p.plan:g} s"
            )
        return []

    def _wait(self, reason: str) -> None:
        if not self._hold:
            self._hold_since = self._time
        self._hold = reason

    def _stand(self, reason: str) -> list[Command]:
        """Make the robot stand until data is back; give up after a time."""
        self._wait(reason)
        if self._time - self._hold_since > self._p.timeout.lost:
            return self._finish(Outcome.FAILED, f"the robot stands and waited in vain: {reason}")
        self._motion.halt()
        return [Drive(0.0, 0.0)] if self._state is _State.MOVING else []

    def _failed_once(self, what: str, message: str) -> list[Command]:
        self._failures += 1
        if self._failures >= self._p.attempts:
            return self._finish(
                Outcome.FAILED, f"{what} {self._failures} times in a row, the last time: {message}"
            )
        self._deadline = math.inf
        self._retry_at = self._time + RETRY_PAUSE
        return []

    # -- the alternation --------------------------------------------------------------------

    def _set_out(self) -> list[Command]:
        assert self._pose is not None
        goal = self._record.goal
        if self._pose.distance_to(goal.x, goal.y) <= self._record.tolerance:
            return self._reached("the robot already stands")
        return self._perceive()

    def _ask(self, state: _State, timeout: float) -> int:
        self._state = state
        self._request += 1
        self._deadline = self._time + timeout
        self._retry_at = math.inf
        return self._request

    def _perceive(self) -> list[Command]:
        if self._record.perceptions >= self._p.perception_cap:
            return self._finish(
                Outcome.UNREACHABLE,
                f"not reached after {self._record.perceptions} perceptions, the most that "
                f"'perception_cap' allows; {self._distance_remaining():.2f} m were left",
            )
        request = self._ask(_State.PERCEIVING, self._p.timeout.build_map)
        self._answered = self._map_seen = False
        self._asked_at = self._clock
        return [Perceive(request)]

    def _perceived(self, now: float) -> list[Command]:
        """Go on to planning once both the mapper's answer and its map are there."""
        if not (self._answered and self._map_seen):
            return []
        assert self._pose is not None
        self._failures = 0
        self._record.perceived(now, self._pose, self._distance_remaining())
        return self._plan()

    def _plan(self) -> list[Command]:
        assert self._pose is not None
        request = self._ask(_State.PLANNING, self._p.timeout.plan)
        tolerance = self._record.tolerance - ARRIVAL_MARGIN
        return [Plan(request, self._pose, self._record.goal, tolerance)]

    def _move(self, plan: PlanResult) -> list[Command]:
        assert self._pose is not None
        assert self._geometry is not None
        try:
            path = PlannedPath.of(plan.poses, plan.alpha, self._geometry, self._pose)
        except ValueError as error:
            return self._failed_once("the planner's path cannot be followed", str(error))
        self._failures = 0
        self._deadline = math.inf
        self._state = _State.MOVING
        self._record.alpha = plan.alpha
        self._anchor = (self._time, self._pose)
        self._motion.begin(
            self._pose, path, self._record.goal, self._reach(path), self._record.relaxed
        )
        return self._stopped() if self._motion.stopped is not None else []

    def _reach(self, path: PlannedPath) -> int:
        assert self._geometry is not None
        assert self._risk is not None
        cells, inside = self._geometry.cells_of(path.points)
        # A map that shrank meanwhile ends the path where it leaves the map.
        last = len(cells) if inside.all() else int(np.argmin(inside))
        return self._cut.reach(self._risk, cells[: max(last, 1)])

    def _drive(
        self, now: float, pose: Pose2, hits: NDArray[np.float64], dt: float
    ) -> list[Command]:
        silent = self._ring.silent(now, self._p.timeout.infrared)
        if silent:
            return self._stand(f"no readings from {', '.join(silent)}")
        self._hold = ""
        v, omega = self._motion.step(pose, hits, dt)
        if self._motion.stopped is not None:
            return self._stopped()
        if self._rooted(pose):
            return self._finish(
                Outcome.FAILED,
                f"the robot does not move: commanded for {self._p.timeout.lost:g} s, it is still "
                f"at ({pose.x:.2f}, {pose.y:.2f}) m",
            )
        return [Drive(v, omega)]

    def _rooted(self, pose: Pose2) -> bool:
        """Whether the robot has not moved for long although it is told to."""
        since, anchor = self._anchor
        turned = abs(math.remainder(pose.theta - anchor.theta, 2.0 * math.pi))
        if anchor.distance_to(pose.x, pose.y) > MOVED or turned > MOVED:
            self._anchor = (self._time, pose)
            return False
        return self._time - since > self._p.timeout.lost

    def _stopped(self) -> list[Command]:
        """Judge what the motion brought, and perceive again unless that is the end."""
        assert self._pose is not None
        assert self._geometry is not None
        r, goal = self._record, self._record.goal
        reason = self._motion.stopped
        assert reason is not None
        if self._pose.distance_to(goal.x, goal.y) <= r.tolerance:
            return self._reached("the robot stands")
        r.stopped(reason, self._motion.progress >= 0.9 * self._geometry.resolution)
        if r.without_progress < self._p.livelock_limit:
            return self._perceive()
        where = f"at ({self._pose.x:.2f}, {self._pose.y:.2f}) m"
        # Above the first rungs everything but a wall is admissible: a robot that gets nowhere
        # there has no way left, and says so.
        if r.alpha > self._p.believed_free_alpha:
            return self._finish(
                Outcome.UNREACHABLE,
                f"the only paths left lead through cells believed occupied (alpha {r.alpha:g}): "
                f"{r.without_progress} perceptions in a row {where} brought no progress",
            )
        return self._finish(
            Outcome.LIVELOCK,
            f"{r.without_progress} perceptions in a row {where} brought no progress; the last "
            f"stop was {r.last_stop.name}",
        )

    # -- ends -------------------------------------------------------------------------------

    def _goal_outside(self) -> bool:
        goal = self._record.goal
        return self._geometry is not None and not self._geometry.contains(goal.x, goal.y)

    def _goal_refused(self) -> list[Command]:
        assert self._geometry is not None
        goal = self._record.goal
        return self._finish(
            Outcome.FAILED,
            f"the goal ({goal.x:.2f}, {goal.y:.2f}) m lies outside the map, whose bounds are "
            f"{self._geometry.bounds} m",
        )

    def _reached(self, how: str) -> list[Command]:
        assert self._pose is not None
        goal = self._record.goal
        self._record.last_stop = Stop.GOAL
        distance = self._pose.distance_to(goal.x, goal.y)
        return self._finish(Outcome.REACHED, f"{how} {distance:.3f} m from the goal")

    def _finish(self, outcome: Outcome, message: str) -> list[Command]:
        self._state = _State.IDLE
        self._deadline = self._retry_at = math.inf
        self._hold = ""
        self._motion.halt()
        return [Drive(0.0, 0.0), self._record.finish(outcome, message, self._time)]

    def _distance_remaining(self) -> float:
        if self._pose is None:
            return math.nan
        if self._record.alpha > 0.0:
            return self._motion.remaining
        return self._pose.distance_to(self._record.goal.x, self._record.goal.y)
