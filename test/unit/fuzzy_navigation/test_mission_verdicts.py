# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: how they end, and what is said of it."""

import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.concurrent_mission import mission_of
from fuzzy_navigation.mission_types import (
    Drive,
    Outcome,
    Perceive,
    Plan,
)
from fuzzy_navigation.params import motion_parameters
from fuzzy_navigation.planner import PlanResult, PlanStatus
from unit.fuzzy_navigation.mission_script import (
    GEOMETRY,
    Script,
    cells_along,
    finish_of,
    paper_script,
    wall_at,
)

STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


@pytest.mark.parametrize(
    ("alpha", "outcome", "words"),
    [
        (0.6, Outcome.LIVELOCK, "seems free"),
        (0.7, Outcome.UNREACHABLE, "believed occupied"),
        (1.0, Outcome.UNREACHABLE, "believed occupied"),
    ],
)
def test_no_progress_is_a_livelock_only_on_a_path_that_seems_free(
    alpha: float, outcome: Outcome, words: str
) -> None:
    script = paper_script()
    script.risk[:] = 1.0
    commands = script.set_out(GOAL, alpha=alpha)
    for _ in range(5):
        commands = script.again(commands, GOAL, alpha=alpha)
    finish = finish_of(commands)
    assert finish.outcome is outcome
    assert finish.perceptions == 6
    assert words in finish.message
    assert "(1.05, 2.05)" in finish.message


def test_progress_begins_the_count_anew() -> None:
    script = paper_script(livelock_limit=2)
    script.risk[:, 20:] = 1.0
    commands = script.set_out(GOAL)
    commands = script.again(script.run(), GOAL, alpha=0.6)
    script.risk[:, 20:25] = 0.0
    script.again(commands, GOAL, alpha=0.6)
    commands = script.run()
    assert script.pose.x == pytest.approx(2.25, abs=0.01)
    commands = script.again(commands, GOAL, alpha=0.6)
    assert [type(c) for c in commands] == [Perceive]
    assert finish_of(script.again(commands, GOAL, alpha=0.6)).outcome is Outcome.LIVELOCK


def test_half_a_cell_to_the_next_cells_centre_is_progress() -> None:
    script = paper_script(livelock_limit=1)
    script.pose = Pose2(1.09, 2.05, 0.0)
    script.risk[:, 14:] = 1.0
    script.set_out(GOAL)
    assert [type(c) for c in script.run()] == [Drive, Perceive]
    assert script.pose.x == pytest.approx(1.15, abs=0.005)


def test_the_cap_on_perceptions_ends_it() -> None:
    script = paper_script(perception_cap=3, livelock_limit=10)
    script.risk[:] = 1.0
    commands = script.set_out(GOAL)
    for _ in range(2):
        commands = script.again(commands, GOAL, alpha=0.6)
    finish = finish_of(commands)
    assert finish.outcome is Outcome.UNREACHABLE
    assert finish.perceptions == 3
    assert "perception_cap" in finish.message
    assert "(1.05, 2.05) m, 2.00 m from the goal" in finish.message


def planned(script: Script, status: PlanStatus, message: str = "because") -> tuple:
    """Start, perceive, and answer the request for a plan with a status."""
    script.tick()
    (plan,) = script.perceive(script.start(*GOAL))
    assert isinstance(plan, Plan)
    result = PlanResult(status, message)
    return plan, script.mission.on_plan(script.now, plan.request, result)


@pytest.mark.parametrize(
    ("status", "outcome"),
    [
        (PlanStatus.NO_PATH, Outcome.UNREACHABLE),
        (PlanStatus.START_OUTSIDE, Outcome.FAILED),
        (PlanStatus.GOAL_OUTSIDE, Outcome.FAILED),
        (PlanStatus.BAD_REQUEST, Outcome.FAILED),
    ],
)
def test_the_planners_no_ends_it(status: PlanStatus, outcome: Outcome) -> None:
    _, commands = planned(Script(), status)
    finish = finish_of(commands)
    assert finish.outcome is outcome
    assert finish.message == "because"


def test_a_planner_without_a_map_is_asked_again() -> None:
    script = Script()
    _, commands = planned(script, PlanStatus.NO_MAP)
    assert commands == ()
    for _ in range(2):
        start = script.now
        commands = script.run(2.0)
        assert script.now - start == pytest.approx(1.0, abs=0.1)
        plan = commands[-1]
        assert isinstance(plan, Plan)
        commands = script.mission.on_plan(
            script.now, plan.request, PlanResult(PlanStatus.NO_MAP, "none yet")
        )
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "3 times in a row" in finish.message
    assert "none yet" in finish.message


def test_what_stopped_it_is_kept_from_the_planner_until_nothing_else_is_left() -> None:
    script = Script()
    script.seen = wall_at(2.45)
    script.set_out(GOAL)
    commands = script.perceive(script.run())
    plan = commands[-1]
    assert isinstance(plan, Plan)
    # No room for the body, and 0.05 m more, before the wall that the sensors see.
    assert plan.barred
    assert all(2.45 - 0.28 < x < 2.45 + 0.28 for x, _ in plan.barred)
    assert GEOMETRY.centre_of(20, 22) in [pytest.approx(cell) for cell in plan.barred]
    # Without a way round it may try again what was refused, but only once.
    no_path = PlanResult(PlanStatus.NO_PATH, "no way round")
    (again,) = script.mission.on_plan(script.now, plan.request, no_path)
    assert isinstance(again, Plan)
    assert again.barred == ()
    finish = finish_of(script.mission.on_plan(script.now, again.request, no_path))
    assert finish.outcome is Outcome.UNREACHABLE
    # The sensor that stopped it is named: it may be at fault.
    told = "no way round; at the last stop infrared_0 sees something 0.1"
    assert finish.message.startswith(told)


def test_a_risky_cell_under_the_body_does_not_hold_the_robot() -> None:
    script = Script()
    script.risk[20, 11] = 1.0  # (1.15, 2.05) m, the robot at (1.05, 2.05)
    script.set_out(GOAL)
    assert finish_of(script.run()).outcome is Outcome.REACHED


def test_a_cell_that_stays_unexplored_before_it_is_kept_from_the_planner() -> None:
    script = paper_script()
    script.risk[:, 20:] = 1.0
    script.set_out(GOAL)
    commands = script.perceive(script.run())
    for _ in range(2):
        assert commands[-1].barred == (), "the next perception may show more"
        commands = script.perceive(script.plan(commands, cells_along((1.75, 2.05), GOAL)))
    assert commands[-1].barred == (pytest.approx((1.85, 2.05)),)


@pytest.mark.parametrize("goal", [(-0.1, 2.0), (6.01, 2.0), (2.0, 4.01)])
def test_a_goal_outside_the_map_is_refused(goal: tuple[float, float]) -> None:
    script = Script()
    script.tick()
    commands = script.start(*goal)
    assert [type(c) for c in commands] == [Perceive], "without a map nobody knows"
    finish = finish_of(script.show_map())
    assert finish.outcome is Outcome.FAILED
    assert "outside the map" in finish.message
    finish = finish_of(script.start(*goal))
    assert finish.outcome is Outcome.FAILED
    assert finish.mission == 2


def test_what_was_wrong_with_the_poses_is_told_until_one_can_be_used() -> None:
    script = Script()
    script.mission.pose_refused("of another clock")
    script.start(*GOAL)
    told = "no usable pose has come yet; the last was refused: of another clock"
    assert script.mission.feedback().hold == told
    script.tick()
    assert script.mission.feedback().hold == ""
    assert script.mission.on_tick(script.now + 1.0) == ()
    assert script.mission.feedback().hold == "no pose for 1.0 s: is 'pose' published?"
    script.mission.pose_refused("of another clock")
    finish = finish_of(script.mission.on_tick(script.now + 60.0))
    assert finish.message == (
        "the robot stood and waited in vain: no usable pose for 60.0 s; the last was refused: "
        "of another clock"
    )


def test_why_no_pose_came_is_known_to_the_mission_that_takes_over() -> None:
    script = Script()
    before = script.mission
    before.pose_refused("of another clock")
    script.mission = mission_of(motion_parameters(overrides={"concurrent": True}), before)
    assert type(script.mission) is not type(before)
    script.start(*GOAL)
    assert script.mission.feedback().hold.endswith("the last was refused: of another clock")


@pytest.mark.parametrize(
    ("poses", "words"),
    [
        ([], "no pose"),
        ([Pose2(1.05, 2.05), Pose2(1.35, 2.05)], "jumps"),
        ([Pose2(1.05, 2.05), Pose2(1.15, 7.05)], "leaves the map"),
        ([Pose2(2.05, 2.05), Pose2(2.15, 2.05)], "starts at"),
    ],
)
def test_a_path_that_cannot_be_followed_is_asked_for_again(poses: list[Pose2], words: str) -> None:
    script = Script()
    script.tick()
    commands = script.perceive(script.start(*GOAL))
    for _ in range(2):
        assert script.plan(commands, poses) == ()
        commands = script.run(2.0)
    finish = finish_of(script.plan(commands, poses))
    assert finish.outcome is Outcome.FAILED
    assert words in finish.message
