# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Augmentation, cuts and path risks against scalar loops."""

import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_navigation import risk as risk_module
from fuzzy_navigation.risk import (
    Footprint,
    alpha_cut,
    augment,
    beta_cut,
    changed_window,
    check_effort,
    checked_risk,
    path_risks,
)


def augment_by_loops(risk, radius, resolution, shape):
    """Return the largest risk under the footprint, cell by cell."""
    height, width = risk.shape
    half = int(radius / resolution) + 2
    square = math.floor(radius / resolution + 0.5 + 1e-9)
    out = np.zeros_like(risk)
    for row in range(height):
        for column in range(width):
            worst = 0.0
            for i in range(-half, half + 1):
                for j in range(-half, half + 1):
                    if shape == "square":
                        inside = abs(i) <= square and abs(j) <= square
                    else:
                        inside = math.hypot(i, j) * resolution <= radius + 1e-9
                    if not inside:
                        continue
                    y, x = row + i, column + j
                    outside = not (0 <= y < height and 0 <= x < width)
                    worst = max(worst, 1.0 if outside else risk[y, x])
            out[row, column] = worst
    return out


@pytest.mark.parametrize("shape", ["square", "disc"])
@pytest.mark.parametrize(
    ("radius", "resolution"),
    [(0.0, 0.1), (0.04, 0.1), (0.1, 0.1), (0.15, 0.1), (0.23, 0.1), (0.3, 0.1), (0.23, 0.05)],
)
def test_augmentation_is_the_largest_risk_under_the_footprint(shape, radius, resolution):
    risk = np.random.default_rng(7).random((13, 17))
    risk[risk < 0.9] *= 0.1
    got = augment(risk, radius, resolution, shape)
    np.testing.assert_array_equal(got, augment_by_loops(risk, radius, resolution, shape))


def test_footprints_of_the_nomad():
    """0.23 m on cells of 0.1 m: 5 x 5 cells, or those 21 less than 2.3 cells away."""
    risk = np.zeros((21, 21))
    risk[10, 10] = 0.7
    assert (augment(risk, 0.23, 0.1)[3:-3, 3:-3] == 0.7).sum() == 25
    assert (augment(risk, 0.23, 0.1, "disc")[3:-3, 3:-3] == 0.7).sum() == 21


def test_outside_the_map_counts_as_risk_1():
    got = augment(np.zeros((9, 9)), 0.23, 0.1)
    assert (got[:2] == 1).all()
    assert (got[:, -2:] == 1).all()
    assert (got[2:-2, 2:-2] == 0).all()


@pytest.mark.parametrize("shape", ["square", "disc"])
def test_a_robot_larger_than_the_map_fits_nowhere(shape):
    assert (augment(np.zeros((3, 4)), 1e6, 0.1, shape) == 1).all()


def test_augmentation_leaves_its_argument_alone():
    risk = np.zeros((5, 5))
    augment(risk, 0.1, 0.1)[:] = 1.0
    assert not risk.any()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((np.zeros((3, 3)), -0.1, 0.1), "radius"),
        ((np.zeros((3, 3)), math.nan, 0.1), "radius"),
        ((np.zeros((3, 3)), 0.1, 0.0), "resolution"),
        ((np.zeros((3, 3)), 0.1, math.inf), "resolution"),
        ((np.zeros((3, 3)), 0.1, 0.1, "hexagon"), "square.*hexagon"),
        ((np.full((3, 3), math.nan), 0.1, 0.1), r"\[0, 1\].*nan"),
        ((np.full((3, 3), 1.5), 0.1, 0.1), r"\[0, 1\].*9 cells.*1.5"),
        ((np.full((3, 3), -0.1), 0.1, 0.1), r"\[0, 1\]"),
        ((np.zeros(3), 0.1, 0.1), r"shape \(3,\)"),
        ((np.zeros((0, 3)), 0.1, 0.1), "at least one cell"),
        ((np.ma.masked_equal([[0.1, 0.9]], 0.9), 0.1, 0.1), "risk has masked values.*filled"),
    ],
)
def test_augmentation_refuses_bad_input(arguments, words):
    with pytest.raises(ValueError, match=words):
        augment(*arguments)


def test_a_refused_map_is_named_with_its_first_wrong_cell():
    risk = np.zeros((4, 6))
    risk[2, 5] = math.nan
    with pytest.raises(ValueError, match=r"M_p.*1 cells.*row 2, column 5: nan"):
        checked_risk(risk, "M_p")


def test_cuts_keep_the_level_itself():
    risk = np.array([[0.0, 0.6, np.nextafter(0.6, 1.0), 1.0]])
    assert alpha_cut(risk, 0.6).tolist() == [[True, True, False, False]]
    assert beta_cut(risk, 0.6).tolist() == [[True, True, False, False]]


def test_path_risks_by_hand():
    mu = np.array([[0.2, 0.3, 0.9], [0.5, 0.4, 1.2]])
    path = np.array([[0, 0], [1, 1], [0, 1], [0, 2]])
    g1, g2, g3 = path_risks(mu, path)
    assert g1 == pytest.approx(0.2 + 0.4 + 0.3 + 0.9, abs=1e-15)
    assert g2 == pytest.approx(0.04 + 0.16 + 0.09 + 0.81, abs=1e-15)
    assert g3 == 0.9
    g1, g2, g3 = path_risks(mu, path, "sqrt2")
    assert g1 == pytest.approx(0.2 + math.sqrt(2) * 0.4 + 0.3 + 0.9, abs=1e-15)
    assert g2 == pytest.approx(0.04 + math.sqrt(2) * 0.16 + 0.09 + 0.81, abs=1e-15)
    assert g3 == 0.9


def test_path_risks_of_one_cell():
    assert path_risks(np.array([[0.25]]), np.array([[0, 0]])) == (0.25, 0.0625, 0.25)


def test_path_risks_refuses_bad_input():
    with pytest.raises(ValueError, match="at least one cell"):
        path_risks(np.ones((2, 2)), np.empty((0, 2), dtype=np.int64))
    with pytest.raises(ValueError, match=r"unit, sqrt2.*cubic"):
        path_risks(np.ones((2, 2)), np.array([[0, 0]]), "cubic")


@pytest.mark.parametrize("shape", ["square", "disc"])
@pytest.mark.parametrize("tile", [1, 7, 1024])
def test_a_part_of_the_augmented_map_is_that_of_the_whole(
    monkeypatch: pytest.MonkeyPatch, shape: str, tile: int
) -> None:
    monkeypatch.setattr(risk_module, "_TILE", tile)
    rng = np.random.default_rng(6)
    values = np.full((31, 40), 20, np.int8)
    values[3:12, 5:9] = rng.integers(0, 101, (9, 4))
    values[18:25, :8] = 100
    footprint = Footprint.of(0.23, 0.1, shape, values.shape)
    whole = footprint.largest(values, np.int8(100))
    for window in (Window(0, 31, 0, 40), Window(4, 9, 6, 7), Window(20, 31, 30, 40)):
        part = footprint.largest_in(values, np.int8(100), window)
        np.testing.assert_array_equal(part, whole[window.slices])


def test_the_window_of_a_change_is_the_smallest_that_holds_every_cell_that_differs() -> None:
    rng = np.random.default_rng(3)
    before = rng.integers(0, 101, (9, 14)).astype(np.int8)
    assert changed_window(before, before.copy()).empty
    for _ in range(40):
        after = before.copy()
        cells = {tuple(c) for c in rng.integers(0, before.shape, (rng.integers(1, 4), 2)).tolist()}
        for cell in cells:
            after[cell] = (after[cell] + 1) % 101
        rows, columns = zip(*cells, strict=True)
        expected = Window(min(rows), max(rows) + 1, min(columns), max(columns) + 1)
        assert changed_window(before, after) == expected


def test_a_map_that_is_too_fine_for_its_size_is_refused() -> None:
    check_effort(GridGeometry(4000, 4000, 0.1), 0.23, "disc")
    check_effort(GridGeometry(8000, 8000, 0.02), 0.23, "disc")
    check_effort(GridGeometry(8000, 8000, 0.001), 0.23, "square")  # one pass, however wide
    with pytest.raises(ValueError, match=r"8000 x 8000 cells of 0.001 m is too fine .*larger"):
        check_effort(GridGeometry(8000, 8000, 0.001), 0.23, "disc")
