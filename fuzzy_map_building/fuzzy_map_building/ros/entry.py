# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where the executable `mapper` begins, and how any other does.

Importing rclpy, numpy and scipy takes a second or two. A signal that comes meanwhile must end
the process as cleanly as one that comes later: this module imports nothing that takes time.
"""

from __future__ import annotations

import errno
import importlib
import io
import os
import signal
import sys
from types import FrameType
from typing import Any

__all__ = ["mapper", "start"]

#: Exit codes of a program that has done its work but could not tell all of it: nobody listens
#: any more (as of one that SIGPIPE ends), or it cannot be written.
_NOBODY_LISTENS = 128 + signal.SIGPIPE
_UNTOLD = 2


class _Output(io.RawIOBase):
    """Standard output or error which, when it fails, fails once and at the end.

    What a closed pipe or a full disk does to a line must not keep results from their files.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream  # whose descriptor is closed with it
        self._descriptor: int = stream.fileno()
        self.problem: OSError | None = None

    def fileno(self) -> int:
        return self._descriptor

    def isatty(self) -> bool:
        return os.isatty(self._descriptor)

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        if self.problem is None:
            try:
                return os.write(self._descriptor, data)
            except OSError as error:
                self.problem = error
        return len(data)

    def code(self, code: Any) -> Any:
        """Return the exit code of a program that would end with `code`, and tell a problem."""
        sys.stdout.flush()
        if self.problem is None:
            return code
        if self.problem.errno == errno.EPIPE:
            return code or _NOBODY_LISTENS
        program = os.path.basename(sys.argv[0])
        reason = self.problem.strerror
        print(f"{program}: cannot write to standard output: {reason}", file=sys.stderr)
        return code or _UNTOLD


def _replaced(name: str) -> _Output:
    """Put an `_Output` in the place of ``sys.stdout`` or ``sys.stderr``."""
    before: Any = getattr(sys, name)
    if before is None:  # it was closed from the start
        before = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8")
    raw = _Output(before)
    replacement = io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=before.encoding,
        errors=before.errors,
        line_buffering=before.line_buffering or before.write_through,
    )
    setattr(sys, name, replacement)
    return raw


def start(module: str, stopped: int | None = 0) -> int:
    """Import a module and run its ``main``, which takes the signals over.

    Parameters
    ----------
    module : str
        Full name of the module.
    stopped : int, optional
        Exit code of the process if SIGINT or SIGTERM comes before ``main`` has taken them over,
        or after it has given them back, 0 of a program that serves until then; None: 128 and the
        signal's number.

    Returns
    -------
    int
        Exit code of ``main``; in place of 0 another one if standard output has failed and what it
        tells is its work.
    """

    def leave(number: int, _frame: FrameType | None) -> None:
        # Nothing has been opened yet that would have to be closed.
        os._exit(128 + number if stopped is None else stopped)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, leave)
    output = _replaced("stdout")
    _replaced("stderr")  # a bar of progress that nobody sees is no reason to stop
    try:
        code: Any = importlib.import_module(module).main()
        served = stopped == 0
    except SystemExit as end:
        code, served = end.code, False
    # Who serves until it is stopped has done its work, whether or not anybody could be told.
    ended: int = code if served else output.code(code)
    return ended


def mapper() -> int:
    """Run the node ``fuzzy_mapper``."""
    return start("fuzzy_map_building.ros.mapper_node")
