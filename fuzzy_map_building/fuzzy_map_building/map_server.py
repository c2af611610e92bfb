# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Maps as map_server and Nav2 keep them: a YAML file beside a grey image (PGM).

The image's top row has the highest y. Written are 254 (free), 0 (occupied) and 205
(unknown), with a free threshold of 0.196: 205 reads as occupied by 0.19608, and with
0.25, seen in many files, unknown would come back as free.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from fuzzy_map_building.grid import MAX_CELLS, GridGeometry
from fuzzy_map_building.map_io import MapFileError, atomic_write, is_special
from fuzzy_map_building.parameter_schema import suggest
from fuzzy_map_building.plain_yaml import load_plain, number_hint, shown

__all__ = ["export_map_server", "import_map_server"]

_OCCUPIED_THRESHOLD = 0.65
_FREE_THRESHOLD = 0.196
_KEYS = ("image", "mode", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_MODES = ("trinary", "scale", "raw")
_MAX_YAML = 65536
_MAX_IMAGE_HEADER = 4096
_MAX_NAME = 1000


def export_map_server(
    path: str | Path, occupancy: NDArray[np.int8], geometry: GridGeometry
) -> None:
    """Write an occupancy grid as ``<path>`` (YAML) and the image of the same name.

    Parameters
    ----------
    path : str or Path
        The YAML file to write, named ``*.yaml`` or ``*.yml``.
    occupancy : ndarray of int8, shape (height, width)
        -1 unknown, 0 (free) to 100 (occupied).
    geometry : GridGeometry
        Where the cells lie.

    Raises
    ------
    MapFileError
        If the shape does not fit or a file cannot be written.
    """
    path = Path(path)
    if path.suffix not in (".yaml", ".yml"):
        raise MapFileError(f"'{path}' must end in .yaml; the image goes beside it as .pgm")
    if occupancy.shape != geometry.shape:
        raise MapFileError(
            f"the occupancy has shape {occupancy.shape}, its grid (rows, columns) {geometry.shape}"
        )
    grey = np.full(geometry.shape, 205, dtype=np.uint8)
    grey[(occupancy >= 0) & (occupancy <= 100.0 * _FREE_THRESHOLD)] = 254
    grey[occupancy >= 100.0 * _OCCUPIED_THRESHOLD] = 0
    image = path.with_suffix(".pgm")
    # The image first: whoever finds the YAML finds what it names.
    with atomic_write(image) as file:
        file.write(f"P5\n{geometry.width} {geometry.height}\n255\n".encode())
        file.write(np.ascontiguousarray(grey[::-1]).tobytes())
    text = yaml.safe_dump(
        {
            "image": image.name,
            "mode": "trinary",
            "resolution": geometry.resolution,
            "origin": [*geometry.origin, 0.0],
            "negate": 0,
            "occupied_thresh": _OCCUPIED_THRESHOLD,
            "free_thresh": _FREE_THRESHOLD,
        },
        sort_keys=False,
    )
    with atomic_write(path) as file:
        file.write(text.encode())


def import_map_server(path: str | Path) -> tuple[NDArray[np.int8], GridGeometry]:
    """Read a YAML file and the binary PGM image that it names.

    Parameters
    ----------
    path : str or Path
        The YAML file; the image is looked for beside it.

    Returns
    -------
    occupancy : ndarray of int8, shape (height, width)
        -1 unknown, 0 (free) to 100 (occupied), by the file's mode and thresholds.
    geometry : GridGeometry
        Where the cells lie.

    Raises
    ------
    MapFileError
        If a file cannot be read or does not follow the format; also for a rotated origin,
        which a grid here cannot have.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            text = file.read(_MAX_YAML + 1)
        if len(text) > _MAX_YAML:
            raise MapFileError("the file is too long for a map's YAML")
        entries = _checked(load_plain(text.decode()))
        grey = _read_pgm(path.parent / str(entries["image"]))
        height, width = grey.shape
        x, y, yaw = entries["origin"]
        if yaw != 0.0:
            raise MapFileError(
                f"the origin is rotated by {yaw} rad; rotate the image so that its yaw is 0"
            )
        geometry = GridGeometry(width, height, entries["resolution"], (x, y))
    except OSError as error:
        raise MapFileError(
            f"cannot read '{error.filename or path}': {error.strerror or error}"
        ) from error
    except (ValueError, OverflowError) as error:
        raise MapFileError(f"cannot import '{path}': {error}") from error
    return _occupancy(grey, entries), geometry


def _checked(entries: Any) -> dict[str, Any]:
    """Return the entries of the YAML file, complete and in their types."""
    if not isinstance(entries, dict):
        raise MapFileError(f"it must be a mapping with the keys {', '.join(_KEYS)}")
    for key in entries:
        if key not in _KEYS:
            raise MapFileError(f"unknown key {shown(key)}{suggest(str(key)[:100], _KEYS)}")
    missing = [key for key in _KEYS if key not in entries and key != "mode"]
    if missing:
        raise MapFileError(f"missing: {', '.join(missing)}")
    out: dict[str, Any] = {"mode": entries.get("mode", "trinary")}
    if out["mode"] not in _MODES:
        raise MapFileError(f"mode {shown(out['mode'])} is none of {', '.join(_MODES)}")
    out["image"] = entries["image"]
    if not isinstance(out["image"], str) or not 0 < len(out["image"]) <= _MAX_NAME:
        raise MapFileError(f"image must be a file name, got {shown(out['image'])}")
    for key in ("resolution", "occupied_thresh", "free_thresh"):
        out[key] = _number(key, entries[key])
    if entries["negate"] not in (0, 1):
        raise MapFileError(f"negate must be 0 or 1, got {shown(entries['negate'])}")
    out["negate"] = bool(entries["negate"])
    origin = entries["origin"]
    if not isinstance(origin, list) or len(origin) != 3:
        raise MapFileError(f"origin must be [x, y, yaw], got {shown(origin)}")
    out["origin"] = [_number("origin", value) for value in origin]
    if not 0.0 <= out["free_thresh"] < out["occupied_thresh"] <= 1.0:
        raise MapFileError(
            f"0 <= free_thresh < occupied_thresh <= 1 is needed, got {out['free_thresh']} and "
            f"{out['occupied_thresh']}"
        )
    return out


def _number(key: str, value: Any) -> float:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not math.isfinite(value):
        raise MapFileError(
            f"{key} must be a finite number, got {shown(value)}{number_hint(value)}"
        )
    return float(value)


def _read_pgm(path: Path) -> NDArray[np.uint8]:
    """Return the grey values of a binary PGM file, top row first."""
    if is_special(path):
        raise MapFileError(f"'{path}' is a folder, a device or a pipe; an image is a file")
    with path.open("rb") as file:
        # Magic, width, height, maximum: words between blanks, comments from # to the line's end.
        words: list[bytes] = []
        word = b""
        for _ in range(_MAX_IMAGE_HEADER):
            char = file.read(1)
            if char == b"#":
                file.readline(_MAX_IMAGE_HEADER)
                char = b"\n"
            if not char.isspace():
                word += char
                continue
            if word:
                words.append(word)
                word = b""
            if len(words) == 4:
                break
        numbers = [int(w) for w in words[1:] if w.isdigit() and len(w) < 10]
        if words[:1] != [b"P5"] or len(numbers) != 3:
            raise MapFileError(f"'{path}' is no binary PGM image (P5)")
        width, height, maximum = numbers
        if not (width > 0 and height > 0 and width * height <= MAX_CELLS and maximum == 255):
            raise MapFileError(
                f"'{path}' has {width} x {height} pixels up to {maximum}; supported are up to "
                f"{MAX_CELLS} pixels with 255 as the maximum"
            )
        # Before memory is taken for all that the header promises.
        there = os.fstat(file.fileno()).st_size - file.tell()
        if there < width * height:
            raise MapFileError(f"'{path}' ends after {there} of {width * height} pixels")
        data = file.read(width * height)
    return np.frombuffer(data, dtype=np.uint8).reshape(height, width)


def _occupancy(grey: NDArray[np.uint8], entries: dict[str, Any]) -> NDArray[np.int8]:
    """Return the occupancy that the grey values stand for, lowest y first."""
    levels = np.arange(256)
    if entries["mode"] == "raw":
        table = np.where(levels <= 100, levels, -1)
    else:
        occupied = levels / 255.0 if entries["negate"] else 1.0 - levels / 255.0
        low, high = entries["free_thresh"], entries["occupied_thresh"]
        between = np.rint(100.0 * (occupied - low) / (high - low))
        table = np.where(entries["mode"] == "scale", between, -1.0)
        table = np.where(occupied > high, 100.0, np.where(occupied < low, 0.0, table))
    out: NDArray[np.int8] = table.astype(np.int8)[grey[::-1]]
    return out
