# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A function over many inputs on a Dask cluster, where Dask is installed."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

__all__ = ["run_on_cluster"]

T = TypeVar("T")
R = TypeVar("R")


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
        If Dask is not installed.
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
    with distributed.Client(address) as client:
        futures = client.map(function, items, pure=False)
        index = {future.key: number for number, future in enumerate(futures)}
        for future, result in distributed.as_completed(futures, with_results=True):
            yield index[future.key], result
            future.release()
