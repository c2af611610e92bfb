# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Floor plans, YAML and image: read, they are grids and walls, or refused."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence

import numpy as np
import yaml

from fuzz.draw import Draw, spoilt
from fuzz.surface import Surface, Target, check_words, scratch_folder
from fuzzy_map_building.map_io import MapFileError
from fuzzy_map_building.map_server import export_map_server, import_map_server
from nomad_sim.worlds.floor_plan import load_floor_plan

__all__ = ["SURFACES"]

TREE = {
    "image": "a.pgm",
    "mode": "trinary",
    "resolution": 0.1,
    "origin": [-1.0, 2.5, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
GOOD = yaml.safe_dump(TREE).encode()
IMAGES = (
    b"P5\n8 6\n255\n" + bytes([0] * 8 + ([0] + [254] * 6 + [0]) * 4 + [0] * 8),
    b"P5 # comment\n3 2\n255\n\x00\xfe\xcd\xfe\x00\xcd",
    b"P5\n99999999 99999999\n255\n",
    b"P5\n8000 8000\n255\n",
    b"P5\n1 1\n65535\n00",
    b"P2\n1 1\n255\n0",
    b"P5 #" + b"x" * 300,
)
#: Between the YAML and the image in one input.
SEPARATOR = b"\x00IMAGE\x00"


@contextlib.contextmanager
def _opened() -> Iterator[Target]:
    with scratch_folder() as folder:
        path = folder / "a.yaml"

        def target(data: bytes) -> None:
            """The first byte says whether the others are the files, or how to make them."""
            draw = Draw(data[1:])
            if data[:1] < b"\x60":
                text, _, image = data[1:].partition(SEPARATOR)
            else:
                tree = spoilt(draw, TREE) if draw.byte() % 2 else TREE
                try:
                    text = yaml.safe_dump(tree).encode("utf-8", "replace")
                except ValueError:  # a number too long to print
                    text = GOOD
                width, height = 1 + draw.below(12), 1 + draw.below(12)
                image = b"P5\n%d %d\n255\n" % (width, height)
                image += bytes(draw.choice((0, 254, 205, 100)) for _ in range(width * height))
            path.write_bytes(text)
            (path.parent / "a.pgm").write_bytes(image)
            try:
                occupancy, geometry = import_map_server(path)
            except MapFileError as error:
                check_words(error)
                return
            assert occupancy.shape == geometry.shape
            assert occupancy.size <= len(image)
            assert occupancy.min() >= -1
            assert occupancy.max() <= 100
            copy = path.with_name("b.yaml")
            export_map_server(copy, occupancy, geometry)
            again, place = import_map_server(copy)
            assert place == geometry
            # What lies between the thresholds becomes unknown; nothing else changes.
            free, occupied = occupancy == 0, occupancy == 100
            assert (again[free] == 0).all()
            assert (again[occupied] == 100).all()
            try:
                plan = load_floor_plan(path)
            except ValueError as error:
                check_words(error)
                return
            assert np.isfinite(plan.segments).all()

        yield target


def _seeds() -> Sequence[bytes]:
    files = [b"\0" + GOOD + SEPARATOR + image for image in IMAGES]
    hostile = [
        b"a: &a [1]\nb: &b [*a,*a,*a,*a]\nc: [*b,*b,*b,*b]\n",
        b"a: &a {x: 1}\nb: &b {<<: [*a,*a,*a]}\nimage: {<<: [*b,*b,*b]}\n",
        GOOD.replace(b"a.pgm", b"/dev/zero"),
        GOOD.replace(b"a.pgm", b"."),
        GOOD.replace(b"0.1", b"1e-6"),
        GOOD.replace(b"0.1", b"1" + b":0" * 200),
    ]
    return [
        *files,
        *(b"\0" + text + SEPARATOR + IMAGES[0] for text in hostile),
        b"\xff",
        b"\xff" + bytes(range(256)),
    ]


SURFACES = (
    Surface(
        "floor_plan",
        _opened,
        _seeds,
        (
            *(SEPARATOR, b"P5\n", b"255\n", b"#", b"scale", b"raw", b"image", b"origin", b"1:1"),
            *(b"<<: ", b"&a ", b"*a", b"{", b"}", b"[", b"]", b": ", b"\n", b"1e-6", b".nan"),
        ),
        longest=1024,
    ),
)
