# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Snapshots: what a mapper remembers, on disk, for the one that takes its place.

A snapshot is written while the mapper goes on. So there is a second copy of the state, which
is brought up to date only where the map has changed since, and only this copy is written::

    snapshot.changed(report.window)  # after each packet
    if snapshot.due:
        snapshot.take(mapper)  # a window's worth of copying
        snapshot.write()  # by another thread, until the end of which `take` must not be called

A mapper takes a snapshot over only if it has the same cells and the same rules of evidence
and fusion; what was believed by other rules means something else.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from fuzzy_map_building.frozen_state import FrozenState
from fuzzy_map_building.grid import Window
from fuzzy_map_building.map_io import (
    MapFileError,
    load_map_and_parameters,
    remove_unfinished,
    save_map,
)
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.parameter_schema import flatten
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.plain_yaml import shown

__all__ = ["Snapshot", "rules_of"]

#: Groups of parameters that say what a belief means.
RULES: Final = (
    "sonar",
    "infrared",
    "evidence",
    "consistency",
    "infrared_evidence",
    "sonar_guard",
    "fusion",
)
#: How many differing parameters a refusal names.
NAMED: Final = 3
#: Added to the name of a snapshot that was refused.
ASIDE: Final = ".refused"

_EMPTY: Final = Window(0, 0, 0, 0)


def rules_of(parameters: MapperParameters, **others: str) -> dict[str, Any]:
    """Return what a snapshot and the mapper that takes it over must have in common.

    Parameters
    ----------
    parameters : MapperParameters
        Those that the mapper was started with.
    **others : str
        What else must be the same, e.g. ``node="/robot1/fuzzy_mapper"``.
    """
    rules: dict[str, Any] = dict(others)
    for group in RULES:
        rules.update(flatten(getattr(parameters, group), f"{group}."))
    # As they come back from a file: tuples as lists.
    read_back: dict[str, Any] = json.loads(json.dumps(rules))
    return read_back


class Snapshot:
    """The snapshot of one mapper in one file.

    Parameters
    ----------
    path : Path
        The file; its folder must exist, and nobody else may write it.
    rules : mapping
        See `rules_of`.

    Attributes
    ----------
    due : bool
        Whether the mapper has changed since the last `take`.
    """

    def __init__(self, path: Path, rules: Mapping[str, Any]) -> None:
        # Of a symbolic link, the file that it leads to.
        self._path = Path(os.path.realpath(path))
        self._rules = dict(rules)
        self._copy: MapState | None = None
        self._frozen: FrozenState | None = None
        self._perceptions = 0
        self._changed = _EMPTY
        self.due = False

    @property
    def path(self) -> Path:
        """The file."""
        return self._path

    def restore(self, mapper: FuzzyMapper) -> bool:
        """Have a mapper take the snapshot over, and remove what a killed writer left.

        Returns
        -------
        bool
            False if there is no snapshot; the mapper is then as it was.

        Raises
        ------
        MapFileError
            If there is one that cannot be taken over. The mapper is then as it was, and the
            file was set aside, its name with `ASIDE` added, where the next one to be refused
            will replace it.
        """
        remove_unfinished(self._path)
        if not self._path.exists():
            return False
        try:
            state, rules = load_map_and_parameters(self._path, mapper.geometry)
            if rules != self._rules:
                raise MapFileError(f"'{self._path}' {_difference(rules, self._rules)}")
            mapper.adopt(state)
        except ValueError as error:
            aside = self._path.with_name(self._path.name + ASIDE)
            try:
                os.replace(self._path, aside)
            except OSError as failure:
                raise MapFileError(f"{error}; and cannot set it aside: {failure}") from error
            raise MapFileError(f"{error}; it was set aside as '{aside.name}'") from error
        return True

    def changed(self, window: Window | None = None) -> None:
        """Take note that cells in a window, or all of them, may have changed."""
        if window is None:
            self._copy = None
        else:
            self._changed = self._changed.union(window)
        self.due = True

    def take(self, mapper: FuzzyMapper) -> None:
        """Copy what has changed since the last time.

        The time that it takes goes with the window that has changed; the first time and after
        ``changed(None)`` `write` will copy all of the map, as it is now.
        """
        if self._copy is None:
            self._frozen = mapper.freeze()
        else:
            cells = self._changed.slices
            for name in ("empty", "occupied", "count"):
                getattr(self._copy, name)[cells] = getattr(mapper, name)[cells]
        self._perceptions = mapper.perceptions
        self._changed = _EMPTY
        self.due = False

    def write(self) -> None:
        """Write what was taken, whole or not at all.

        Raises
        ------
        MapFileError
            If it cannot be written; the snapshot before it is then still there.
        """
        if self._frozen is not None:
            self._copy, self._frozen = self._frozen.state(), None
        assert self._copy is not None, "take() comes first"
        state = dataclasses.replace(self._copy, perceptions=self._perceptions)
        save_map(self._path, state, self._rules)

    def discard(self) -> None:
        """Remove the file: what was written before never comes back.

        Raises
        ------
        MapFileError
            If it cannot be removed.
        """
        self.changed()
        try:
            with contextlib.suppress(FileNotFoundError):
                self._path.unlink()
        except OSError as error:
            raise MapFileError(
                f"cannot remove '{self._path}': {error.strerror or error}"
            ) from error


def _difference(theirs: Mapping[str, Any] | None, ours: Mapping[str, Any]) -> str:
    """Return in words how the rules of a snapshot differ from a mapper's."""
    if theirs is None:
        return "does not tell with which parameters it was made: load_map takes such files"
    names = sorted(theirs.keys() | ours.keys())
    differing = [
        f"{name} is {_value(theirs, name)} there and {_value(ours, name)} here"
        for name in names
        if name not in theirs or name not in ours or theirs[name] != ours[name]
    ]
    more = f" and {len(differing) - NAMED} more differ" if len(differing) > NAMED else ""
    return f"was made with other parameters: {', '.join(differing[:NAMED])}{more}"


def _value(parameters: Mapping[str, Any], name: str) -> str:
    return shown(parameters[name]) if name in parameters else "unknown"
