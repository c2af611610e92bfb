# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Paths that come in by a service, and what is said of those that cannot be used."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzy_map_building.ros.files import file_to_read, file_to_write


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that the process works in."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_relative_paths_become_absolute(here: Path) -> None:
    assert file_to_read("file") == here / "file"
    assert file_to_write("new") == here / "new"
    assert file_to_write(str(here / "new")) == here / "new"


@pytest.mark.parametrize("of", [file_to_read, file_to_write])
def test_messages_say_where_a_relative_path_was_looked_for(
    here: Path, of: Callable[[str], Path]
) -> None:
    with pytest.raises(ValueError, match=rf"^'folder' in the folder '{here}' is a folder, a dev"):
        of("folder")
    with pytest.raises(ValueError, match=rf"^'{here}/folder' is a folder, a device"):
        of(f"{here}/folder")
    with pytest.raises(ValueError, match=rf"no file 'absent' in the folder '{here}' as this"):
        file_to_read("absent")
    with pytest.raises(ValueError, match=rf"no file '{here}/absent' as this"):
        file_to_read(f"{here}/absent")


@pytest.mark.parametrize("path", ["", "a\0b"])
def test_what_is_no_path(here: Path, path: str) -> None:
    for of in (file_to_read, file_to_write):
        with pytest.raises(ValueError, match=r"no path was given|is no file name"):
            of(path)
