# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which of the whole maps and the windows that come make up the mapper's newest map.

Whole maps and windows come by two ways, neither of which waits for the other. Each state of a
map is known by when the map began and by its own stamp, which grows from state to state. A
window tells the state that it changes and the one that it makes of it: so a window that was
missed, one that comes before its map, and a map that is older than what windows have made of it
already are all told apart, whatever the order they come in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import MAX_CELLS, GridGeometry, Window

__all__ = ["MapFollower", "MapWindow"]

#: Most windows that wait for the map they belong to.
MOST_WAITING = 100


@dataclass(frozen=True, eq=False)
class MapWindow:
    """New cells of a map.

    Parameters
    ----------
    began : int
        When the map began that they belong to [ns].
    previous, stamp : int
        Stamps of the state that they change and of the one they make of it [ns].
    window : Window
        Where they are.
    cells : ndarray of int8, shape of the window
        Their values.
    """

    began: int
    previous: int
    stamp: int
    window: Window
    cells: NDArray[np.int8]


class MapFollower:
    """Puts whole maps and windows in order; the cells are kept by who asks.

    Attributes
    ----------
    taken : int
        Windows that became part of the map.
    missed : int
        Windows that never could, because one before them did not come; the next whole map
        holds what they held.

    Examples
    --------
    >>> follower, cells = MapFollower(), np.zeros((1, 1), np.int8)
    >>> early = MapWindow(5, 10, 20, Window(0, 1, 0, 1), cells)
    >>> follower.take_window(early)  # the map it belongs to has yet to come
    []
    >>> [window.stamp for window in follower.take_map(5, 10, GridGeometry(4, 3, 0.1))]
    [20]
    >>> follower.outdated(5, 10), follower.outdated(5, 30)
    (True, False)
    """

    def __init__(self) -> None:
        self._began = self._stamp = -1
        self._geometry: GridGeometry | None = None
        self._by_window = False
        # By the state that they change.
        self._waiting: dict[tuple[int, int], MapWindow] = {}
        self.taken = 0
        self.missed = 0

    @property
    def waiting(self) -> int:
        """Number of windows that wait for the one before them, or for their map."""
        return len(self._waiting)

    def outdated(self, began: int, stamp: int) -> bool:
        """Whether windows have made a newer map of this one already, or just this one.

        Parameters
        ----------
        began, stamp : int
            When a whole map that has come began, and its stamp [ns].
        """
        return self._by_window and began == self._began and stamp <= self._stamp

    def take_map(self, began: int, stamp: int, geometry: GridGeometry) -> list[MapWindow]:
        """Go on from a whole map.

        Parameters
        ----------
        began, stamp : int
            When it began, and its stamp [ns].
        geometry : GridGeometry
            Where its cells lie.

        Returns
        -------
        list of MapWindow
            Windows that came before it and belong on it, in this order.
        """
        self._began, self._stamp, self._geometry = began, stamp, geometry
        self._by_window = False
        known = [
            key
            for key, window in self._waiting.items()
            if key[0] == began and (key[1] < stamp or not _fits(window, geometry))
        ]
        self._drop(known)
        return self._connected()

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
            If it lies outside its map, or its stamps are none of a window.
        """
        if not 0 <= window.previous < window.stamp:
            raise ValueError(
                f"a window makes a state at {window.stamp} ns of one at {window.previous} ns: "
                "the second must be the earlier one"
            )
        if window.began == self._began and self._geometry is not None:
            if window.stamp <= self._stamp:
                return []
            _check_fits(window, self._geometry)
            if window.previous < self._stamp:
                raise ValueError(
                    f"a window makes a state at {window.stamp} ns of one at {window.previous} ns, "
                    f"but in between there was one at {self._stamp} ns: does somebody else "
                    "publish windows?"
                )
        self._waiting[window.began, window.previous] = window
        self._drop_surplus()
        return self._connected()

    def _connected(self) -> list[MapWindow]:
        """Take from those that wait what goes on from the map as it is."""
        out: list[MapWindow] = []
        while (window := self._waiting.get((self._began, self._stamp))) is not None:
            del self._waiting[window.began, window.previous]
            self._stamp, self._by_window = window.stamp, True
            out.append(window)
        self.taken += len(out)
        return out

    def _drop(self, keys: list[tuple[int, int]]) -> None:
        for key in keys:
            del self._waiting[key]
        self.missed += len(keys)

    def _drop_surplus(self) -> None:
        """Keep what waits within bounds, the newest of it."""
        cells = sum(window.cells.size for window in self._waiting.values())
        while len(self._waiting) > MOST_WAITING or cells > MAX_CELLS:
            oldest = next(iter(self._waiting))
            cells -= self._waiting[oldest].cells.size
            self._drop([oldest])


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
            f"{window.window} of {window.cells.shape} cells is no part of a map of "
            f"{geometry.height} rows, {geometry.width} columns"
        )
