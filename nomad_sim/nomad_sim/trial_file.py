# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The file that a campaign's trials are written to one by one, and taken up again from.

Its first line says what all of them have in common, each further line is one result, in JSON.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Any

from fuzzy_map_building.map_io import is_special
from nomad_sim.json_fields import parse_json
from nomad_sim.trials import TrialResult

__all__ = ["TrialFile"]

#: Layout of the file; raised when a key changes its meaning.
FORMAT = 1
#: Largest file that is read; a trial takes about 700 bytes.
MAX_BYTES = 2_000_000_000


class TrialFile:
    """Results on disk, each from the moment on in which it is added.

    A campaign that was stopped in the middle of a line leaves a part of it: that trial counts
    as not run. While the file is open no other campaign can write to it.

    Parameters
    ----------
    path : Path
        The file; made if missing.
    configuration : mapping
        What the results have in common, in JSON's types.

    Attributes
    ----------
    results : dict
        What is there: `TrialResult` by (kind, seed).

    Raises
    ------
    ValueError
        If the file holds results of another configuration or of a mission twice, is being
        written to, or is none.
    OSError
        If it cannot be opened.
    """

    def __init__(self, path: Path, configuration: dict[str, Any]) -> None:
        # A pipe would wait for whoever writes to it, and a device may give without end.
        if is_special(path):
            raise ValueError(
                f"{path} is a folder, a device or a pipe; remove it or use another --output"
            )
        self.path = path
        self.results: dict[tuple[str, int], TrialResult] = {}
        # Without a buffer: what could not be written would be tried again when it is closed.
        self._file = path.open("a+b", buffering=0)
        try:
            self._lock()
            self._read(json.loads(json.dumps({"format": FORMAT, **configuration})))
        except BaseException:
            self._file.close()
            raise

    def _lock(self) -> None:
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ValueError(
                f"{self.path} is being written to by another campaign; use another --output"
            ) from None

    def _read(self, header: dict[str, Any]) -> None:
        size = self._file.seek(0, os.SEEK_END)
        if size > MAX_BYTES:
            raise ValueError(f"{self.path} has {size} bytes: it holds no trials")
        self._file.seek(0)
        content = self._file.read()
        # What follows the last line's end was being written when the campaign was stopped.
        whole = content[: content.rfind(b"\n") + 1]
        first, *lines = whole.split(b"\n")[:-1] or [b""]
        start = json.dumps(header).encode() + b"\n"
        if not whole and not start.startswith(content):
            raise ValueError(f"{self.path} holds no trials; use another --output")
        try:
            found = parse_json(first) if whole else header
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{self.path} holds no trials; use another --output") from error
        if not _same(found, header):
            raise ValueError(
                f"{self.path} holds trials of another configuration"
                f"{_difference(found, header)}; use another --output"
            )
        results = self._results(lines)
        # Only now, for what is refused is not to be touched.
        self._file.truncate(len(whole))
        if not whole:
            self._write(header)
        self.results = results

    def _results(self, lines: Sequence[bytes]) -> dict[tuple[str, int], TrialResult]:
        """Return what the lines below the first one hold."""
        results: dict[tuple[str, int], TrialResult] = {}
        line_of: dict[tuple[str, int], int] = {}
        damaged: dict[int, Exception] = {}
        for number, line in enumerate(lines, start=2):
            try:
                result = TrialResult.from_json(parse_json(line))
                mission = result.kind, result.mission.seed
                if mission in results:
                    raise ValueError(
                        f"mission {result.kind} {result.mission.seed} is in line "
                        f"{line_of[mission]} already"
                    )
            except (ValueError, RecursionError) as error:
                damaged[number] = error
            else:
                results[mission], line_of[mission] = result, number
        if damaged:
            number, first = next(iter(damaged.items()))
            # Of JSON that ends amiss without its place, which would be that in the line.
            reason = getattr(first, "msg", first)
            more = f" ({len(damaged) - 1} more are damaged as well)" if len(damaged) > 1 else ""
            raise ValueError(
                f"{self.path}: line {number} cannot be taken: {reason}{more}; remove it, and a "
                "mission that no line holds is run again, or use another --output"
            ) from first
        return results

    def _write(self, value: dict[str, Any]) -> None:
        rest = json.dumps(value).encode() + b"\n"
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            raise OSError(f"cannot write {self.path}: {error.strerror or error}") from error

    def add(self, result: TrialResult) -> None:
        """Append a result.

        Raises
        ------
        OSError
            If it cannot be written; those before it are on the disk.
        """
        self._write(asdict(result))
        self.results[result.kind, result.mission.seed] = result

    def __enter__(self) -> TrialFile:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()


def _same(found: Any, wanted: Any) -> bool:
    """Whether two JSON values are the same: `True` is not 1."""
    return json.dumps(found, sort_keys=True) == json.dumps(wanted, sort_keys=True)


def _difference(found: Any, wanted: Any, where: str = "") -> str:
    """Return the first place where two JSON values differ, in words."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        for key in sorted({*found, *wanted}):
            if not _same(found.get(key), wanted.get(key)):
                place = f"{where}.{key}" if where else str(key)
                return _difference(found.get(key), wanted.get(key), place)
    there, here = (json.dumps(value)[:200] for value in (found, wanted))
    return f" ({where[:200] or 'its first line'}: {there} there, {here} here)"
