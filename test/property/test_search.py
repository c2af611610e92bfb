# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A1, A2 and A3 against exact solvers that share no code with them, on random maps."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from fuzzy_navigation.search import find_path
from fuzzy_navigation.workspace import Workspace

MAPS = 1000
BATCH = 100


@dataclass
class Problem:
    """A map, a request, and the graph of its legal steps."""

    risk: np.ndarray
    start: tuple
    goal: tuple
    options: dict

    @property
    def mu(self):
        """Risks with epsilon."""
        return self.risk + self.options["epsilon"]

    @property
    def admissible(self):
        """Cells that a path may enter, the start among them."""
        cut = self.options["cut"] if self.options["cut"] is not None else self.risk
        ok = cut <= self.options["alpha"]
        if self.options["barred"] is not None:
            ok &= ~self.options["barred"]
        ok[self.start] = True
        return ok

    def steps(self):
        """Return (from, to, whether diagonal) of all legal steps, as flat indices."""
        height, width = self.risk.shape
        ok = self.admissible
        index = np.arange(height * width).reshape(height, width)
        out = []
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                if (i, j) == (0, 0) or (self.options["adjacency"] == 4 and i and j):
                    continue
                # Slices of the cells that have a neighbour at (i, j), and of the neighbours.
                y, x = slice(max(0, -i), height - max(0, i)), slice(max(0, -j), width - max(0, j))
                v, u = slice(max(0, i), height + min(0, i)), slice(max(0, j), width + min(0, j))
                legal = ok[y, x] & ok[v, u]
                if i and j and not self.options["corner_cutting"]:
                    legal &= ok[y, u] & ok[v, x]
                out.append((index[y, x][legal], index[v, u][legal], bool(i and j)))
        tails = np.concatenate([a for a, _, _ in out])
        heads = np.concatenate([b for _, b, _ in out])
        diagonal = np.concatenate([np.full(len(a), d) for a, _, d in out])
        return tails, heads, diagonal

    def flat(self, cell):
        """Return the flat index of a cell."""
        return cell[0] * self.risk.shape[1] + cell[1]

    def distances(self, weight, factor):
        """Return the least sums of weights from the start to every cell (Dijkstra)."""
        tails, heads, diagonal = self.steps()
        data = weight.ravel()[heads] * np.where(diagonal, factor, 1.0)
        graph = coo_matrix((data, (tails, heads)), shape=(self.risk.size,) * 2).tocsr()
        return dijkstra(graph, indices=self.flat(self.start))

    def least_sum(self, power):
        """Return the least g1 or g2."""
        weight = self.mu**power
        factor = math.sqrt(2) if self.options["diagonal"] == "sqrt2" else 1.0
        total = self.distances(weight, factor)[self.flat(self.goal)]
        return float(total + weight[self.start])

    def least_maximum(self):
        """Return the least g3: the lowest threshold that joins start and goal."""
        tails, heads, _ = self.steps()
        mu = self.mu.ravel()
        first, last = self.flat(self.start), self.flat(self.goal)
        levels = np.unique(mu[mu >= max(mu[first], mu[last])])

        def joined(level):
            keep = (mu[tails] <= level) & (mu[heads] <= level)
            shape = (self.risk.size,) * 2
            graph = coo_matrix((np.ones(keep.sum()), (tails[keep], heads[keep])), shape=shape)
            part = connected_components(graph, directed=False)[1]
            return part[first] == part[last]

        if not joined(levels[-1]):
            return math.inf
        low, high = 0, len(levels) - 1
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if joined(levels[middle]) else (middle + 1, high)
        return float(levels[low])


def random_problem(seed):
    """Return a map of random size with walls, and a random request."""
    rng = np.random.default_rng(seed)
    height, width = rng.integers(1, 101 if seed % 20 == 0 else 33, 2)
    if height * width == 1:
        width = 2
    kind = rng.integers(5)
    if kind == 0:
        risk = np.full((height, width), rng.random() * 0.5)  # uniform
    elif kind == 1:
        risk = rng.integers(0, 5, (height, width)) / 8.0  # many ties
    elif kind == 2:
        risk = ndimage.gaussian_filter(rng.random((height, width)), 1.5)  # smooth, as real maps
        risk = (risk - risk.min()) / max(np.ptp(risk), 1e-9)
    else:
        risk = rng.random((height, width)) ** 3
    for _ in range(rng.integers(0, 8)):  # walls, some with a door
        row, column = rng.integers(height), rng.integers(width)
        reach = rng.integers(2, 25)
        level = rng.choice([0.65, 0.85, 1.0])
        if rng.random() < 0.5:
            risk[row, column : column + reach] = level
        else:
            risk[row : row + reach, column] = level
    if rng.random() < 0.3:
        risk[rng.random((height, width)) < 0.35] = 1.0  # scattered pillars
    cells = [tuple(int(v) for v in (rng.integers(height), rng.integers(width))) for _ in range(2)]
    options = {
        "alpha": float(rng.choice([0.3, 0.6, 0.7, 0.9, 1.0])),
        "adjacency": int(rng.choice([4, 8])),
        "epsilon": float(rng.choice([0.001, 0.2, 1.0])),
        "diagonal": str(rng.choice(["unit", "sqrt2"])),
        "corner_cutting": bool(rng.random() < 0.5),
        "cut": rng.random((height, width)) * 1.5 if rng.random() < 0.15 else None,
        "barred": rng.random((height, width)) < 0.15 if rng.random() < 0.15 else None,
    }
    return Problem(risk, cells[0], cells[1], options)


def check_path(problem, result):
    """Check that a path is legal step by step, and its reported risks, in plain loops."""
    path = [tuple(cell) for cell in result.path.tolist()]
    assert path[0] == problem.start
    assert path[-1] == problem.goal
    ok = problem.admissible
    assert all(ok[cell] for cell in path)
    factor = math.sqrt(2) if problem.options["diagonal"] == "sqrt2" else 1.0
    mu = problem.mu
    g1, g2, g3 = mu[path[0]], mu[path[0]] ** 2, mu[path[0]]
    for (a, b), (c, d) in itertools.pairwise(path):
        step = abs(a - c) + abs(b - d)
        assert max(abs(a - c), abs(b - d)) == 1
        assert step == 1 or problem.options["adjacency"] == 8
        if step == 2 and not problem.options["corner_cutting"]:
            assert ok[a, d]
            assert ok[c, b]
        weight = factor if step == 2 else 1.0
        g1 += weight * mu[c, d]
        g2 += weight * mu[c, d] ** 2
        g3 = max(g3, mu[c, d])
    assert result.g1 == pytest.approx(g1, rel=1e-12)
    assert result.g2 == pytest.approx(g2, rel=1e-12)
    assert result.g3 == g3


@pytest.mark.parametrize("batch", range(MAPS // BATCH))
def test_costs_equal_those_of_an_exact_solver(batch):
    """1,000 random maps with walls."""
    found = 0
    for seed in range(batch * BATCH, (batch + 1) * BATCH):
        problem = random_problem(seed)
        truth = {
            "g1": problem.least_sum(1),
            "g2": problem.least_sum(2),
            "g3": problem.least_maximum(),
        }
        for cost, least in truth.items():
            result = find_path(problem.risk, problem.start, problem.goal, cost, **problem.options)
            where = f"map {seed}, cost {cost}"
            assert result.found == math.isfinite(least), where
            assert result.expanded <= problem.risk.size, where
            if result.found:
                found += 1
                assert getattr(result, cost) == pytest.approx(least, rel=1e-12), where
                check_path(problem, result)
            else:
                assert result.path.shape == (0, 2), where
                assert math.isinf(getattr(result, cost)), where
    assert found > BATCH  # the maps are no trivial ones: about two thirds have a path
    assert found < 3 * BATCH


@pytest.mark.parametrize("diagonal", ["unit", "sqrt2"])
def test_uniform_risks_make_a1_and_a2_the_same(diagonal):
    """Same path, and no more expansions than Dijkstra's cells up to the goal's distance."""
    checked = 0
    for seed in range(150):
        problem = random_problem(seed)
        walls = problem.risk > 0.6
        value = np.random.default_rng(seed).random() * 0.6
        problem.risk = np.where(walls, 1.0, value)
        problem.options.update(alpha=0.6, diagonal=diagonal, cut=None, barred=None)
        first, second = (
            find_path(problem.risk, problem.start, problem.goal, cost, **problem.options)
            for cost in ("g1", "g2")
        )
        assert first.path.tolist() == second.path.tolist()
        assert first.expanded == second.expanded
        if not first.found:
            continue
        checked += 1
        factor = math.sqrt(2) if diagonal == "sqrt2" else 1.0
        distance = problem.distances(np.ones_like(problem.risk), factor)
        nearer = int((distance <= distance[problem.flat(problem.goal)] + 1e-9).sum())
        assert first.expanded <= nearer
    assert checked > 50


@pytest.mark.parametrize("scale", [1e-4, 1e-6, 1e-9, 1e-12])
def test_differences_too_small_for_the_order_of_the_search(scale):
    """Costs that differ by less than the open list can tell are told apart in the end."""
    found = 0
    for seed in range(60):
        problem = random_problem(seed)
        walls = problem.risk > 0.6
        noise = np.random.default_rng(seed).random(problem.risk.shape)
        problem.risk = np.where(walls, 1.0, 0.3 + scale * noise)
        problem.options.update(alpha=0.6, epsilon=0.2, cut=None, barred=None)
        for cost, power in (("g1", 1), ("g2", 2)):
            result = find_path(problem.risk, problem.start, problem.goal, cost, **problem.options)
            if result.found:
                found += 1
                least = problem.least_sum(power)
                assert getattr(result, cost) - least <= 1e-13 * least, f"map {seed}"
    assert found > 40


@pytest.mark.parametrize("adjacency", [4, 8])
@pytest.mark.parametrize("most", [1e-3, 1e-4, 1e-6])
def test_a3_goes_any_way_round_for_a_maximum_less_by_next_to_nothing(most, adjacency):
    detours = 0
    for seed in range(400):
        problem = random_problem(seed)
        rng = np.random.default_rng(seed)
        shape = problem.risk.shape
        small = most ** rng.uniform(1.0, 3.0, shape)
        problem.risk = np.where(rng.random(shape) < 0.3, rng.random(shape), small)
        problem.options.update(alpha=1.0, epsilon=0.0, adjacency=adjacency, cut=None, barred=None)
        result = find_path(problem.risk, problem.start, problem.goal, "g3", **problem.options)
        assert result.g3 == problem.least_maximum(), f"map {seed}"
        away = np.abs(np.subtract(problem.start, problem.goal))
        detours += len(result.path) - 1 > (away.sum() if adjacency == 4 else away.max())
    assert detours > 100


@pytest.mark.parametrize("cost", ["g1", "g2", "g3"])
def test_a_constant_that_outweighs_all_risks_takes_no_more_memory(cost):
    problem = random_problem(3)
    problem.options.update(alpha=0.6, epsilon=1000.0, diagonal="unit", cut=None, barred=None)
    workspace = Workspace()
    result = find_path(
        problem.risk, problem.start, problem.goal, cost, **problem.options, workspace=workspace
    )
    assert result.found
    if cost == "g3":
        assert result.g3 == problem.least_maximum()
    else:
        steps = problem.distances(np.ones_like(problem.risk), 1.0)[problem.flat(problem.goal)]
        assert len(result.path) == steps + 1
    assert workspace.nbytes < 2**20


def test_ties_go_to_the_shortest_path():
    """Of the paths with the fewest cells, that with the fewest diagonal steps."""
    checked = 0
    for seed in range(150):
        problem = random_problem(seed)
        problem.risk = np.where(problem.risk > 0.6, 1.0, 0.0)
        problem.options.update(alpha=0.6, diagonal="unit", adjacency=8, cut=None, barred=None)
        result = find_path(problem.risk, problem.start, problem.goal, "g1", **problem.options)
        if not result.found:
            continue
        checked += 1
        # A diagonal step costs 1e-4 more: too little to make up for a whole step.
        least = problem.distances(np.ones_like(problem.risk), 1.0 + 1e-4)
        diagonals = int((np.abs(np.diff(result.path, axis=0)).sum(axis=1) == 2).sum())
        cost = len(result.path) - 1 + 1e-4 * diagonals
        assert cost == pytest.approx(least[problem.flat(problem.goal)], abs=1e-9)
    assert checked > 50


@settings(derandomize=True, max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), cost=st.sampled_from(["g1", "g2", "g3"]))
def test_cost_does_not_depend_on_the_side_one_looks_from(seed, cost):
    """Mirrored and turned maps have mirrored and turned problems of the same cost."""
    problem = random_problem(seed)
    problem.options.update(cut=None, barred=None)
    width = problem.risk.shape[1]
    straight = find_path(problem.risk, problem.start, problem.goal, cost, **problem.options)
    mirrored = find_path(
        problem.risk[:, ::-1],
        (problem.start[0], width - 1 - problem.start[1]),
        (problem.goal[0], width - 1 - problem.goal[1]),
        cost,
        **problem.options,
    )
    turned = find_path(
        problem.risk.T, problem.start[::-1], problem.goal[::-1], cost, **problem.options
    )
    for other in (mirrored, turned):
        assert other.found == straight.found
        if straight.found:
            assert getattr(other, cost) == pytest.approx(getattr(straight, cost), rel=1e-12)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), cost=st.sampled_from(["g1", "g2", "g3"]))
def test_a_higher_cut_never_costs_more(seed, cost):
    problem = random_problem(seed)
    costs = []
    for alpha in (0.3, 0.6, 0.8, 1.0):
        problem.options["alpha"] = alpha
        result = find_path(problem.risk, problem.start, problem.goal, cost, **problem.options)
        costs.append(getattr(result, cost))
    assert all(b <= a * (1 + 1e-12) for a, b in itertools.pairwise(costs))
