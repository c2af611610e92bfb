# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The worlds behind the method's table, measured out."""

import math

import numpy as np
import pytest

from fuzzy_map_building.params import DEFAULT_PRESET, PAPER_PRESET
from nomad_sim.ground_truth import reachable
from nomad_sim.params import simulator_parameters
from nomad_sim.reference import (
    MISSIONS,
    ROWS,
    clutter,
    lab_with_gaps,
    slalom_with_openings,
    with_materials,
)
from nomad_sim.world import Circle, Polygon
from nomad_sim.world_io import load_world


@pytest.mark.parametrize("name", ROWS)
def test_the_goal_of_every_row_can_be_reached(name: str) -> None:
    row = ROWS[name]
    world = row.world(1)
    assert world.expected == "reached"
    assert reachable(world, 0.23, 0.05)
    assert 0 <= row.reached[PAPER_PRESET] <= row.reached[DEFAULT_PRESET] <= MISSIONS
    simulator_parameters(row.simulator, world.parameters)  # all known and allowed


def test_rows_carry_beam_and_materials_of_their_names() -> None:
    for name, row in ROWS.items():
        parameters = simulator_parameters(row.simulator)
        beam = float(name.split("beam_")[1]) if "beam_" in name else 10.0
        assert parameters.sonar.beam_half_angle == pytest.approx(math.radians(beam))
        assert parameters.sonar.edge_echo
        assert parameters.infrared.sees_glass
        materials = row.world(1).materials
        expected = {"cardboard": 40, "wood": 40, "painted_wall": 25, "glass": 8}
        if name.startswith("lab_"):
            box, wall, glass = (int(number) for number in name.split("_")[1:4])
            expected = {"cardboard": box, "wood": box, "painted_wall": wall, "glass": glass}
        elif "rough" in name:
            expected = dict.fromkeys(expected, 70)
        for material, angle in expected.items():
            assert materials[material].critical_angle == pytest.approx(math.radians(angle)), name


@pytest.mark.parametrize("gap", [0.65, 0.8])
def test_both_openings_of_the_lab_are_as_wide_as_said(gap: float) -> None:
    surfaces = lab_with_gaps(gap).surfaces()
    # In the middle of an opening both sides are half its width away.
    assert surfaces.distance(3.7, 2.65) == pytest.approx(0.5 * gap)
    assert surfaces.distance(3.7, 2.65 + 0.1) == pytest.approx(0.5 * gap - 0.1)
    assert surfaces.distance(3.7, 2.65 - 0.1) == pytest.approx(0.5 * gap - 0.1)
    # The other one is counted to the area's edge; the wall stands 5 cm behind it.
    middle = 7.65 - 0.5 * (gap + 0.05)
    assert surfaces.distance(middle, 4.25) == pytest.approx(0.5 * (gap + 0.05))
    assert surfaces.distance(middle - 0.1, 4.25) == pytest.approx(0.5 * (gap + 0.05) - 0.1)
    # The rest of the laboratory stays as it is.
    shipped = load_world("lab").surfaces()
    for x, y in ((1.4, 3.2), (0.2, 0.2), (3.0, 1.0), (4.4, 5.0), (2.0, 6.2)):
        assert surfaces.distance(x, y) == pytest.approx(shipped.distance(x, y))


@pytest.mark.parametrize("place", [(3.7, 2.65), (7.175, 4.25)])
def test_the_openings_of_the_shipped_lab_are_of_the_family(place: tuple[float, float]) -> None:
    shipped = load_world("lab").surfaces().distance(*place)
    assert lab_with_gaps(0.9).surfaces().distance(*place) == pytest.approx(shipped)


@pytest.mark.parametrize("width", [0.7, 0.9])
def test_the_openings_of_the_slalom_are_as_wide_as_said(width: float) -> None:
    surfaces = slalom_with_openings(width).surfaces()
    # Counted to the area's edge; the wall stands 5 cm behind it.
    half = 0.5 * (width + 0.05)
    top, bottom = 4.05 - half, -0.05 + half
    for x, y in ((1.8, top), (3.3, bottom), (4.8, top), (6.3, bottom)):
        assert surfaces.distance(x, y) == pytest.approx(half)
        assert surfaces.distance(x, y + 0.1) == pytest.approx(half - 0.1)


def test_the_slalom_of_the_table_is_the_shipped_one() -> None:
    for ours, shipped in zip(
        slalom_with_openings(0.9).polygons, load_world("slalom").polygons, strict=True
    ):
        assert ours.material == shipped.material
        assert ours.points == pytest.approx(shipped.points)


def test_materials_change_nothing_else() -> None:
    office = load_world("office")
    rough = with_materials(office, 70.0, 60.0, 50.0)
    assert rough.materials["wood"].critical_angle == pytest.approx(math.radians(70.0))
    assert rough.materials["painted_wall"].critical_angle == pytest.approx(math.radians(60.0))
    assert rough.materials["glass"].critical_angle == pytest.approx(math.radians(50.0))
    assert not rough.materials["glass"].infrared
    assert (rough.surfaces().segments == office.surfaces().segments).all()


def outline(shape: Circle | Polygon) -> np.ndarray:
    """Return points along a face, at most 5 mm apart, shape (n, 2)."""
    share = np.linspace(0.0, 1.0, 101)[:, None]
    if isinstance(shape, Circle):
        angle = 2.0 * math.pi * share
        return np.hstack(
            [shape.x + shape.radius * np.cos(angle), shape.y + shape.radius * np.sin(angle)]
        )
    ends = np.roll(shape.points, -1, axis=0)
    return np.concatenate([a + share * (b - a) for a, b in zip(shape.points, ends, strict=True)])


@pytest.mark.parametrize("seed", range(1, 6))
def test_clutter_leaves_room_everywhere(seed: int) -> None:
    world = clutter(seed)
    shapes = [*world.circles, *world.polygons]
    assert len(shapes) == 9
    assert {type(shape) for shape in shapes} == {Circle, Polygon}
    outlines = [outline(shape) for shape in shapes]
    for i, one in enumerate(outlines):
        radius = np.ptp(one, axis=0).max() / 2.0
        assert 0.12 / math.sqrt(2.0) <= radius <= 0.35 + 1e-9
        for place in (world.start.x, world.start.y), world.goal:
            assert np.hypot(*(one - np.array(place)).T).min() >= 0.6 - 1e-9
        for other in outlines[:i]:
            apart = np.hypot(*(one[:, None] - other[None, :]).transpose(2, 0, 1)).min()
            assert apart >= 0.85 - 1e-9
    assert reachable(world, 0.23, 0.05)


def test_clutter_depends_on_its_seed_alone() -> None:
    assert (clutter(3).surfaces().segments == clutter(3).surfaces().segments).all()
    assert (clutter(3).surfaces().circles != clutter(4).surfaces().circles).any()


@pytest.mark.parametrize("name", ["gaps_0.70", "slalom_0.70", "office", "clutter"])
def test_outer_walls_stand_five_centimetres_outside(name: str) -> None:
    world = ROWS[name].world(2)
    (outer,) = world.walls
    low, high = np.array(world.origin), np.array(world.origin) + np.array(world.size)
    assert outer.closed
    assert outer.points.min(axis=0) == pytest.approx(low - 0.05)
    assert outer.points.max(axis=0) == pytest.approx(high + 0.05)
