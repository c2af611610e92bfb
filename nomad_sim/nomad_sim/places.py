# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whether a world's start and goal are places where a mission can begin and end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from nomad_sim.ray_casting import in_polygon
from nomad_sim.world import World

__all__ = ["check_places"]


def check_places(world: World, robot_radius: float) -> None:
    """Refuse a start without room for the body, and a goal that cannot be reached as claimed.

    Whether there is a way from one to the other is not looked at, except for closed walls
    between them: that takes a search, see `ground_truth.reachable`.

    Parameters
    ----------
    world : World
        The world. Its obstacles that move, come or go count at the start where they stand at
        first, and not at all at the goal.
    robot_radius : float
        Radius of the body [m].

    Raises
    ------
    ValueError
        Naming the place, the obstacle, and what can be done.
    """
    start, goal = (world.start.x, world.start.y), world.goal
    if problem := _problem(world, start, robot_radius):
        raise ValueError(
            f"start.position: {problem}; move the start, or give the robot a smaller "
            "robot.radius under 'parameters'"
        )
    if world.expected != "reached":
        return
    lasting = tuple(m for m in world.moving if m.lasting)
    # A world of its own would compute its surfaces anew.
    still = world if lasting == world.moving else replace(world, moving=lasting)
    if problem := _problem(still, goal, robot_radius):
        raise ValueError(
            f"goal.position: {problem}; move the goal, or write 'expected: unreachable'"
        )
    for number, wall in enumerate(world.walls):
        segments = wall.segments
        if wall.closed and (
            in_polygon(*start, segments, 0, len(segments))
            != in_polygon(*goal, segments, 0, len(segments))
        ):
            raise ValueError(
                f"goal.position: every way from the start to ({goal[0]:g}, {goal[1]:g}) m crosses "
                f"walls[{number}], a closed line; open it, move the goal, or write "
                "'expected: unreachable'"
            )


def _problem(world: World, place: tuple[float, float], radius: float) -> str:
    """Return what is in the body's way at a place (x, y) [m] at first; empty if nothing is."""
    if world.surfaces().distance(*place) >= radius:
        return ""
    room, name = min((one.surfaces().distance(*place), name) for name, one in _each(world))
    spot = f"({place[0]:g}, {place[1]:g}) m"
    if room < 0.0:
        return f"{spot} lies inside {name}, {-room:.2f} m from its surface"
    return f"{spot} is {room:.2f} m from {name}, and the robot's body has a radius of {radius:g} m"


def _each(world: World) -> Iterator[tuple[str, World]]:
    """Yield the obstacles by name, each in a world of its own."""
    bare = replace(world, walls=(), polygons=(), circles=(), moving=())
    for i, wall in enumerate(world.walls):
        yield f"walls[{i}]", replace(bare, walls=(wall,))
    for i, polygon in enumerate(world.polygons):
        yield f"polygons[{i}]", replace(bare, polygons=(polygon,))
    for i, circle in enumerate(world.circles):
        yield f"circles[{i}]", replace(bare, circles=(circle,))
    for i, moving in enumerate(world.moving):
        yield f"moving[{i}]", replace(bare, moving=(moving,))
