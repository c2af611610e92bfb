# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mission of a robot that maps while it moves.

Paper, section II: perception, by far the most expensive phase, can be done during the motion if
both are concurrent processes. The mapper then fuses packet after packet without being asked, and
this mission has the path planned anew with every map that comes on the way, from a little ahead of
the robot, which goes over to it without a stop. Where a stop condition of the motion holds, the
robot stands; it goes on at once if the map that is there has a way on. If not, it does what the
alternating mission does: it perceives, and from then on that one's rules hold, verdicts included.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_navigation import verdicts
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_state import State
from fuzzy_navigation.mission_types import Command, Commands, Plan, Stop
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.plan_types import PlanResult, PlanStatus
from fuzzy_navigation.planned_path import PlannedPath

__all__ = ["SETTINGS", "ConcurrentMission", "mission_of"]

#: What mapper and motion are set to for mapping while moving, by node. On the way a packet is full
#: every half second, four times as often as a robot that stands for each makes one. The mean
#: counts twice as many: more, and it is late to learn that what looked doubtful is free; as many,
#: and it forgets what it saw from close by. The readings of a packet are taken on a way of 0.2 m.
SETTINGS: Mapping[str, Mapping[str, Any]] = {
    "mapper": {"mode": "continuous", "fusion.max_count": 6, "consistency.max_offset": 0.2},
    "motion": {"concurrent": True},
}

#: Way after which a map that is made on the way counts as a perception [m]: what robots come from
#: one to the next that stand for each, so that limits in perceptions mean the same for both.
LOOK_SPACING = 0.8
#: How far ahead of the robot another path leaves the one that it follows: this far [m], and what
#: it comes in a time [s].
FORK_DISTANCE, FORK_TIME = 0.2, 0.3
#: The first cell that a path leads to lies farther from the robot than this, in cells.
NEAREST = 0.7
#: A path that stays so close to another, in cells, is the same up to where the robot may drive and
#: a few cells beyond.
SAME, BEYOND = 1.5, 4
#: A path turns back if within some cells from where it leaves another it leads into a direction
#: whose cosine is below this. To go back is for a robot that has looked from close by: a narrow
#: opening that looks closed on the way is often open then (two of 0.7 m took 152 s without this
#: rule and 97 s with it, in 3 missions each).
AWAY, BACK = 6, -0.2
#: A robot that has stopped looks before it takes a path below this cosine.
ELSEWHERE = 0.4
#: As long as the robot may drive on by more than this [m], and by what it comes in a time [s], it
#: does not change its mind: late where it is narrow, in time to keep its speed where it is not.
SETTLED_DISTANCE, SETTLED_TIME = 0.5, 0.8
#: Way from one stop to the next below which a stop is one for a perception [m].
LEAST_WAY = 0.3

#: Time on the way without a map after which the mapper seems to make none, and age of a map from
#: which on a robot that is given a goal looks before it sets out [s].
MAP_SILENCE = 5.0


def mission_of(
    parameters: MotionParameters | None = None, before: Mission | None = None
) -> Mission:
    """Return the mission that goes by some parameters, concurrent or alternating.

    Parameters
    ----------
    parameters : MotionParameters, optional
        Rules and limits.
    before : Mission, optional
        One that is to go by them from now on, see `Mission.adopt`, and knows what is known. It is
        the one that is returned, unless it is idle and of the other kind.
    """
    parameters = parameters if parameters is not None else MotionParameters()
    kind = ConcurrentMission if parameters.concurrent else Mission
    if before is None:
        return kind(parameters)
    mission = before
    if type(before) is not kind:
        mission = kind(parameters)
        mission.take_over(before)
    mission.adopt(parameters)
    return mission


class ConcurrentMission(Mission):
    """Brings the robot to one goal after the other, mapping while it moves.

    Parameters
    ----------
    parameters : MotionParameters, optional
        Rules and limits.
    """

    def __init__(self, parameters: MotionParameters | None = None) -> None:
        super().__init__(parameters)
        self._maps = 0
        #: The map that the newest plan rests on.
        self._planned_on = 0
        #: Whether the newest plan was asked for by a robot that stood, without a perception.
        self._unseen = False
        #: Way at the last map that counted as a perception [m]; of missions before, below 0.
        self._way_looked = 0.0
        #: Way at the last stop [m].
        self._way_stopped = 0.0
        #: When the newest map was made [s].
        self._map_made = -math.inf
        #: When the robot last set out, or a map came on its way [s].
        self._mapped_at = 0.0
        self._unmapped = False
        #: Cell of the path from which on a new one is asked for.
        self._fork = 0

    @property
    def advice(self) -> str:
        """See `Mission.advice`: without maps on the way the robot stands for each."""
        if not self._unmapped:
            return super().advice
        return (
            "no map comes on the way, so that the robot stands for each: 'concurrent' is for a "
            "mapper in its mode 'continuous'"
        )

    def on_plan(self, now: float, request: int, plan: PlanResult) -> Commands:
        """See `Mission.on_plan`; on the way the robot goes over to the new path."""
        if self._state is State.MOVING:
            self._advance(now)
            if self._awaits(State.MOVING, request):
                self._request.settle()
                self._divert(plan)
            return ()
        awaited, no_path = self._awaits(State.PLANNING, request), plan.status == PlanStatus.NO_PATH
        if awaited and self._unseen and (no_path or self._leads_away(plan)):
            self._advance(now)
            return tuple(self._perceive())
        if awaited and no_path and self._around.forget_kept():
            # Where nobody has looked again somebody may have stood who has gone.
            self._advance(now)
            return tuple(self._plan())
        return super().on_plan(now, request, plan)

    def on_plan_error(self, now: float, request: int, message: str) -> Commands:
        """See `Mission.on_plan_error`; a robot on its way follows the path that it has."""
        if self._awaits(State.MOVING, request):
            self._advance(now)
            self._request.settle()
            return ()
        return super().on_plan_error(now, request, message)

    def _mapped(self, now: float, area: ExploredArea, stamp: float | None) -> Commands:
        commands = super()._mapped(now, area, stamp)
        self._maps += 1
        age = 0.0 if stamp is None else max(now - stamp, 0.0)
        self._map_made = self._time.elapsed - age
        if self._state is not State.MOVING:
            return commands
        self._mapped_at, self._unmapped = self._time.elapsed, False
        return (*commands, *self._on_the_way(now))

    def _watch(self) -> list[Command]:
        time = self._time.elapsed
        if self._state is State.MOVING:
            if self._hold.reason:
                self._mapped_at = time  # what it waits for, the mapper may miss as well
            self._unmapped |= time - self._mapped_at > MAP_SILENCE
            if self._request.overdue(time):
                self._request.settle()
        return super()._watch()

    def _set_out(self) -> list[Command]:
        verdict = verdicts.arrival(self._record, self._here)
        if verdict:
            return self._finish(verdict)
        self._way_stopped = 0.0
        # Where it had been long idle, or its mapper maps on demand, the map tells of another time.
        outdated = self._time.elapsed - self._map_made > MAP_SILENCE
        if outdated or not self._known.holds(self._here.x, self._here.y):
            return self._perceive()
        self._around.move_on()
        return self._plan_unseen()

    def _finish(self, verdict: verdicts.Verdict) -> list[Command]:
        # A goal is no look: many in a row must not make the robot forget what it has seen.
        self._way_looked -= self._record.path_length
        return super()._finish(verdict)

    @property
    def _look_place(self) -> Pose2 | None:
        """See `MissionState`: a way that was refused is not tried again for want of memory.

        At the start of a mission, and where it gets nowhere, the robot forgets all the same.
        """
        record = self._record
        return self._here if record.perceptions > 0 and record.without_progress == 0 else None

    def _perceive(self) -> list[Command]:
        self._unseen = False
        self._way_looked = self._record.path_length
        return super()._perceive()

    def _move(self, plan: PlanResult) -> list[Command]:
        self._mapped_at = self._time.elapsed
        return super()._move(plan)

    def _plan(self) -> list[Command]:
        self._planned_on = self._maps
        return super()._plan()

    def _plan_unseen(self) -> list[Command]:
        """Plan on the map that is there: the robot stands and has not looked from here."""
        self._unseen = True
        return [self._with_present_hits(plan) for plan in self._plan()]

    def _on_the_way(self, now: float) -> list[Command]:
        """Count what was seen on the way, and plan anew."""
        record, motion = self._record, self._motion
        if record.path_length - self._way_looked >= LOOK_SPACING:
            self._way_looked = record.path_length
            record.perceived(now, self._here, self._distance_remaining(), on_the_way=True)
            self._tried.perceived(self._known, self._here)
            self._around.look()
            motion.tighten()
            verdict = verdicts.exhaustion(record, self._here, self._p)
            if verdict:
                return self._finish(verdict)
        if self._request.open:
            return []
        self._fork = motion.ahead(FORK_DISTANCE + FORK_TIME * motion.velocity[0])
        x, y = motion.path.places[self._fork].tolist()
        start = Pose2(x, y, self._here.theta)
        commands = [self._with_present_hits(plan) for plan in self._plan()]
        self._state = State.MOVING
        return [replace(c, start=start) if isinstance(c, Plan) else c for c in commands]

    def _with_present_hits(self, command: Command) -> Command:
        if not isinstance(command, Plan):
            return command
        hits = self._around.known(self._time.clock)
        return replace(command, hits=tuple((x, y) for x, y in hits.tolist()))

    def _divert(self, plan: PlanResult) -> None:
        """Go over to a path that was planned from the fork, where that is of use."""
        motion = self._motion
        path = self._joined(plan) if plan.status == PlanStatus.FOUND else None
        settled = SETTLED_DISTANCE + SETTLED_TIME * motion.velocity[0]
        if path is None or motion.room > settled:
            return
        if plan.alpha > max(motion.path.alpha, self._p.believed_free_alpha):
            return  # a riskier path is for a robot that has looked from where it is
        reach = self._known.reach(path.points)
        if (reach == 0 and len(path.points) > 1) or self._same(path, reach) or self._back(path):
            return
        self._record.alpha = plan.alpha
        hits = self._around.known(self._time.clock)
        motion.divert(self._here, path, self._record.goal, reach, hits)

    def _joined(self, plan: PlanResult) -> PlannedPath | None:
        """Return the path up to the fork and the planned one; None if the robot is beyond it."""
        motion = self._motion
        first = motion.passed
        if self._fork < first:
            return None
        nearest = NEAREST * motion.path.resolution
        if first < self._fork and motion.distance_to(first + 1, self._here) < nearest:
            first += 1
        poses = [Pose2(x, y) for x, y in motion.path.places[first : self._fork].tolist()]
        geometry = self._known.geometry
        try:
            return PlannedPath.of([*poses, *plan.poses], plan.alpha, geometry, self._here)
        except ValueError:
            return None

    def _same(self, path: PlannedPath, reach: int) -> bool:
        """Whether a path is as good as that which the robot follows, as far as is known."""
        old = self._motion.path.points
        near = path.points[: reach + BEYOND]
        apart = np.hypot(*(near[:, None, :] - old[None, :, :]).transpose(2, 0, 1)).min(axis=1)
        return bool(apart.max() <= SAME * path.resolution)

    def _back(self, path: PlannedPath) -> bool:
        """Whether a path turns back from that which the robot follows."""
        x, y = self._motion.path.points[self._fork]
        fork = int(np.hypot(path.points[:, 0] - x, path.points[:, 1] - y).argmin())
        return self._turned(self._fork, path.points[fork:]) < BACK

    def _leads_away(self, plan: PlanResult) -> bool:
        """Whether a path leads a robot that has stopped elsewhere than where it was going."""
        if plan.status != PlanStatus.FOUND or len(self._motion.path.points) == 0:
            return False
        new = np.array([(pose.x, pose.y) for pose in plan.poses[: AWAY + 1]])
        return self._turned(self._motion.passed, new) < ELSEWHERE

    def _turned(self, cell: int, new: NDArray[np.float64]) -> float:
        """Return the cosine of the angle that a path (x, y) [m] takes to the one from a cell on.

        Where that one ends there, the robot's heading counts.
        """
        old = self._motion.path.points[cell : cell + AWAY + 1]
        was, now = old[-1] - old[0], new[min(AWAY, len(new) - 1)] - new[0]
        if len(old) < 2:
            was = np.array([math.cos(self._here.theta), math.sin(self._here.theta)])
        apart = float(np.hypot(*was) * np.hypot(*now))
        return float(was @ now) / apart if apart > 0.0 else 1.0

    def _stopped(self) -> list[Command]:
        """Go on where the map has a way on; else perceive, and judge as a robot that stood."""
        motion = self._motion
        assert motion.stopped is not None
        if verdicts.arrival(self._record, self._here):
            return super()._stopped()
        way = self._record.path_length - self._way_stopped
        self._way_stopped = self._record.path_length
        news = self._maps > self._planned_on or motion.stopped is Stop.CLEARANCE
        if motion.came_on and news and way >= LEAST_WAY:
            self._note_stop(motion.stopped)
            return self._plan_unseen()
        if self._unseen and not motion.came_on:
            # No perception was in vain.
            self._record.last_stop = motion.stopped
            return self._perceive()
        return super()._stopped()
