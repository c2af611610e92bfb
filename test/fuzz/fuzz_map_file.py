# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Map files: loaded, they are a state that a mapper can go on with, or refused."""

from __future__ import annotations

import contextlib
import io
import json
import zipfile
from collections.abc import Iterator, Sequence

import numpy as np

from fuzz.draw import Draw, spoilt
from fuzz.surface import Surface, Target, check_words, scratch_folder
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_folder import MapFolder
from fuzzy_map_building.map_io import MapFileError, load_map, save_map
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.types import Pose2, SonarReading

__all__ = ["SURFACES"]

GEOMETRY = GridGeometry(6, 4, 0.1, (0.5, -2.0))
HEADER = {
    "format": "fuzzy_map_building",
    "version": 1,
    "width": 6,
    "height": 4,
    "resolution": 0.1,
    "origin": [0.5, -2.0],
    "perceptions": 12,
}
MAGIC = (b"\x93NUMPY\x01\x00", b"\x93NUMPY\x02\x00", b"\x93NUMPY\x01\x01", b"NUMPY")
ARRAY_HEADERS = (
    b"{'descr': '<f8', 'fortran_order': False, 'shape': (4, 6), }",
    b"{'descr': '<i4', 'fortran_order': False, 'shape': (4, 6), }",
    b"{'descr': '|O', 'fortran_order': False, 'shape': (4, 6), }",
    b"{'descr': '<f8', 'fortran_order': True, 'shape': (4, 6), }",
    b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999, 99999999), }",
    b"{'descr': ',,', 'fortran_order': False, 'shape': (4, 6), }",
    b"((((",
    b"'''",
)
METHODS = (zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)


def _array(draw: Draw, kind: type) -> bytes:
    """Return an .npy file, good or bad."""
    magic = draw.choice(MAGIC) if draw.one_in(12) else MAGIC[0]
    header = ARRAY_HEADERS[0 if kind is np.float64 else 1]
    if draw.one_in(6):
        header = draw.choice(ARRAY_HEADERS) if draw.byte() % 2 else draw.take(draw.below(80))
    header = header.ljust(118) + b"\n" if draw.byte() % 4 else header
    length = draw.below(65536) if draw.one_in(12) else len(header)
    if kind is np.int32:
        values = np.array([draw.byte() % 13 for _ in range(24)], dtype=np.int32)
        if draw.one_in(4):
            values[draw.below(24)] = np.int64(draw.whole() & 0xFFFFFFFF).astype(np.int32)
    else:
        values = np.array([draw.byte() / 255.0 for _ in range(24)])
        if draw.one_in(4):
            values[draw.below(24)] = draw.float64()
    data = values.tobytes()
    if draw.one_in(12):
        data = data[: draw.below(len(data))] + draw.take(draw.below(20))
    return magic + length.to_bytes(2, "little") + header + data


def _archive(draw: Draw) -> bytes:
    """Return a map file that was put together well, of parts that may be bad."""
    file = io.BytesIO()
    method = draw.choice(METHODS) if draw.one_in(8) else zipfile.ZIP_DEFLATED
    header = spoilt(draw, HEADER) if draw.byte() % 2 else HEADER
    with zipfile.ZipFile(file, "w", method) as archive:
        text = json.dumps(header) if draw.byte() % 8 else draw.text()
        archive.writestr("map.json", text.encode("utf-8", "replace"))
        for name, kind in (("empty", np.float64), ("occupied", np.float64), ("count", np.int32)):
            if not draw.one_in(24):
                archive.writestr(f"{name}.npy", _array(draw, kind))
    data = bytearray(file.getvalue())
    for _ in range(draw.byte() % 3):
        # Behind the members: what the directory says of them.
        start = data.index(b"PK\1\2") if b"PK\1\2" in data else 0
        data[start + draw.below(len(data) - start)] = draw.byte()
    return bytes(data)


def _state() -> MapState:
    mapper = FuzzyMapper(GEOMETRY)
    mapper.update([SonarReading(Pose2(0.6, -1.9), 0.2, 0.4)])
    return mapper.state()


@contextlib.contextmanager
def _opened() -> Iterator[Target]:
    mapper = FuzzyMapper(GEOMETRY)
    with scratch_folder() as folder:
        path = folder / "a.map"

        def target(data: bytes) -> None:
            """The first byte says whether the others are a file, or how to put one together."""
            content = data[1:] if data[:1] < b"\x60" else _archive(Draw(data[1:]))
            path.write_bytes(content)
            known = None if data[:1] < b"\x10" else GEOMETRY
            before = mapper.state()
            try:
                state = load_map(path, known)
                mapper.restore(state)
            except (MapFileError, ValueError) as error:
                check_words(error)
                after = mapper.state()
                for name in ("empty", "occupied", "count"):
                    assert np.array_equal(getattr(before, name), getattr(after, name))
                assert before.perceptions == after.perceptions
                return
            for values in (mapper.empty, mapper.occupied, mapper.motion_risk):
                assert ((values >= 0.0) & (values <= 1.0)).all()
            assert ((mapper.planning_risk >= 0.0) & (mapper.planning_risk <= 1.0)).all()
            # What was loaded can be gone on with, saved, and loaded again as it was.
            save_map(path, mapper.state())
            again = load_map(path, GEOMETRY)
            assert np.array_equal(again.empty, state.empty)
            assert np.array_equal(again.count, state.count)
            mapper.update([SonarReading(Pose2(0.6, -1.9), 0.2, 0.4)])
            mapper.reset()

        yield target


def _seeds() -> Sequence[bytes]:
    file = io.BytesIO()
    with scratch_folder() as folder:
        path = folder / "a.map"
        save_map(path, _state())
        file.write(path.read_bytes())
    good = file.getvalue()
    return [b"\x20" + good, b"\x00" + good, b"\x20", b"\xff", b"\xff" + bytes(range(256)) * 2]


@contextlib.contextmanager
def _folder_opened() -> Iterator[Target]:
    with scratch_folder() as top:
        maps = top / "maps"
        (maps / "sub").mkdir(parents=True)
        (top / "secret").write_text("")
        (maps / "a").write_text("")
        (maps / "up").symlink_to("..")
        (maps / "out").symlink_to("../secret")
        (maps / "sub" / "back").symlink_to("../a")
        folder = MapFolder(str(maps))
        inside = maps.resolve()
        words = (
            "a",
            "..",
            ".",
            "/",
            "up",
            "out",
            "sub",
            "back",
            "secret",
            "maps",
            "~",
            str(top),
            "",
        )

        def target(data: bytes) -> None:
            """A name is put together of what may lead astray."""
            draw = Draw(data)
            parts = [draw.choice(words) if draw.byte() % 4 else draw.text() for _ in range(6)]
            name = "/".join(parts[: 1 + draw.below(6)]) if draw.byte() % 8 else draw.text()
            for of in (folder.file_to_write, folder.file_to_read):
                try:
                    path = of(name)
                except (ValueError, OSError):
                    continue
                assert path == path.resolve()
                assert path != inside
                assert path.is_relative_to(inside)

        yield target


SURFACES = (
    Surface(
        "map_file",
        _opened,
        _seeds,
        (b"PK\1\2", b"PK\3\4", b"PK\5\6", b"PK\6\7", b"map.json", b".npy", b"\xff\xff\xff\xff"),
        longest=2048,
    ),
    Surface("map_name", _folder_opened, lambda: [bytes(range(0, 256, 5)), b"\1\2\3"], longest=128),
)
