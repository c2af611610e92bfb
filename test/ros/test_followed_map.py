# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a node says of a map that is behind what was sent of it."""

from __future__ import annotations

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_follower import MapWindow
from fuzzy_map_building.params import PublishingParameters
from fuzzy_map_building.ros import names
from fuzzy_map_building.ros.clock import stamp_from_nanoseconds
from fuzzy_map_building.ros.diagnostics import Diagnostics
from fuzzy_map_building.ros.map_conversions import grid_to_msg, window_to_msg
from fuzzy_navigation.ros import followed_map
from fuzzy_navigation.ros.followed_map import FollowedMap
from ros.harness import Probe

GEOMETRY = GridGeometry(6, 5, 0.1)
CORNER, OUTSIDE = Window(0, 1, 0, 1), Window(4, 6, 0, 1)


class Follower:
    """A followed map on a clock of its own."""

    def __init__(self, probe: Probe, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setattr(followed_map.time, "monotonic", lambda: self.now)
        self.map = FollowedMap(
            probe.node,
            names.PLANNING_MAP,
            "the planning map",
            Diagnostics(probe.node),
            lambda _: None,
            lambda _: None,
            lambda _: None,
        )

    def whole(self, stamp: int, values: int = 0) -> None:
        cells = np.full(GEOMETRY.shape, values, np.int8)
        self.map.on_map(grid_to_msg(cells, GEOMETRY, stamp_from_nanoseconds(stamp)))

    def window(self, number: int, stamp: int, where: Window = CORNER) -> None:
        new = MapWindow(number, stamp, where, np.zeros(where.shape, np.int8))
        self.map.on_window(window_to_msg(new), {"publication_sequence_number": number})

    def after(self, seconds: float) -> str:
        self.now += seconds
        return self.map.problem()


@pytest.fixture
def follower(probe: Probe, monkeypatch: pytest.MonkeyPatch) -> Follower:
    return Follower(probe, monkeypatch)


def test_a_lost_window_is_a_problem_once_no_whole_map_comes(follower: Follower) -> None:
    follower.whole(5)
    follower.window(1, 6)
    assert follower.after(1000.0) == ""
    follower.window(3, 8)  # the second is lost
    assert follower.after(PublishingParameters().period) == ""
    follower.window(4, 9)
    told = follower.after(PublishingParameters().period + 0.1)
    assert told.startswith(
        "the planning map has been behind for 4 s: by 'planning_map_updates' 1 window missed so "
        "far and 2 waiting for a whole map by 'planning_map'"
    )
    assert "'publishing.period'" in told
    follower.whole(8)  # all but the newest, which goes on from it
    assert follower.after(1000.0) == ""


@pytest.mark.parametrize("whole", [False, True])
def test_what_was_refused_is_a_problem_until_a_whole_map_comes(
    follower: Follower, whole: bool
) -> None:
    follower.whole(5)
    if whole:
        follower.whole(6, -1)
    else:
        follower.window(1, 6, OUTSIDE)
    assert follower.after(1.0) == ""
    told = follower.after(4.0)
    assert told.startswith("the planning map may be behind: 5 s ago something of it was refused (")
    assert ("has cells of -1" if whole else "no part of the map of 5 rows") in told
    follower.whole(7)
    assert follower.after(1000.0) == ""
