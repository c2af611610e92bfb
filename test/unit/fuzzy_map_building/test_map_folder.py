# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The map folder: no name leads out of it, whoever asks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fuzzy_map_building.map_folder import MapFolder, MapNameError
from fuzzy_map_building.map_io import atomic_write


@pytest.fixture
def folder(tmp_path: Path) -> MapFolder:
    """A folder with all that leads astray, beside a secret."""
    maps = tmp_path / "maps"
    (maps / "floors").mkdir(parents=True)
    (tmp_path / "secret").write_text("do not touch")
    (tmp_path / "maps_of_others").mkdir()
    (maps / "here.map").write_text("")
    (maps / "floors" / "1.map").write_text("")
    (maps / "link").symlink_to("here.map")
    (maps / "out").symlink_to("../secret")
    (maps / "away").symlink_to("/etc")
    (maps / "up").symlink_to("..")
    (maps / "beside").symlink_to("../maps_of_others")
    (maps / "circle").symlink_to("circle")
    os.mkfifo(maps / "pipe")
    return MapFolder(str(maps))


def test_names_inside_are_files_inside(folder: MapFolder, tmp_path: Path) -> None:
    maps = tmp_path / "maps"
    assert folder.file_to_read("here.map") == maps / "here.map"
    assert folder.file_to_read("./floors/1.map") == maps / "floors" / "1.map"
    assert folder.file_to_read("link") == maps / "here.map"
    assert folder.file_to_write("new map.2") == maps / "new map.2"
    assert folder.file_to_write("..map") == maps / "..map"
    assert folder.file_to_read(str(maps / "floors" / "1.map")) == maps / "floors" / "1.map"
    with pytest.raises(ValueError, match=rf"no file '{maps}/absent'"):
        folder.file_to_read("absent")


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("", "no name was given"),
        (".", "is a folder"),
        ("..", "lie inside of the map folder"),
        ("../secret", "lie inside of the map folder"),
        ("floors/../../secret", "lie inside of the map folder"),
        ("floors/../here.map", "lie inside of the map folder"),
        ("/etc/passwd", "lie inside of the map folder"),
        ("//etc/passwd", "lie inside of the map folder"),
        ("out", "a symbolic link leads out"),
        ("away/passwd", "a symbolic link leads out"),
        ("up/secret", "a symbolic link leads out"),
        ("up/maps_of_others/x", "a symbolic link leads out"),
        ("beside/x", "a symbolic link leads out"),
        ("circle", "leads back to itself"),
        ("floors", "is a folder, a device or a pipe"),
        ("pipe", "is a folder, a device or a pipe"),
        ("a\0b", "is no file name"),
        ("a\nb", "is no file name"),
        ("a\x1b[2J", "is no file name"),
        ("a\ud800", "is no file name"),
        ("x" * 100_000, "too long"),
        ("x" * 256, "too long, 255 bytes are allowed of each part"),
        ("ä" * 128, "too long"),
        ("~/a", "'~' does not stand for a home here"),
        ("~", "'~' does not stand for a home here"),
    ],
)
def test_no_other_name_is_looked_at(
    folder: MapFolder, tmp_path: Path, name: str, why: str
) -> None:
    for of in (folder.file_to_read, folder.file_to_write):
        with pytest.raises(ValueError, match=why) as caught:
            of(name)
        assert len(str(caught.value)) < 400 + len(str(tmp_path))
    assert (tmp_path / "secret").read_text() == "do not touch"


def test_folders_inside_are_not_made(folder: MapFolder, tmp_path: Path) -> None:
    maps = tmp_path / "maps"
    assert folder.file_to_write("floors/2.map") == maps / "floors" / "2.map"
    with pytest.raises(MapNameError, match=f"there is no folder '{maps}/absent'.*make it first"):
        folder.file_to_write("absent/a")
    with pytest.raises(MapNameError, match="no folder"):
        folder.file_to_write("here.map/a")
    assert not (maps / "absent").exists()
    longest = "ä" * 127
    with atomic_write(folder.file_to_write(longest)) as file:
        file.write(b"x")
    assert (maps / longest).read_bytes() == b"x"


def test_the_folder_itself_may_be_reached_by_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "maps").symlink_to("disk")
    folder = MapFolder(str(tmp_path / "maps"))
    assert folder.file_to_write("a") == tmp_path / "disk" / "a"


def test_the_folder_is_made_when_something_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    folder = MapFolder("~/.ros/maps")
    with pytest.raises(ValueError, match="there is no file"):
        folder.file_to_read("a")
    with pytest.raises(ValueError, match="refused"):
        folder.file_to_write("../a")
    assert list(tmp_path.iterdir()) == []
    assert folder.file_to_write("a") == tmp_path / ".ros" / "maps" / "a"
    assert (tmp_path / ".ros" / "maps").is_dir()


def test_a_relative_folder_starts_where_the_process_was_started(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = MapFolder("maps")
    monkeypatch.chdir("/")
    assert folder.file_to_write("a") == tmp_path / "maps" / "a"


def test_without_a_folder_any_file_may_be_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = MapFolder("")
    assert folder.file_to_write(str(tmp_path / "a")) == tmp_path / "a"
    assert folder.file_to_write("../b") == tmp_path.parent / "b"
    with pytest.raises(ValueError, match="is a folder"):
        folder.file_to_write(str(tmp_path))
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="or a pipe"):
        folder.file_to_read("pipe")


def test_no_folder_is_named_so() -> None:
    with pytest.raises(ValueError, match="no folder's name"):
        MapFolder("a\0b")
