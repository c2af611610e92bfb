# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sonars that lose echoes, and the robot that drives slowly for it."""

import itertools
import math
from dataclasses import replace

import pytest

from fuzzy_map_building.sensor_params import SonarParameters
from fuzzy_map_building.types import Pose2, SonarReading
from fuzzy_navigation.echo_loss import LOSSY, SOUND, WINDOW, EchoLoss
from fuzzy_navigation.mission_types import Drive, Outcome
from fuzzy_navigation.params import motion_parameters
from unit.fuzzy_navigation.mission_script import (
    DT,
    Concurrent,
    Script,
    finish_of,
    hall,
    wall_at,
)

P = SonarParameters()
GOAL = (3.05, 2.05)


class Ears:
    """One sonar of a robot, a reading every 0.05 s."""

    def __init__(self) -> None:
        self.loss = EchoLoss(P)
        self.reading = SonarReading(Pose2(0.0, 0.0, 0.0), 0.0, math.inf, 10.0, 3)

    def hear(self, *ranges: float, after: float = DT, **changes: object) -> int:
        for distance in ranges:
            stamp = self.reading.stamp + after
            self.reading = replace(self.reading, range=distance, stamp=stamp, **changes)
            self.loss.update([self.reading])
        return self.loss.lost

    def pairs(self, heard: int, missing: int) -> int:
        """Hear something from close by, of which so many echoes are heard again or missing."""
        for distance in [1.0] * heard + [math.inf] * missing:
            # What was heard before tells of nothing after so long.
            self.hear(1.0, after=5.0)
            self.hear(distance)
        return self.loss.lost


def test_a_quarter_of_the_echoes_missing_make_a_ring_that_loses_them() -> None:
    ears = Ears()
    assert ears.pairs(WINDOW - LOSSY + 1, LOSSY - 1) == 0
    # The window goes on: an echo that was heard again goes out.
    assert ears.pairs(0, 1) == LOSSY
    # How many it was when it began is told until it is over.
    assert ears.pairs(0, 5) == LOSSY


def test_too_few_echoes_tell_nothing() -> None:
    ears = Ears()
    assert ears.pairs(0, WINDOW - 1) == 0
    assert ears.pairs(0, 1) == WINDOW


def test_a_ring_that_hears_again_is_sound() -> None:
    ears = Ears()
    ears.pairs(0, WINDOW)
    assert ears.pairs(WINDOW - SOUND, 0) == WINDOW
    assert ears.pairs(1, 0) == 0
    # From there on it is lossy no sooner than one that never was.
    assert ears.pairs(0, LOSSY - SOUND) == 0 < ears.pairs(0, WINDOW)


def test_the_ring_counts_as_a_whole() -> None:
    loss = EchoLoss(P)
    pose = Pose2(0.0, 0.0, 0.0)
    for stamp, distance in ((1.0, 1.0), (1.1, math.inf)):
        loss.update([SonarReading(pose, 0.0, distance, stamp, k) for k in range(WINDOW)])
    assert loss.lost == WINDOW


@pytest.mark.parametrize(
    ("before", "now", "counts"),
    [
        (4.2, math.inf, True),
        (4.3, math.inf, False),  # 0.65 of 6.5 m: from there an echo may be missing
        (-math.inf, math.inf, True),  # too close to measure
        (1.0, 6.5, True),
        (1.0, 6.4, False),  # an echo, if another one
        (1.0, -math.inf, False),
    ],
)
def test_what_an_echo_from_close_by_is_and_what_it_is_to_lack_it(
    before: float, now: float, counts: bool
) -> None:
    ears = Ears()
    for _ in range(WINDOW):
        ears.hear(before, after=5.0)
        ears.hear(now)
    assert (ears.loss.lost == WINDOW) == counts


@pytest.mark.parametrize(
    ("after", "pose", "bearing", "counts"),
    [
        (0.4, Pose2(0.06, 0.07, 0.0), 0.0, True),
        (0.6, Pose2(0.0, 0.0, 0.0), 0.0, False),
        (0.0, Pose2(0.0, 0.0, 0.0), 0.0, False),  # the same reading once more
        (-0.1, Pose2(0.0, 0.0, 0.0), 0.0, False),
        (0.4, Pose2(0.08, 0.07, 0.0), 0.0, False),
        (0.4, Pose2(0.0, 0.0, 0.05), 0.0, True),
        (0.4, Pose2(0.0, 0.0, 0.06), 0.0, False),
        (0.4, Pose2(0.0, 0.0, 0.0), -0.06, False),  # the turret turned
        (0.4, Pose2(0.0, 0.0, 0.06), -0.06, True),  # against the robot
        (0.4, Pose2(0.0, 0.0, math.tau - 0.02), 0.0, True),
    ],
)
def test_the_next_reading_has_to_be_of_the_same_place(
    after: float, pose: Pose2, bearing: float, counts: bool
) -> None:
    ears = Ears()
    for _ in range(WINDOW):
        ears.hear(1.0, after=5.0, pose=Pose2(0.0, 0.0, 0.0), bearing=0.0)
        ears.hear(math.inf, after=after, pose=pose, bearing=bearing)
    assert (ears.loss.lost == WINDOW) == counts


def test_faulty_readings_are_left_out() -> None:
    ears = Ears()
    for _ in range(WINDOW):
        ears.hear(1.0, after=5.0)
        ears.hear(math.nan)
    assert ears.loss.lost == 0
    for _ in range(WINDOW):
        ears.hear(1.0, after=5.0)
        ears.hear(math.nan, math.inf)
    assert ears.loss.lost == WINDOW


def now_and_then(script: Script, turns: int = 4) -> None:
    """Have the ring miss every so manyth round of echoes."""

    def heard(x: float, y: float, direction: float) -> float:
        return math.inf if round(script.now / DT) % turns == 0 else hall(x, y, direction)

    script.heard = heard


def speeds(script: Script) -> list[float]:
    return [c.linear for c in script.commands if isinstance(c, Drive)]


@pytest.mark.parametrize("limit", [0.3, 0.05])
def test_a_robot_whose_sonars_lose_echoes_drives_slowly(limit: float) -> None:
    script = Script(motion_parameters(overrides={"watch.lossy_speed": limit}))
    now_and_then(script)
    for _ in range(WINDOW):
        script.tick()
    script.set_out(GOAL)
    finish = finish_of(script.run(limit=90.0))
    assert finish.outcome is Outcome.REACHED
    assert max(speeds(script)) == pytest.approx(limit)


@pytest.mark.parametrize("kind", [Script, Concurrent])
def test_one_that_begins_to_lose_them_slows_down_and_says_so(kind: type[Script]) -> None:
    script = kind()
    script.set_out(GOAL)
    while script.pose.x < 1.4:
        script.tick()
    top = speeds(script)[-1]
    assert top > 0.4
    assert script.mission.advice == ""
    now_and_then(script)
    told = set()
    for _ in range(30):
        script.tick()
        told.add(script.mission.advice)
    # As fast as it can brake, and no faster.
    before, slow = speeds(script)[-30:], motion_parameters().watch.lossy_speed
    assert before[-1] == pytest.approx(slow)
    assert max(a - b for a, b in itertools.pairwise(before)) <= 0.6 * DT + 1e-9
    told.discard("")
    (text,) = told
    assert text.startswith("sonars lose echoes (")
    assert text.endswith(f" of {WINDOW}): driving at no more than {slow:g} m/s")


def test_one_that_hears_again_drives_on_as_before() -> None:
    script = Script()
    now_and_then(script)
    for _ in range(WINDOW):
        script.tick()
    assert script.mission.advice
    script.heard = hall
    for _ in range(WINDOW):
        script.tick()
    assert script.mission.advice == ""
    script.set_out(GOAL)
    script.run()
    assert max(speeds(script)) > 0.5


@pytest.mark.parametrize("kind", [Script, Concurrent])
def test_a_healthy_ring_never_loses_echoes(kind: type[Script]) -> None:
    script = kind()
    script.seen = wall_at(5.0)
    script.set_out(GOAL)
    commands = ()
    while script.mission.active:
        commands = script.tick()
        assert script.mission.advice == ""
    assert finish_of(commands).outcome is Outcome.REACHED


def test_sonars_that_guard_nothing_may_lose_echoes() -> None:
    script = Script(motion_parameters(overrides={"sonar_guard.enabled": False}))
    now_and_then(script)
    for _ in range(WINDOW):
        script.tick()
    assert script.mission.advice == ""


@pytest.mark.parametrize("turns", [1, 4])
def test_what_sonars_did_that_guard_no_more_is_forgotten(turns: int) -> None:
    script = Script()
    now_and_then(script, turns)
    for _ in range(WINDOW):
        script.tick()
    script.mission.adopt(motion_parameters(overrides={"sonar_guard.enabled": False}))
    assert script.mission.advice == ""
    script.set_out(GOAL)
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert max(speeds(script)) > 0.5
