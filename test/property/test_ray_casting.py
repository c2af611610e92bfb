# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Rays and echoes in random worlds against a fan of rays that march through them.

The marcher knows nothing of intersections: it steps along each ray by the distance to the
nearest surface until it stands on one (sphere tracing).
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nomad_sim.beam import foot, wrapped
from nomad_sim.echo import echo_range
from nomad_sim.ray_casting import cast_rays, inside, nearest_distance
from nomad_sim.segment_index import SegmentIndex
from nomad_sim.surfaces import Outline, Surfaces

REACH = 6.5
TOUCH = 1e-7
NOBODY = np.zeros(3)


def distances(points, surfaces):
    """Return distances of points to all surfaces, shape (R, N + M)."""
    start, end = surfaces.segments[:, :2], surfaces.segments[:, 2:]
    along = end - start
    w = ((points[:, None] - start) * along).sum(-1) / (along**2).sum(-1)
    foot = start + np.clip(w, 0.0, 1.0)[..., None] * along
    to_segments = np.linalg.norm(points[:, None] - foot, axis=-1)
    centres, radii = surfaces.circles[:, :2], surfaces.circles[:, 2]
    to_circles = np.linalg.norm(points[:, None] - centres, axis=-1) - radii
    return np.hstack([to_segments, np.abs(to_circles)])


def march(starts, directions, surfaces, reach=REACH):
    """Return way and surface of each ray; the way is inf where nothing is met."""
    way = np.full(len(starts), 1e-5)
    hit = np.full(len(starts), -1)
    active = np.arange(len(starts))
    for _ in range(2000):
        if not len(active):
            break
        gap = distances(starts[active] + way[active, None] * directions[active], surfaces)
        nearest = gap.argmin(axis=1)
        step = gap[np.arange(len(active)), nearest]
        arrived = step < TOUCH
        hit[active[arrived]] = nearest[arrived]
        way[active] += np.where(arrived, 0.0, step)
        active = active[~arrived & (way[active] <= reach)]
    return np.where(hit >= 0, way, np.inf), hit


def normals(points, hit, surfaces):
    count = len(surfaces.segments)
    out = np.empty((len(points), 2))
    straight = hit < count
    along = surfaces.segments[hit[straight], 2:] - surfaces.segments[hit[straight], :2]
    out[straight] = np.stack([-along[:, 1], along[:, 0]], axis=1)
    out[~straight] = points[~straight] - surfaces.circles[hit[~straight] - count, :2]
    return out / np.linalg.norm(out, axis=1, keepdims=True)


def fan_echo(x, y, axis, half, reflections, surfaces, rays=1501):
    """Return the shortest echo of a fan of rays, without edges."""
    angles = axis + np.linspace(-half, half, rays)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    starts = np.tile([x, y], (rays, 1)).astype(float)
    gone = np.zeros(rays)
    best = np.inf
    for _ in range(reflections + 1):
        way, hit = march(starts, directions, surfaces)
        met = np.isfinite(way) & (gone + way <= REACH)
        starts, directions = starts[met], directions[met]
        way, hit, gone = way[met], hit[met], gone[met] + way[met]
        if not len(way):
            break
        points = starts + way[:, None] * directions
        normal = normals(points, hit, surfaces)
        cosine = np.abs((normal * directions).sum(axis=1))
        echoes = np.arccos(np.minimum(cosine, 1.0)) <= surfaces.critical_angles[hit]
        best = min(best, gone[echoes].min(initial=np.inf))
        mirrored = ~echoes & (hit < len(surfaces.segments))
        starts, normal, gone = points[mirrored], normal[mirrored], gone[mirrored]
        inward = (directions[mirrored] * normal).sum(axis=1, keepdims=True)
        directions = directions[mirrored] - 2.0 * inward * normal
    return best


coordinate = st.integers(-400, 400).map(lambda n: n / 100.0)
angle = st.integers(5, 80).map(math.radians)


@st.composite
def random_surfaces(draw, cylinders=True):
    """Walls and circles at random places, none of them close to the sonar at the origin."""
    outlines = []
    for _ in range(draw(st.integers(1, 6))):
        x0, y0, x1, y1 = (draw(coordinate) for _ in range(4))
        segments = np.array([[x0, y0, x1, y1]])
        if math.hypot(x1 - x0, y1 - y0) < 0.1:
            continue
        if nearest_distance(0.0, 0.0, segments, np.empty((0, 3)), np.empty((0, 2), int)) < 0.05:
            continue
        outlines.append(Outline(segments, np.empty((0, 3)), draw(angle), True, False))
    for _ in range(draw(st.integers(0, 3)) if cylinders else 0):
        x, y, radius = draw(coordinate), draw(coordinate), draw(st.integers(5, 80)) / 100.0
        if math.hypot(x, y) > radius + 0.05:
            circles = np.array([[x, y, radius]])
            outlines.append(Outline(np.empty((0, 4)), circles, draw(angle), True, False))
    assume(outlines)
    return Surfaces.of(outlines)


def exact_echo(x, y, axis, half, reflections, s, edges=False):
    return echo_range(
        x, y, axis, half, REACH, edges, reflections, NOBODY,
        s.segments, s.circles, s.critical_angles, s.edges, s.marks,
    )  # fmt: skip


@settings(max_examples=60)
@given(random_surfaces(), st.integers(-180, 179))
def test_rays_meet_what_the_marcher_meets(surfaces, degrees):
    angles = math.radians(degrees) + np.linspace(-0.3, 0.3, 16)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    starts = np.zeros((16, 2))
    cast = cast_rays(starts, directions, surfaces.segments, surfaces.circles)
    marched, _ = march(starts, directions, surfaces, reach=20.0)
    # The marcher stops when it grazes a surface within its tolerance; that is no crossing.
    same = np.isclose(cast, marched, atol=1e-4) | (np.isinf(cast) & np.isinf(marched))
    assert same.all()


@settings(max_examples=100)
@given(
    random_surfaces(), st.integers(-180, 179), coordinate, coordinate, st.sampled_from([1, 1e3])
)
def test_the_index_finds_what_a_look_at_all_finds(surfaces, degrees, x, y, scale):
    """To the last bit, also from outside, along the axes and the squares' sides, and far away."""
    assume(len(surfaces.segments))
    segments, circles = scale * surfaces.segments, scale * surfaces.circles
    angles = np.append(
        math.radians(degrees) + np.linspace(-3.0, 3.0, 60), np.arange(8) * np.pi / 4
    )
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    directions = np.concatenate([directions, [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]])
    # The last starts are ends of segments and points on them.
    starts = np.tile([scale * x, scale * y], (len(directions), 1))
    starts[-8:-4] = segments[0, :2]
    starts[-4:] = segments[-1].reshape(2, 2).mean(axis=0)
    index = SegmentIndex.of(segments)
    np.testing.assert_array_equal(
        index.cast_rays(starts, directions, circles),
        cast_rays(starts, directions, segments, circles),
    )


@pytest.mark.parametrize("length", [0.3, 40.0])
def test_the_index_of_many_segments(length):
    rng = np.random.default_rng(4)
    ends = rng.uniform(-40.0, 40.0, (3000, 2))
    angles = rng.uniform(0.0, 7.0, 3000)
    angles[::3] = 0.0  # many lie along the squares
    along = length * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    segments = np.hstack([ends, ends + along])
    starts = rng.uniform(-60.0, 60.0, (500, 2))
    turns = rng.uniform(0.0, 7.0, 500)
    directions = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    index = SegmentIndex.of(segments)
    cast = index.cast_rays(starts, directions, np.empty((0, 3)))
    np.testing.assert_array_equal(cast, cast_rays(starts, directions, segments, np.empty((0, 3))))
    assert 50 < np.isfinite(cast).sum() <= 500
    # Each segment is known to few squares: that is what makes it quick.
    assert len(index.members) < 30 * len(segments)


def test_an_index_refuses_what_is_no_segments():
    with pytest.raises(ValueError, match=r"shape \(1 or more, 4\), got \(0, 4\)"):
        SegmentIndex.of(np.empty((0, 4)))
    with pytest.raises(ValueError, match="finite"):
        SegmentIndex.of(np.array([[0.0, 0.0, np.inf, 1.0]]))


def test_worlds_of_many_segments_are_seen_as_those_of_few():
    """Walls of glass and wood, a thing in front of them, and all of it once more elsewhere."""
    rng = np.random.default_rng(6)
    ends = rng.uniform(1.0, 20.0, (1200, 2))
    walls = np.hstack([ends, ends + rng.uniform(0.01, 0.02, (1200, 2))])
    nothing = np.empty((0, 2))

    def surfaces(segments, opaque):
        return Surfaces(
            segments, np.empty((0, 3)), np.ones(len(segments)), opaque,
            np.empty((0, 2), np.int64), nothing, nothing,
        )  # fmt: skip

    still = surfaces(walls, rng.random(1200) < 0.7)
    mover = surfaces(np.array([[2.0, -3.0, 2.0, 3.0]]), np.array([True]))
    turns = rng.uniform(-0.5, 2.0, 300)
    directions = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    starts = np.zeros((300, 2))
    for world in (still, still.joined([mover]), still.joined([mover]).shifted(-0.5, 0.25)):
        for glass in (True, False):
            seen = world.segments if glass else world.seen_by_infrared[0]
            np.testing.assert_array_equal(
                world.cast_rays(starts, directions, sees_glass=glass),
                cast_rays(starts, directions, seen, np.empty((0, 3))),
            )


@settings(max_examples=80)
@given(random_surfaces(), st.integers(-180, 179), st.integers(1, 25), st.integers(0, 1))
def test_echo_is_that_of_a_dense_fan(surfaces, degrees, half, reflections):
    axis, half = math.radians(degrees), math.radians(half)
    exact = exact_echo(0.0, 0.0, axis, half, reflections, surfaces)
    fan = fan_echo(0.0, 0.0, axis, half, reflections, surfaces)
    # No ray of the fan comes back before the exact echo.
    assert exact <= fan + 1e-5
    # And close beside some ray is the exact one, where it does not come through a slit
    # narrower than the fan's spacing: then a fan of only that part finds it.
    if exact < fan - 0.02:
        parts = axis + np.linspace(-half, half, 41)[1:-1]
        fine = min(
            fan_echo(0.0, 0.0, part, half / 40.0, reflections, surfaces, rays=401)
            for part in parts
        )
        assert exact == pytest.approx(fine, abs=0.02)


@settings(max_examples=40)
@given(random_surfaces(cylinders=False), st.integers(-180, 179))
def test_edges_are_heard_exactly_when_nothing_hides_them(surfaces, degrees):
    axis, half = math.radians(degrees), math.radians(10.0)
    candidates = [exact_echo(0.0, 0.0, axis, half, 0, surfaces)]
    for x, y in surfaces.edges:
        distance = math.hypot(x, y)
        if abs((math.atan2(y, x) - axis + math.pi) % (2 * math.pi) - math.pi) > half:
            continue
        direction = np.array([[x, y]]) / distance
        # Marched at the edge itself: a surface met more than a touch before it hides it.
        way, _ = march(np.zeros((1, 2)), direction, surfaces, reach=20.0)
        if way[0] > distance - 1e-4 and distance <= REACH:
            candidates.append(distance)
    heard = exact_echo(0.0, 0.0, axis, half, 0, surfaces, edges=True)
    assert heard == pytest.approx(min(candidates), abs=1e-9)


@settings(max_examples=30)
@given(random_surfaces(), st.integers(-180, 179), st.integers(0, 359), coordinate, coordinate)
def test_echo_does_not_depend_on_where_the_world_lies(surfaces, degrees, turn, dx, dy):
    axis, half, turn = math.radians(degrees), math.radians(10.0), math.radians(turn)
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, s], [-s, c]])

    def moved(points):
        return points @ rotation + (dx, dy)

    ends = moved(surfaces.segments.reshape(-1, 2)).reshape(-1, 4)
    circles = np.hstack([moved(surfaces.circles[:, :2]), surfaces.circles[:, 2:]])
    elsewhere = Surfaces(
        ends, circles, surfaces.critical_angles, surfaces.opaque, surfaces.solids,
        moved(surfaces.edges), moved(surfaces.marks),
    )  # fmt: skip
    here = exact_echo(0.0, 0.0, axis, half, 1, surfaces, edges=True)
    there = exact_echo(dx, dy, axis + turn, half, 1, elsewhere, edges=True)
    # A border that lies on an end or at the critical angle may fall to either side.
    nudged = {
        round(exact_echo(0.0, 0.0, axis + e, half + f, 1, surfaces, edges=True), 6)
        for e in (-1e-9, 0.0, 1e-9)
        for f in (-1e-9, 0.0, 1e-9)
    }
    assert there == pytest.approx(here, abs=1e-6) or round(there, 6) in nudged


@settings(max_examples=50)
@given(
    st.lists(st.tuples(coordinate, coordinate), min_size=3, max_size=8, unique=True),
    coordinate,
    coordinate,
)
def test_inside_counts_windings_of_star_shaped_polygons(points, x, y):
    centre = np.mean(points, axis=0)
    offset = np.array(points) - centre
    order = np.argsort(np.arctan2(offset[:, 1], offset[:, 0]))
    ring = np.array(points)[order]
    segments = np.hstack([ring, np.roll(ring, -1, axis=0)])
    if nearest_distance(x, y, segments, np.empty((0, 3)), np.empty((0, 2), int)) < 1e-6:
        return
    # The sum of the angles under which a point sees the sides is 2 pi inside, 0 outside.
    a, b = segments[:, :2] - (x, y), segments[:, 2:] - (x, y)
    seen = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)).sum()
    odd = round(seen / (2.0 * math.pi)) % 2 == 1
    assert inside(x, y, segments, np.array([[0, len(segments)]])) == odd


@given(st.floats(-50.0, 50.0))
def test_wrapped_angles_point_the_same_way(value):
    angle = wrapped(value)
    assert -math.pi <= angle <= math.pi
    assert math.cos(angle) == pytest.approx(math.cos(value), abs=1e-9)
    assert math.sin(angle) == pytest.approx(math.sin(value), abs=1e-9)


@given(coordinate, coordinate, coordinate, coordinate, coordinate, coordinate)
def test_the_foot_lies_on_the_line_and_the_way_to_it_stands_upright(x, y, x0, y0, x1, y1):
    if math.hypot(x1 - x0, y1 - y0) < 0.01:
        return
    d, normal = foot(x, y, np.array([x0, y0, x1, y1]))
    fx, fy = x + d * math.cos(normal), y + d * math.sin(normal)
    assert d >= 0.0
    assert (fx - x0) * (y1 - y0) == pytest.approx((fy - y0) * (x1 - x0), abs=1e-9)
    upright = math.cos(normal) * (x1 - x0) + math.sin(normal) * (y1 - y0)
    assert upright == pytest.approx(0.0, abs=1e-9)
