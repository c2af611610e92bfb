# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Save and load all that a mapper remembers, exactly.

A map file is a zip archive of ``map.json`` (format, version, grid, perceptions) and the
arrays ``empty.npy``, ``occupied.npy``, ``count.npy``; `numpy.load` opens it as well. It is
written beside its final place and moved there when it is complete, so that a reader or a
power failure never meets half a file. Loading trusts nothing: sizes are checked before
memory is taken, and no code can come along (no pickle).

The header may also tell with which parameters the state came about; snapshots do.
"""

from __future__ import annotations

import glob
import io
import json
import os
import re
import secrets
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.plain_yaml import shown

__all__ = [
    "MapFileError",
    "atomic_write",
    "is_special",
    "load_map",
    "load_map_and_parameters",
    "remove_unfinished",
    "save_map",
]

_FORMAT = "fuzzy_map_building"
_VERSION = 1
_HEADER = "map.json"
_ARRAYS = {"empty": np.float64, "occupied": np.float64, "count": np.int32}
#: Longest header: room for the parameters of some hundred sensors.
_MAX_HEADER = 65536
#: Longest header of an .npy file of these arrays, with room to spare.
_MAX_ARRAY_HEADER = 1024
#: The end of a zip archive without comment: signature, numbers of disks and of members, size
#: and place of the directory, length of the comment.
_ARCHIVE_END = struct.Struct("<4s4H2LH")
#: Largest directory of a map file [bytes]; four members need 216.
_MAX_DIRECTORY = 4096
_SPECIAL = "it is a folder, a device or a pipe"
#: What stands before the end of an archive with 64-bit sizes, which no map file needs.
_LOCATOR, _LOCATOR_SIZE = b"PK\x06\x07", 20


class MapFileError(ValueError):
    """A map file cannot be written, or is none, or is damaged."""


@contextmanager
def atomic_write(path: Path) -> Iterator[IO[bytes]]:
    """Open a file for writing that appears at `path` only when it is complete.

    A symbolic link stays one: what appears is the file that it leads to.

    Raises
    ------
    MapFileError
        If it cannot be written; what was at `path` before is then still there.
    """
    try:
        target = Path(os.path.realpath(path))
        if target.is_symlink():
            raise MapFileError(f"cannot write '{path}': the symbolic link leads back to itself")
        if is_special(target):
            raise MapFileError(f"cannot write '{path}': {_SPECIAL}")
        temporary = target.with_name(f"{_unfinished(target)}{secrets.token_hex(8)}.tmp")
        try:
            with open(temporary, "xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, target)
        finally:
            temporary.unlink(missing_ok=True)
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)  # the new name itself survives a power failure
        finally:
            os.close(folder)
    except OSError as error:
        raise MapFileError(f"cannot write '{path}': {error.strerror or error}") from error


def is_special(path: Path) -> bool:
    """Whether a path is a folder, a device or a pipe.

    To read from it may wait for ever or never end, and no file must take its place.
    """
    return path.exists() and not path.is_file()


def remove_unfinished(path: str | Path) -> None:
    """Remove what a process that was killed while it wrote this file has left beside it.

    Only for whoever is alone in writing it: the write of another one would fail.

    Raises
    ------
    MapFileError
        If it cannot be removed.
    """
    target = Path(os.path.realpath(_checked_path(path)))
    start = _unfinished(target)
    try:
        for file in target.parent.glob(f"{glob.escape(start)}*.tmp"):
            if re.fullmatch(r"[0-9a-f]{16}\.tmp", file.name[len(start) :]):
                file.unlink(missing_ok=True)
    except OSError as error:
        raise MapFileError(f"cannot tidy up beside '{path}': {error.strerror or error}") from error


def _unfinished(target: Path) -> str:
    """Return how the names of files begin that are to become `target`."""
    return f".{target.name[:50]}."  # of up to 4 bytes a character, 255 in all


def save_map(
    path: str | Path, state: MapState, parameters: Mapping[str, Any] | None = None
) -> None:
    """Write a state to a file, replacing what was there.

    Parameters
    ----------
    path : str or Path
        The file; its folder must exist. Of a symbolic link, the file that it leads to.
    state : MapState
        What `FuzzyMapper.state` returns.
    parameters : mapping, optional
        With which parameters it came about: numbers, words, and lists of them by name.

    Raises
    ------
    MapFileError
        If the file cannot be written. One that was there before is unharmed.
    """
    geometry = state.geometry
    header: dict[str, Any] = {
        "format": _FORMAT,
        "version": _VERSION,
        "width": geometry.width,
        "height": geometry.height,
        "resolution": geometry.resolution,
        "origin": list(geometry.origin),
        "perceptions": state.perceptions,
    }
    if parameters is not None:
        header["parameters"] = dict(parameters)
    text = json.dumps(header)
    if len(text) > _MAX_HEADER:
        raise MapFileError(f"cannot write '{path}': its parameters take {len(text)} bytes")
    with (
        atomic_write(_checked_path(path)) as file,
        zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
    ):
        archive.writestr(_HEADER, text)
        for name in _ARRAYS:
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, getattr(state, name), allow_pickle=False)


def load_map(path: str | Path, geometry: GridGeometry | None = None) -> MapState:
    """Read a state from a file.

    Parameters
    ----------
    path : str or Path
        The file.
    geometry : GridGeometry, optional
        The grid that the state must be of; another one is refused before its arrays are read.

    Returns
    -------
    MapState
        Equal, to the last bit, to the one that was saved.

    Raises
    ------
    MapFileError
        If the file cannot be read, is no map file, is of a later version or another grid, or is
        damaged.
    """
    return load_map_and_parameters(path, geometry)[0]


def load_map_and_parameters(
    path: str | Path, geometry: GridGeometry | None = None
) -> tuple[MapState, dict[str, Any] | None]:
    """Read a state from a file, and with which parameters it came about.

    Parameters
    ----------
    path, geometry
        As for `load_map`.

    Returns
    -------
    state : MapState
        Equal, to the last bit, to the one that was saved.
    parameters : dict or None
        As given to `save_map`, sequences as lists; None if the file does not tell.

    Raises
    ------
    MapFileError
        As `load_map`.
    """
    path = _checked_path(path)
    try:
        if is_special(path):
            raise MapFileError(_SPECIAL)
        with open(path, "rb") as file:
            _check_directory(file)
            with zipfile.ZipFile(file) as archive:
                return _read(archive, geometry)
    except MapFileError as error:
        raise MapFileError(f"cannot load '{path}': {error}") from error
    except OSError as error:
        raise MapFileError(f"cannot load '{path}': {error.strerror or error}") from error
    except (
        zipfile.BadZipFile,
        zlib.error,
        # zipfile: encrypted members and unknown compression; json: too deep.
        RuntimeError,
        # A truncated or nonsensical member.
        EOFError,
        OverflowError,
        ValueError,
    ) as error:
        # What they say is for who writes such files.
        raise MapFileError(f"cannot load '{path}': it is no map file, or damaged") from error


def _checked_path(path: str | Path) -> Path:
    if not str(path) or "\0" in str(path):
        raise MapFileError(f"{str(path)!r} is no file name")
    return Path(path)


def _check_directory(file: IO[bytes]) -> None:
    """Refuse what zipfile would read a long directory of: it keeps an object for each member."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(0, size - _ARCHIVE_END.size - _LOCATOR_SIZE))
    locator, end = (tail := file.read())[: -_ARCHIVE_END.size], tail[-_ARCHIVE_END.size :]
    if len(end) < _ARCHIVE_END.size or not end.startswith(b"PK\x05\x06"):
        raise MapFileError("it is no map file, or its end is missing")
    *_, directory, _, comment = _ARCHIVE_END.unpack(end)
    if directory > _MAX_DIRECTORY or comment or locator.startswith(_LOCATOR):
        raise MapFileError("its directory is not that of a map file")


def _read(
    archive: zipfile.ZipFile, wanted: GridGeometry | None
) -> tuple[MapState, dict[str, Any] | None]:
    members = {info.filename: info for info in archive.infolist()}
    expected = [_HEADER, *(f"{name}.npy" for name in _ARRAYS)]
    if sorted(info.filename for info in archive.infolist()) != sorted(expected):
        raise MapFileError(f"a map file has the members {expected}, this one {sorted(members)}")
    methods = {info.compress_type for info in members.values()}
    if not methods <= {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
        # The others fail in ways of their own on damaged data.
        raise MapFileError(f"its members are compressed by methods {sorted(methods)}, not deflate")
    if members[_HEADER].file_size > _MAX_HEADER:
        raise MapFileError(f"its header has {members[_HEADER].file_size} bytes")
    with archive.open(_HEADER) as member:
        # Never without a limit: zipfile then unpacks the whole stream, whatever its size is
        # said to be, before it cuts.
        header = json.loads(member.read(_MAX_HEADER + 1))
    geometry = _geometry(header)
    if wanted is not None and geometry != wanted:
        raise MapFileError(
            f"it is a map of {geometry}, the mapper's is one of {wanted}; start the mapper with "
            f"the area and resolution of the saved map (parameters 'area.*')"
        )
    parameters = header.get("parameters")
    if not (parameters is None or isinstance(parameters, dict)):
        raise MapFileError("its parameters are no mapping")
    arrays = {
        name: _array(archive, members[f"{name}.npy"], geometry, np.dtype(kind))
        for name, kind in _ARRAYS.items()
    }
    try:
        state = MapState(geometry, **arrays, perceptions=header.get("perceptions"))
    except ValueError as error:
        raise MapFileError(f"it holds what no map has: {error}") from error
    return state, parameters


def _geometry(header: Any) -> GridGeometry:
    if not isinstance(header, dict) or header.get("format") != _FORMAT:
        raise MapFileError("it was not saved by this program")
    version = header.get("version")
    if version != _VERSION:
        raise MapFileError(f"it is of version {shown(version)}, this program reads {_VERSION}")
    origin = header.get("origin")
    values = [header.get(name) for name in ("width", "height", "resolution")]
    if not isinstance(origin, list) or not all(
        isinstance(value, (int, float)) for value in (*values, *origin)
    ):
        raise MapFileError("its header does not describe a grid")
    width, height, resolution = values
    try:
        return GridGeometry(width, height, resolution, tuple(origin))  # type: ignore[arg-type]
    except ValueError as error:
        raise MapFileError(f"it holds what no map has: {error}") from error


def _array(
    archive: zipfile.ZipFile,
    info: zipfile.ZipInfo,
    geometry: GridGeometry,
    kind: np.dtype[Any],
) -> NDArray[Any]:
    size = geometry.width * geometry.height * kind.itemsize
    # Before anything of that size is allocated or unpacked.
    if not size < info.file_size <= size + _MAX_ARRAY_HEADER:
        raise MapFileError(
            f"{info.filename} has {info.file_size} bytes, a grid of {geometry.width} x "
            f"{geometry.height} cells needs {size} and a short header"
        )
    with archive.open(info) as member:
        if np.lib.format.read_magic(member) != (1, 0):
            raise MapFileError(f"{info.filename} is of another version of the array format")
        # Compared, not parsed: numpy's parser is one of Python expressions, and raises
        # whatever that raises.
        length = int.from_bytes(member.read(2), "little")
        found = member.read(min(length, _MAX_ARRAY_HEADER))
        if found.rstrip() != (needed := _array_header(geometry, kind)):
            raise MapFileError(f"{info.filename} holds {found[:100]!r}, its grid needs {needed!r}")
        data = bytearray(member.read(size))
        if len(data) != size or member.read(1):
            raise MapFileError(f"{info.filename} does not end where it should")
    return np.frombuffer(data, dtype=kind).reshape(geometry.shape)


def _array_header(geometry: GridGeometry, kind: np.dtype[Any]) -> bytes:
    """Return what describes an array in its .npy file, without the padding."""
    file = io.BytesIO()
    description = {"descr": kind.str, "fortran_order": False, "shape": geometry.shape}
    np.lib.format.write_array_header_1_0(file, description)
    return file.getvalue()[10:].rstrip()  # after magic, version and length
