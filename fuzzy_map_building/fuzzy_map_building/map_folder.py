# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where map files may lie that are asked for by name: in one folder, if one was chosen.

Whoever can call the mapper's services gives the names. They are looked at before anything
is opened, and where a folder was chosen none of them leads out of it.
"""

from __future__ import annotations

import os
import reprlib
from pathlib import Path

from fuzzy_map_building.map_io import is_special

__all__ = ["MapFolder", "MapNameError"]

#: Longest name of a file with its folders, and of each of these [bytes of UTF-8]; file systems
#: take little more, and beside the file another one is written.
_MAX_NAME = 1024
_MAX_PART = 255


class MapNameError(ValueError):
    """A name that stands for no file that may be written or read."""


class MapFolder:
    """Names of files to paths inside of a folder.

    Parameters
    ----------
    folder : str
        The folder, ``~`` being the user's home, a relative one starting from where the process
        was started. It need not exist until something is written. Empty: none was chosen, and
        every file that the process may open can be named.

    Raises
    ------
    ValueError
        If it can be no folder's name.
    """

    def __init__(self, folder: str) -> None:
        if "\0" in folder:
            raise ValueError(f"{folder!r} is no folder's name")
        self._folder = Path(os.path.abspath(os.path.expanduser(folder)))
        self._confined = bool(folder)

    def file_to_write(self, name: str) -> Path:
        """Return the path of a file that may be written, replacing what is there.

        The folder itself is made if it is missing.

        Parameters
        ----------
        name : str
            Name of the file, with folders inside of the map folder if need be; or its absolute
            path.

        Raises
        ------
        MapNameError
            If the name is empty, leads out of the folder as an absolute path, by ``..`` or by a
            symbolic link, begins with ``~``, lies in a folder that is not there, or is that of a
            folder, a device or a pipe: writing would replace it, too.
        OSError
            If the folder cannot be made or looked at.
        """
        file = self._allowed(name)
        self._folder.mkdir(parents=True, exist_ok=True)
        if not file.parent.is_dir():
            raise MapNameError(f"there is no folder '{file.parent}' for {name!r}; make it first")
        return file

    def file_to_read(self, name: str) -> Path:
        """Return the path of a file that exists.

        Raises
        ------
        MapNameError
            As `file_to_write`, or if there is none of that name. A pipe would block for ever.
        OSError
            If it cannot be looked at.
        """
        file = self._allowed(name)
        if not file.exists():
            raise MapNameError(f"there is no file '{file}'")
        return file

    def _allowed(self, name: str) -> Path:
        """Return the path, free of symbolic links, that a name stands for."""
        if not name:
            raise MapNameError("no name was given; name a file")
        if not name.isprintable():
            raise MapNameError(
                f"{reprlib.repr(name)} is no file name: it has a character that cannot be printed"
            )
        if len(name.encode()) > _MAX_NAME or any(
            len(part.encode()) > _MAX_PART for part in name.split("/")
        ):
            raise MapNameError(
                f"{reprlib.repr(name)} is no file name: it is too long, {_MAX_PART} bytes are "
                f"allowed of each part, {_MAX_NAME} in all"
            )
        if name.startswith("~"):
            raise MapNameError(
                f"{name!r} is refused: '~' does not stand for a home here; name a file in "
                f"'{self._folder}', or with its absolute path"
            )
        file = Path(os.path.realpath(self._folder / name))
        if self._confined:
            self._assert_inside(name, file)
        if file.is_symlink():
            raise MapNameError(f"{name!r} is a symbolic link that leads back to itself")
        if is_special(file):
            raise MapNameError(f"{name!r} is a folder, a device or a pipe; name a file")
        return file

    def _assert_inside(self, name: str, file: Path) -> None:
        named = self._folder / name
        if ".." in named.parts or not named.is_relative_to(self._folder):
            raise MapNameError(
                f"{name!r} is refused: map files lie inside of the map folder "
                f"'{self._folder}' (parameter 'map_folder'); name one without '..'"
            )
        if not file.is_relative_to(os.path.realpath(self._folder)):
            raise MapNameError(
                f"{name!r} is refused: a symbolic link leads out of the map folder "
                f"'{self._folder}'"
            )
