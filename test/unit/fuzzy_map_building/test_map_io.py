# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Map files: exact, never half written, and whatever is damaged is refused in words."""

import io
import json
import os
import random
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from fuzzy_map_building import map_io
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_io import MapFileError, load_map, save_map
from fuzzy_map_building.map_state import MapState


def make_state(seed: int = 0) -> MapState:
    rng = np.random.default_rng(seed)
    geometry = GridGeometry(6, 4, 0.1, (1 / 3, -2.0 / 7))
    empty = rng.random(geometry.shape)
    empty[0, :3] = (5e-324, 1.0, np.nextafter(1.0, 0.0))  # nothing may be rounded
    return MapState(
        geometry,
        empty,
        rng.random(geometry.shape),
        rng.integers(0, 9, geometry.shape, dtype=np.int32),
        12,
    )


def assert_equal(a: MapState, b: MapState) -> None:
    assert (a.geometry, a.perceptions) == (b.geometry, b.perceptions)
    for name in ("empty", "occupied", "count"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
        assert getattr(a, name).dtype == getattr(b, name).dtype


def test_what_is_loaded_is_what_was_saved(tmp_path: Path) -> None:
    state = make_state()
    save_map(tmp_path / "a.map", state)
    loaded = load_map(str(tmp_path / "a.map"))
    assert_equal(loaded, state)
    loaded.empty[0, 0] = 0.5  # of its own memory, ready to be written to
    assert os.listdir(tmp_path) == ["a.map"]


def test_numpy_reads_it_as_well(tmp_path: Path) -> None:
    save_map(tmp_path / "a.map", make_state())
    with np.load(tmp_path / "a.map", allow_pickle=False) as archive:
        np.testing.assert_array_equal(archive["occupied"], make_state().occupied)


def test_saving_replaces_and_follows_the_usual_permissions(tmp_path: Path) -> None:
    path = tmp_path / "a.map"
    save_map(path, make_state(1))
    save_map(path, make_state(2))
    assert_equal(load_map(path), make_state(2))
    plain = tmp_path / "plain"
    plain.write_text("")
    assert path.stat().st_mode == plain.stat().st_mode


def test_a_symbolic_link_stays_one_and_leads_to_the_new_file(tmp_path: Path) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    for name in ("there", "not_yet"):
        link = tmp_path / f"{name}.link"
        link.symlink_to(Path("elsewhere") / name)
    save_map(folder / "there", make_state(1))
    for name in ("there", "not_yet"):
        save_map(tmp_path / f"{name}.link", make_state(2))
        assert (tmp_path / f"{name}.link").is_symlink()
        assert not (folder / name).is_symlink()
        assert_equal(load_map(folder / name), make_state(2))
    assert sorted(os.listdir(folder)) == ["not_yet", "there"]
    circle = tmp_path / "circle"
    circle.symlink_to("circle")
    with pytest.raises(MapFileError, match=r"cannot write '.*circle': .* leads back to itself"):
        save_map(circle, make_state())
    assert circle.is_symlink()


def test_a_failed_save_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.map"
    save_map(path, make_state(1))

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(map_io.os, "fsync", fail)
    with pytest.raises(MapFileError, match=r"cannot write '.*a\.map': No space left on device"):
        save_map(path, make_state(2))
    assert os.listdir(tmp_path) == ["a.map"]
    assert_equal(load_map(path), make_state(1))


def test_where_nothing_can_be_written(tmp_path: Path) -> None:
    for path in (tmp_path / "no" / "folder.map", tmp_path, "", "a\0b"):
        with pytest.raises(MapFileError):
            save_map(path, make_state())
    assert os.listdir(tmp_path) == []


def test_what_is_no_map_file(tmp_path: Path) -> None:
    for name, content in (("empty", b""), ("text", b"hello"), ("zip", b"PK\x05\x06" + b"\0" * 18)):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(MapFileError, match=f"cannot load '.*{name}'"):
            load_map(tmp_path / name)
    with pytest.raises(MapFileError, match="No such file"):
        load_map(tmp_path / "nothing")
    with pytest.raises(MapFileError, match="it is a folder"):
        load_map(tmp_path)
    with pytest.raises(MapFileError, match="no file name"):
        load_map("")


HEADER = {
    "format": "fuzzy_map_building",
    "version": 1,
    "width": 6,
    "height": 4,
    "resolution": 0.1,
    "origin": [0.0, 0.0],
    "perceptions": 12,
}


def write(path: Path, header: object, **arrays: np.ndarray) -> None:
    good = make_state()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("map.json", header if isinstance(header, str) else json.dumps(header))
        for name in ("empty", "occupied", "count"):
            with archive.open(f"{name}.npy", "w") as member:
                np.lib.format.write_array(member, arrays.get(name, getattr(good, name)))


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ({**HEADER, "format": "other"}, "not saved by this program"),
        ([1, 2], "not saved by this program"),
        ({**HEADER, "version": 2}, "of version 2, this program reads 1"),
        ({**HEADER, "width": 70}, "a grid of 70 x 4 cells needs"),
        ({**HEADER, "width": 4, "height": 6}, r"its grid needs .*<f8.*\(6, 4\)"),
        ({**HEADER, "width": 10**9, "height": 10**9}, "exceeds the limit"),
        ({**HEADER, "width": 10**400}, "holds what no map has: .* exceeds the limit"),
        ({**HEADER, "width": -6}, "width"),
        ({**HEADER, "width": "6"}, "does not describe a grid"),
        ({**HEADER, "resolution": float("nan")}, "resolution"),
        ({**HEADER, "origin": [0.0]}, "origin"),
        ({**HEADER, "origin": "ab"}, "does not describe a grid"),
        ({**HEADER, "perceptions": 3}, "more than the 3 of the map"),
        ({**HEADER, "perceptions": None}, "perceptions must be whole"),
        ({**HEADER, "perceptions": ["9" * 3800]}, "perceptions must be whole"),
        ({**HEADER, "version": "9" * 3800}, "this program reads 1"),
        ("{", "damaged"),
        ({**HEADER, "parameters": [1]}, "parameters are no mapping"),
        ("[" * 60000, "damaged"),
        (" " * 70000, "header has 70000 bytes"),
    ],
)
def test_a_wrong_header_is_refused(tmp_path: Path, header: object, message: str) -> None:
    write(tmp_path / "a.map", header)
    with pytest.raises(MapFileError, match=message) as caught:
        load_map(tmp_path / "a.map")
    assert len(str(caught.value)) < 1500


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"empty": np.full((4, 6), 2.0)}, "the beliefs 'empty' are not all in"),
        ({"empty": np.full((4, 6), np.nan)}, "the beliefs 'empty' are not all in"),
        ({"occupied": np.zeros((4, 7))}, r"holds .*<f8.*\(4, 7\).*, its grid needs .*\(4, 6\)"),
        ({"occupied": np.zeros((40, 60))}, "bytes, a grid of 6 x 4 cells needs"),
        ({"occupied": np.zeros((4, 6), dtype=np.int64)}, "occupied.npy holds .*<i8"),
        ({"occupied": np.asfortranarray(np.random.default_rng(0).random((4, 6)))}, "holds"),
        ({"count": np.zeros((4, 6), dtype=np.int64)}, "count.npy holds .*<i8"),
        ({"count": np.full((4, 6), -1, dtype=np.int32)}, "negative"),
    ],
)
def test_wrong_arrays_are_refused(tmp_path: Path, arrays: dict, message: str) -> None:
    write(tmp_path / "a.map", HEADER, **arrays)
    with pytest.raises(MapFileError, match=message):
        load_map(tmp_path / "a.map")


@pytest.mark.parametrize(
    ("version", "cut", "message"),
    [
        ((2, 0), 0, "another version of the array format"),
        ((1, 0), 8, "does not end where it should"),
        ((1, 0), -8, "does not end where it should"),
    ],
)
def test_arrays_of_another_length_are_refused(
    tmp_path: Path, version: tuple, cut: int, message: str
) -> None:
    state = make_state()
    with zipfile.ZipFile(tmp_path / "a.map", "w") as archive:
        archive.writestr("map.json", json.dumps(HEADER))
        for name in ("empty", "occupied", "count"):
            content = io.BytesIO()
            np.lib.format.write_array(content, getattr(state, name), version=version)
            data = content.getvalue() + bytes(max(0, -cut))
            archive.writestr(f"{name}.npy", data[: len(data) - max(0, cut)])
    with pytest.raises(MapFileError, match=message):
        load_map(tmp_path / "a.map")


def test_missing_and_foreign_members_are_refused(tmp_path: Path) -> None:
    write(tmp_path / "a.map", HEADER)
    with zipfile.ZipFile(tmp_path / "a.map", "a") as archive:
        archive.writestr("more.npy", b"")
    with pytest.raises(MapFileError, match="a map file has the members"):
        load_map(tmp_path / "a.map")


def members_of(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.mark.parametrize(
    "text",
    # What numpy's own parser answers with errors that are no ValueError.
    [b"((((", b"'''", b"{'descr': ',,', 'fortran_order': False, 'shape': (4, 6)}", b"\\\n"],
)
def test_a_header_that_is_no_expression_is_refused(tmp_path: Path, text: bytes) -> None:
    write(tmp_path / "a.map", HEADER)
    members = members_of(tmp_path / "a.map")
    data = members["empty.npy"]
    members["empty.npy"] = data[:8] + len(text).to_bytes(2, "little") + text + data[-192:]
    with zipfile.ZipFile(tmp_path / "a.map", "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with pytest.raises(MapFileError, match=r"empty\.npy holds"):
        load_map(tmp_path / "a.map")


def peak_of_refusing(path: Path, message: str) -> int:
    """Return the most memory [bytes] that is taken until a file is refused."""
    tracemalloc.start()
    try:
        with pytest.raises(MapFileError, match=message):
            load_map(path, GridGeometry(6, 4, 0.1))
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_member_that_lies_about_its_size_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "a.map"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("map.json", bytes(30_000_000))
        for name in ("empty", "occupied", "count"):
            archive.writestr(f"{name}.npy", b"")
    data = bytearray(path.read_bytes())
    place = data.index(b"PK\1\2") + 24  # the size unpacked, as the directory has it
    data[place : place + 4] = (100).to_bytes(4, "little")
    path.write_bytes(data)
    assert peak_of_refusing(path, "damaged") < 5_000_000


def test_a_directory_without_end_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.map"
    with zipfile.ZipFile(path, "w") as archive:
        for k in range(3000):
            archive.writestr(f"{k}", b"")
    assert peak_of_refusing(path, "not that of a map file") < 200_000


def test_the_arrays_of_another_grid_are_not_read(tmp_path: Path) -> None:
    geometry = GridGeometry(1000, 1000, 0.1)
    grid = np.zeros(geometry.shape)
    save_map(tmp_path / "a.map", MapState(geometry, grid, grid, grid.astype(np.int32), 0))
    load_map(tmp_path / "a.map", geometry)
    words = "it is a map of 1000 x 1000 cells of 0.1 m .*, the mapper's is one of 6 x 4 cells"
    assert peak_of_refusing(tmp_path / "a.map", words) < 200_000


def test_no_code_comes_along(tmp_path: Path) -> None:
    # 24 pointers are as long as 24 doubles: only the header tells.
    with zipfile.ZipFile(tmp_path / "a.map", "w") as archive:
        archive.writestr("map.json", json.dumps(HEADER))
        for name in ("empty", "occupied", "count"):
            with archive.open(f"{name}.npy", "w") as member:
                np.lib.format.write_array(
                    member, np.full((4, 6), None, dtype=object), allow_pickle=True
                )
    with pytest.raises(MapFileError):
        load_map(tmp_path / "a.map")


def test_whatever_the_bytes_it_is_a_map_or_a_refusal(tmp_path: Path) -> None:
    save_map(tmp_path / "a.map", make_state())
    good = (tmp_path / "a.map").read_bytes()
    draw = random.Random(7)
    refused = 0
    for _ in range(400):
        data = bytearray(good)
        for _ in range(draw.choice([1, 1, 3, 20])):
            data[draw.randrange(len(data))] = draw.randrange(256)
        if draw.random() < 0.2:
            data = data[: draw.randrange(len(data))]
        (tmp_path / "b.map").write_bytes(data)
        try:
            load_map(tmp_path / "b.map")
        except MapFileError:
            refused += 1
    assert refused > 200


@pytest.mark.parametrize("method", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_only_the_compression_that_is_written_is_read(tmp_path: Path, method: int) -> None:
    # Damaged LZMA data fail with an error that is neither OSError nor ValueError.
    save_map(tmp_path / "a.map", make_state())
    with (
        zipfile.ZipFile(tmp_path / "a.map") as archive,
        zipfile.ZipFile(tmp_path / "b.map", "w", method) as other,
    ):
        for name in archive.namelist():
            other.writestr(name, archive.read(name))
    with pytest.raises(MapFileError, match="compressed"):
        load_map(tmp_path / "b.map")


def test_what_is_no_ordinary_file_is_neither_read_nor_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)  # to open it would wait for somebody at its other end
    (tmp_path / "folder").mkdir()
    for path in (pipe, tmp_path / "folder"):
        before = path.stat().st_mode
        for do in (lambda file: save_map(file, make_state()), load_map):
            with pytest.raises(MapFileError, match=r"cannot \w+ .*: it is a folder, a device"):
                do(path)
        assert path.stat().st_mode == before
    with pytest.raises(MapFileError, match="File name too long"):
        save_map(tmp_path / ("x" * 300), make_state())


def test_a_number_of_perceptions_that_no_counter_holds_is_refused() -> None:
    state = make_state()
    arrays = (state.geometry, state.empty, state.occupied, state.count)
    with pytest.raises(ValueError, match="at most"):
        MapState(*arrays, 10**30)
