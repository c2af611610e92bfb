# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Materials, obstacles with schedules, and the surfaces of a world at a moment."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from nomad_sim.world import Circle, Material, MovingObstacle, Polygon, Wall, World


def world(**values):
    fields = {
        "name": "test",
        "origin": (0.0, 0.0),
        "size": (4.0, 3.0),
        "start": Pose2(1.0, 1.0),
        "goal": (3.0, 2.0),
        "expected": "reached",
        **values,
    }
    return World(**fields)


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def cylinder(waypoints, **values):
    return MovingObstacle(
        "can", Circle(0.0, 0.0, 0.2, "clothes"), np.array(waypoints, dtype=float), **values
    )


def test_a_wall_is_open_or_closed():
    assert Wall(SQUARE, "wood").segments.tolist() == [[0, 0, 1, 0], [1, 0, 1, 1], [1, 1, 0, 1]]
    assert Wall(SQUARE, "wood", closed=True).segments[-1].tolist() == [0, 1, 0, 0]
    assert Polygon(SQUARE, "wood").segments[-1].tolist() == [0, 1, 0, 0]


def test_surfaces_carry_their_materials():
    s = world(
        polygons=(Polygon(SQUARE, "glass"),), circles=(Circle(3, 1, 0.2, "wood"),)
    ).surfaces()
    assert s.critical_angles.tolist() == pytest.approx([math.radians(8)] * 4 + [math.radians(40)])
    assert s.opaque.tolist() == [False] * 4 + [True]
    assert len(s.solids) == 1


def test_an_obstacle_moves_straight_between_its_waypoints():
    can = cylinder([[1.0, 0.0, 0.0], [3.0, 2.0, 1.0], [4.0, 2.0, 0.0]])
    assert can.place(0.0, 0) == (0.0, 0.0)
    assert can.place(2.0, 0) == (1.0, 0.5)
    assert can.place(3.5, 0) == (2.0, 0.5)
    assert can.place(99.0, 0) == (2.0, 0.0)
    assert not can.lasting


def test_an_obstacle_comes_and_goes():
    timed = cylinder([[0.0, 1.0, 1.0]], times=(2.0, 5.0))
    assert [timed.place(t, 0) is not None for t in (1.9, 2.0, 4.9, 5.0)] == [
        False, True, True, False,
    ]  # fmt: skip
    counted = cylinder([[0.0, 1.0, 1.0]], perceptions=(1, 3))
    assert [counted.place(0.0, k) is not None for k in range(5)] == [
        False, True, True, False, False,
    ]  # fmt: skip
    assert not timed.lasting
    assert not counted.lasting
    assert cylinder([[0.0, 1.0, 1.0]]).lasting


def test_surfaces_at_a_moment_hold_what_is_there_then():
    scene = world(
        polygons=(Polygon(SQUARE, "wood"),),
        moving=(cylinder([[0.0, 2.0, 2.0], [10.0, 3.0, 2.0]], perceptions=(0, 2)),),
    )
    assert scene.surfaces(5.0, 1).circles.tolist() == [[2.5, 2.0, 0.2]]
    assert scene.surfaces(5.0, 1) is scene.surfaces(5.0, 1)
    assert scene.surfaces(0.0, 0).circles.tolist() == [[2.0, 2.0, 0.2]]
    assert len(scene.surfaces(5.0, 2).circles) == 0
    assert len(scene.surfaces(5.0, 2).segments) == 4


def test_a_moving_polygon_takes_its_edges_along():
    box = MovingObstacle("cart", Polygon(SQUARE, "wood"), np.array([[0, 0, 0], [1, 2, 1.0]]))
    edges = world(moving=(box,)).surfaces(0.5).edges
    assert {tuple(p) for p in edges} == {(1, 0.5), (2, 0.5), (2, 1.5), (1, 1.5)}


def test_other_critical_angles():
    plain = world(polygons=(Polygon(SQUARE, "glass"),))
    rough = plain.with_critical_angles({"glass": math.radians(30.0)})
    assert rough.surfaces().critical_angles.tolist() == pytest.approx([math.radians(30.0)] * 4)
    assert not rough.surfaces().opaque.any()
    assert plain.surfaces().critical_angles[0] == pytest.approx(math.radians(8.0))
    with pytest.raises(ValueError, match="did you mean 'glass'"):
        plain.with_critical_angles({"glas": 0.5})
    with pytest.raises(ValueError, match="at most 90 deg"):
        plain.with_critical_angles({"glass": 2.0})


@pytest.mark.parametrize("angle", [0.0, -0.1, math.nan, 1.6])
def test_a_material_needs_a_critical_angle(angle):
    with pytest.raises(ValueError, match="critical angle"):
        Material(angle)


def test_unknown_material_and_outcome():
    with pytest.raises(ValueError, match="unknown material 'woood'; did you mean 'wood'"):
        world(polygons=(Polygon(SQUARE, "woood"),)).surfaces()
    with pytest.raises(ValueError, match="expected outcome"):
        world(expected="perhaps")


def test_geometry_covers_the_area():
    geometry = world(origin=(-1.0, 2.0)).geometry(0.1)
    assert geometry.shape == (30, 40)
    assert geometry.origin == (-1.0, 2.0)
