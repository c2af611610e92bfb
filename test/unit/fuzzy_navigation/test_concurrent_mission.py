# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions of a robot that maps while it moves, by script: maps come, partners answer."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.concurrent_mission import (
    LOOK_SPACING,
    MAP_SILENCE,
    SETTINGS,
    ConcurrentMission,
    mission_of,
)
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_types import (
    Drive,
    Finish,
    Outcome,
    Perceive,
    Phase,
    Plan,
    Stop,
)
from fuzzy_navigation.motion import Motion
from fuzzy_navigation.params import PAPER_PRESET, MotionParameters, motion_parameters
from fuzzy_navigation.planned_path import PlannedPath
from unit.fuzzy_navigation.mission_script import (
    DT,
    GEOMETRY,
    Concurrent,
    cells_along,
    finish_of,
    plans,
    wall_at,
)

GOAL = (5.05, 2.05)
CONFIG = Path(__file__).parents[3] / "fuzzy_navigation" / "config"


def test_the_parameter_chooses_the_mission() -> None:
    assert type(mission_of()) is Mission
    assert type(mission_of(MotionParameters())) is Mission
    assert type(mission_of(MotionParameters(concurrent=True))) is ConcurrentMission


def test_the_example_for_users_sets_what_the_options_set() -> None:
    nodes = yaml.safe_load((CONFIG / "concurrent.yaml").read_text())
    assert nodes == {
        f"/**/fuzzy_{name}": {"ros__parameters": dict(values)} for name, values in SETTINGS.items()
    }
    assert mapper_parameters(overrides=SETTINGS["mapper"]).mode == "continuous"
    assert motion_parameters(overrides=SETTINGS["motion"]).concurrent


def test_a_map_on_the_way_has_the_path_planned_anew_from_ahead_of_a_robot_that_drives_on() -> None:
    script = Concurrent(known_to=3.0)
    script.set_out(GOAL)
    assert script.ticks(30)[-1] > 0.3
    (plan,) = script.show_map()
    assert isinstance(plan, Plan)
    assert script.mission.phase is Phase.MOVING
    # On the path, ahead of where the robot can be when the answer comes.
    assert plan.start.y == pytest.approx(2.05)
    assert 0.2 < plan.start.x - script.pose.x < 0.6
    assert script.show_map() == ()  # one request at a time
    assert script.plan((plan,), cells_along((plan.start.x, 2.05), GOAL)) == ()
    assert min(script.ticks(10)) > 0.3


def test_the_robot_stops_where_the_map_ends_and_drives_on_without_a_stop_if_it_grows() -> None:
    stops = Concurrent(known_to=2.5)
    stops.set_out(GOAL)
    commands = stops.run()
    assert isinstance(commands[-1], Perceive)
    # The body's radius before what is unexplored.
    assert stops.pose.x == pytest.approx(2.5 - 0.23, abs=0.1)

    drives = Concurrent(known_to=2.5)
    drives.set_out(GOAL)
    drives.ticks(30)
    while drives.pose.x < 1.7:
        drives.ticks(1)
    drives.know(math.inf)
    (plan,) = plans(drives.show_map())
    drives.plan((plan,), cells_along((plan.start.x, 2.05), GOAL))
    while drives.pose.x < 4.0:
        assert drives.ticks(1)[0] > 0.4
    assert finish_of(drives.run()).outcome is Outcome.REACHED


def test_another_way_is_taken_where_the_one_ends_and_not_before() -> None:
    script = Concurrent(known_to=3.5)
    script.set_out(GOAL)
    script.ticks(25)
    x = script.pose.x
    assert x < 2.0
    (plan,) = plans(script.show_map())
    start = (plan.start.x, plan.start.y)
    script.plan((plan,), cells_along(start, (start[0], 3.05), (5.05, 3.05), GOAL))
    script.ticks(30)
    assert script.pose.y == pytest.approx(2.05, abs=0.02)
    assert script.pose.x < 3.2
    while script.pose.x < 2.75:
        script.ticks(1)
    (plan,) = plans(script.show_map())
    start = (plan.start.x, plan.start.y)
    script.plan((plan,), cells_along(start, (start[0], 3.05), (5.05, 3.05), GOAL))
    for _ in range(100):
        script.tick()
    assert script.pose.y > 2.5


@pytest.mark.parametrize(("corner", "alpha"), [((1.05, 2.05), 0.6), ((3.25, 3.05), 0.8)])
def test_it_does_not_turn_back_or_take_a_riskier_path_before_it_has_looked(
    corner: tuple[float, float], alpha: float
) -> None:
    script = Concurrent(known_to=3.5)
    script.set_out(GOAL)
    script.ticks(25)
    while script.pose.x < 2.75:
        script.ticks(1)
    (plan,) = plans(script.show_map())
    away = cells_along((plan.start.x, plan.start.y), corner, (corner[0], 3.05))
    script.plan((plan,), away, alpha)
    commands = script.run()
    assert isinstance(commands[-1], Perceive)
    # At the end of what is known of the path that it had.
    assert script.pose.x == pytest.approx(3.5 - 0.23, abs=0.1)
    assert script.pose.y == pytest.approx(2.05, abs=0.02)
    script.plan(script.perceive(commands), cells_along((script.pose.x, 2.05), corner), alpha)
    assert script.mission.feedback().alpha == alpha


def test_a_smaller_clearance_is_allowed_no_farther_than_the_robot_comes_on_by_it() -> None:
    """As after a perception without progress, with the paper's rule: 5 cm, then 12 again."""
    p = motion_parameters(PAPER_PRESET, {"concurrent": True})
    least = {}
    for tightened in (False, True):
        motion = Motion(p)
        pose, wall = Pose2(1.05, 2.05), np.array([(2.96, 0.1 * k) for k in range(40)])
        cells = cells_along((1.05, 2.05), GOAL)
        path = PlannedPath.of(cells, 0.6, GEOMETRY, pose)
        motion.begin(pose, path, Pose2(*GOAL), len(cells) - 1, True, wall)
        while motion.stopped is None:
            v, omega = motion.step(pose, wall, DT)
            assert abs(omega) < 0.1
            pose = replace(pose, x=pose.x + DT * v)
            if tightened:
                motion.tighten()
        least[tightened] = 2.96 - 0.23 - pose.x
    assert 0.05 - 0.005 <= least[False] < 0.12
    assert least[True] >= 0.12 - 0.005


def test_an_answer_that_comes_too_late_or_never_changes_nothing() -> None:
    script = Concurrent(known_to=3.0)
    script.set_out(GOAL)
    script.ticks(30)
    (plan,) = plans(script.show_map())
    while script.pose.x < plan.start.x + 0.15:
        script.ticks(1)
    far = cells_along((plan.start.x, 2.05), (plan.start.x, 3.55))
    script.plan((plan,), far)
    assert script.mission.plan_path[-1] == pytest.approx(GOAL)
    # One that fails, and one that is not answered at all.
    (plan,) = plans(script.show_map())
    assert script.mission.on_plan_error(script.now, plan.request, "gone") == ()
    (plan,) = plans(script.show_map())
    assert script.refuse((plan,)) == ()
    assert script.mission.phase is Phase.MOVING


def test_where_a_stop_condition_holds_it_plans_at_once_and_perceives_if_no_path_leads_on() -> None:
    for leads_on in (True, False):
        script = Concurrent()
        script.seen = wall_at(3.0)
        script.set_out(GOAL)
        script.ticks(5)
        commands = script.run()
        (plan,) = plans(commands)
        hits = np.array(plan.hits)
        assert np.abs(hits[:, 0] - 3.0).min() < 0.01  # the wall is in the request
        if leads_on:
            here = (script.pose.x, script.pose.y)
            script.seen = lambda x, y, direction: math.inf
            script.plan(commands, cells_along(here, (here[0] + 1.0, here[1] + 1.0)))
            assert script.mission.phase is Phase.MOVING
            assert script.mission.feedback().perceptions == 1
        else:
            commands = script.refuse(commands)
            assert isinstance(commands[-1], Perceive)
            # From here on the rules of a robot that stood hold: no path is a verdict.
            commands = script.refuse(script.perceive(commands))
            for _ in range(3):
                if isinstance(commands[-1], Finish):
                    break
                commands = script.refuse(commands)
            assert finish_of(commands).outcome is Outcome.UNREACHABLE


@pytest.mark.parametrize("angle", [60.0, 90.0, 180.0])
def test_a_robot_that_has_stopped_looks_before_it_goes_elsewhere(angle: float) -> None:
    script = Concurrent()
    script.seen = wall_at(3.0)
    script.set_out(GOAL)
    script.ticks(5)
    commands = script.run()
    x, y = script.pose.x, script.pose.y
    script.seen = lambda x, y, direction: math.inf
    away = x + math.cos(math.radians(angle)), y + math.sin(math.radians(angle))
    plan = cells_along((x, y), away)
    commands = script.plan(commands, plan)
    if angle == 60.0:
        assert script.mission.phase is Phase.MOVING
        return
    assert isinstance(commands[-1], Perceive)
    script.plan(script.perceive(commands), plan)
    assert script.mission.phase is Phase.MOVING


def test_maps_on_the_way_count_as_perceptions_by_the_way_and_come_to_the_cap() -> None:
    script = Concurrent(perception_cap=3)
    script.set_out(GOAL)
    start = script.pose.x
    counted = []
    finish = None
    for _ in range(400):
        script.tick()
        commands = script.show_map()
        if commands and isinstance(commands[-1], Finish):
            finish = commands[-1]
            break
        for plan in plans(commands):
            script.plan((plan,), cells_along((plan.start.x, plan.start.y), GOAL))
        counted.append((script.pose.x - start, script.mission.feedback().perceptions))
    way = np.array(counted)
    # One where it stood, and one after each piece of way.
    expected = 1 + np.floor(way[:, 0] / LOOK_SPACING)
    assert (np.abs(way[:, 1] - expected) <= 1).all()
    assert (np.abs(way[:, 1] - expected) == 0).mean() > 0.9
    assert finish is not None
    assert (finish.outcome, finish.perceptions) == (Outcome.UNREACHABLE, 3)
    assert script.pose.x - start == pytest.approx(2 * LOOK_SPACING, abs=0.1)
    told = [(e.on_the_way, e.stop) for e in script.mission.log]
    assert told == [(False, Stop.NONE), (True, Stop.NONE), (True, Stop.NONE)]


def test_a_map_made_on_the_way_is_not_told_as_another_stop() -> None:
    script = Concurrent(known_to=2.5)
    script.set_out(GOAL)
    commands = script.run()
    assert isinstance(commands[-1], Perceive)
    script.know(math.inf)
    commands = script.perceive(commands)
    here = (script.pose.x, script.pose.y)
    script.plan(commands, cells_along(here, GOAL))
    while script.pose.x < here[0] + LOOK_SPACING + 0.2:
        script.ticks(1)
        for plan in plans(script.show_map()):
            script.plan((plan,), cells_along((plan.start.x, plan.start.y), GOAL))
    assert script.mission.feedback().last_stop is Stop.UNEXPLORED
    told = [(e.on_the_way, e.stop) for e in script.mission.log]
    assert told == [(False, Stop.NONE), (False, Stop.UNEXPLORED), (True, Stop.NONE)]


def test_a_second_mission_sets_out_on_the_map_that_is_there() -> None:
    script = Concurrent()
    script.set_out((2.05, 2.05))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    commands = script.start(*GOAL)
    assert [type(c) for c in commands] == [Plan]
    script.plan(commands, cells_along((2.05, 2.05), GOAL))
    finish = finish_of(script.run())
    assert (finish.outcome, finish.perceptions) == (Outcome.REACHED, 0)


def test_it_perceives_first_where_the_map_does_not_know_the_place() -> None:
    script = Concurrent(known_to=0.5)
    script.tick()
    script.show_map()
    script.pose = replace(script.pose, x=3.05)
    script.tick()
    assert [type(c) for c in script.start(*GOAL)] == [Perceive]


def test_without_maps_on_the_way_it_alternates() -> None:
    """As with a mapper that makes none: stop, perceive, plan, move."""
    script = Concurrent(known_to=2.5)
    commands = script.set_out(GOAL)
    for known_to in (3.5, 4.5, 6.0):
        commands = script.run()
        assert isinstance(commands[-1], Perceive)
        script.know(known_to)
        script.again(commands, GOAL, alpha=0.6)
    finish = finish_of(script.run())
    assert (finish.outcome, finish.perceptions) == (Outcome.REACHED, 4)


def test_it_says_so_when_no_map_comes_on_the_way_and_no_longer_when_one_does() -> None:
    script = Concurrent(**{"follower.max_linear": 0.2})
    script.set_out(GOAL)
    script.ticks(math.floor(MAP_SILENCE / DT))
    assert script.mission.advice == ""
    script.ticks(4)
    assert "'continuous'" in script.mission.advice
    script.show_map()
    assert script.mission.advice == ""
    assert script.mission.maps_on_the_way == 1


def test_a_pause_of_the_motion_is_no_silence_of_maps_on_the_way() -> None:
    script = Concurrent(**{"follower.max_linear": 0.2})
    script.set_out(GOAL)
    script.ticks(20)
    script.now += 2.0 * MAP_SILENCE
    script.mission.resume(script.now)
    script.ticks(math.floor(MAP_SILENCE / DT) - 20)
    assert script.mission.advice == ""
    script.ticks(24)
    assert "'continuous'" in script.mission.advice


def test_a_small_step_between_two_stops_is_no_news() -> None:
    """Whoever stops again close by perceives: steps to and fro must come to an end."""
    script = Concurrent(known_to=2.0)
    script.set_out(GOAL)
    commands = script.run()
    assert isinstance(commands[-1], Perceive)
    script.know(2.2)
    script.again(commands, GOAL, alpha=0.6)
    while True:
        (_drive, *others) = script.tick()
        if others:
            break
        script.show_map()
    assert isinstance(others[-1], Perceive)


def test_a_pose_that_jumps_on_the_way_makes_it_stand_and_perceive() -> None:
    script = Concurrent(known_to=3.0)
    script.set_out(GOAL)
    script.ticks(30)
    script.show_map()
    script.pose = Pose2(script.pose.x, script.pose.y + 1.0, 0.0)
    assert Drive(0.0, 0.0) in script.tick()
    assert script.mission.phase is Phase.PERCEIVING


def test_time_without_a_goal_is_no_silence_of_maps_on_the_way() -> None:
    script = Concurrent()
    script.set_out((3.05, 2.05))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    for _ in range(math.ceil(2.0 * MAP_SILENCE / DT)):
        script.tick()
    script.show_map()  # the newest of those that came meanwhile
    # The plan is answered before the next pose.
    script.plan(script.start(*GOAL), cells_along((script.pose.x, script.pose.y), GOAL))
    script.ticks(20)
    assert script.mission.phase is Phase.MOVING
    assert script.mission.advice == ""


@pytest.mark.parametrize("age", [0.5 * MAP_SILENCE, 1.5 * MAP_SILENCE])
def test_a_goal_that_comes_while_the_map_is_of_now_is_set_out_for_without_a_look(
    age: float,
) -> None:
    script = Concurrent()
    script.set_out((3.05, 2.05))
    assert finish_of(script.run()).outcome is Outcome.REACHED
    for _ in range(math.ceil(20.0 / DT)):
        script.tick()
    # One that comes late tells of the time of its stamp.
    script.take(script.mission.on_map(script.now, GEOMETRY, script.risk, script.now - age))
    (command,) = script.start(*GOAL)
    assert isinstance(command, Plan if age < MAP_SILENCE else Perceive)


def test_time_without_poses_is_no_silence_of_maps_on_the_way() -> None:
    script = Concurrent()
    script.set_out(GOAL)
    script.ticks(10)
    for _ in range(math.ceil(1.5 * MAP_SILENCE / DT)):
        script.now += DT
        script.take(script.mission.on_tick(script.now))
    assert "no pose" in script.mission.feedback().hold
    script.ticks(5)
    assert script.mission.advice == ""
    script.ticks(math.ceil(MAP_SILENCE / DT))  # it drives again, and still no map comes
    assert script.mission.advice
