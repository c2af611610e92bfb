# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Paths that can be told by hand, ties, refusals, and the same source without numba."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest

from fuzzy_map_building.jit import compiled
from fuzzy_navigation import kernels
from fuzzy_navigation.search import admissible_cells, find_path, warm_up
from fuzzy_navigation.workspace import Workspace

# Prints what searches on a few maps return; run with and without compilation.
SEARCHES = """
import json, sys
{prepare}
import numpy as np
from fuzzy_map_building.jit import compiled
from fuzzy_navigation.search import find_path, warm_up
warm_up()
rng = np.random.default_rng(5)
out = []
for size in (2, 9, 25):
    for cost in ("g1", "g2", "g3"):
        for adjacency in (4, 8):
            for diagonal in ("unit", "sqrt2"):
                risk = rng.random((size, size + 3)) ** 2
                risk[:, size // 2] = 1.0
                risk[rng.integers(size), size // 2] = 0.1
                r = find_path(risk, (0, 0), (size - 1, size + 2), cost, 0.9, adjacency,
                              diagonal=diagonal, corner_cutting=size != 9)
                out.append([r.path.tolist(), repr(r.g1), repr(r.g2), repr(r.g3), r.expanded])
                r = find_path(risk.round(2), (0, 0), (size - 1, size + 2), cost, 0.9, adjacency)
                out.append([r.path.tolist(), repr(r.g1), repr(r.g2), repr(r.g3), r.expanded])
print(json.dumps([compiled(), out]))
"""


def searches(prepare="", **environment):
    """Run `SEARCHES` in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", SEARCHES.format(prepare=prepare)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    ("prepare", "environment"),
    [("", {"NUMBA_DISABLE_JIT": "1"}), ("sys.modules['numba'] = None", {})],
    ids=["switched_off", "not_installed"],
)
def test_plain_python_gives_the_same_paths(prepare, environment):
    machine_code, results = searches(prepare, **environment)
    assert machine_code is False
    assert results == searches()[1]
    assert len({json.dumps(r) for r in results}) > 20


def test_a_wall_is_walked_around():
    risk = np.zeros((5, 5))
    risk[:4, 2] = 0.7
    for cost in ("g1", "g2", "g3"):
        result = find_path(risk, (0, 0), (0, 4), cost)
        assert result.found
        assert [4, 2] in result.path.tolist()
        assert result.g3 == pytest.approx(0.2)
    assert find_path(risk, (0, 0), (0, 4)).path.shape == (9, 2)
    assert find_path(risk, (0, 0), (0, 4), adjacency=4).path.shape == (13, 2)
    # With the cut at 0.9 the wall is the cheaper way for g1: 4 x 0.2 + 0.9 < 9 x 0.2.
    through = find_path(risk, (0, 0), (0, 4), "g1", 0.9)
    assert through.path.tolist() == [[0, k] for k in range(5)]
    assert through.g1 == pytest.approx(4 * 0.2 + 0.9)
    assert find_path(risk, (0, 0), (0, 4), "g2", 0.9).g3 == pytest.approx(0.2)


def test_the_three_costs_choose_differently():
    """Straight on through 0.4, a detour of one row at 0.2, a long one at 0.1."""
    risk = np.full((7, 9), 1.0)
    risk[0, :] = [0.0, 0, 0.45, 0, 0, 0, 0, 0, 0]
    risk[1:, 1] = 0.2
    risk[6, 1:4] = 0.2
    risk[1:, 3] = 0.2
    straight = find_path(risk, (0, 0), (0, 8), "g1", 0.5, 4)
    detour = find_path(risk, (0, 0), (0, 8), "g3", 0.5, 4)
    assert len(straight.path) == 9
    assert len(detour.path) > 9
    assert straight.g3 == pytest.approx(0.65)
    assert detour.g3 == pytest.approx(0.4)
    assert straight.g1 < detour.g1


def test_start_is_exempt_from_the_cut_and_the_goal_is_not():
    risk = np.zeros((1, 4))
    risk[0, 0] = risk[0, 3] = 1.0
    assert find_path(risk, (0, 0), (0, 2)).found
    blocked = find_path(risk, (0, 0), (0, 3))
    assert (blocked.found, blocked.expanded, blocked.g1) == (False, 0, math.inf)
    assert blocked.path.shape == (0, 2)


def test_start_at_the_goal_is_a_path_of_one_cell():
    result = find_path(np.ones((2, 2)), (1, 0), (1, 0), alpha=0.1)
    assert result.found
    assert result.path.tolist() == [[1, 0]]
    assert (result.g1, result.g3, result.expanded) == (1.2, 1.2, 0)


def test_alpha_is_compared_without_epsilon():
    risk = np.full((1, 3), 0.6)
    assert find_path(risk, (0, 0), (0, 2), alpha=0.6, epsilon=0.4).found
    assert not find_path(risk, (0, 0), (0, 2), alpha=0.59, epsilon=0.0).found


def test_cut_decides_admission_and_risk_the_cost():
    risk = np.zeros((3, 5))
    risk[1, 2] = 1.0
    cut = np.zeros((3, 5))
    cut[[0, 2], 2] = 2.0
    result = find_path(risk, (1, 0), (1, 4), "g1", 0.6, cut=cut)
    assert [1, 2] in result.path.tolist()
    assert result.g1 == pytest.approx(4 * 0.2 + 1.2)
    cut[1, 2] = math.inf
    assert not find_path(risk, (1, 0), (1, 4), "g1", 1.0, cut=cut).found


def test_barred_cells_are_not_entered():
    barred = np.zeros((3, 5), dtype=bool)
    barred[:2, 2] = True
    result = find_path(np.zeros((3, 5)), (0, 0), (0, 4), barred=barred)
    assert [2, 2] in result.path.tolist()
    barred[2, 2] = True
    assert not find_path(np.zeros((3, 5)), (0, 0), (0, 4), barred=barred).found


def test_corner_cutting():
    risk = np.array([[0.0, 1.0], [1.0, 0.0]])
    assert find_path(risk, (0, 0), (1, 1)).found
    assert not find_path(risk, (0, 0), (1, 1), corner_cutting=False).found
    risk[0, 1] = 0.0
    detour = find_path(risk, (0, 0), (1, 1), corner_cutting=False)
    assert detour.path.tolist() == [[0, 0], [0, 1], [1, 1]]


def test_diagonal_steps_cost_what_was_asked():
    risk = np.zeros((4, 4))
    unit = find_path(risk, (0, 0), (3, 3), "g1", epsilon=0.5)
    octile = find_path(risk, (0, 0), (3, 3), "g1", epsilon=0.5, diagonal="sqrt2")
    assert unit.g1 == pytest.approx(0.5 * 4)
    assert octile.g1 == pytest.approx(0.5 + 0.5 * 3 * math.sqrt(2))


def test_epsilon_zero_on_a_map_of_zeros():
    result = find_path(np.zeros((4, 4)), (0, 0), (3, 3), epsilon=0.0)
    assert result.found
    assert result.g1 == 0.0


def test_free_space_is_crossed_straight():
    """Ties: of all the paths of 20 steps, the one without a needless diagonal."""
    result = find_path(np.zeros((21, 21)), (10, 0), (10, 20))
    assert result.path.tolist() == [[10, k] for k in range(21)]
    assert result.expanded == 20


def test_a3_goes_straight_for_the_goal_while_the_maximum_stays():
    risk = np.full((30, 30), 0.3)
    result = find_path(risk, (3, 4), (25, 20), "g3", adjacency=4)
    assert len(result.path) == 1 + 22 + 16
    assert result.expanded == 22 + 16


def test_the_same_request_has_the_same_answer():
    risk = np.random.default_rng(3).integers(0, 3, (40, 40)) / 4
    first = find_path(risk, (1, 1), (38, 38))
    again = find_path(risk.copy(), (1, 1), (38, 38))
    assert first.path.tolist() == again.path.tolist()


def test_arguments_are_left_alone_in_any_layout():
    risk = np.asfortranarray(np.random.default_rng(1).random((20, 30)))
    before = risk.copy()
    result = find_path(risk, (0, 0), (19, 29), alpha=1.0)
    np.testing.assert_array_equal(risk, before)
    listed = find_path(before.tolist(), [0, 0], np.array([19, 29]), alpha=1.0)
    assert listed.path.tolist() == result.path.tolist()
    single = find_path(before.astype(np.float32), (0, 0), (19, 29), alpha=1.0)
    assert single.found


GRID = np.zeros((3, 4))


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        ((GRID, (3, 0), (0, 0)), {}, "start.*row 3.*3 rows and 4 columns"),
        ((GRID, (0, 0), (0, -1)), {}, "goal.*column -1.*outside"),
        ((GRID, (0.5, 0), (0, 0)), {}, "start.*whole numbers"),
        ((GRID, (0, 0, 0), (0, 0)), {}, "start.*whole numbers"),
        ((GRID, None, (0, 0)), {}, "start.*whole numbers"),
        ((GRID, (0, 0), (1, 1)), {"cost": "g4"}, "cost.*g1, g2, g3.*'g4'"),
        ((GRID, (0, 0), (1, 1)), {"adjacency": 6}, "adjacency.*4, 8.*6"),
        (
            (GRID.astype(complex), (0, 0), (1, 1)),
            {},
            "risk must be an array of real numbers.*comp",
        ),
        ((GRID.astype(str), (0, 0), (1, 1)), {}, "risk must be an array of real numbers"),
        ((GRID.astype(object), (0, 0), (1, 1)), {}, "risk must be an array of real numbers"),
        (([[0.1], [0.1, 0.2]], (0, 0), (1, 0)), {}, "risk must be an array of real numbers"),
        ((GRID, (0, 0), (1, 1)), {"cut": GRID.astype(complex)}, "cut must be an array of real"),
        ((GRID, (0, 0), (1, 1)), {"cut": GRID.astype(str)}, "cut must be an array of real"),
        ((GRID, (0, 0), (1, 1)), {"alpha": "0.6"}, "alpha.*'0.6'"),
        ((GRID, (0, 0), (1, 1)), {"epsilon": 1j}, "epsilon.*1j"),
        ((GRID, (0, 0), (1, 1)), {"alpha": math.nan}, "alpha.*nan"),
        ((GRID, (0, 0), (1, 1)), {"alpha": 1.1}, "alpha.*1.1"),
        ((GRID, (0, 0), (1, 1)), {"alpha": -0.1}, "alpha.*-0.1"),
        ((GRID, (0, 0), (1, 1)), {"epsilon": -0.1}, "epsilon.*-0.1"),
        ((GRID, (0, 0), (1, 1)), {"epsilon": math.inf}, "epsilon.*inf"),
        ((GRID, (0, 0), (1, 1)), {"epsilon": 1e5}, "epsilon.*1000.*100000"),
        ((GRID, (0, 0), (1, 1)), {"diagonal": "long"}, "diagonal.*'long'"),
        ((GRID, (0, 0), (1, 1)), {"cut": np.zeros((4, 3))}, r"cut.*\(3, 4\).*\(4, 3\)"),
        ((GRID, (0, 0), (1, 1)), {"cut": np.full((3, 4), math.nan)}, "cut.*NaN"),
        ((GRID, (0, 0), (1, 1)), {"barred": np.zeros((4, 3), dtype=bool)}, r"barred.*\(4, 3\)"),
        ((GRID, (0, 0), (1, 1)), {"barred": np.zeros((3, 4))}, "barred.*bool.*float64"),
        ((GRID, (0, 0), (1, 1)), {"barred": np.ma.masked_less(GRID, 1.0)}, "barred.*masked"),
        ((np.full((3, 4), math.nan), (0, 0), (1, 1)), {}, "risk.*nan"),
        ((np.full((3, 4), 2.0), (0, 0), (1, 1)), {}, "risk.*2.0"),
        ((np.zeros(4), (0, 0), (1, 1)), {}, "risk.*shape"),
    ],
)
def test_bad_input_is_refused(arguments, options, words):
    with pytest.raises(ValueError, match=words):
        find_path(*arguments, **options)


def test_a_workspace_serves_any_number_of_searches():
    """Maps of all sizes, with and without a path, some with more open cells than it has room."""
    workspace = Workspace()
    rng = np.random.default_rng(8)
    found = 0
    for size in (3, 40, 7, 120, 120, 40, 2):
        for decimals in (2, 15):
            risk = (rng.random((size, size + 1)) ** 3).round(decimals)
            request = (risk, (0, 0), (size - 1, size), ("g1", "g2", "g3")[found % 3], 0.5)
            kept, fresh = find_path(*request, workspace=workspace), find_path(*request)
            assert kept.path.tolist() == fresh.path.tolist()
            assert (kept.g2, kept.expanded) == (fresh.g2, fresh.expanded)
            found += kept.found
    assert found > 8


def serpentine(size):
    """Walls across all but one end of every other row, and the cells that the only path enters."""
    barred = np.zeros((size, size), dtype=bool)
    barred[1::2] = True
    barred[1::4, -1] = barred[3::4, 0] = False
    return barred, int((~barred).sum())


@pytest.mark.parametrize("cost", ["g1", "g3"])
def test_a_path_too_long_for_short_labels_is_found_all_the_same(monkeypatch, cost):
    barred, entered = serpentine(21)
    workspace = Workspace()
    asked = (np.zeros(barred.shape), (0, 0), (20, 20), cost, 1.0, 4)
    bits = []

    def tight(most):
        """As if labels of 32 bits ended soon after the first rows."""
        bits.append(int(most).bit_length() + 1)
        return 100 * kernels.STRAIGHT if bits[-1] == 32 else 2**40

    monkeypatch.setattr(kernels, "longest_labelled", tight)
    assert find_path(*asked[:2], (0, 20), *asked[3:], barred=barred, workspace=workspace).found
    assert bits == [32]
    for _ in range(2):
        found = find_path(*asked, barred=barred, workspace=workspace)
        assert len(found.path) == entered == 241
        assert len({tuple(cell) for cell in found.path.tolist()}) == 241
    assert bits == [32, 32, 64, 64]


def test_labels_have_room_for_a_million_cells():
    """A label is the length times 16, and up to 15; one step more must fit as well."""
    longest = kernels.longest_labelled(2**31 - 1)
    assert (longest + kernels.DIAGONAL) * 16 + 15 <= 2**31 - 1
    assert longest >= 1_900_000 * kernels.STRAIGHT


def test_a_search_that_is_broken_off_leaves_nothing_behind(monkeypatch):
    workspace = Workspace()
    risk = np.random.default_rng(8).random((30, 30)).round(2)
    whole = find_path(risk, (0, 0), (29, 29), alpha=1.0, workspace=workspace)

    def interrupted(*arguments):
        for cell in range(100, 600):
            workspace._cost[cell] = 0.0
        workspace._buckets[3] = 5
        raise KeyboardInterrupt

    with monkeypatch.context() as broken:
        broken.setattr(kernels, "best_first", interrupted)
        with pytest.raises(KeyboardInterrupt):
            find_path(risk, (0, 0), (29, 29), alpha=1.0, workspace=workspace)
    again = find_path(risk, (0, 0), (29, 29), alpha=1.0, workspace=workspace)
    assert again.path.tolist() == whole.path.tolist()


def test_maps_beyond_what_an_entry_holds_are_refused(monkeypatch):
    monkeypatch.setattr(kernels, "MOST_CELLS", 400)
    assert find_path(np.zeros((18, 18)), (0, 0), (17, 17)).found
    with pytest.raises(ValueError, match=r"22 x 20 cells is too large.*at most 400"):
        find_path(np.zeros((20, 18)), (0, 0), (17, 17))


def test_memory_of_a_search():
    """Bytes a cell beside the map: cost, label, and what the open cells need."""
    workspace = Workspace()
    risk = np.random.default_rng(2).random((500, 400))
    find_path(risk, (0, 0), (499, 399), alpha=1.0, workspace=workspace)
    least = 12 if compiled() else 16  # lists of plain Python hold pointers
    assert least * risk.size < workspace.nbytes < (least + 2) * risk.size


def test_admissible_cells_takes_its_shape_from_the_map():
    assert admissible_cells([[0.5, 0.7]], 0.6).tolist() == [[True, False]]
    assert admissible_cells(np.zeros((0, 3)), 0.6).shape == (0, 3)


def test_nothing_is_compiled_after_warm_up():
    warm_up()
    if not compiled():
        pytest.skip("numba is not installed or switched off")
    before = [len(kernels.best_first.signatures), len(kernels.trace.signatures)]
    risk = np.random.default_rng(0).random((10, 10)).astype(np.float32)
    for cost in ("g1", "g2", "g3"):
        for adjacency in (np.int32(4), 8):
            for diagonal in ("unit", "sqrt2"):
                find_path(risk, (0, 0), (9, 9), cost, 1, adjacency, epsilon=1, diagonal=diagonal)
    find_path(np.ones((10, 10), dtype=np.uint8), (0, 0), (9, 9), alpha=1)
    assert [len(kernels.best_first.signatures), len(kernels.trace.signatures)] == before
    wide = Workspace(wide=True)  # as for a path of a million cells and more
    find_path(risk, (0, 0), (9, 9), workspace=wide)
    find_path(risk.round(2), (0, 0), (9, 9), workspace=wide)
    assert [len(kernels.best_first.signatures), len(kernels.trace.signatures)] == before
    assert before == [4, 2]  # costs by a table, and costs as they are; both with long labels


@pytest.mark.parametrize("shape", [(200, 40), (600, 40), (40, 300)])
def test_on_even_ground_cells_that_are_expanded_again_do_not_end_the_search(shape):
    goal = (shape[0] - 10, shape[1] - 10)
    found = find_path(np.zeros(shape), (3, 3), goal, "g2", diagonal="sqrt2")
    assert found.found
    low, high = sorted((goal[0] - 3, goal[1] - 3))
    assert found.g2 == pytest.approx(0.04 * (1.0 + high - low + math.sqrt(2.0) * low))


@pytest.mark.parametrize("diagonal", ["unit", "sqrt2"])
@pytest.mark.parametrize("epsilon", [0.001, 0.01, 0.2])
def test_few_cells_are_expanded_twice_whatever_the_range_of_costs(epsilon, diagonal):
    risk = np.where(np.random.default_rng(3).random((200, 200)) < 0.4, 0.55, 0.0)
    found = find_path(risk, (0, 0), (199, 199), "g2", epsilon=epsilon, diagonal=diagonal)
    assert found.found
    assert found.expanded <= 1.2 * risk.size
