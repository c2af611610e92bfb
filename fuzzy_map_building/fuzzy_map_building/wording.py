# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How messages to users put numbers of things and what the system refused."""

from __future__ import annotations

__all__ = ["counted", "plain_reason"]


def counted(number: int, thing: str) -> str:
    """Return a number of things in words.

    Examples
    --------
    >>> counted(1, "perception"), counted(0, "perception")
    ('1 perception', '0 perceptions')
    """
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def plain_reason(error: BaseException) -> str:
    """Return what went wrong, without the numbers and brackets of the system.

    Examples
    --------
    >>> plain_reason(FileNotFoundError(2, "No such file or directory", "a.map"))
    "'a.map': No such file or directory"
    """
    if isinstance(error, MemoryError):
        return "there is not enough memory for it"
    if isinstance(error, OSError) and error.strerror:
        return f"'{error.filename}': {error.strerror}" if error.filename else error.strerror
    return str(error) or "no reason is known"
