# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A follower behind channels that lose, delay and reorder, against the maps as they were made."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzy_map_building import map_follower
from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_follower import MapFollower, MapWindow

GEOMETRY = GridGeometry(6, 5, 0.1)
CORNER = Window(0, 1, 0, 1)


def window(began: int, previous: int, stamp: int, where: Window = CORNER) -> MapWindow:
    return MapWindow(began, previous, stamp, where, np.full(where.shape, stamp % 100, np.int8))


class Source:
    """A mapper's maps: every state that was made, whole and as a window."""

    def __init__(self, data: st.DataObject) -> None:
        self.states: dict[tuple[int, int], np.ndarray] = {}
        self.sent: list[MapWindow | tuple[int, int]] = []
        # A map that is begun anew may be stamped earlier than the one before: clocks are set.
        began_at = st.lists(st.integers(1, 60), min_size=1, max_size=3, unique=True)
        for began in data.draw(began_at, "began"):
            stamp, grid = began, np.zeros(GEOMETRY.shape, np.int8)
            self._keep(began, stamp, grid)
            self.sent.append((began, stamp))
            for _ in range(data.draw(st.integers(0, 6), "packets")):
                row, column = data.draw(st.integers(0, 4)), data.draw(st.integers(0, 5))
                where = Window(row, min(5, row + 2), column, min(6, column + 3))
                cells = np.full(where.shape, data.draw(st.integers(0, 100)), np.int8)
                grid = grid.copy()
                grid[where.slices] = cells
                previous, stamp = stamp, stamp + data.draw(st.integers(1, 3))
                self._keep(began, stamp, grid)
                self.sent.append(MapWindow(began, previous, stamp, where, cells))
                if data.draw(st.booleans(), "whole as well"):
                    self.sent.append((began, stamp))
        self.last = (began, stamp)
        self.sent.append(self.last)

    def _keep(self, began: int, stamp: int, grid: np.ndarray) -> None:
        self.states[began, stamp] = grid


class Sink:
    """Who follows: the cells, and which state of the source they are."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.follower = MapFollower()
        self.grid = np.empty(0)
        self.state: tuple[int, int] | None = None

    def take(self, sent: MapWindow | tuple[int, int]) -> None:
        if isinstance(sent, MapWindow):
            ready = self.follower.take_window(sent)
        elif self.follower.outdated(*sent):
            assert self.state is not None
            assert self.state[0] == sent[0]
            assert self.state[1] >= sent[1]
            return
        else:
            self.grid, self.state = self.source.states[sent].copy(), sent
            ready = self.follower.take_map(*sent, GEOMETRY)
        for each in ready:
            self.grid[each.window.slices] = each.cells
            self.state = (each.began, each.stamp)
        if self.state is not None:
            np.testing.assert_array_equal(self.grid, self.source.states[self.state])


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_whatever_is_lost_or_late_the_map_is_one_that_was_made(data: st.DataObject) -> None:
    source = Source(data)
    sink = Sink(source)
    delays = [data.draw(st.integers(0, 5)) for _ in source.sent]
    order = sorted(range(len(delays)), key=lambda k: (k + delays[k], k))
    lost = data.draw(st.sets(st.integers(0, len(delays) - 1), max_size=4))
    for k in order:
        if k not in lost:
            sink.take(source.sent[k])
    sink.take(source.sent[-1])  # the whole map that is latched in the end
    assert sink.state == source.last


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_without_loss_the_first_map_and_the_windows_are_enough(data: st.DataObject) -> None:
    source = Source(data)
    sink = Sink(source)
    began: set[int] = set()
    windows = 0
    for sent in source.sent:
        if isinstance(sent, MapWindow) or sent[0] not in began:
            began.add(sent[0] if not isinstance(sent, MapWindow) else sent.began)
            windows += isinstance(sent, MapWindow)
            sink.take(sent)
    assert sink.state == source.last
    assert (sink.follower.taken, sink.follower.missed) == (windows, 0)
    assert sink.follower.waiting == 0


def test_windows_wait_for_the_one_before_and_a_whole_map_makes_good_for_it() -> None:
    follower = MapFollower()
    assert follower.take_map(1, 1, GEOMETRY) == []
    third, fourth = window(1, 3, 4), window(1, 4, 5)
    assert follower.take_window(third) == []
    assert follower.take_window(fourth) == []
    assert (follower.waiting, follower.missed) == (2, 0)
    assert follower.take_map(1, 4, GEOMETRY) == [fourth]
    assert (follower.waiting, follower.missed, follower.taken) == (0, 1, 1)
    assert follower.take_window(third) == []  # known by now
    assert follower.waiting == 0


def test_a_whole_map_is_looked_at_unless_windows_led_to_it() -> None:
    follower = MapFollower()
    follower.take_map(1, 9, GEOMETRY)
    # Maps without windows are as they come, whatever their stamps.
    assert not follower.outdated(1, 9)
    assert not follower.outdated(1, 3)
    follower.take_window(window(1, 9, 12))
    assert [follower.outdated(1, t) for t in (3, 9, 12, 13)] == [True, True, True, False]
    assert not follower.outdated(2, 3)  # another map, begun anew


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (window(1, 5, 5), "must be the earlier"),
        (window(1, 4, 6), "in between there was one at 5"),
        (window(1, 5, 6, Window(4, 6, 0, 1)), "no part of a map of 5 rows, 6 columns"),
        (window(1, 5, 6, Window(0, 1, 5, 7)), "no part of a map"),
        (window(1, 5, 6, Window(-1, 1, 0, 1)), "no part of a map"),
        (MapWindow(1, 5, 6, CORNER, np.zeros((2, 2), np.int8)), "no part of a map"),
    ],
)
def test_a_window_that_does_not_fit_is_refused(wrong: MapWindow, words: str) -> None:
    follower = MapFollower()
    follower.take_map(1, 5, GEOMETRY)
    with pytest.raises(ValueError, match=words):
        follower.take_window(wrong)
    assert follower.waiting == 0
    assert follower.take_window(window(1, 5, 6))


def test_one_that_waits_and_does_not_fit_its_map_is_dropped() -> None:
    follower = MapFollower()
    follower.take_window(window(1, 5, 6, Window(0, 9, 0, 9)))
    assert follower.take_map(1, 5, GEOMETRY) == []
    assert (follower.waiting, follower.missed) == (0, 1)


def test_what_waits_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    follower = MapFollower()
    for k in range(1, map_follower.MOST_WAITING + 4):
        follower.take_window(window(1, k, k + 1))
    assert (follower.waiting, follower.missed) == (map_follower.MOST_WAITING, 3)
    monkeypatch.setattr(map_follower, "MAX_CELLS", 10)
    follower.take_window(window(1, 900, 901, Window(0, 3, 0, 3)))
    assert follower.waiting == 2
