# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Has the mapper's snapshots written beside its work, as often as the parameters want.

A snapshot is written by a thread of its own. What the node's thread does for it is to copy
the cells that have changed; where the two would get in each other's way, at `discard` and
`close`, the node waits for the write that goes on.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from typing import Final

from fuzzy_map_building.grid import Window
from fuzzy_map_building.map_folder import MapFolder
from fuzzy_map_building.map_io import MapFileError
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.snapshot import Snapshot, rules_of
from fuzzy_map_building.wording import counted

__all__ = ["SnapshotWriter"]

#: Share of the time that may be spent on writing.
SHARE: Final = 0.1


class SnapshotWriter:
    """Keeps the snapshot of a mapper up to date; does nothing where none is wanted.

    Parameters
    ----------
    node : str
        Full name of the mapper's node: a snapshot of another one is not taken over.
    parameters : MapperParameters
        Those that the node was started with.

    Attributes
    ----------
    saved : int
        Perceptions in the snapshot on disk; -1 while there is none.

    Raises
    ------
    ValueError, OSError
        If ``snapshot.file`` cannot be a file to write.
    """

    def __init__(self, node: str, parameters: MapperParameters) -> None:
        self.saved = -1
        self._snapshot: Snapshot | None = None
        self._thread: threading.Thread | None = None
        self._fault = ""
        self._taken = 0
        self._began = self._ended = self._due = 0.0
        path = parameters.snapshot.file
        if not path:
            return
        try:
            file = MapFolder("").file_to_write(os.path.expanduser(path))
        except ValueError as error:
            raise ValueError(f"parameter 'snapshot.file': {error}") from error
        if not file.parent.is_dir():
            raise ValueError(f"parameter 'snapshot.file': there is no folder '{file.parent}'")
        self._snapshot = Snapshot(file, rules_of(parameters, node=node))

    @property
    def writing(self) -> bool:
        """Whether a snapshot is being written: `discard` would wait for it."""
        return self._thread is not None and self._thread.is_alive()

    def join(self) -> None:
        """Wait, in any thread, for the snapshot that is being written."""
        if (thread := self._thread) is not None:
            thread.join()

    def restore(self, mapper: FuzzyMapper) -> str:
        """Have the mapper go on from its snapshot.

        Returns
        -------
        str
            What was done, for the log; empty if there was nothing to do.

        Raises
        ------
        MapFileError
            If the snapshot cannot be taken over; see `Snapshot.restore`.
        """
        if self._snapshot is None or not self._snapshot.restore(mapper):
            return ""
        self.saved = mapper.perceptions
        return f"went on from {counted(mapper.perceptions, 'perception')} in {self._snapshot.path}"

    def changed(self, window: Window) -> None:
        """Take note that the cells of a window may have changed."""
        if self._snapshot is not None:
            self._snapshot.changed(window)

    def advance(self, mapper: FuzzyMapper, period: float, refused: Callable[[str], None]) -> None:
        """Begin to write a snapshot if it is time; call it several times a second.

        Parameters
        ----------
        mapper : FuzzyMapper
            Whose snapshot it is.
        period : float
            Least time from one to the next [s of wall time].
        refused : callable
            Told why a snapshot could not be written, after each that could not.
        """
        snapshot = self._snapshot
        if snapshot is None:
            return
        if self.writing:
            return
        self._finish(period, refused)
        if not snapshot.due or time.monotonic() < self._due:
            return
        self._began = time.monotonic()
        snapshot.take(mapper)
        self._taken = mapper.perceptions
        self._thread = threading.Thread(target=self._write, args=(snapshot,), name="snapshot")
        self._thread.start()

    def discard(self, refused: Callable[[str], None]) -> None:
        """Have what was before never come back: the map has become another one.

        The snapshot of the new one is begun by the next `advance`.
        """
        if self._snapshot is None:
            return
        self._finish(0.0, refused)
        try:
            self._snapshot.discard()
        except MapFileError as error:
            refused(str(error))
        self.saved = -1
        self._due = 0.0

    def close(self, mapper: FuzzyMapper, refused: Callable[[str], None]) -> None:
        """Write what is not written yet, and wait for it."""
        snapshot = self._snapshot
        if snapshot is None:
            return
        self._finish(0.0, refused)
        if snapshot.due:
            snapshot.take(mapper)
            self._write(snapshot)
            if self._fault:
                refused(self._fault)

    def _write(self, snapshot: Snapshot) -> None:
        try:
            snapshot.write()
            self._fault = ""
        except MapFileError as error:
            self._fault = str(error)
        self._ended = time.monotonic()

    def _finish(self, period: float, refused: Callable[[str], None]) -> None:
        """Take note of what became of the write that was begun, if any, waiting for its end."""
        if self._snapshot is None or self._thread is None:
            return
        self._thread.join()
        self._thread = None
        pause = (self._ended - self._began) * (1.0 / SHARE - 1.0)
        self._due = max(self._began + period, self._ended + pause)
        if self._fault:
            self._snapshot.due = True  # to be tried again
            refused(self._fault)
        else:
            self.saved = self._taken
