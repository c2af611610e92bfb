# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Runs something once in a process of its own: processor time of the first time, and memory."""

from __future__ import annotations

import multiprocessing
import re
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

__all__ = ["first_call"]


def _resident(peak: bool) -> int:
    """Return the memory of this process, now or at most so far [bytes]."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    found = re.search(rf"^{'VmHWM' if peak else 'VmRSS'}:\s+(\d+) kB", status, re.MULTILINE)
    return int(found[1]) * 1024 if found else 0


def _measure(call: Callable[[], object], end: Connection) -> None:
    before = _resident(peak=False)
    began = time.process_time()
    call()
    seconds = time.process_time() - began
    end.send((seconds, max(0, _resident(peak=True) - before)))


def first_call(call: Callable[[], object]) -> tuple[float, int]:
    """Return processor time [s] and additional peak memory [bytes] of a call in a new process.

    All modules are loaded and all kernels compiled, but no memory has been touched.
    """
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_measure, args=(call, there))
    process.start()
    there.close()
    seconds, memory = here.recv()
    process.join()
    return seconds, memory
