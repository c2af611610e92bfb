# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A folder for results, looked at before the work and not after it, and what is written there."""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from fuzzy_map_building.map_io import MapFileError, atomic_write

__all__ = ["made_folder", "write_result", "write_table"]


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


def write_result(file: Path, content: str | bytes) -> None:
    """Write a file of results, which is the old one until it is the new one as a whole.

    Parameters
    ----------
    file : Path
        In a folder that is there.
    content : str or bytes
        All of it; a text is written in UTF-8.

    Raises
    ------
    OSError
        If it cannot be written; the message is for whoever wants the results.
    """
    try:
        with atomic_write(file) as out:
            out.write(content.encode() if isinstance(content, str) else content)
    except MapFileError as error:
        raise OSError(f"{error}; see to that and run the same command again") from error


def write_table(file: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a table as CSV, as `write_result` does."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns)
    writer.writeheader()
    writer.writerows(rows)
    write_result(file, text.getvalue())
