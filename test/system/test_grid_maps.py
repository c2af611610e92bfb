# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The Moving AI grid benchmark: 160 problems with published optimal lengths.

The maps are found through FUZZY_NAV_DATA; SOURCE.txt beside them has origin and rules.
"""

import numpy as np
import pytest

from fuzzy_navigation.search import find_path


def read_map(path):
    """Return the risks of a map: 0 where one can pass, 1 elsewhere."""
    lines = path.read_text().splitlines()
    rows = lines[lines.index("map") + 1 :]
    return np.array([[0.0 if cell in ".G" else 1.0 for cell in row] for row in rows])


def read_problems(path):
    """Return (start, goal, optimal length) of each problem, cells as (row, column)."""
    out = []
    for line in path.read_text().splitlines()[1:]:
        x0, y0, x1, y1 = (int(word) for word in line.split()[4:8])
        out.append(((y0, x0), (y1, x1), float(line.split()[8])))
    return out


@pytest.mark.parametrize("cost", ["g1", "g2"])
def test_all_lengths_are_the_published_ones(cost, fuzzy_nav_data):
    folder = fuzzy_nav_data / "grid_maps"
    risk = read_map(folder / "arena.map")
    assert risk.shape == (49, 49)
    problems = read_problems(folder / "arena.map.scen")
    assert len(problems) == 160
    for start, goal, length in problems:
        result = find_path(
            risk, start, goal, cost, 0.5, epsilon=1.0, diagonal="sqrt2", corner_cutting=False
        )
        # The start cell's own risk of 1 counts in g1 but is no length.
        assert result.g1 - 1.0 == pytest.approx(length, abs=1e-4), (start, goal)
        steps = np.hypot(*np.diff(result.path, axis=0).T)
        assert steps.sum() == pytest.approx(length, abs=1e-4)
