# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A function over many inputs on a Dask cluster, where Dask is installed."""

from __future__ import annotations

import importlib
import logging
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from tqdm import tqdm

from nomad_sim.campaign_parser import PROGRAM

__all__ = ["run_on_cluster"]

T = TypeVar("T")
R = TypeVar("R")

#: After how long without a result it is looked whether there are workers, and how often it is
#: looked for a result [s].
_PATIENCE = 5.0
_POLL = 0.05


def run_on_cluster(
    function: Callable[[T], R], items: Sequence[T], address: str
) -> Iterator[tuple[int, R]]:
    """Yield (index, result) for each item, in the order in which they are done.

    When the caller ends before the work does, what has not begun is cancelled.

    Parameters
    ----------
    function : callable
        What the workers have installed as well, found by its name in its module.
    items : sequence
        What it is called with.
    address : str
        The scheduler's, such as ``tcp://10.0.0.1:8786``.

    Raises
    ------
    ValueError
        If Dask is not installed here, or the function's module cannot be imported there.
    ConnectionError
        If the scheduler is lost.
    ChildProcessError
        If workers died of an item, as often as the scheduler tries.
    OSError
        If there is no scheduler at the address.
    Exception
        Whatever `function` raises.
    """
    try:
        distributed = importlib.import_module("distributed")
    except ImportError as error:
        raise ValueError(
            "--dask needs the package 'distributed' here and on the workers: "
            "pip install distributed; without it use --jobs"
        ) from error
    # What it logs of a scheduler that is lost, in tracebacks, the exception here says.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    failure: BaseException | None = None
    with distributed.Client(address) as client:
        try:
            _await_workers(client, address)
            _check_workers(client, function.__module__)
            futures = client.map(function, items, pure=False)
            index = {future.key: number for number, future in enumerate(futures)}
            for future in _completed(client, distributed.as_completed(futures), address):
                if future.status == "error":
                    failure = future.exception()
                    break
                yield index[future.key], future.result()
                future.release()
        except (distributed.CancelledError, OSError) as error:
            raise ConnectionError(f"the Dask scheduler at {address} is lost") from error
    if isinstance(failure, distributed.KilledWorker):
        raise ChildProcessError(
            f"Dask workers of {address} died, one after the other, of the same work: killed, out "
            "of memory, or without its package; their logs tell"
        ) from failure
    if isinstance(failure, RuntimeError) and isinstance(failure.__cause__, ImportError):
        raise ValueError(_lacking(f"scheduler {address}", failure.__cause__)) from failure
    if failure is not None:
        raise failure


def _await_workers(client: Any, address: str) -> None:
    """Wait until there is a worker."""
    patience = time.monotonic() + _PATIENCE
    while not client.nthreads():
        if time.monotonic() > patience:
            _tell(f"no workers yet at {address}; waiting")
            patience = math.inf
        time.sleep(_POLL)


def _check_workers(client: Any, module: str) -> None:
    """Refuse workers that cannot import what they are to run: it would end them."""
    found = client.run(importlib.import_module, module, on_error="return")
    for worker, answer in found.items():
        if isinstance(answer, ImportError):
            raise ValueError(_lacking(f"worker {worker}", answer))


def _lacking(where: str, error: ImportError) -> str:
    return (
        f"the Dask {where} lacks a package: {error}; install it where scheduler and workers run, "
        "and start them anew"
    )


def _completed(client: Any, completed: Any, address: str) -> Iterator[Any]:
    """Yield futures as they are done, and tell when nobody is left to do them."""
    told = False
    look = time.monotonic() + _PATIENCE
    while not completed.is_empty():
        if completed.has_ready():
            yield next(completed)
        elif time.monotonic() > look:
            alone = not client.nthreads()
            if alone and not told:
                _tell(f"no workers left at {address}, their logs tell why; waiting")
            told = alone
        else:
            time.sleep(_POLL)
            continue
        look = time.monotonic() + _PATIENCE


def _tell(text: str) -> None:
    # Beside a bar of progress, which a plain print would tear.
    tqdm.write(f"{PROGRAM}: {text}", file=sys.stderr)
