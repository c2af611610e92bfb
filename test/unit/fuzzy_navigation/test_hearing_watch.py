# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sonars that hear nothing: in open space, or deaf."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from fuzzy_map_building.sensor_params import SonarParameters
from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.hearing_watch import ROUNDS, WITNESSES, HearingWatch
from fuzzy_navigation.mission_types import Drive, Finish, Outcome, Perceive
from fuzzy_navigation.params import motion_parameters
from unit.fuzzy_navigation.mission_script import DT, Script, finish_of, hall, nothing, wall_at

COUNT = 16
NOTHING = np.empty((0, 2))
STAND = Drive(0.0, 0.0)
GOAL = (3.05, 2.05)


def watch() -> HearingWatch:
    return HearingWatch(SonarParameters())


def ring(
    distance: float, x: float = 0.0, sensors: Sequence[int] = range(COUNT), theta: float = 0.0
) -> list[SonarReading]:
    pose = Pose2(x, 0.0, theta)
    return [SonarReading(pose, math.tau * k / COUNT, distance, 0.0, k) for k in sensors]


def silence(ears: HearingWatch, x: float = 0.0) -> None:
    for _ in range(ROUNDS):
        ears.update(ring(math.inf, x))


def circle(count: int, radius: float) -> np.ndarray:
    angles = math.tau * np.arange(count) / COUNT
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))


def test_silence_of_beams_on_what_infrareds_see_is_deafness() -> None:
    ears = watch()
    ears.update(ring(5.0))
    silence(ears)
    assert ears.deaf(circle(WITNESSES - 1, 0.5), open_space=False) == ""
    assert ears.deaf(circle(WITNESSES, 0.5), open_space=True) == (
        "hardly any sonar hears an echo, though infrareds see 3 points that should echo"
    )


@pytest.mark.parametrize(
    ("sensors", "x", "deaf"), [(3, 0.0, True), (2, 0.0, False), (COUNT, 6.0, False)]
)
def test_silence_where_echoes_came_from_before_is_deafness(
    sensors: int, x: float, deaf: bool
) -> None:
    ears = watch()
    # On a circle of 2.23 m, of which no point is within 3.25 m of a robot 6 m away.
    ears.update(ring(2.0, sensors=range(sensors)))
    silence(ears, x)
    told = ears.deaf(NOTHING, open_space=False)
    assert ("though 3 came from less than 3.2 m away before" in told) == deaf
    assert ("watch.open_space" in told) == deaf
    # Who may be in open space may have come from where something was, or it has gone.
    assert ears.deaf(NOTHING, open_space=True) == ""


def test_echoes_of_three_rounds_count() -> None:
    ears = watch()
    ears.update(ring(2.0))
    for _ in range(3):
        ears.update(ring(5.0))
    silence(ears)
    assert ears.deaf(NOTHING, open_space=False) == ""


def test_sonars_that_look_ahead_need_not_hear_what_is_behind_them() -> None:
    front = (13, 14, 15, 0, 1, 2, 3)
    p = SonarParameters(
        frame_ids=tuple(f"s{k}" for k in front),
        bearings=tuple(math.tau * k / COUNT for k in front),
    )
    for theta, deaf in ((0.0, True), (math.pi, False)):
        ears = HearingWatch(p)
        ears.update(ring(1.0, sensors=front))
        for _ in range(ROUNDS):
            ears.update(ring(math.inf, sensors=front, theta=theta))
        wall = np.array([(1.23, 0.1 * k) for k in range(-2, 3)])
        assert (ears.deaf(NOTHING, open_space=False) != "") == deaf
        assert (ears.deaf(wall, open_space=False) != "") == deaf
    # Nor does it say anything that they have not heard anything yet.
    ears = HearingWatch(p)
    for _ in range(ROUNDS):
        ears.update(ring(math.inf, sensors=front))
    assert ears.deaf(NOTHING, open_space=False) == ""


def test_what_never_heard_anything_counts_as_deaf_unless_it_may_be_in_open_space() -> None:
    ears = watch()
    silence(ears)
    assert "watch.open_space" in ears.deaf(NOTHING, open_space=False)
    assert ears.deaf(NOTHING, open_space=True) == ""


@pytest.mark.parametrize("heard", [5.0, -math.inf])
@pytest.mark.parametrize(("strays", "deaf"), [(2, True), (3, False)])
def test_a_ring_that_is_all_but_deaf_is_deaf(heard: float, strays: int, deaf: bool) -> None:
    ears, seen = watch(), circle(COUNT, 0.5)
    ears.update(ring(5.0))
    silence(ears)
    ears.update(ring(heard, sensors=range(strays)))
    ears.update(ring(7.0, sensors=range(strays, COUNT)))  # beyond the range: nothing was heard
    assert (ears.deaf(seen, open_space=False) != "") == deaf


def test_faulty_readings_are_neither_echo_nor_silence() -> None:
    ears, seen = watch(), circle(COUNT, 0.5)
    for _ in range(ROUNDS):
        ears.update(ring(math.nan))
    assert ears.deaf(seen, open_space=False) == ""
    silence(ears)
    ears.update(ring(math.nan))
    assert ears.deaf(seen, open_space=False) != ""


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
    assert "away before" in finish.message
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


def test_after_a_jump_of_the_pose_echoes_of_before_prove_nothing() -> None:
    script = Script(motion_parameters())
    script.set_out(GOAL)
    while script.pose.x < 1.5:
        script.tick()
    script.heard = nothing
    script.pose = Pose2(script.pose.x + 0.5, script.pose.y, script.pose.theta)
    script.perceive(script.run())
    assert "as if all were deaf" in script.mission.feedback().hold


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
    assert "points that should echo" in script.mission.feedback().hold
