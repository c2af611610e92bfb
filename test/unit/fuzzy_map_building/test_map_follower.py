# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A follower behind channels that lose, delay and reorder, against the maps as they were made."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzy_map_building import map_follower
from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_follower import MapFollower, MapWindow

GEOMETRY = GridGeometry(6, 5, 0.1)
CORNER = Window(0, 1, 0, 1)
NOWHERE = Window(0, 0, 0, 0)
#: What a clock may do where a map is begun anew; windows follow each other by 1 to 3.
FORWARD = st.integers(1, 9)
FAR_BACK = st.integers(-60, -40) | FORWARD
NEAR = st.integers(-9, 9)


def window(number: int | None, stamp: int, where: Window = CORNER) -> MapWindow:
    return MapWindow(number, stamp, where, np.full(where.shape, stamp % 100, np.int8))


@dataclass(frozen=True, eq=False)
class Sent:
    """What a mapper sends, and the state of its map that it belongs to."""

    stamp: int
    state: np.ndarray
    window: MapWindow | None = None


class Source:
    """A mapper's maps: begun once or several times, each with windows of what is new."""

    def __init__(self, data: st.DataObject, steps: st.SearchStrategy[int] = FORWARD) -> None:
        self.sent: list[Sent] = []
        self._number = 0
        self._stamp = data.draw(st.integers(200, 260), "start")
        self.state = data.draw(st.integers(0, 100)) * np.ones(GEOMETRY.shape, np.int8)
        self.restarts = data.draw(st.booleans(), "the first map was begun before")
        for turn in range(data.draw(st.integers(1, 3), "maps")):
            if turn:
                self._stamp += data.draw(steps, "step")
                if data.draw(st.booleans(), "the mapper is started again"):
                    self._number = 0
                self.state = np.full(GEOMETRY.shape, data.draw(st.integers(0, 100)), np.int8)
            if turn or not self.restarts:
                self._send(NOWHERE, np.empty((0, 0), np.int8))
            self.whole()
            for _ in range(data.draw(st.integers(0, 6), "packets")):
                self.packet(data)
                if data.draw(st.booleans(), "whole as well"):
                    self.whole()

    def packet(self, data: st.DataObject) -> None:
        row, column = data.draw(st.integers(0, 4)), data.draw(st.integers(0, 5))
        where = Window(row, min(5, row + 2), column, min(6, column + 3))
        cells = np.full(where.shape, data.draw(st.integers(0, 100)), np.int8)
        self.state = self.state.copy()
        self.state[where.slices] = cells
        self._stamp += data.draw(st.integers(1, 3))
        self._send(where, cells)

    def whole(self) -> None:
        self.sent.append(Sent(self._stamp, self.state))

    def _send(self, where: Window, cells: np.ndarray) -> None:
        self._number += 1
        new = MapWindow(self._number, self._stamp, where, cells)
        self.sent.append(Sent(self._stamp, self.state, new))


class Sink:
    """Who follows: the cells, and the state of the source that they should be."""

    def __init__(self, *, strict: bool = True) -> None:
        self.follower = MapFollower()
        self.strict = strict
        self.grid = np.empty((0, 0), np.int8)
        self.state = self.grid
        self._known: dict[int, Sent] = {}

    def take(self, sent: Sent) -> None:
        if sent.window is not None:
            self._known[id(sent.window)] = sent
            ready = self.follower.take_window(sent.window)
        elif self.follower.outdated(sent.stamp):
            return
        else:
            self.grid, self.state = sent.state.copy(), sent.state
            ready = self.follower.take_map(sent.stamp, GEOMETRY)
        for each in ready:
            self.grid[each.window.slices] = each.cells
            self.state = self._known[id(each)].state
        if self.follower.settled and self.strict:
            np.testing.assert_array_equal(self.grid, self.state)


def arrival(data: st.DataObject, sent: list[Sent]) -> list[Sent]:
    """Return what was sent as it comes: late, each of the two ways in its order."""
    latest = {False: 0, True: 0}
    at = []
    for k, each in enumerate(sent):
        way = each.window is not None
        latest[way] = max(latest[way], k + data.draw(st.integers(0, 5), "delay"))
        at.append((latest[way], k))
    return [sent[k] for _, k in sorted(at)]


# By less than what is on its way, a clock that is set back misleads until all of it has come.
@pytest.mark.parametrize(("steps", "strict"), [(FORWARD, True), (FAR_BACK, True), (NEAR, False)])
@settings(max_examples=70, deadline=None)
@given(data=st.data())
def test_whatever_is_lost_or_late_the_map_is_one_that_was_made(
    steps: st.SearchStrategy[int], strict: bool, data: st.DataObject
) -> None:
    source, sink = Source(data, steps), Sink(strict=strict)
    last = data.draw(st.integers(0, len(source.sent)), "first heard")
    lost = data.draw(st.sets(st.integers(0, len(source.sent)), max_size=5), "lost")
    heard = []
    for k, each in enumerate(source.sent):
        if each.window is None:
            # Where the clock is set back all whole maps come.
            comes = steps is not FORWARD or k not in lost
        else:
            # Windows come from some time on. The first of a mapper that was started again does:
            # its other numbers may by chance go on from those before.
            comes = k >= last and (k not in lost or each.window.number == 1)
        if comes:
            heard.append(each)
    for each in arrival(data, heard):
        sink.take(each)
    # A window, and the whole map within the period after it.
    source.packet(data)
    source.whole()
    for each in source.sent[-2:]:
        sink.take(each)
    assert sink.follower.settled
    np.testing.assert_array_equal(sink.grid, source.state)


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_without_loss_the_first_map_and_the_windows_are_enough(data: st.DataObject) -> None:
    source, sink = Source(data), Sink()
    numbered = data.draw(st.booleans(), "numbered")
    sent, begun = [], True
    for each in source.sent:
        if each.window is not None:
            begun = each.window.window.empty
            number = each.window.number if numbered else None
            sent.append(replace(each, window=replace(each.window, number=number)))
        elif begun:
            sent.append(each)
            begun = False
    for each in arrival(data, sent):
        sink.take(each)
    np.testing.assert_array_equal(sink.grid, source.state)
    assert sink.follower.waiting == 0


def test_somebody_who_sends_a_map_once_and_then_windows_is_followed() -> None:
    follower = MapFollower()
    assert follower.take_map(5, GEOMETRY) == []
    for k in range(1, 2 * map_follower.MOST_KEPT):
        new = window(k, 5 + k)
        assert follower.take_window(new) == [new]
        assert (follower.taken, follower.waiting, follower.missed) == (k, 0, 0)


def test_windows_after_a_lost_one_wait_for_a_whole_map_that_is_late_enough() -> None:
    follower = MapFollower()
    follower.take_map(1, GEOMETRY)
    assert follower.take_window(window(1, 2))
    third, fourth, fifth = window(3, 4), window(4, 5), window(5, 6)
    for late in (third, fourth):
        assert follower.take_window(late) == []
    assert (follower.waiting, follower.missed, follower.settled) == (2, 1, False)
    assert follower.outdated(2)
    assert not follower.outdated(3)
    # The lost one may be newer than this map: it is taken, but the windows go on waiting.
    assert follower.take_map(3, GEOMETRY) == []
    assert (follower.waiting, follower.settled) == (2, False)
    assert follower.take_map(4, GEOMETRY) == [fourth]
    assert (follower.waiting, follower.missed, follower.taken) == (0, 2, 2)
    assert follower.take_window(fifth) == [fifth]
    assert follower.settled


def test_what_was_missed_before_the_first_window_is_made_good() -> None:
    follower = MapFollower()
    follower.take_map(1, GEOMETRY)
    first, second = window(7, 8), window(8, 9)
    assert follower.take_window(first) == [first]
    assert follower.take_window(second) == [second]
    assert not follower.settled
    # Though it is older than what the windows have made, it holds what was missed.
    assert not follower.outdated(8)
    assert follower.take_map(8, GEOMETRY) == [second]
    assert follower.settled
    assert follower.outdated(8)
    assert (follower.taken, follower.missed) == (2, 0)


def test_windows_of_another_map_wait_for_it() -> None:
    follower = MapFollower()
    follower.take_map(50, GEOMETRY)
    assert follower.take_window(window(1, 51))
    # The clock was set back: what is older than the map that is held is not known already.
    assert follower.take_window(window(2, 10, NOWHERE)) == []
    new = window(3, 11)
    assert follower.take_window(new) == []
    assert (follower.waiting, follower.outdated(10)) == (1, False)
    assert follower.take_map(10, GEOMETRY) == [new]
    # The map comes before its window.
    follower.take_map(20, GEOMETRY)
    assert follower.take_window(window(4, 20, NOWHERE)) == []
    assert follower.take_window(window(5, 21))
    # The publisher is another one.
    assert follower.take_window(window(1, 22)) == []
    assert follower.take_map(22, GEOMETRY) == []
    assert follower.take_window(window(2, 23))


def test_a_clock_that_is_set_back_without_a_word_is_a_gap() -> None:
    follower = MapFollower()
    follower.take_map(50, GEOMETRY)
    assert follower.take_window(window(1, 51))
    second, third = window(2, 10), window(3, 11)
    assert follower.take_window(second) == follower.take_window(third) == []
    assert (follower.waiting, follower.missed) == (2, 0)
    assert not follower.outdated(10)
    assert follower.take_map(10, GEOMETRY) == [third]
    assert follower.settled


def test_a_map_of_before_that_comes_late_is_not_taken_for_the_one_begun_anew() -> None:
    follower = MapFollower()
    follower.take_map(49, GEOMETRY)
    assert follower.take_window(window(1, 50))
    assert follower.take_window(window(2, 10, NOWHERE)) == []
    follower.take_map(50, GEOMETRY)  # of before
    assert follower.take_window(window(3, 11)) == []  # so it seems to be known
    assert follower.take_map(10, GEOMETRY) == []
    twelfth, thirteenth = window(4, 12), window(5, 13)
    assert follower.take_window(twelfth) == follower.take_window(thirteenth) == []
    assert follower.take_map(12, GEOMETRY) == [thirteenth]
    assert follower.settled


def test_a_map_begun_anew_is_not_awaited_where_a_later_one_is_held() -> None:
    follower = MapFollower()
    follower.take_map(4, GEOMETRY)
    assert follower.take_window(window(1, 5))
    follower.take_map(10, GEOMETRY)
    assert follower.take_window(window(2, 8, NOWHERE)) == []
    assert follower.settled
    assert follower.take_window(window(3, 11))


def test_a_window_that_the_map_holds_is_known_but_its_number_counts() -> None:
    follower = MapFollower()
    follower.take_map(9, GEOMETRY)
    assert follower.take_window(window(4, 9)) == []
    assert follower.take_window(window(5, 10))
    assert (follower.settled, follower.missed) == (True, 0)
    assert follower.take_window(window(7, 11)) == []
    assert follower.missed == 1


def test_a_whole_map_is_looked_at_unless_windows_led_to_it() -> None:
    follower = MapFollower()
    follower.take_map(9, GEOMETRY)
    # Maps without windows are as they come, whatever their stamps.
    assert not follower.outdated(9)
    assert not follower.outdated(3)
    follower.take_window(window(1, 9))
    follower.take_window(window(2, 12))
    assert [follower.outdated(t) for t in (9, 12, 13)] == [True, True, False]
    assert not follower.outdated(3)  # whole maps come in order: this one was begun anew


@pytest.mark.parametrize(
    "wrong",
    [
        window(2, 7, Window(4, 6, 0, 1)),
        window(2, 7, Window(0, 1, 5, 7)),
        window(2, 7, Window(-1, 1, 0, 1)),
        MapWindow(2, 7, CORNER, np.zeros((2, 2), np.int8)),
    ],
)
def test_a_window_that_does_not_fit_is_refused_and_leaves_a_gap(wrong: MapWindow) -> None:
    follower = MapFollower()
    follower.take_map(5, GEOMETRY)
    assert follower.take_window(window(1, 6))
    with pytest.raises(ValueError, match="no part of the map of 5 rows and 6 columns"):
        follower.take_window(wrong)
    assert follower.waiting == 0
    assert not follower.behind
    assert follower.take_window(window(3, 8)) == []
    assert follower.waiting == 1
    assert follower.behind
    follower.take_map(8, GEOMETRY)
    assert not follower.behind


def test_a_map_that_is_another_one_is_behind_until_it_comes_whole() -> None:
    follower = MapFollower()
    follower.take_window(window(1, 6))
    assert not follower.behind  # there is none yet
    follower.take_map(6, GEOMETRY)
    follower.take_window(window(2, 9, NOWHERE))
    assert (follower.behind, follower.waiting) == (True, 0)
    follower.take_map(9, GEOMETRY)
    assert not follower.behind


def test_one_that_waits_and_does_not_fit_its_map_is_dropped() -> None:
    follower = MapFollower()
    good = window(1, 6)
    for new in (good, window(2, 7, Window(0, 9, 0, 9)), window(3, 8)):
        follower.take_window(new)
    assert follower.take_map(5, GEOMETRY) == [good]
    assert (follower.waiting, follower.missed, follower.settled) == (1, 1, False)
    follower.take_map(7, GEOMETRY)
    assert (follower.waiting, follower.taken, follower.settled) == (0, 2, True)


def test_what_is_kept_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    most = map_follower.MOST_KEPT
    waiting, taking = MapFollower(), MapFollower()
    taking.take_map(5, GEOMETRY)
    for k in range(1, most + 4):
        waiting.take_window(window(k, 5 + k))
        taking.take_window(window(k, 5 + k))
    assert (waiting.waiting, waiting.missed) == (most, 3)
    # Three are gone: an older map cannot be brought up to date, this one can.
    assert waiting.take_map(7, GEOMETRY) == []
    assert len(waiting.take_map(8, GEOMETRY)) == most
    assert [taking.outdated(t) for t in (7, 8)] == [True, False]
    assert len(taking.take_map(8, GEOMETRY)) == most
    monkeypatch.setattr(map_follower, "MAX_CELLS", 10)
    small = MapFollower()
    for k in range(1, 12):
        small.take_window(window(k, k))
    small.take_window(window(12, 12, Window(0, 3, 0, 3)))
    assert small.waiting == 2
