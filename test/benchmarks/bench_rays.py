# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""720 rays from one place beside ir-sim's, among 200 segments and among 100,000."""

import functools

import numpy as np
import pytest
from aside import first_call
from irsim.lib.algorithm.ray_casting_2d import cast_ray_segments

from nomad_sim.ray_casting import cast_rays
from nomad_sim.segment_index import SegmentIndex

RAYS = 720
REACH = 1e6
NO_CIRCLES = np.empty((0, 3))


@functools.cache
def scene(number):
    """Return segments of 0.5 m strewn over an area that grows with their number."""
    rng = np.random.default_rng(0)
    extent = 0.5 * np.sqrt(number)
    ends = rng.uniform(-extent, extent, (number, 2))
    turns = rng.uniform(0.0, 2.0 * np.pi, number)
    along = 0.5 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return np.hstack([ends, ends + along])


def all_of_them(segments, starts, directions):
    return lambda: cast_rays(starts, directions, segments, NO_CIRCLES)


def by_index(segments, starts, directions):
    index = SegmentIndex.of(segments)
    return lambda: index.cast_rays(starts, directions, NO_CIRCLES)


def irsim(segments, starts, directions):
    first, last = segments[:, :2].copy(), segments[:, 2:].copy()
    return lambda: cast_ray_segments(starts[0], directions, first, last, REACH)[0]


@pytest.mark.parametrize("contender", [all_of_them, by_index, irsim], ids=lambda f: f.__name__)
@pytest.mark.parametrize("number", [200, 100_000])
def test_rays(benchmark, number, contender):
    turns = np.linspace(0.0, 2.0 * np.pi, RAYS, endpoint=False)
    directions = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    starts = np.full((RAYS, 2), 0.01)
    all_of_them(scene(200), starts, directions)(), by_index(scene(200), starts, directions)()
    cast = contender(scene(number), starts, directions)
    benchmark.group = f"{RAYS} rays, {number} segments"
    cold, memory = first_call(cast)
    ranges = benchmark.pedantic(cast, rounds=20 if cold < 0.1 else 3, warmup_rounds=1)
    benchmark.extra_info.update(
        contender=contender.__name__,
        cells=number,
        cold=cold,
        bytes_per_cell=memory / number,
        excess=0.0,
    )
    truth = all_of_them(scene(number), starts, directions)()
    np.testing.assert_allclose(np.minimum(ranges, REACH), np.minimum(truth, REACH), rtol=1e-9)
