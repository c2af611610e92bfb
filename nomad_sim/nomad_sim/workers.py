# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A function over many inputs in worker processes that never outlive their parent."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

__all__ = ["run_in_parallel"]

T = TypeVar("T")
R = TypeVar("R")

#: Threads of the numeric libraries in one worker: the processes share the cores out already.
_THREADS = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
}


def run_in_parallel(
    function: Callable[[T], R], items: Sequence[T], jobs: int
) -> Iterator[tuple[int, R]]:
    """Yield (index, result) for each item, in the order in which they are done.

    With one job, or one item, the work is done in this process. However the caller ends,
    also by an exception or by closing the iterator, no worker is left.

    Parameters
    ----------
    function : callable
        Found by its name in its module, so that a new process can find it as well; what it
        takes and returns can be pickled.
    items : sequence
        What it is called with.
    jobs : int
        Most processes at a time, from 1 on.

    Raises
    ------
    ValueError
        If `jobs` is less than 1.
    ChildProcessError
        If a worker was killed.
    Exception
        Whatever `function` raises.
    """
    if jobs < 1:
        raise ValueError(f"at least one job is needed, got {jobs}")
    if jobs == 1 or len(items) <= 1:
        for index, item in enumerate(items):
            yield index, function(item)
        return
    workers: dict[Connection, BaseProcess] = {}
    try:
        _start(workers, function, min(jobs, len(items)))
        waiting = iter(enumerate(items))
        for connection in workers:
            connection.send(next(waiting))
        for _ in items:
            connection = _next_answer(workers)
            try:
                index, result, error = connection.recv()
            except (EOFError, OSError):
                worker = workers[connection]
                worker.join()
                raise ChildProcessError(
                    f"a worker process was ended from outside (exit code {worker.exitcode})"
                ) from None
            if error is not None:
                raise error
            following = next(waiting, None)
            if following is not None:
                connection.send(following)
            yield index, result
    finally:
        with _signals_held():
            for connection, worker in workers.items():
                worker.kill()
                worker.join()
                connection.close()


def _next_answer(workers: dict[Connection, BaseProcess]) -> Connection:
    ready = wait(list(workers))
    assert isinstance(ready[0], Connection)
    return ready[0]


def _start(
    workers: dict[Connection, BaseProcess], function: Callable[[Any], Any], count: int
) -> None:
    """Start workers, fresh interpreters that share neither threads nor locks with this one."""
    context = get_context("spawn")
    resource_tracker.ensure_running()  # it resets the signals that are blocked
    with _signals_held(), _inherited():
        for _ in range(count):
            ours, theirs = context.Pipe()
            worker = context.Process(target=_work, args=(function, theirs), daemon=True)
            worker.start()
            theirs.close()
            workers[ours] = worker


@contextlib.contextmanager
def _signals_held() -> Iterator[None]:
    """Let SIGINT and SIGTERM wait, so that no worker is lost between start and list."""
    if threading.current_thread() is not threading.main_thread():
        yield  # Python handles signals in the main thread alone
        return
    held: list[int] = []
    before = {
        number: signal.signal(number, lambda number, _frame: held.append(number))
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for late in held:
            signal.raise_signal(late)


@contextlib.contextmanager
def _inherited() -> Iterator[None]:
    """Set what a new process inherits: its libraries' threads, and to leave Ctrl-C to us."""
    before = {name: os.environ.get(name) for name in _THREADS}
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    os.environ.update(_THREADS)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


def _work(function: Callable[[Any], Any], connection: Connection) -> None:
    """Answer calls until the parent closes the connection or is no more."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            index, item = connection.recv()
            result, error = None, None
            try:
                result = function(item)
            except Exception as problem:
                error = problem
            connection.send((index, result, error))
