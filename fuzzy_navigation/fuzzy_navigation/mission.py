# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mission: perceive, plan, move, and again, until the goal is reached or cannot be.

A pure state machine (paper, Figs. 1 and 9): events go in, commands come out, time is an
argument. The same object runs in the motion node and headless.
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.occupancy import Hundredths
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation import verdicts
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.mission_record import MissionRecord, checked_tolerance
from fuzzy_navigation.mission_state import MissionState, State
from fuzzy_navigation.mission_types import (
    Command,
    Commands,
    Drive,
    Outcome,
    Perceive,
    Phase,
    Plan,
    Stop,
)
from fuzzy_navigation.mission_waiting import LONGEST_TICK
from fuzzy_navigation.plan_types import PlanResult, PlanStatus
from fuzzy_navigation.planned_path import PlannedPath

__all__ = ["Mission"]


class Mission(MissionState):
    """Brings the robot to one goal after the other.

    Each event method returns the commands to carry out, in order. While a mission runs,
    `on_pose` answers with exactly one `Drive`; every `Finish` comes right after ``Drive(0, 0)``.
    Every method raises ValueError for a time that is not finite, and then does nothing.

    Parameters
    ----------
    parameters : MotionParameters, optional
        Rules and limits.
    """

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
        accuracy = checked_tolerance(tolerance) or self._p.goal_tolerance
        self._advance(now)
        commands = self._finish((Outcome.CANCELED, verdicts.REPLACED)) if self.active else []
        mission = self._record.mission + 1
        self._record = MissionRecord(mission, target, accuracy, self._time.elapsed)
        self._forget()
        self._state = State.WAITING
        if self._area and (refusal := verdicts.outside(self._record, self._area.geometry)):
            commands += self._finish(refusal)
        elif self._pose_age() > self._p.timeout.pose:
            self._hold.begin(self._time.elapsed, self._poseless("has come yet"))
        else:
            commands += self._set_out()
        return tuple(commands)

    def cancel(self, now: float, reason: str = "cancelled on request") -> Commands:
        """End the mission, the robot standing from this call on."""
        self._advance(now)
        return tuple(self._finish((Outcome.CANCELED, reason))) if self.active else ()

    def on_pose(
        self,
        now: float,
        pose: Pose2,
        infrared: Sequence[InfraredReading] = (),
        sonar: Sequence[SonarReading] = (),
        delay: float = 0.0,
    ) -> Commands:
        """Take a pose and what the sensors saw there or on the way: the tick of the control.

        Parameters
        ----------
        now : float
            Time [s], that of the pose.
        pose : Pose2
            Where the robot was then.
        infrared, sonar : sequence of readings
            New readings of the sensors.
        delay : float
            How long ago that was [s]: the robot has moved since.

        Raises
        ------
        ValueError
            If a reading is of an unknown sensor; then nothing is taken.
        """
        self._time.check(now)
        self._around.update(now, pose, infrared, sonar)
        self._advance(now)
        before, age = self._pose, self._pose_age()
        dt = min(age, LONGEST_TICK)
        self._stand_at(pose)
        if not self.active:
            return ()
        self._record.pass_by(pose, self._around.clearance(now, pose))
        commands = self._watch()
        jump = self._poses.jump(before, pose, age) if before is not None else ""
        if jump and self._state not in (State.IDLE, State.WAITING):
            self._around.clear()
            commands += self._interrupted("the pose jumped", jump)
        elif self._state is State.MOVING:
            commands += self._drive(pose, dt, max(delay, 0.0))
        else:
            self._hold.end()
            if self._state is State.WAITING:
                commands += self._set_out()
            elif self._state is State.TURNING:
                omega = self._turn.step(pose, dt)
                commands += self._perceive() if omega is None else [Drive(0.0, omega)]
        if not any(isinstance(command, Drive) for command in commands):
            commands.insert(0, Drive(0.0, 0.0))
        return tuple(commands)

    def on_tick(self, now: float) -> Commands:
        """Watch over what should have come by now; to be called even when nothing comes."""
        self._advance(now)
        return tuple(self._watch()) if self.active else ()

    def on_map(
        self,
        now: float,
        geometry: GridGeometry,
        motion_risk: ArrayLike | Hundredths,
        stamp: float | None = None,
    ) -> Commands:
        """Take a motion map.

        Parameters
        ----------
        now : float
            Time [s].
        geometry : GridGeometry
            Where its cells lie.
        motion_risk : array_like or Hundredths, shape (H, W)
            M_m, not augmented.
        stamp : float, optional
            When it was made [s], on the clock of `now`; `now` if not given.

        Raises
        ------
        ValueError
            If shape or values are wrong; then the map before stays.
        """
        self._time.check(now)
        area, p = self._area, self._p
        known = area is not None and area.coded and area.geometry == geometry
        if known and isinstance(motion_risk, Hundredths):
            self._known.renew(motion_risk, self._pose)
        else:
            rules = p.beta, p.robot_radius, p.augmentation
            self._area = ExploredArea(geometry, motion_risk, *rules, self._pose)
        return self._mapped(now, self._known, stamp)

    def on_window(
        self, now: float, motion_risk: Hundredths, window: Window, stamp: float | None = None
    ) -> Commands:
        """Take what is new in the motion map.

        Parameters
        ----------
        now : float
            Time [s].
        motion_risk : Hundredths, shape (h, w)
            M_m in the window, not augmented.
        window : Window
            The only cells that differ from the map before.
        stamp : float, optional
            When it was made [s], on the clock of `now`; `now` if not given.

        Raises
        ------
        ValueError
            If there is no map yet or it is not in hundredths, or shape or window are wrong; then
            the map before stays.
        """
        self._time.check(now)
        if self._area is None:
            raise ValueError("the first motion map must be whole, not a window")
        self._area.update(motion_risk, window, self._pose)
        return self._mapped(now, self._area, stamp)

    def _mapped(self, now: float, area: ExploredArea, stamp: float | None) -> Commands:
        self._advance(now)
        if self.active and (refusal := verdicts.outside(self._record, area.geometry)):
            return tuple(self._finish(refusal))
        if self._state is State.MOVING:
            self.maps_on_the_way += 1
            self._motion.allow(area.reach(self.plan_path, self._motion.passed))
        if self._state is State.PERCEIVING:
            self._map_seen |= (now if stamp is None else stamp) >= self._asked_at
            return tuple(self._perceived(now))
        return ()

    def on_perception(self, now: float, request: int, ok: bool, message: str = "") -> Commands:
        """Take the end of a perception, done or failed; a stale answer changes nothing."""
        self._advance(now)
        if not self._awaits(State.PERCEIVING, request):
            return ()
        if not ok:
            return tuple(self._failed_once("the perception failed", message))
        self._answered = True
        return tuple(self._perceived(now))

    def on_plan(self, now: float, request: int, plan: PlanResult) -> Commands:
        """Take the planner's answer, of a path its poses; a stale one changes nothing."""
        self._advance(now)
        if not self._awaits(State.PLANNING, request):
            return ()
        if plan.status == PlanStatus.FOUND:
            return tuple(self._move(plan))
        if plan.status == PlanStatus.NO_MAP:
            return tuple(self._failed_once("the planner has no map", plan.message))
        if plan.status == PlanStatus.NO_PATH and self._tried.try_again(self._record.perceptions):
            return tuple(self._plan())
        return tuple(self._judged(verdicts.no_plan(plan, self._record)))

    def on_plan_error(self, now: float, request: int, message: str) -> Commands:
        """Take note that no answer that can be used comes from the planner."""
        self._advance(now)
        if not self._awaits(State.PLANNING, request):
            return ()
        return tuple(self._failed_once("no usable plan", message))

    def _advance(self, now: float) -> None:
        if self._time.advance(now):
            # Stamps from before the step back tell nothing any more.
            self._around.clear()
            self._asked_at = now

    def _watch(self) -> list[Command]:
        """Stop, ask again or give up for what did not come in time."""
        p, time = self._p.timeout, self._time.elapsed
        age = time - max(self._pose_time, self._record.started, self._resumed)
        if age > p.pose and (commands := self._stand(self._poseless(f"for {age:.1f} s"))):
            return commands
        if self._request.due(time):
            return self._plan() if self._state is State.PLANNING else self._perceive()
        if not self._request.overdue(time):
            return []
        if self._state is State.PLANNING:
            return self._failed_once("the planner did not answer", f"nothing for {p.plan:g} s")
        missing = "map" if self._answered else "answer"
        return self._failed_once("the perception failed", f"no {missing} for {p.build_map:g} s")

    def _stand(self, reason: str) -> list[Command]:
        """Make the robot stand until data is back; give up after a time."""
        self._hold.begin(self._time.elapsed, self._blamed(reason))
        if self._hold.lasted(self._time.elapsed) > self._p.timeout.lost:
            return self._finish((Outcome.FAILED, f"the robot stood and waited in vain: {reason}"))
        self._motion.halt()
        return [Drive(0.0, 0.0)] if self.phase is Phase.MOVING else []

    def _failed_once(self, what: str, message: str) -> list[Command]:
        self._request.fail(self._time.elapsed)
        if self._request.failures < self._p.attempts:
            return []
        reason = f"{what} {self._request.failures} times in a row, the last time: {message}"
        return self._finish((Outcome.FAILED, reason))

    def _set_out(self) -> list[Command]:
        verdict = verdicts.arrival(self._record, self._here)
        return self._finish(verdict) if verdict else self._perceive()

    def _perceive(self) -> list[Command]:
        if verdict := verdicts.exhaustion(self._record, self._here, self._p):
            return self._finish(verdict)
        self._state = State.PERCEIVING
        self._around.begin_perception(self._look_place)
        self._asked_at, self._answered, self._map_seen = self._time.clock, False, False
        return [Perceive(self._request.make(self._time.elapsed, self._p.timeout.build_map))]

    def _perceived(self, now: float) -> list[Command]:
        """Go on to planning once both the mapper's answer and its map are there."""
        if not (self._answered and self._map_seen):
            return []
        if deaf := self._around.deaf(now):
            return self._interrupted("the perception cannot be trusted", deaf)
        self._request.settle()
        self._around.end_perception()
        self._record.perceived(now, self._here, self._distance_remaining())
        self._doubts.note(self._around.doubt)
        self._tried.perceived(self._known, self._here, self._around.surfaces)
        return self._plan()

    def _plan(self) -> list[Command]:
        self._state = State.PLANNING
        p, r = self._p, self._record
        request = self._request.make(self._time.elapsed, p.timeout.plan)
        barred = self._tried.barred(r.perceptions, self._known)
        hits = tuple((x, y) for x, y in self._around.remembered.tolist())
        how = hits, p.slim_radius, p.believed_free_alpha, p.any_angle
        return [Plan(request, self._here, r.goal, r.path_tolerance, barred, *how)]

    def _move(self, plan: PlanResult) -> list[Command]:
        try:
            path = PlannedPath.of(plan.poses, plan.alpha, self._known.geometry, self._here)
        except ValueError as error:
            return self._failed_once("the planner's path cannot be followed", str(error))
        self._request.settle()
        self._state = State.MOVING
        self._record.alpha = plan.alpha
        reach = self._known.reach(path.points)
        hits, vain = self._around.remembered, self._record.looked_in_vain
        self._motion.begin(self._here, path, self._record.goal, reach, vain, hits)
        return self._stopped() if self._motion.stopped is not None else []

    def _interrupted(self, what: str, why: str) -> list[Command]:
        """Stand and perceive anew: what the path rests on does not hold any more."""
        if self._state is State.MOVING:
            self._motion.halt()
            self._record.stopped(Stop.NONE, self._motion.came_on)
        self._state = State.PERCEIVING
        self._doubts.note(why)
        self._hold.begin(self._time.elapsed, why)
        return self._failed_once(what, why) or [Drive(0.0, 0.0)]

    def _drive(self, pose: Pose2, dt: float, delay: float) -> list[Command]:
        around, now = self._around, self._time.clock
        speed = self._motion.velocity[0]
        if doubt := around.distrusted(now) or self._poses.frozen(pose, speed, dt):
            return self._stand(doubt)
        if deaf := around.deaf(now):
            return self._interrupted("the sonars cannot be trusted", deaf)
        self._hold.end()
        hits, suspected = around.known(now), around.suspected(now)
        v, omega = self._motion.step(pose, hits, dt, suspected, delay, around.max_speed)
        if self._motion.stopped is not None:
            return self._stopped()
        if self._motion.stuck:
            return self._finish(verdicts.stuck(pose))
        return [Drive(v, omega)]

    def _stopped(self) -> list[Command]:
        """Judge what the motion brought, and perceive again unless that is the end."""
        assert self._motion.stopped is not None
        if verdict := verdicts.arrival(self._record, self._here):
            return self._finish(verdict)
        self._note_stop(self._motion.stopped)
        verdict = verdicts.stalemate(self._record, self._here, self._p)
        if verdict or self._record.without_progress == 0 or not self._turn.begin(self._here):
            return self._judged(verdict) if verdict else self._perceive()
        self._state = State.TURNING
        return []

    def _note_stop(self, stop: Stop) -> None:
        """Remember why and where the motion ended."""
        now = self._time.clock
        because = self._around.nearest(now, self._here) if stop is Stop.CLEARANCE else ""
        self._record.stopped(stop, self._motion.came_on, because)
        hits = self._around.near(now, self._here, self._record.without_progress)
        if self._tried.stopped(self._record, hits, self._motion.next_point, self._known):
            self._record.without_progress = 0

    def _judged(self, verdict: verdicts.Verdict) -> list[Command]:
        """End, unless there is a doubt in what the verdict rests on: then look again."""
        if verdict[0] is not Outcome.UNREACHABLE or not self._doubts.look_again():
            return self._finish(verdict)
        self._tried.forget()
        self._record.without_progress = 0
        return self._perceive()

    def _finish(self, verdict: verdicts.Verdict) -> list[Command]:
        self._state = State.IDLE
        self._around.rest()
        self._request.settle()
        self._hold.end()
        told = verdicts.doubted(verdict, self._doubts.reason)
        return [Drive(0.0, 0.0), self._record.finish(*told, self._time.elapsed)]
