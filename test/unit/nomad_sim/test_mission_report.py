# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Moments of a mission, told and drawn."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import LogEntry, Stop
from nomad_sim.headless import HeadlessMission
from nomad_sim.mission_report import Moment, draw_moments, entry_line, moment_of


def test_moments_keep_what_was_then(small: Path) -> None:
    mission = HeadlessMission(small, seed=3)
    moments: list[Moment] = [moment_of(mission)]
    log = mission.run(lambda now: moments.append(moment_of(now)))
    moments.append(moment_of(mission))
    assert [m.perceptions for m in moments] == [*range(log.perceptions + 1), log.perceptions]
    # Unexplored at first, then more and more of it known.
    assert (moments[0].motion_risk == 1.0).all()
    assert (moments[0].planning_risk == 0.0).all()
    known = [int((m.motion_risk < 1.0).sum()) for m in moments]
    assert known == sorted(known)
    assert known[1] > 0
    for earlier, later in itertools.pairwise(moments):
        points = len(earlier.scene.travelled)
        assert points <= len(later.scene.travelled)
        assert (later.scene.travelled[:points] == earlier.scene.travelled).all()
    last = moments[-1]
    assert (last.motion_risk == log.motion_risk).all()
    assert (last.planning_risk == log.planning_risk).all()
    assert last.scene.robot == mission.simulator.pose
    assert last.scene.goal == log.goal
    assert last.scene.start == (log.start.x, log.start.y)
    assert [tuple(place) for place in last.scene.perceptions] == [
        (entry.pose.x, entry.pose.y) for entry in log.entries
    ]
    assert len(last.scene.plan) == 0  # there is nothing left to do
    assert len(last.scene.segments) == 4


def test_a_figure_has_both_maps_of_every_moment(small: Path) -> None:
    mission = HeadlessMission(small, seed=3)
    moments: list[Moment] = []
    mission.run(lambda now: moments.append(moment_of(now)))
    figure = draw_moments(moments[:2], "both")
    titles = [axes.get_title() for axes in figure.axes[:4]]
    assert titles == [
        "motion risk after perception 1",
        "motion risk after perception 2",
        "planning risk after perception 1",
        "planning risk after perception 2",
    ]
    assert figure.get_suptitle() == "both"
    (drawn,) = figure.axes[3].get_images()
    assert np.asarray(drawn.get_array()) == pytest.approx(moments[1].planning_risk)
    with pytest.raises(ValueError, match="got"):
        draw_moments([])


def test_a_perception_is_told_in_a_line() -> None:
    entry = LogEntry(7, 47.6, Pose2(2.79, 0.93, 1.0), Stop.CLEARANCE, 0.6, 6.49)
    assert entry_line(entry) == (
        "perception   7 at   47.60 s, (  2.79,   0.93) m: stopped by clearance  alpha 0.6, "
        " 6.49 m left"
    )
    assert "perception   7 at    7.60 s, " in entry_line(entry, started=40.0)
    first = LogEntry(1, 4.2, Pose2(1.25, 5.25, 0.0), Stop.NONE, 0.0, 6.12)
    assert entry_line(first) == (
        "perception   1 at    4.20 s, (  1.25,   5.25) m: at the start,                    "
        " 6.12 m left"
    )
    moved = replace(first, perception=5, alpha=0.6)
    assert ": off its path, or moved from it,   6.12 m left" in entry_line(moved)
    later = replace(first, perception=2, alpha=0.6, on_the_way=True)
    assert ": on the way,            alpha 0.6, " in entry_line(later)
