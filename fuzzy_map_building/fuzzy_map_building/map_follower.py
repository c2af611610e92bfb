# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which of the whole maps and the windows that come make up the newest map.

Whole maps and windows come by two ways, each in order, neither of which waits for the other.
Stamps grow from state to state, and the middleware numbers what a publisher sends: so a window
that was missed, one that its map holds already, and a map that is older than what windows have
made of it are told apart. A window without cells says that the map is another one from its stamp
on. What stays in doubt the next whole map settles that is late enough to hold what was missed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import MAX_CELLS, GridGeometry, Window

__all__ = ["MapFollower", "MapWindow"]

#: Most windows that are kept until a whole map settles a doubt.
MOST_KEPT = 100


@dataclass(frozen=True, eq=False)
class MapWindow:
    """New cells of a map.

    Parameters
    ----------
    number : int or None
        How many windows their publisher had sent with this one; None if the middleware does not
        tell: then none is taken to be missing.
    stamp : int
        Stamp of the map that they make [ns].
    window : Window
        Where they are; an empty one says that the map is another one from the stamp on.
    cells : ndarray of int8, shape of the window
        Their values.
    """

    number: int | None
    stamp: int
    window: Window
    cells: NDArray[np.int8]


class _Doubt(Enum):
    """Whether the windows go on from the map that is held."""

    NONE = auto()
    #: The first ones were heard: they are taken, but some may have been sent before.
    FIRST = auto()
    #: Some are missing: the others wait.
    GAP = auto()


class MapFollower:
    """Puts whole maps and windows in order; the cells are kept by who asks.

    Attributes
    ----------
    taken : int
        Windows that became part of the map.
    missed : int
        Windows that never could, because they were lost or one before them was; the next whole
        map holds what they held.

    Examples
    --------
    >>> follower, cells = MapFollower(), np.zeros((1, 1), np.int8)
    >>> early = MapWindow(1, 20, Window(0, 1, 0, 1), cells)
    >>> follower.take_window(early)  # the map it belongs to has yet to come
    []
    >>> [window.stamp for window in follower.take_map(10, GridGeometry(4, 3, 0.1))]
    [20]
    >>> follower.take_window(MapWindow(3, 40, Window(0, 1, 0, 1), cells))  # the second is lost
    []
    >>> follower.take_map(40, GridGeometry(4, 3, 0.1)), follower.missed
    ([], 2)
    """

    def __init__(self) -> None:
        self._geometry: GridGeometry | None = None
        # Of the map that is held, and of the whole map that it goes on from.
        self._stamp = self._whole = -1
        self._by_window = False
        self._doubt = _Doubt.NONE
        # A whole map of this stamp or a newer one settles the doubt.
        self._wanted = 0
        # The windows since the doubt began. An older map than `_oldest` lacks some of them.
        self._kept: deque[MapWindow] = deque()
        self._oldest = 0
        # Of the last window heard.
        self._number: int | None = None
        self._heard: int | None = None
        self.taken = 0
        self.missed = 0

    @property
    def waiting(self) -> int:
        """Number of windows that wait for a whole map."""
        return len(self._kept) if self._waits else 0

    @property
    def settled(self) -> bool:
        """Whether the map that is held is known to lack nothing that was sent before."""
        return self._geometry is not None and self._doubt is _Doubt.NONE

    @property
    def behind(self) -> bool:
        """Whether a map is held that windows can go on from only after the next whole one."""
        return self._geometry is not None and self._doubt is _Doubt.GAP

    def outdated(self, stamp: int) -> bool:
        """Whether windows have made a newer map of this one already, or just this one.

        Parameters
        ----------
        stamp : int
            That of a whole map that has come [ns].
        """
        if not self._by_window or not self._whole <= stamp <= self._stamp:
            return False
        return self._doubt is not _Doubt.FIRST or stamp < self._oldest

    def take_map(self, stamp: int, geometry: GridGeometry) -> list[MapWindow]:
        """Go on from a whole map.

        Parameters
        ----------
        stamp : int
            Its stamp [ns].
        geometry : GridGeometry
            Where its cells lie.

        Returns
        -------
        list of MapWindow
            Windows that came before it and belong on it, in this order.
        """
        if stamp < self._whole and self._heard is not None and stamp < self._heard:
            # Another map began; windows of it may have been taken for ones of the map before.
            self._await(self._heard)
        waited = self._waits
        self._stamp = self._whole = stamp
        self._geometry, self._by_window = geometry, False
        newer = [window for window in self._kept if window.stamp > stamp]
        if self._doubt is not _Doubt.NONE and stamp >= self._wanted:
            if waited:
                self.missed += len(self._kept) - len(newer)
            self._doubt = _Doubt.NONE
            self._kept.clear()
        if self._doubt is _Doubt.GAP:
            return []
        return self._put_on(newer, geometry, waited)

    def take_window(self, window: MapWindow) -> list[MapWindow]:
        """Take note of a window.

        Returns
        -------
        list of MapWindow
            Windows that belong on the map now, in this order; empty if it is known already, or
            one before it is missing.

        Raises
        ------
        ValueError
            If it lies outside its map. It counts as not heard: the next one shows a gap.
        """
        lost = self._lost(window)
        back = lost is None
        if window.window.empty:
            self._begin_anew(window, lost or 0)
            return []
        known = not back and self._geometry is not None and window.stamp <= self._stamp
        if not known and lost == 0 and self._geometry is not None and not self._waits:
            _check_fits(window, self._geometry)
        first = self._heard is None
        self._note(window, lost or 0)
        if known:
            return []
        if first:
            self._doubt, self._wanted = _Doubt.FIRST, window.stamp
        elif lost != 0:
            self._await(window.stamp)
            if back:
                self._forget_stamps()
        if self._doubt is not _Doubt.NONE:
            self._kept.append(window)
        if not self._waits:
            self._stamp, self._by_window = window.stamp, True
            self.taken += 1
        self._drop_surplus()
        return [] if self._waits else [window]

    @property
    def _waits(self) -> bool:
        return self._doubt is _Doubt.GAP or self._geometry is None

    def _lost(self, window: MapWindow) -> int | None:
        """Return how many are missing before a window; None if numbers or stamps went back."""
        if self._heard is not None and window.stamp < self._heard:
            return None
        if window.number is None or self._number is None:
            return 0
        return window.number - self._number - 1 if window.number > self._number else None

    def _note(self, window: MapWindow, lost: int) -> None:
        self._number, self._heard = window.number, window.stamp
        self.missed += lost

    def _await(self, stamp: int) -> None:
        """Have windows wait until a whole map of this stamp or a newer one comes."""
        self.missed += self.waiting
        self._kept.clear()
        self._doubt, self._wanted = _Doubt.GAP, stamp

    def _begin_anew(self, window: MapWindow, lost: int) -> None:
        """Await the map that begins with this window, unless it is held already."""
        held, heard = self._stamp, self._heard
        at_once = held == window.stamp and not self._by_window
        newer = heard is not None and heard < window.stamp < held
        self._await(window.stamp)
        self._note(window, lost)
        if self._geometry is not None and (at_once or newer):
            self._doubt = _Doubt.NONE
        else:
            self._forget_stamps()

    def _forget_stamps(self) -> None:
        """Take whatever whole map comes: stamps tell nothing about which is the newer."""
        self._stamp = self._whole = -1
        self._by_window = False

    def _put_on(
        self, windows: Sequence[MapWindow], geometry: GridGeometry, waited: bool
    ) -> list[MapWindow]:
        """Go on by windows that were kept, up to one that does not fit."""
        for k, window in enumerate(windows):
            if not _fits(window, geometry):
                self._await(window.stamp)
                self._kept.extend(windows[k + 1 :])
                self.missed += 1
                windows = windows[:k]
                break
        if windows:
            self._stamp, self._by_window = windows[-1].stamp, True
        if waited:
            self.taken += len(windows)
        return list(windows)

    def _drop_surplus(self) -> None:
        """Keep what is kept within bounds, the newest of it."""
        cells = sum(window.cells.size for window in self._kept)
        while len(self._kept) > MOST_KEPT or cells > MAX_CELLS:
            window = self._kept.popleft()
            cells -= window.cells.size
            if self._waits:
                self._doubt, self._wanted = _Doubt.GAP, window.stamp
                self.missed += 1
            else:
                self._oldest = window.stamp


def _fits(window: MapWindow, geometry: GridGeometry) -> bool:
    w = window.window
    return (
        0 <= w.row0 < w.row1 <= geometry.height
        and 0 <= w.col0 < w.col1 <= geometry.width
        and window.cells.shape == w.shape
    )


def _check_fits(window: MapWindow, geometry: GridGeometry) -> None:
    if not _fits(window, geometry):
        raise ValueError(
            f"the window ({window.window}; {window.cells.size} values) is no part of the map of "
            f"{geometry.height} rows and {geometry.width} columns; does somebody else publish it?"
        )
