# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a robot that maps while it moves remembers of what it has passed, when it looks anew."""

import math
from collections.abc import Callable

import numpy as np

from fuzzy_navigation.concurrent_mission import LOOK_SPACING
from fuzzy_navigation.mission_types import Perceive, Phase
from unit.fuzzy_navigation.mission_script import (
    Concurrent,
    cells_along,
    corridor,
    nothing,
    plans,
    wall_at,
)

GOAL = (5.05, 2.05)


def beside_and_ahead(
    x_from: float, x_to: float, y_wall: float, ahead: float
) -> Callable[[float, float, float], float]:
    """Return what sensors see of a wall along x, of some length, and of one along y."""
    above, across = corridor(-math.inf, y_wall, x_from), wall_at(ahead)

    def seen(x: float, y: float, direction: float) -> float:
        distance = above(x, y, direction)
        beyond = x + distance * math.cos(direction) > x_to
        return min(math.inf if beyond else distance, across(x, y, direction))

    return seen


def test_a_look_leaves_alone_what_it_cannot_see_until_no_path_is_left() -> None:
    """Glass that was passed is in no sonar's map: forgotten, it would be tried again."""
    script = Concurrent()
    script.seen = beside_and_ahead(1.2, 1.8, 2.5, ahead=3.5)
    script.set_out(GOAL)
    script.ticks(5)
    commands = script.refuse(script.run())
    assert isinstance(commands[-1], Perceive)
    # Standing for the look: here it sees what is ahead, and not what it has passed.
    script.ticks(10)
    (plan,) = plans(script.perceive(commands))
    hits = np.array(plan.hits)
    assert ((np.abs(hits[:, 1] - 2.5) < 0.01) & (hits[:, 0] < 1.81)).sum() >= 3
    assert (np.abs(hits[:, 0] - 3.5) < 0.01).any()
    # No path: who was passed may have gone. Without a path then there is none.
    (anew,) = plans(script.refuse((plan,)))
    left = np.array(anew.hits)
    assert np.hypot(left[:, 0] - script.pose.x, left[:, 1] - script.pose.y).max() < 0.84
    assert set(anew.hits) < set(plan.hits)
    here = (script.pose.x, script.pose.y)
    script.plan((anew,), cells_along(here, (here[0] - 1.0, here[1] + 1.0)))
    assert script.mission.phase is Phase.MOVING


def test_a_robot_that_gets_nowhere_forgets_what_it_passed() -> None:
    script = Concurrent()
    script.seen = beside_and_ahead(1.2, 1.8, 2.5, ahead=3.5)
    script.set_out(GOAL)
    script.ticks(5)
    commands = script.refuse(script.run())
    nearest = []
    # On into the wall: a cell's length at first, then nothing.
    for _ in range(3):
        (plan,) = plans(script.perceive(commands))
        nearest.append(min(x for x, _ in plan.hits))
        script.plan((plan,), cells_along((script.pose.x, script.pose.y), GOAL))
        commands = script.run()
        assert isinstance(commands[-1], Perceive)
        script.ticks(10)
    assert max(nearest[:2]) < 1.81
    assert nearest[2] > 3.4


def test_goal_after_goal_the_robot_forgets_nothing_that_it_has_not_driven_away_from() -> None:
    script = Concurrent()
    script.seen = wall_at(3.0)
    script.set_out(GOAL)
    while script.pose.x < 2.4:
        script.tick()
    script.seen = nothing  # what only sonars and the past tell of
    for _ in range(20):
        script.show_map()
        (plan,) = plans(script.start(*GOAL))
        script.ticks(1)
        assert np.abs(np.array(plan.hits).reshape(-1, 2)[:, 0] - 3.0).min() < 0.01
    assert script.pose.x < 2.4 + LOOK_SPACING


def test_looks_on_the_way_are_counted_by_the_way_whatever_the_goals() -> None:
    script = Concurrent()
    script.set_out(GOAL)
    looks, begun = 0, script.pose.x
    while script.pose.x < 4.0:
        script.ticks(10)
        script.show_map()
        looks += sum(entry.on_the_way for entry in script.mission.log)
        way = cells_along((script.pose.x, 2.05), GOAL)
        script.plan(script.start(*GOAL), way)
    assert looks == int((script.pose.x - begun) / LOOK_SPACING)
