# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compilation of kernels where numba is present; the same Python source where it is not.

A kernel is a function decorated with `njit`. Without numba, or with the environment
variable ``NUMBA_DISABLE_JIT=1``, it stays plain Python: slower, with the same results.

Compiled code is kept on disk, in ``NUMBA_CACHE_DIR`` if that is set, else beside the
source, else in the user's cache folder. Where none of these can be written (a read-only
installation, a service without a home), the code is compiled anew by each process.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

try:
    import numba
except ImportError:  # not installed, or not for this numpy
    numba = None

__all__ = ["compiled", "elementwise", "filled", "for_kernel", "njit", "remark", "short_for_kernel"]

F = TypeVar("F", bound=Callable[..., Any])

#: Names of the kernels that could not be given a place in a cache.
_uncached: list[str] = []


def compiled() -> bool:
    """Whether kernels run as machine code."""
    return numba is not None and not numba.config.DISABLE_JIT


def njit(function: F) -> F:
    """Compile a kernel at its first call, for the argument types of that call.

    The global interpreter lock is released while the kernel runs. Compiling takes
    seconds: each module with kernels has a ``warm_up()`` to call before work begins.

    Parameters
    ----------
    function : callable
        Loops over numpy arrays, in the part of Python that numba knows.

    Returns
    -------
    callable
        The compiled kernel, or `function` itself without numba.
    """
    if not compiled():
        return function
    try:
        kernel: F = numba.njit(cache=True, nogil=True)(function)
    except RuntimeError:  # numba: "no locator available", there is nowhere to write a cache
        _uncached.append(function.__name__)
        return numba.njit(nogil=True)(function)  # type: ignore[no-any-return]
    # numba compares the kernel's own file only, but the machine code holds the kernels that
    # it calls, and those may live in other files of the package: all of them count.
    cache_file: Any = getattr(getattr(kernel, "_cache", None), "_cache_file", None)
    if hasattr(cache_file, "_source_stamp"):
        stamp = _sources_stamp(Path(function.__code__.co_filename).parent)
        cache_file._source_stamp = (cache_file._source_stamp, stamp)
    return kernel


def elementwise(function: F) -> F:
    """Compile a formula to a loop over arrays at its first call, for the types of that call.

    Numpy evaluates the same formula operation by operation, each with a pass over the arrays.

    Parameters
    ----------
    function : callable
        Arithmetic on its arguments, which may be numbers or arrays, without branches.

    Returns
    -------
    callable
        The compiled formula, or `function` itself without numba; takes arrays.
    """
    if not compiled():
        return function
    try:
        return numba.vectorize(cache=True)(function)  # type: ignore[no-any-return]
    except RuntimeError:  # as for `njit`
        _uncached.append(function.__name__)
        return numba.vectorize(function)  # type: ignore[no-any-return]


def remark() -> str:
    """Return what a user should know of how kernels run here; empty where all is well.

    Returns
    -------
    str
        One line: that they are not compiled, or that each process compiles them anew.
    """
    if not compiled():
        return "kernels run as plain Python, many times slower: numba is missing or switched off"
    if _uncached:
        return (
            "kernels are compiled anew by each process, which takes seconds: there is nowhere to "
            "keep the code; set NUMBA_CACHE_DIR to a folder that can be written"
        )
    return ""


def for_kernel(array: NDArray[Any]) -> Any:
    """Return what a kernel reads and writes fastest: plain Python takes views of memory."""
    return array if compiled() else array.data


def short_for_kernel(array: NDArray[Any]) -> Any:
    """Return what a kernel reads fastest, and does not write, of an array of few numbers.

    Plain Python reads lists at twice the speed of memory, but a list has to be made first.
    """
    return array if compiled() else array.tolist()


def filled(count: int, value: float, kind: type[Any]) -> Any:
    """Return so many equal numbers for kernels alone to work on: plain Python does so on lists.

    Parameters
    ----------
    count : int
        How many.
    value : float
        Each of them.
    kind : type
        Scalar type of numpy, that of the array where kernels are compiled.
    """
    return np.full(count, value, kind) if compiled() else [value] * count


@functools.cache
def _sources_stamp(folder: Path) -> tuple[tuple[str, int, int], ...]:
    """Return name, time and size of every source in a folder and in the packages above it."""
    own = [(f.name, f.stat().st_mtime_ns, f.stat().st_size) for f in sorted(folder.glob("*.py"))]
    inside = (folder.parent / "__init__.py").exists()
    return (*own, *(_sources_stamp(folder.parent) if inside else ()))
