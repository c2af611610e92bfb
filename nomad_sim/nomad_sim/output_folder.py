# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A folder for results, looked at before the work and not after it."""

from __future__ import annotations

import tempfile
from pathlib import Path

__all__ = ["made_folder"]


def made_folder(text: str) -> Path:
    """Return the folder that ``--output`` names, made if missing, in which files can be written.

    Parameters
    ----------
    text : str
        As it was typed.

    Raises
    ------
    ValueError
        If it names nothing, or a folder that cannot be made or written to; the message is for
        whoever typed it.
    """
    if not text.strip() or "\0" in text:
        # An empty path is that of the working folder, where nobody expects results.
        raise ValueError(f"--output {text!r} names no folder; for the working folder write '.'")
    folder = Path(text)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise ValueError(f"--output {text} is no folder: a file of this name is there") from None
    except OSError as error:
        raise ValueError(f"--output {text}: cannot make this folder: {error.strerror}") from error
    try:
        # The permissions do not tell: a file system may be read-only or full.
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise ValueError(f"--output {text}: cannot write there: {error.strerror}") from error
    return folder
