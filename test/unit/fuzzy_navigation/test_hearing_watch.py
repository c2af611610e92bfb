# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sonars that hear nothing: in open space, or deaf."""

import math

import pytest

from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.hearing_watch import ROUNDS, WITNESSES, HearingWatch
from fuzzy_navigation.mission_types import Drive, Finish, Outcome, Perceive
from fuzzy_navigation.params import motion_parameters
from unit.fuzzy_navigation.mission_script import DT, Script, finish_of, hall, nothing, wall_at

COUNT = 16
STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


def watch() -> HearingWatch:
    return HearingWatch(COUNT, 0.23, 6.5)


def ring(distance: float, x: float = 0.0, count: int = COUNT) -> list[SonarReading]:
    pose = Pose2(x, 0.0)
    return [SonarReading(pose, math.tau * k / COUNT, distance, 0.0, k) for k in range(count)]


def silence(ears: HearingWatch, x: float = 0.0) -> None:
    for _ in range(ROUNDS):
        ears.update(ring(math.inf, x))


def test_silence_beside_what_infrareds_see_is_deafness() -> None:
    ears = watch()
    ears.update(ring(5.0))
    silence(ears)
    assert ears.deaf(WITNESSES - 1, open_space=False) == ""
    assert ears.deaf(WITNESSES, open_space=True) == (
        f"no sonar hears any echo, though {WITNESSES} infrareds see something"
    )


@pytest.mark.parametrize(
    ("count", "x", "deaf"), [(3, 0.0, True), (2, 0.0, False), (16, 6.0, False)]
)
def test_silence_where_echoes_came_from_before_is_deafness(
    count: int, x: float, deaf: bool
) -> None:
    ears = watch()
    # On a circle of 2.23 m, of which no point is within 3.25 m of a robot 6 m away.
    ears.update(ring(2.0, count=count))
    silence(ears, x)
    told = ears.deaf(0, open_space=True)
    assert told == (
        "no sonar hears any echo, though 3 came from less than 3.2 m from here before"
        if deaf
        else ""
    )


def test_echoes_of_three_rounds_count() -> None:
    ears = watch()
    ears.update(ring(2.0))
    for _ in range(3):
        ears.update(ring(5.0))
    silence(ears)
    assert ears.deaf(0, open_space=False) == ""


def test_what_never_heard_anything_counts_as_deaf_unless_it_may_be_in_open_space() -> None:
    ears = watch()
    silence(ears)
    assert "watch.open_space" in ears.deaf(0, open_space=False)
    assert ears.deaf(0, open_space=True) == ""


@pytest.mark.parametrize("heard", [5.0, -math.inf])
def test_one_echo_ends_a_silence(heard: float) -> None:
    ears = watch()
    silence(ears)
    ears.update(ring(heard, count=1))
    assert ears.deaf(COUNT, open_space=False) == ""
    for _ in range(ROUNDS - 1):
        ears.update(ring(7.0))  # beyond the range from which on nothing is heard
    assert ears.deaf(COUNT, open_space=False) == ""
    ears.update(ring(7.0))
    assert ears.deaf(COUNT, open_space=False) != ""


def test_faulty_readings_are_neither_echo_nor_silence() -> None:
    ears = watch()
    for _ in range(ROUNDS):
        ears.update(ring(math.nan))
    assert ears.deaf(COUNT, open_space=False) == ""
    silence(ears)
    ears.update(ring(math.nan))
    assert ears.deaf(COUNT, open_space=False) != ""


def test_sonars_that_fall_deaf_on_the_way_make_it_stand_look_and_give_up() -> None:
    script = Script(motion_parameters())
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.heard = nothing
    place, looks, commands = script.pose.x, 0, ()
    while script.mission.active:
        commands = script.tick()
        if any(isinstance(c, Perceive) for c in commands):
            looks += 1
            commands = script.perceive(commands)
        assert script.now < 200.0
    finish = finish_of(commands)
    assert finish.outcome is Outcome.FAILED
    assert "cannot be trusted 3 times in a row" in finish.message
    assert "from here before" in finish.message
    assert looks == 2
    # Four rounds, a tick, and what it takes to stop.
    assert script.pose.x - place < 0.6 * (ROUNDS + 2) * DT


def test_a_robot_that_hears_again_goes_on() -> None:
    script = Script(motion_parameters())
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.heard = nothing
    commands = script.run()
    script.heard = hall
    script.tick()
    assert not any(isinstance(c, Finish) for c in commands)
    script.again(commands, GOAL, alpha=0.6)
    assert finish_of(script.run()).outcome is Outcome.REACHED


@pytest.mark.parametrize("overrides", [{"sonar_guard.enabled": False}, {"watch.open_space": True}])
def test_sonars_that_guard_nothing_or_may_be_in_open_space_need_not_hear(overrides: dict) -> None:
    script = Script(motion_parameters(overrides=overrides))
    script.heard = nothing
    script.set_out(GOAL)
    assert finish_of(script.run()).outcome is Outcome.REACHED


def test_at_a_perception_walls_that_infrareds_see_tell_of_deaf_sonars() -> None:
    script = Script(motion_parameters(overrides={"watch.open_space": True}))
    script.heard, script.seen = nothing, wall_at(1.5)
    for _ in range(ROUNDS):
        script.tick()
    commands = script.start(*GOAL)
    script.tick()
    commands = script.perceive(commands)
    assert STAND in commands
    assert "infrareds see something" in script.mission.feedback().hold
