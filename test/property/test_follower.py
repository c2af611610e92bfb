# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The follower on any path from cell to cell, in a world of its own: exact kinematics."""

import itertools
import math
from collections import deque

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.follower import Follower
from fuzzy_navigation.params import FollowerParameters

CELL = 0.1
DIRECTIONS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def distance_to_polyline(x: float, y: float, points: NDArray[np.float64]) -> float:
    """Distance [m] to the nearest of the segments, by the textbook's projection."""
    best = min(math.hypot(x - px, y - py) for px, py in points)
    for (ax, ay), (bx, by) in itertools.pairwise(points):
        length2 = (bx - ax) ** 2 + (by - ay) ** 2
        if length2 > 0.0:
            t = min(max(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length2, 0.0), 1.0)
            best = min(best, math.hypot(x - ax - t * (bx - ax), y - ay - t * (by - ay)))
    return best


class Drive:
    """A unicycle that does exactly what it was told, `late` ticks later."""

    def __init__(self, pose: Pose2, late: int) -> None:
        self.x, self.y, self.theta = pose.x, pose.y, pose.theta
        self.waiting = deque([(0.0, 0.0)] * late)

    @property
    def pose(self) -> Pose2:
        return Pose2(self.x, self.y, self.theta)

    @property
    def standing(self) -> bool:
        return not any(v or omega for v, omega in self.waiting)

    def move(self, v: float, omega: float, dt: float) -> None:
        self.waiting.append((v, omega))
        v, omega = self.waiting.popleft()
        if abs(omega) < 1e-9:  # as good as straight, and v / omega may be no number
            self.x += v * dt * math.cos(self.theta)
            self.y += v * dt * math.sin(self.theta)
        else:
            end = self.theta + omega * dt
            self.x += v / omega * (math.sin(end) - math.sin(self.theta))
            self.y -= v / omega * (math.cos(end) - math.cos(self.theta))
            self.theta = end


@st.composite
def cell_paths(draw: st.DrawFn) -> NDArray[np.float64]:
    """Paths with turns of up to 180 degrees; start and end need not be cell centres."""
    direction = draw(st.integers(0, 7))
    turns = draw(st.lists(st.sampled_from([0, 0, 0, 0, 1, -1, 1, -1, 2, -2, 3, 4]), max_size=18))
    cells = [(0, 0)]
    for turn in [0, *turns]:
        direction = (direction + turn) % 8
        dx, dy = DIRECTIONS[direction]
        cells.append((cells[-1][0] + dx, cells[-1][1] + dy))
    points = CELL * np.array(cells, dtype=np.float64)
    offset = st.floats(-0.049, 0.049)
    points[0] += draw(offset), draw(offset)
    points[-1] += draw(offset), draw(offset)
    return points


@given(
    points=cell_paths(),
    heading=st.floats(-math.pi, math.pi),
    dt=st.sampled_from([0.05, 0.02, 0.1]),
    late=st.sampled_from([0, 1]),
)
@settings(max_examples=150)
def test_stays_within_half_a_cell_and_stops_at_the_end(
    points: NDArray[np.float64], heading: float, dt: float, late: int
) -> None:
    limits = FollowerParameters()
    follower = Follower(limits)
    follower.follow(points)
    robot = Drive(Pose2(points[0, 0], points[0, 1], heading), late)
    v_before = omega_before = 0.0
    # No path of n cells takes longer: every corner a turn on the spot, every step a stop.
    patience = 8.0 + 7.0 * len(points)
    for _ in range(math.ceil(patience / dt)):
        v, omega = follower.step(robot.pose, dt)
        assert 0.0 <= v <= limits.max_linear
        assert abs(omega) <= limits.max_angular
        assert abs(v - v_before) <= limits.linear_acceleration * dt + 1e-12
        assert abs(omega - omega_before) <= limits.angular_acceleration * dt + 1e-12
        v_before, omega_before = v, omega
        robot.move(v, omega, dt)
        assert distance_to_polyline(robot.x, robot.y, points) <= 0.5 * CELL
        if follower.done and robot.standing:
            break
    assert follower.done
    assert math.hypot(robot.x - points[-1, 0], robot.y - points[-1, 1]) <= 0.005


@given(points=cell_paths(), stop=st.floats(0.0, 1.0), dt=st.sampled_from([0.05, 0.1]))
@settings(max_examples=60)
def test_stands_where_it_is_told_to(points: NDArray[np.float64], stop: float, dt: float) -> None:
    follower = Follower(FollowerParameters())
    follower.follow(points)
    robot = Drive(Pose2(points[0, 0], points[0, 1], 0.0), 0)
    stop_at = stop * follower.length
    for _ in range(math.ceil((8.0 + 7.0 * len(points)) / dt)):
        robot.move(*follower.step(robot.pose, dt, stop_at=stop_at), dt)
        assert follower.progress <= stop_at + 0.005
        if follower.standing and follower.progress >= stop_at - 0.005:
            break
    else:
        raise AssertionError(f"stood at {follower.progress} m instead of {stop_at} m")
    target = follower.points_at([stop_at])[0]
    assert math.hypot(robot.x - target[0], robot.y - target[1]) <= 0.05
