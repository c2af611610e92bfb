# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Exchange with map_server: the image upside down, thresholds, unknown that stays unknown."""

import os
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import yaml

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_io import MapFileError
from fuzzy_map_building.map_server import export_map_server, import_map_server

GRID = GridGeometry(3, 2, 0.05, (-1.0, 2.5))
OCCUPANCY = np.array([[0, 100, -1], [65, 19, 40]], dtype=np.int8)

GOOD = {
    "image": "a.pgm",
    "mode": "trinary",
    "resolution": 0.05,
    "origin": [-1.0, 2.5, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def write(folder: Path, grey: list[list[int]] | None = None, **changes: object) -> Path:
    rows = np.array(grey if grey is not None else [[0, 254, 205]], dtype=np.uint8)
    (folder / "a.pgm").write_bytes(
        b"P5\n# a comment\n%d %d\n255\n" % rows.shape[::-1] + rows.tobytes()
    )
    entries = {k: v for k, v in {**GOOD, **changes}.items() if v is not ...}
    (folder / "a.yaml").write_text(yaml.safe_dump(entries))
    return folder / "a.yaml"


def test_the_top_row_of_the_image_has_the_highest_y(tmp_path: Path) -> None:
    export_map_server(tmp_path / "m.yaml", OCCUPANCY, GRID)
    image = (tmp_path / "m.pgm").read_bytes()
    assert image == b"P5\n3 2\n255\n" + bytes([0, 254, 205, 254, 0, 205])
    entries = yaml.safe_load((tmp_path / "m.yaml").read_text())
    assert entries == {**GOOD, "image": "m.pgm"}


def test_what_is_exported_comes_back(tmp_path: Path) -> None:
    export_map_server(tmp_path / "m.yaml", OCCUPANCY, GRID)
    occupancy, geometry = import_map_server(tmp_path / "m.yaml")
    assert geometry == GRID
    # 40 lies between the thresholds: map_server files know no degrees in this mode.
    np.testing.assert_array_equal(occupancy, [[0, 100, -1], [100, 0, -1]])


def test_export_refuses_what_does_not_fit(tmp_path: Path) -> None:
    with pytest.raises(MapFileError, match="shape"):
        export_map_server(tmp_path / "m.yaml", OCCUPANCY[:1], GRID)
    with pytest.raises(MapFileError, match=r"must end in \.yaml"):
        export_map_server(tmp_path / "m.pgm", OCCUPANCY, GRID)
    with pytest.raises(MapFileError, match="cannot write"):
        export_map_server(tmp_path / "no" / "m.yaml", OCCUPANCY, GRID)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("changes", "values"),
    [
        ({}, [100, 0, -1, -1]),
        ({"mode": ...}, [100, 0, -1, -1]),  # the default
        ({"free_thresh": 0.25}, [100, 0, 0, -1]),  # the trap that 0.196 avoids
        ({"negate": 1}, [0, 100, 100, -1]),
        ({"negate": True}, [0, 100, 100, -1]),
        # rint(100 (occupied - free_thresh) / (occupied_thresh - free_thresh))
        ({"mode": "scale"}, [100, 0, 0, 58]),
        ({"mode": "raw"}, [0, -1, -1, -1]),
    ],
)
def test_modes_and_thresholds(tmp_path: Path, changes: dict, values: list[int]) -> None:
    occupancy, _ = import_map_server(write(tmp_path, [[0, 254, 205, 138]], **changes))
    np.testing.assert_array_equal(occupancy, [values])


def test_raw_values(tmp_path: Path) -> None:
    occupancy, _ = import_map_server(write(tmp_path, [[7, 100, 101, 255]], mode="raw"))
    np.testing.assert_array_equal(occupancy, [[7, 100, -1, -1]])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"origin": [0.0, 0.0, 0.1]}, "rotated by 0.1 rad"),
        ({"origin": [0.0, 0.0]}, "origin must be"),
        ({"origin": [0.0, "a", 0.0]}, "origin must be a finite number"),
        ({"origin": ...}, "missing: origin"),
        ({"resolution": 0.0}, "resolution must be from"),
        ({"resolution": "fine"}, "resolution must be a finite number, got 'fine'$"),
        ({"resolution": True}, "resolution must be a finite number, got True"),
        ({"resolution": "5.0e2"}, "got '5.0e2', which is a text to YAML; write 500.0 without"),
        ({"resolution": "1e-7"}, "which is a text to YAML; write 1.0e-07 without quotes"),
        ({"resolution": "1e999"}, "got '1e999'$"),
        ({"resolution": float("nan")}, "resolution must be a finite number"),
        ({"resolution": 10**400}, "cannot import"),
        ({"free_thresh": 0.7}, "free_thresh < occupied_thresh"),
        ({"mode": "tertiary"}, "mode"),
        ({"negate": 2}, "negate must be 0 or 1, got 2"),
        ({"image": 3}, "image must be a file name"),
        ({"image": "b.pgm"}, "cannot read '.*b.pgm'"),
        ({"resolutoin": 0.1}, "unknown key 'resolutoin'; did you mean 'resolution'"),
    ],
)
def test_wrong_entries_are_named(tmp_path: Path, changes: dict, message: str) -> None:
    with pytest.raises(MapFileError, match=message):
        import_map_server(write(tmp_path, **changes))


def test_an_entry_that_is_there_twice_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path)
    path.write_text(path.read_text() + "negate: 1\n")
    with pytest.raises(MapFileError, match=r"cannot import.*'negate' is repeated"):
        import_map_server(path)


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (b"", "no binary PGM"),
        (b"P2\n1 1\n255\n0", "no binary PGM"),
        (b"P5\nx 1\n255\n0", "no binary PGM"),
        (b"P5\n0 1\n255\n", "0 x 1 pixels"),
        (b"P5\n1 1\n65535\n00", "up to 65535"),
        (b"P5\n99999999 99999999\n255\n0", "supported are up to"),
        (b"P5\n2 2\n255\n000", "ends after 3 of 4 pixels"),
        (b"P5" + b" " * 9000, "no binary PGM"),
        (b"P5 #" + b"x" * 9000, "no binary PGM"),
    ],
)
def test_wrong_images_are_refused(tmp_path: Path, image: bytes, message: str) -> None:
    path = write(tmp_path)
    (tmp_path / "a.pgm").write_bytes(image)
    with pytest.raises(MapFileError, match=message):
        import_map_server(path)


@pytest.mark.parametrize(
    "text",
    [
        "<<: &a {x: 1}\ny: *a\n",
        "x" * 5000 + ": 1\n",
        "? 1" + ":0" * 200 + "\n: 1\n",
        "",
        "- 1\n",
        "a: [",
        "&a [*a]",
        "- " * 3000,
        "x" * 70000,
        "? [a]\n: b\n",
        "\x00",
    ],
)
def test_wrong_yaml_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(MapFileError):
        import_map_server(tmp_path / "a.yaml")


def test_mappings_merged_from_aliases_are_not_grown(tmp_path: Path) -> None:
    lines = ["a: &a {x0: 0, x1: 1}"]
    for before, name in zip("abcdefghijkl", "bcdefghijklm", strict=True):
        lines.append(f"{name}: &{name} {{<<: [{', '.join([f'*{before}'] * 9)}]}}")
    (tmp_path / "a.yaml").write_text("\n".join(lines))
    with pytest.raises(MapFileError, match="aliases"):
        import_map_server(tmp_path / "a.yaml")


def test_an_image_that_is_no_file_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.pgm")
    with pytest.raises(MapFileError, match=r"pipe\.pgm' is a folder, a device or a pipe"):
        import_map_server(write(tmp_path, image="pipe.pgm"))


def test_memory_is_taken_for_what_is_there_only(tmp_path: Path) -> None:
    path = write(tmp_path)
    (tmp_path / "a.pgm").write_bytes(b"P5\n8000 8000\n255\n0")
    tracemalloc.start()
    with pytest.raises(MapFileError, match="ends after 1 of 64000000 pixels"):
        import_map_server(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(MapFileError, match=r"cannot read '.*none\.yaml': No such file"):
        import_map_server(tmp_path / "none.yaml")


@pytest.mark.parametrize(
    ("name", "shape", "occupied"),
    [("depot", (307, 604), 5947), ("tb3_sandbox", (384, 384), 870)],
)
def test_real_maps(fuzzy_nav_data: Path, name: str, shape: tuple, occupied: int) -> None:
    folder = fuzzy_nav_data / "server_maps"
    occupancy, geometry = import_map_server(folder / f"{name}.yaml")
    assert occupancy.shape == geometry.shape == shape
    # Counted in the file itself: black pixels are those below 0.35 of white.
    pixels = (folder / f"{name}.pgm").read_bytes()[-shape[0] * shape[1] :]
    assert sum(p < 0.35 * 255 for p in pixels) == occupied == (occupancy == 100).sum()
