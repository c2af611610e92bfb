# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""One motion phase: a planned path followed until a stop condition holds.

Paper, section IV-B: up to the goal, unless the robot is leaving the explored area or an
obstacle is too close. How far the path stays explored is known beforehand; clearances are
judged at every tick, and far enough ahead that the robot really stands in time.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.clear_way import LARGE_CELL, clear_until
from fuzzy_navigation.clearance import approach_speed, clearance_at
from fuzzy_navigation.clearance_layer import PLENTY, best_clearance, best_places, shift_within
from fuzzy_navigation.elastic_band import roomy_band
from fuzzy_navigation.follower import ALIGNED, BRAKING_PART, Follower
from fuzzy_navigation.mission_types import Stop
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.planned_path import PlannedPath
from fuzzy_navigation.stop_rules import ClosingClearance, LayerClearance, stop_rule

__all__ = ["Motion"]

#: A point of the path that is nearer than this [m] has been passed.
PASSED = 0.01
#: A robot that came this much farther along its path has come on [m].
ADVANCE = 0.01
#: What another place in a cell ahead must be better by for a robot on its way to take it [m].
BETTER = 0.01
Points = NDArray[np.float64]

#: No points.
NOTHING = np.empty((0, 2))
#: What the clearance exceeds its limit by where a smooth path counts for more than room [m].
SPARE = 0.03
#: Way that a robot may have come since the pose that it goes by [m]; it drives slower, not below
#: a speed [m/s].
STALE_WAY, CRAWL = 0.05, 0.05
#: Speed that is allowed at any clearance [m/s].
LEAST_SPEED = 0.1
#: Heading error at which a turn on the spot ends, of a robot that maps on its way [rad].
ROUGHLY_ALIGNED = math.radians(15.0)


class Motion:
    """Drives one planned path after the other.

    Parameters
    ----------
    parameters : MotionParameters
        Rules and limits.
    """

    def __init__(self, parameters: MotionParameters) -> None:
        self._follower = Follower(parameters.follower)
        self.adopt(parameters)
        self.forget()

    def adopt(self, parameters: MotionParameters) -> None:
        """Go by other parameters; on the way by those only that `ParameterChange` lets through."""
        self._p = parameters
        self._rule = stop_rule(parameters.clearance, parameters.layer)
        # What the layer says of a cell, the way that is driven through it must keep as well.
        self._floor = ClosingClearance(parameters.layer.closed, parameters.layer.closed)
        aligned = ROUGHLY_ALIGNED if parameters.concurrent else ALIGNED
        self._follower.adopt(parameters.follower, aligned)
        # Clearance beyond which more is no better for where to drive in a cell [m].
        self._enough = parameters.clearance.limit + SPARE if parameters.concurrent else PLENTY

    def forget(self) -> None:
        """Forget the path."""
        self._path = PlannedPath(NOTHING, NOTHING, 0.0, math.inf)
        self._targets = self._path.points
        self._first = self._aimed_at = self._driven = self._reach = 0
        self._before = 0.0
        self._stop_at = math.inf
        self._vain = 0
        self._stopping: Stop | None = None
        self._stopped: Stop | None = None
        self._stalled = self._advanced = 0.0
        self._follower.halt()

    @property
    def path(self) -> PlannedPath:
        """The whole planned path."""
        return self._path

    @property
    def velocity(self) -> tuple[float, float]:
        """The last command: speed [m/s] and turning rate [rad/s]."""
        return self._follower.velocity

    @property
    def stopped(self) -> Stop | None:
        """Why the motion is over and the robot stands; None while it goes on."""
        return self._stopped

    @property
    def stuck(self) -> bool:
        """Whether the robot has been driven for long without coming on."""
        # Time for a turn on the spot, and some more.
        turn = 2.0 * math.pi / self._p.follower.max_angular
        return self._stalled > self._p.timeout.lost + turn

    @property
    def passed(self) -> int:
        """Index of the last cell of the path that the robot has passed."""
        follower = self._follower
        return self._first + follower.vertices_until(follower.progress + PASSED) - 1

    @property
    def progress(self) -> float:
        """Distance along the path that the robot has come [m]."""
        return self._before + self._follower.progress

    @property
    def came_on(self) -> bool:
        """Whether the robot has come at least a cell farther along the path."""
        # The follower may stop a little short of a cell's length.
        return self.passed > 0 or self.progress >= 0.9 * self._path.resolution

    @property
    def next_point(self) -> tuple[float, float]:
        """Centre (x, y) [m] of the path's cell that the robot stopped before.

        It is the one behind the last that is explored, or the next where there is no room.
        """
        last = self.passed if self._stopped is Stop.CLEARANCE else self._reach
        x, y = self._path.points[min(last + 1, len(self._path.points) - 1)]
        return float(x), float(y)

    def ahead(self, distance: float) -> int:
        """Return the index of the path's cell that lies a distance [m] ahead.

        It is one that the robot may drive to, or the last that it has passed.
        """
        along = self._follower.vertex_progress
        behind = int(np.searchsorted(along, self._follower.progress + distance))
        last = min(self._reach, self._driven)
        return min(max(self._first + behind, self.passed), last)

    @property
    def reach(self) -> int:
        """Index of the last cell of the path that the robot may drive to, as of now."""
        return self._reach

    @property
    def room(self) -> float:
        """Way along the path that the robot may drive, as far as it is known to be free [m]."""
        along = self._follower.vertex_progress
        last = min(max(self._reach - self._first, 0), len(along) - 1)
        return min(float(along[last]), self._stop_at) - self._follower.progress

    def distance_to(self, cell: int, pose: Pose2) -> float:
        """Return how far it is [m] from a pose to where in a cell of the path to drive."""
        return pose.distance_to(*self._targets[cell])

    @property
    def remaining(self) -> float:
        """Length of the path to the goal that is left [m]."""
        steps = np.diff(self._path.points[max(self._driven, 0) :], axis=0)
        return self._follower.remaining + float(np.hypot(steps[:, 0], steps[:, 1]).sum())

    def begin(
        self, pose: Pose2, path: PlannedPath, goal: Pose2, reach: int, vain: int, hits: Points
    ) -> None:
        """Set out on a path.

        Parameters
        ----------
        pose : Pose2
            Where the robot stands.
        path : PlannedPath
            Where it is to go.
        goal : Pose2
            The path ends exactly there if its last cell holds it.
        reach : int
            Index of the last cell of the path that is in the explored area.
        vain : int
            How many perceptions in a row have not ended a stop for want of clearance.
        hits : ndarray of float64, shape (n, 2)
            Hit points [m] of the perception.
        """
        self._vain = vain
        self._stalled, self._advanced, self._before = 0.0, 0.0, 0.0
        self._lay(pose, path, goal, reach, hits)

    def divert(
        self, pose: Pose2, path: PlannedPath, goal: Pose2, reach: int, hits: Points
    ) -> None:
        """Go over to another path without a stop; the parameters are those of `begin`."""
        self.tighten()
        self._before += self._follower.progress
        self._lay(pose, path, goal, reach, hits, moving=True)

    def _lay(
        self,
        pose: Pose2,
        path: PlannedPath,
        goal: Pose2,
        reach: int,
        hits: NDArray[np.float64],
        moving: bool = False,
    ) -> None:
        """Give the follower a path, from where the robot is to where it is explored.

        A robot that maps on its way gets all of it: it stops where it has to, but need not slow
        down beforehand for the end of what may be explored further by then.
        """
        last = len(path.points) - 1
        self._path, self._reach = path, reach
        self._driven = last if self._p.concurrent else reach
        self._stopping = self._stopped = None
        self._stop_at = math.inf
        self._first = self._aimed_at = 0
        self._targets = self._aim(slice(None), hits)
        centre = path.points[last]
        at_goal = np.abs(centre - (goal.x, goal.y)).max() <= 0.5 * path.resolution + 1e-9
        room = clearance_at((goal.x, goal.y), hits, self._p.robot_radius)[0]
        # Where the body has so little room, a better place in the cell is sought.
        if at_goal and not (self._p.subcell_target and room < self._p.layer.limit):
            self._targets[last] = goal.x, goal.y
        # From where the robot is straight to the second cell, or to the aim in its own one.
        ahead = self._targets[1 : self._driven + 1] if last > 0 else self._targets
        way = np.vstack([(pose.x, pose.y), ahead])
        if self._p.concurrent:
            way = self._smoothed(way, pose, hits, moving)
            self._targets[-len(way) + 1 :] = way[1:]
        self._follower.follow(way, moving=moving)
        if last > 0 and reach == 0:
            self._stopped = Stop.UNEXPLORED

    def allow(self, reach: int) -> None:
        """Take a new limit of the explored area while the robot is on its way."""
        self._reach = reach

    def tighten(self) -> None:
        """Allow a smaller clearance no longer if the robot has come on."""
        if self.came_on:
            self._vain = 0

    def halt(self) -> None:
        """Take note that the robot was commanded to stand at once."""
        self._follower.halt()

    def step(
        self,
        pose: Pose2,
        hits: NDArray[np.float64],
        dt: float,
        suspected: NDArray[np.float64] = NOTHING,
        delay: float = 0.0,
        limit: float = math.inf,
    ) -> tuple[float, float]:
        """Return the command of one tick, speed [m/s] and turning rate [rad/s].

        Parameters
        ----------
        pose : Pose2
            Where the robot is.
        hits : ndarray of float64, shape (n, 2)
            Hit points [m] to keep clear of.
        dt : float
            Time since the last tick [s].
        suspected : ndarray of float64, shape (m, 2)
            Points [m] that the robot must be able to stop short of, should they prove true.
        delay : float
            How long ago the robot was there [s].
        limit : float
            Speed not to exceed [m/s].
        """
        follower = self._follower
        self._stalled += dt
        if self.progress > self._advanced + ADVANCE:
            self._stalled, self._advanced = 0.0, self.progress
        if self._p.subcell_target and self.passed > self._aimed_at and self._stopping is None:
            self._aim_again(pose, hits)
        lag = 2.0 * dt + delay
        stop_at, max_speed = self._limits(pose, hits, suspected, lag)
        max_speed = min(max_speed, limit)
        if delay * max_speed > STALE_WAY:
            max_speed = max(STALE_WAY / delay, CRAWL)
        self._stop_at = stop_at
        if self._stopping is not None:
            stop_at = -math.inf
        v, omega = follower.step(pose, dt, stop_at=stop_at, max_speed=max_speed, delay=delay)
        if follower.standing and self._stopping is not None:
            self._stopped = self._stopping
        elif follower.done:
            last = self._driven == len(self._path.points) - 1
            self._stopped = Stop.GOAL if last else Stop.UNEXPLORED
        if follower.deviation > 2.0 * self._p.follower.max_deviation:
            # Pushed or slipped off the path: the plan does not hold here.
            self._stop(Stop.NONE)
        return v, omega

    def _aim(self, part: slice, hits: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where in each cell of a part of the path to drive [m], shape (n, 2)."""
        planned = self._path.places[part]
        if not self._p.subcell_target:
            return planned.copy()
        radius, shift = self._p.robot_radius, self._p.layer.shift
        shift = shift_within(shift, self._path.resolution)
        return best_places(self._path.points[part], hits, radius, shift, planned)

    def _smoothed(self, way: Points, pose: Pose2, hits: Points, moving: bool) -> Points:
        """Return a way from a pose on, bent less in its cells where that costs no room."""
        side, radius = self._path.resolution, self._p.robot_radius
        return roomy_band(way, pose if moving else None, hits, radius, self._enough, side)

    def _aim_again(self, pose: Pose2, hits: NDArray[np.float64]) -> None:
        """Drive to better places in the cells ahead, if what was seen since shows such."""
        self._aimed_at = self.passed
        ahead = slice(self._aimed_at + 1, self._driven + 1)
        before = self._targets[ahead]
        if len(before) == 0:
            return
        targets = self._aim(ahead, hits)
        radius = self._p.robot_radius
        gain = np.minimum(clearance_at(targets, hits, radius), self._enough)
        gain -= np.minimum(clearance_at(before, hits, radius), self._enough)
        if not (gain > BETTER).any():
            return
        self._targets[ahead] = np.where(gain[:, None] > BETTER, targets, before)
        self._before += self._follower.progress
        self._first = self._aimed_at
        way = np.vstack([(pose.x, pose.y), self._targets[ahead]])
        if self._p.concurrent:
            way = self._smoothed(way, pose, hits, moving=True)
            self._targets[ahead] = way[1:]
        self._follower.follow(way, moving=True)

    def _stop(self, reason: Stop) -> None:
        if self._stopping is None:
            self._stopping = reason

    def _limits(
        self, pose: Pose2, hits: Points, suspected: Points, lag: float
    ) -> tuple[float, float]:
        """Return where the robot has to stand at the latest [m] and its largest speed [m/s]."""
        follower, radius = self._follower, self._p.robot_radius
        speed, _ = follower.velocity
        deceleration = BRAKING_PART * self._p.follower.linear_acceleration
        horizon = follower.progress + speed * speed / (2.0 * deceleration)
        horizon += speed * lag
        stop_at, side, rungs = math.inf, self._path.resolution, (self._path.alpha, self._vain)
        if side >= LARGE_CELL:
            stop_at = clear_until(self._rule, follower, pose, hits, radius, *rungs, horizon)
            if stop_at <= follower.progress:
                self._stop(Stop.CLEARANCE)
        horizon += 1.5 * side
        passed = follower.vertex_progress
        first = self.passed - self._first + 1
        ahead = slice(first, max(first + 1, follower.vertices_until(horizon)))
        places = np.concatenate(([(pose.x, pose.y)], follower.vertices[ahead]))
        clearances = clearance_at(places, hits, radius)
        max_speed = max(LEAST_SPEED, approach_speed(float(clearances[0]), deceleration, lag))
        if len(suspected) > 0:
            # An echo tells no direction: it counts as if it lay ahead of the robot.
            room = float(clearance_at(places[:1], suspected, radius)[0]) - self._p.clearance.limit
            wary = max(LEAST_SPEED, approach_speed(room, deceleration, lag))
            max_speed = min(max_speed, wary)
        if self._reach < self._driven:
            # The map changed under the path.
            end = float(passed[self._reach - self._first])
            stop_at = min(stop_at, end)
            if follower.progress >= end - PASSED:
                self._stop(Stop.UNEXPLORED)
        blocked = self._blocked(clearances, self._first + first, hits).tolist()
        if True in blocked:
            step = blocked.index(True)
            if step == 0:
                self._stop(Stop.CLEARANCE)
            else:
                stop_at = min(stop_at, float(passed[first + step - 1]))
        return stop_at, max_speed

    def _blocked(
        self, clearances: NDArray[np.float64], first: int, hits: Points
    ) -> NDArray[np.bool_]:
        """Tell which steps along the path's points from the first one on must not be made.

        `clearances` [m] are those where the robot is and on the driven way beside the points.
        """
        alpha, vain = self._path.alpha, self._vain
        if not isinstance(self._rule, LayerClearance):
            return self._rule.blocked(clearances, alpha, vain)
        # As the planner judged the cells: by the best place in each.
        first = min(first, len(self._path.points) - 1)
        cells = self._path.points[first : first + len(clearances) - 1]
        shift = shift_within(self._p.layer.shift, self._path.resolution)
        best = best_clearance(cells, hits, self._p.robot_radius, shift)
        by_cells = self._rule.blocked(np.concatenate((clearances[:1], best)), alpha, vain)
        return by_cells | self._floor.blocked(clearances, alpha, vain)
