# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""When a mission is over, and what is then said: only what the robot knows to be true."""

from __future__ import annotations

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.mission_types import Outcome
from fuzzy_navigation.params import MotionParameters
from fuzzy_navigation.plan_types import PlanResult, PlanStatus

__all__ = [
    "REPLACED",
    "Verdict",
    "arrival",
    "beyond",
    "doubted",
    "exhaustion",
    "no_plan",
    "outside",
    "stalemate",
    "stuck",
]

Verdict = tuple[Outcome, str]

#: Why a mission is cancelled when another goal comes.
REPLACED = "a newer goal replaced this one"


def beyond(goal: Pose2, geometry: GridGeometry) -> str:
    """Return that a goal lies outside the map, in words; empty if it lies inside."""
    if geometry.contains(goal.x, goal.y):
        return ""
    x0, y0, x1, y1 = geometry.bounds
    return (
        f"the goal ({goal.x:.2f}, {goal.y:.2f}) m lies outside the map, which covers "
        f"x {x0:g} to {x1:g} m and y {y0:g} to {y1:g} m; choose a goal inside"
    )


def outside(record: MissionRecord, geometry: GridGeometry) -> Verdict | None:
    """Return the verdict on a goal outside the map, None if it lies inside."""
    message = beyond(record.goal, geometry)
    return (Outcome.FAILED, message) if message else None


def arrival(record: MissionRecord, pose: Pose2) -> Verdict | None:
    """Return the verdict on a robot that stands at the goal, None if it does not."""
    distance = pose.distance_to(record.goal.x, record.goal.y)
    if distance > record.tolerance:
        return None
    return Outcome.REACHED, f"the robot stands {distance:.3f} m from the goal"


def no_plan(plan: PlanResult, record: MissionRecord) -> Verdict:
    """Return the verdict on a request to the planner that brought no path."""
    if plan.status != PlanStatus.NO_PATH:
        return Outcome.FAILED, plan.message
    because = f"; at the last stop {record.because}" if record.because else ""
    return Outcome.UNREACHABLE, plan.message + because


def stuck(pose: Pose2) -> Verdict:
    """Return the verdict on a robot that is driven and does not come on."""
    where = f"({pose.x:.2f}, {pose.y:.2f}) m"
    return Outcome.FAILED, f"the robot does not do what it is told: it is still at {where}"


def stalemate(record: MissionRecord, pose: Pose2, parameters: MotionParameters) -> Verdict | None:
    """Return the verdict on a robot that gets nowhere, None while it may still.

    Above the first rung of the ladder the planner admits cells that are believed occupied, on
    the last one all. A robot that makes no progress on such a path has found no way: the goal
    is unreachable. A livelock is no progress on a path that seems free.
    """
    if record.without_progress < parameters.livelock_limit:
        return None
    what = (
        f"{record.without_progress} perceptions in a row at ({pose.x:.2f}, {pose.y:.2f}) m "
        f"brought no progress, the last stop was {record.last_stop.name}"
        + (f": {record.because}" if record.because else "")
    )
    if record.alpha > parameters.believed_free_alpha:
        return (
            Outcome.UNREACHABLE,
            "the only paths left lead through cells believed occupied "
            f"(alpha {record.alpha:g}): {what}",
        )
    return Outcome.LIVELOCK, f"a path seems free (alpha {record.alpha:g}), but {what}"


def exhaustion(record: MissionRecord, pose: Pose2, parameters: MotionParameters) -> Verdict | None:
    """Return the verdict on a mission with no perception left, None if it has one."""
    if record.perceptions < parameters.perception_cap:
        return None
    distance = pose.distance_to(record.goal.x, record.goal.y)
    return (
        Outcome.UNREACHABLE,
        f"not reached after {record.perceptions} perceptions, the most that 'perception_cap' "
        f"allows: the robot stands at ({pose.x:.2f}, {pose.y:.2f}) m, {distance:.2f} m from the "
        "goal",
    )


def doubted(verdict: Verdict, doubt: str) -> Verdict:
    """Return a verdict in the light of what makes the map doubtful, in words.

    What the robot has reached it has. That there is no way is more than a map in doubt tells.
    """
    outcome, message = verdict
    if outcome is Outcome.REACHED or not doubt or doubt in message:
        return verdict
    message += f"; on the way {doubt}, so that the map may be wrong"
    return (Outcome.FAILED if outcome is Outcome.UNREACHABLE else outcome), message
