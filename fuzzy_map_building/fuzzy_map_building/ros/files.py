# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Paths that come in by a service: looked at before anything is opened there."""

from __future__ import annotations

from pathlib import Path

__all__ = ["file_to_read", "file_to_write"]


def file_to_write(path: str) -> Path:
    """Return the absolute path of a file that may be written, replacing what is there.

    Raises
    ------
    ValueError
        If the path is empty, or a folder, device or pipe: writing would replace it, too.
    OSError
        If it cannot be looked at.
    """
    if not path:
        raise ValueError("no path was given; name the file, as this process sees it")
    if "\0" in path:
        raise ValueError(f"{path!r} is no file name")
    file = Path.cwd() / path
    if file.exists() and not file.is_file():
        raise ValueError(f"{_shown(path)} is a folder, a device or a pipe; name a file")
    return file


def file_to_read(path: str) -> Path:
    """Return the absolute path of a file that exists.

    Raises
    ------
    ValueError
        If there is none, or it is a folder, a device, or a pipe, which would block for ever.
    OSError
        If it cannot be looked at.
    """
    file = file_to_write(path)
    if not file.exists():
        raise ValueError(f"there is no file {_shown(path)} as this process sees it")
    return file


def _shown(path: str) -> str:
    """Return how a message names a path, a relative one with what it is relative to."""
    absolute = Path(path).is_absolute()
    return f"'{path}'" if absolute else f"'{path}' in the folder '{Path.cwd()}'"
