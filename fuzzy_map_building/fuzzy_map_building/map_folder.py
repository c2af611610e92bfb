# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The one folder that map files may be asked for by name, and be written to.

Whoever can call the mapper's services gives the names. They are looked at before anything
is opened, and none of them leads out of the folder.
"""

from __future__ import annotations

import os
import reprlib
from pathlib import Path

__all__ = ["MapFolder"]

#: Longest name of a file with its folders [bytes of UTF-8]; file systems take little more.
_MAX_NAME = 1024


class MapFolder:
    """Names of files to paths inside of a folder.

    Parameters
    ----------
    folder : str
        The folder, ``~`` being the user's home, a relative one starting from where the process
        was started. It need not exist until something is written. Empty: there is none, and
        every name is refused.

    Raises
    ------
    ValueError
        If it can be no folder's name.
    """

    def __init__(self, folder: str) -> None:
        if "\0" in folder:
            raise ValueError(f"{folder!r} is no folder's name")
        self._folder = Path(os.path.abspath(os.path.expanduser(folder))) if folder else None

    def file_to_write(self, name: str) -> Path:
        """Return the path of a file that may be written, replacing what is there.

        The folder itself is made if it is missing.

        Parameters
        ----------
        name : str
            Name of the file, with folders inside of the map folder if need be.

        Raises
        ------
        ValueError
            If the name is empty, absolute, leads out of the folder by ``..`` or by a symbolic
            link, or is that of a folder, a device or a pipe: writing would replace it, too.
        OSError
            If the folder cannot be made or looked at.
        """
        file = self._inside(name)
        assert self._folder is not None
        self._folder.mkdir(parents=True, exist_ok=True)
        return file

    def file_to_read(self, name: str) -> Path:
        """Return the path of a file that exists.

        Raises
        ------
        ValueError
            As `file_to_write`, or if there is none of that name. A pipe would block for ever.
        OSError
            If it cannot be looked at.
        """
        file = self._inside(name)
        if not file.exists():
            raise ValueError(f"there is no file {name!r} in the map folder '{self._folder}'")
        return file

    def _inside(self, name: str) -> Path:
        """Return the path, free of symbolic links, that a name stands for."""
        if self._folder is None:
            raise ValueError(
                "map files are switched off: no folder is named in the parameter 'map_folder'"
            )
        if not name:
            raise ValueError(f"no name was given; name a file in the map folder '{self._folder}'")
        if not name.isprintable() or len(name.encode(errors="replace")) > _MAX_NAME:
            raise ValueError(f"{reprlib.repr(name)} is no file name")
        parts = Path(name).parts
        if os.path.isabs(name) or ".." in parts or not parts:
            raise ValueError(
                f"{name!r} is refused: names are those of files inside the map folder "
                f"'{self._folder}' (parameter 'map_folder'), without '/' before or '..' in them"
            )
        file = Path(os.path.realpath(self._folder / name))
        if not file.is_relative_to(os.path.realpath(self._folder)):
            raise ValueError(
                f"{name!r} is refused: a symbolic link leads out of the map folder "
                f"'{self._folder}'"
            )
        if file.is_symlink():
            raise ValueError(f"{name!r} is a symbolic link that leads back to itself")
        if file.exists() and not file.is_file():
            raise ValueError(f"{name!r} is a folder, a device or a pipe; name a file")
        return file
