# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How messages to users put numbers of things and what was refused."""

from __future__ import annotations

import argparse
import math

import numpy as np

__all__ = ["as_meant", "counted", "plain_reason", "real_number", "whole_number"]


def as_meant(value: float) -> str:
    """Return a number as it was before a message of 32 bits: 0.1, not 0.10000000149.

    Examples
    --------
    >>> as_meant(float(np.float32(5.3))), as_meant(5.3)
    ('5.3', '5.3')
    """
    if abs(value) > float(np.finfo(np.float32).max):
        return str(value)
    single = np.float32(value)
    return str(single) if float(single) == value else str(value)


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


def whole_number(text: str) -> int:
    """Return a whole number of a command line; the `type` of an argument of argparse."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, got {text!r}") from None


def real_number(text: str) -> float:
    """Return a finite number of a command line; the `type` of an argument of argparse."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"must be a finite number, got {text!r}")
    return value
