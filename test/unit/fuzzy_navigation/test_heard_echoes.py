# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Echoes from afar that count when the robot comes close to where they came from."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation.heard_echoes import KEPT, HeardEchoes
from fuzzy_navigation.params import motion_parameters
from fuzzy_navigation.surroundings import Surroundings

RADIUS = 0.23
BELOW, REACH = RADIUS + 0.6, RADIUS + 0.25
#: A corner beside the way of a robot that drives along the x axis: the body would touch it.
CORNER = (1.0, 0.16)


def heard(x: float, at: tuple[float, float] = CORNER, stamp: float = 0.0) -> SonarReading:
    """What a sonar that looks at a point hears from (x, 0)."""
    bearing = math.atan2(at[1], at[0] - x)
    return SonarReading(Pose2(x, 0.0), bearing, math.dist((x, 0.0), at) - RADIUS, stamp)


def taken(*echoes: SonarReading) -> HeardEchoes:
    memory = HeardEchoes(RADIUS)
    for echo in echoes:
        memory.take([echo], BELOW)
    return memory


def test_what_was_heard_from_two_places_is_due_close_by_and_once() -> None:
    echoes = [heard(0.40), heard(0.45)]
    memory = taken(*echoes)
    assert memory.due(Pose2(0.50, 0.0), REACH) == []  # 0.525 m from the corner
    assert memory.due(Pose2(0.60, 0.0), REACH) == echoes  # 0.431 m
    assert memory.due(Pose2(0.60, 0.0), REACH) == []


@pytest.mark.parametrize(
    "echoes",
    [
        [heard(0.40)],
        [heard(0.40), heard(0.41)],  # the robot stood, nearly
        [heard(0.40), heard(0.45, (1.0, 0.30))],  # from elsewhere
        [heard(0.10), heard(0.15)],  # from too far away, 0.69 m from the body and more
        [SonarReading(Pose2(x, 0.0), 0.0, r, 0.0) for x, r in ((0.7, math.inf), (0.8, math.nan))],
        [SonarReading(Pose2(x, 0.0), 0.0, -math.inf, 0.0) for x in (0.7, 0.8)],
    ],
)
def test_what_is_single_or_far_is_never_due(echoes: list[SonarReading]) -> None:
    memory = taken(*echoes)
    assert all(memory.due(Pose2(0.05 * k, 0.0), REACH) == [] for k in range(20))


def test_it_forgets_when_told_and_the_oldest_first() -> None:
    memory = taken(heard(0.40), heard(0.45))
    memory.forget()
    assert memory.due(Pose2(0.6, 0.0), REACH) == []
    crowd = [heard(0.40, (0.40, 0.3 + 0.01 * k)) for k in range(KEPT)]  # all from one place
    memory = taken(heard(0.40), *crowd[:40], heard(0.45))
    assert len(memory.due(Pose2(0.6, 0.0), REACH)) >= 2
    memory = taken(heard(0.40), *(crowd[k % 40] for k in range(KEPT)), heard(0.45))
    assert memory.due(Pose2(0.6, 0.0), REACH) == []


def driven(corner_seen: bool) -> tuple[Surroundings, list[float]]:
    """Drive past a corner that sonars hear from afar alone; where points became known."""
    surroundings = Surroundings(motion_parameters())
    surroundings.begin_perception()
    surroundings.end_perception()
    first = []
    for k in range(30):
        x, now = 0.3 + 0.015 * k, 0.05 * k
        echoes = [heard(x, stamp=now)] if x < 0.5 else []
        hits = []
        if corner_seen and math.dist((x, 0.0), CORNER) < RADIUS + 0.3:
            bearing = math.atan2(CORNER[1], CORNER[0] - x)
            distance = math.dist((x, 0.0), CORNER) - RADIUS
            hits = [InfraredReading(Pose2(x, 0.0), bearing, distance, now, 1)]
        surroundings.update(now, Pose2(x, 0.0), hits, echoes)
        if len(surroundings.remembered) and not first:
            first = [x]
    return surroundings, first


def test_a_corner_that_sonars_lose_is_known_before_the_body_is_there() -> None:
    surroundings, first = driven(corner_seen=False)
    known = surroundings.remembered
    assert len(known)
    assert np.hypot(known[:, 0] - CORNER[0], known[:, 1] - CORNER[1]).min() < 0.02
    # The reach while moving from the body: from there on the robot can stop, and not before.
    assert math.dist((first[0], 0.0), CORNER) == pytest.approx(REACH, abs=0.02)


def test_what_infrareds_see_there_explains_it() -> None:
    surroundings, _ = driven(corner_seen=True)
    known = surroundings.remembered
    # Hits of the infrareds alone, all of them on the corner; no points beside its axis.
    assert len(known)
    assert np.hypot(known[:, 0] - CORNER[0], known[:, 1] - CORNER[1]).max() < 1e-9


def test_a_perception_ends_what_was_heard_before() -> None:
    surroundings = Surroundings(motion_parameters())
    surroundings.end_perception()
    for k, x in enumerate((0.40, 0.45)):
        surroundings.update(0.1 * k, Pose2(x, 0.0), [], [heard(x, stamp=0.1 * k)])
    surroundings.begin_perception()
    surroundings.end_perception()
    surroundings.update(1.0, Pose2(0.6, 0.0), [], [])
    assert len(surroundings.remembered) == 0
