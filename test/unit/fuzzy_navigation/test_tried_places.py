# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script: looking again along other rays, and trying everything again."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.look_turn import LookTurn
from fuzzy_navigation.mission_record import MissionRecord
from fuzzy_navigation.mission_types import Drive, Outcome, Perceive, Phase, Plan, Stop
from fuzzy_navigation.params import FollowerParameters, motion_parameters
from fuzzy_navigation.planner import PlanResult, PlanStatus
from fuzzy_navigation.tried_places import TriedPlaces
from unit.fuzzy_navigation.mission_script import DT, GEOMETRY, Script, finish_of

GOAL = (3.05, 2.05)
TURN = math.radians(20.0)


def blocked(**overrides: object) -> tuple[Script, tuple[object, ...]]:
    """Return a script whose robot could not set out after its first perception."""
    script = Script(**overrides)
    script.risk[:] = 1.0
    return script, script.set_out(GOAL, alpha=0.6)


def test_without_progress_the_robot_turns_before_it_looks_again() -> None:
    script, commands = blocked(look_turn=TURN)
    assert commands == ()
    assert script.mission.phase is Phase.MOVING
    follow = script.run(limit=3.0)
    assert [type(c) for c in follow] == [Drive, Perceive]
    assert follow[0] == Drive(0.0, 0.0)
    assert script.pose.theta == pytest.approx(TURN, abs=math.radians(1.5))
    assert (script.pose.x, script.pose.y) == (1.05, 2.05)


def test_without_the_rule_it_looks_at_once() -> None:
    _, commands = blocked(look_turn=0.0)
    assert [type(c) for c in commands] == [Perceive]


def test_the_turn_keeps_to_the_limits_of_the_robot() -> None:
    p = FollowerParameters(max_angular=0.5, angular_acceleration=1.0)
    turn = LookTurn(2.0, p)
    pose, before, rates = Pose2(0.0, 0.0, 3.0), 0.0, []
    assert turn.begin(pose)
    while (omega := turn.step(pose, DT)) is not None:
        assert abs(omega) <= 0.5 + 1e-12
        assert abs(omega - before) <= 1.0 * DT + 1e-12
        before = omega
        rates.append(omega)
        pose = Pose2(0.0, 0.0, pose.theta + omega * DT)
    assert pose.theta == pytest.approx(5.0, abs=math.radians(1.0))
    assert max(rates) == pytest.approx(0.5)


def test_a_robot_that_does_not_turn_looks_all_the_same() -> None:
    turn = LookTurn(TURN, FollowerParameters())
    turn.begin(Pose2(0.0, 0.0, 0.0))
    ticks = 0
    while turn.step(Pose2(0.0, 0.0, 0.0), DT) is not None:
        ticks += 1
    assert 1.0 < ticks * DT < 3.0


def test_no_angle_no_turn() -> None:
    assert not LookTurn(0.0, FollowerParameters()).begin(Pose2(0.0, 0.0))


def no_path(script: Script, commands: object) -> tuple[object, ...]:
    (request,) = (c.request for c in commands if isinstance(c, Plan))  # type: ignore[attr-defined]
    return script.mission.on_plan(script.now, request, PlanResult(PlanStatus.NO_PATH, "no way"))


def test_before_the_goal_is_unreachable_everything_barred_is_given_free_once() -> None:
    script = Script(frontier_looks=1, patience=0)
    script.risk[:] = 1.0
    script.tick()
    (plan,) = script.perceive(script.start(*GOAL))
    assert isinstance(plan, Plan)
    assert len(plan.barred) > 20
    (again,) = no_path(script, [plan])
    assert isinstance(again, Plan)
    assert again.barred == ()
    assert finish_of(no_path(script, [again])).outcome is Outcome.UNREACHABLE  # type: ignore[arg-type]


def test_obstacles_are_tried_once_more_before_the_patience_is_over_and_once_after_it() -> None:
    tried = TriedPlaces(motion_parameters(overrides={"frontier_looks": 0, "patience": 20}))
    area = ExploredArea(GEOMETRY, np.ones(GEOMETRY.shape), 0.9, 0.23, "disc")
    granted = []
    for perceptions in (5, 10, 20, 25):
        record = MissionRecord(1, Pose2(3.05, 2.05), 0.1, 0.0)
        record.perceptions, record.last_stop = perceptions, Stop.CLEARANCE
        tried.stopped(record, np.array([(1.55, 2.05)]), (1.55, 2.05), area)
        assert len(tried.barred(perceptions, area)) > 0
        granted.append(tried.try_again(perceptions))
        assert tried.barred(perceptions, area) == ()
    assert granted == [True, False, True, False]


@pytest.mark.parametrize(
    ("overrides", "looks", "alpha", "impasse"),
    [
        ({}, 6, 0.6, True),
        ({}, 5, 0.6, False),
        ({}, 6, 0.7, False),  # through cells believed occupied: there is a verdict for that
        ({"livelock_limit": 2}, 2, 0.6, True),
        ({"clearance.impasse": 0.0}, 6, 0.6, False),
        ({"refusal_memory": 0}, 6, 0.6, False),
    ],
)
def test_where_look_after_look_finds_no_room_there_is_no_way(
    overrides: dict[str, float], looks: int, alpha: float, impasse: bool
) -> None:
    tried = TriedPlaces(motion_parameters(overrides={"frontier_looks": 0, **overrides}))
    area = ExploredArea(GEOMETRY, np.zeros(GEOMETRY.shape), 0.9, 0.23, "disc")
    record = MissionRecord(1, Pose2(3.05, 2.05), 0.1, 0.0)
    record.alpha = alpha
    for _ in range(looks):
        record.perceptions += 1
        record.stopped(Stop.CLEARANCE, progress=False)
    assert tried.stopped(record, np.empty((0, 2)), (1.55, 2.05), area) is impasse
    assert len(tried.barred(looks, area)) == (9 if impasse else 0)


@pytest.mark.parametrize(
    ("perceptions", "times"), [([1, 2, 3, 4], 3), ([7, 8], 1), ([2, 9, 10], 2)]
)
def test_all_is_looked_at_again_while_patience_lasts_and_once_after_it(
    perceptions: list[int], times: int
) -> None:
    parameters = motion_parameters(overrides={"frontier_looks": 1, "patience": 3})
    tried = TriedPlaces(parameters)
    area = ExploredArea(GEOMETRY, np.ones(GEOMETRY.shape), 0.9, 0.23, "disc")
    granted = 0
    for perception in perceptions:
        tried.perceived(area, Pose2(1.05, 2.05), np.empty((0, 2)))
        assert len(tried.barred(perception, area)) > 20
        if tried.try_again(perception):
            granted += 1
            assert tried.barred(perception, area) == ()
    assert granted == times
    tried.forget()
    assert tried.barred(100, area) == ()
    tried.perceived(area, Pose2(1.05, 2.05), np.empty((0, 2)))
    assert tried.try_again(100)
