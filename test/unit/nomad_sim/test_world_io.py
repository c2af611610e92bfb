# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""World files: what is read, and that nothing hostile or misspelt gets through."""

import math
import textwrap

import numpy as np
import pytest

from nomad_sim import world_io, yaml_document
from nomad_sim.params import ROBOT_RADIUS
from nomad_sim.places import check_places
from nomad_sim.reference import ROWS
from nomad_sim.world_io import WorldError, load_world, parse_world, world_names
from nomad_sim.worlds import KINDS, generate

GOOD = textwrap.dedent("""
    name: hall
    description: a test
    area: {origin: [0.0, 0.0], size: [6, 4]}
    start: {position: [1.0, 1.0], heading_deg: 90}
    goal: {position: [5.0, 3.0]}
    expected: reached
    materials:
      felt: {critical_angle_deg: 55.0, infrared: false}
    walls:
      - {points: [[0, 0], [6, 0], [6, 4], [0, 4]], material: painted_wall, closed: true}
      - {points: [[2, 0], [2, 1.5]], material: felt}
    polygons:
      - {points: [[3, 1], [4, 1], [3.5, 2]], material: wood}
    circles:
      - {center: [4.5, 3.5], radius: 0.2, material: glass}
    moving:
      - name: person
        material: clothes
        radius: 0.25
        waypoints: [[0, 1, 3], [10, 5, 3]]
        times: [2, 8]
      - name: cart
        material: wood
        points: [[-0.2, -0.2], [0.2, -0.2], [0, 0.2]]
        waypoints: [[0, 3, 3]]
        perceptions: [0, 16]
    parameters:
      sonar: {beam_half_angle: 0.218}
""")


def test_everything_is_read():
    world = parse_world(GOOD)
    assert (world.name, world.expected, world.goal) == ("hall", "reached", (5.0, 3.0))
    assert (world.start.x, world.start.y) == (1.0, 1.0)
    assert world.start.theta == pytest.approx(math.pi / 2)
    assert (world.origin, world.size) == ((0.0, 0.0), (6.0, 4.0))
    assert [w.closed for w in world.walls] == [True, False]
    assert world.materials["felt"].critical_angle == pytest.approx(math.radians(55.0))
    assert not world.materials["felt"].infrared
    assert world.circles[0].radius == 0.2
    person, cart = world.moving
    assert person.times == (2.0, 8.0)
    assert person.perceptions == (0.0, math.inf)
    assert cart.perceptions == (0.0, 16.0)
    assert cart.waypoints.tolist() == [[0.0, 3.0, 3.0]]
    assert dict(world.parameters) == {"sonar": {"beam_half_angle": 0.218}}
    assert world.description == "a test"


def test_the_documented_example_is_a_world():
    example = textwrap.dedent(world_io.__doc__.split("All keys::")[1])
    world = parse_world(example)
    assert world.name == "hall"
    assert world.moving[0].perceptions == (0.0, 16.0)


def changed(old, new):
    assert old in GOOD
    return GOOD.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("goal:", "gaol:", "unknown key 'gaol'; did you mean 'goal'"),
        ("closed: true", "close: true", r"walls\[0\]: .* did you mean 'closed'"),
        (
            "radius: 0.2,",
            "radios: 0.2,",
            r"circles\[0\]: .* did you mean 'radius'",
        ),
        (
            "material: wood}",
            "material: wod}",
            r"^polygons\[0\].material: 'wod' is unknown; did you mean 'wood'\?$",
        ),
        ("material: wood}", "material: 7}", r"polygons\[0\].material: one of .* expected, got 7$"),
        ("expected: reached", "expected: reach", "expected: .*did you mean 'reached'"),
        ("heading_deg: 90", "heading: 90", "start: .* did you mean 'heading_deg'"),
        ("critical_angle_deg", "critical_angle", "did you mean 'critical_angle_deg'"),
        (
            "beam_half_angle",
            "beam_half_angel",
            "parameters: .*did you mean 'sonar.beam_half_angle",
        ),
        ("name: hall\n", "", "the world: key 'name' is missing"),
        ("name: hall", "name: []", "name: a text"),
        ("name: hall", "name: !!timestamp x", "not of the kind that its tag tells"),
        ("name: hall", "name: !!int ''", "not of the kind that its tag tells"),
        ("name: hall", "name: !!bool maybe", "not of the kind that its tag tells"),
        ("size: [6, 4]", "size: [6]", "area.size: a list of 2 numbers"),
        ("size: [6, 4]", "size: [6, -4]", "area.size"),
        ("size: [6, 4]", "size: [6, 0]", "area.size"),
        ("size: [6, 4]", "size: [6, .nan]", r"area.size\[1\]: a number"),
        ("size: [6, 4]", "size: [1e9, 4]", r"area.size\[0\]: a number"),
        (
            "position: [5.0, 3.0]",
            "position: [7.0, 3.0]",
            r"goal.position: \(7, 3\) m lies outside",
        ),
        ("position: [1.0, 1.0]", "position: [.inf, 1]", r"start.position\[0\]: a number"),
        ("position: [1.0, 1.0]", "position: [true, 1]", r"start.position\[0\]: a number"),
        ("position: [1.0, 1.0]", "position: ['1', 1]", r"start.position\[0\]: a number"),
        ("radius: 0.2,", "radius: 2e-1,", "got '2e-1', which is a text to YAML; write 0.2 w"),
        ("radius: 0.2,", "radius: '2.5e+15',", "is a text to YAML; write 2500000000000000.0 w"),
        ("radius: 0.2,", "radius: ,", r"circles\[0\].radius: a number expected, got nothing"),
        ("heading_deg: 90", "heading_deg: 1.0e+400", "heading_deg: a number"),
        ("radius: 0.2,", "radius: -0.2,", r"circles\[0\].radius: a number from 0.001"),
        ("radius: 0.2,", "radius: 0,", r"circles\[0\].radius"),
        (
            "critical_angle_deg: 55.0",
            "critical_angle_deg: 95",
            "felt.critical_angle_deg: a n",
        ),
        ("critical_angle_deg: 55.0", "critical_angle_deg: 0", "felt.critical_angle_deg: a n"),
        ("infrared: false", "infrared: 0", "felt.infrared: true or false"),
        ("[3.5, 2]", "[4, 1]", r"polygons\[0\]: the side from point 1 is shorter"),
        ("[3.5, 2]", "[3.5, 1]", r"polygons\[0\]: the polygon folds back on itself"),
        ("[[3, 1], [4, 1], [3.5, 2]]", "[[3, 1], [4, 1]]", r"polygons\[0\].points: at leas"),
        (
            "[[3, 1], [4, 1], [3.5, 2]]",
            "[[3, 1], [4, 2], [4, 1], [3, 2]]",
            r"polygons\[0\]: .* crosses or touches itself: its sides from points 0 and 2",
        ),
        (
            "[[3, 1], [4, 1], [3.5, 2]]",
            "[[3, 1], [5, 1], [5, 2], [4, 1], [3, 2]]",
            r"polygons\[0\]: the polygon crosses or touches itself",
        ),
        ("[[2, 0], [2, 1.5]]", "[[2, 0]]", r"walls\[1\].points: at least 2"),
        ("[[2, 0], [2, 1.5]]", "[[2, 0], [2]]", r"walls\[1\].points\[1\]: a list of 2 numbers"),
        ("[[2, 0], [2, 1.5]]", "nothing", r"walls\[1\].points: a list"),
        ("[[0, 1, 3], [10, 5, 3]]", "[[0, 1, 3], [0, 5, 3]]", "waypoints must increase"),
        ("[[0, 1, 3], [10, 5, 3]]", "[]", "at least one waypoint"),
        ("[[0, 1, 3], [10, 5, 3]]", "[[0, 1]]", r"waypoints\[0\]: \[time, x, y\]"),
        ("times: [2, 8]", "times: [8, 2]", r"moving\[0\].times: until \(2\) must be after"),
        ("times: [2, 8]", "times: [2]", r"moving\[0\].times: \[from, until\]"),
        ("radius: 0.25\n", "points: []\n", r"moving\[0\].points: at least 3"),
        ("    radius: 0.25\n", "", r"moving\[0\]: give its shape by either"),
        ("sonar: {beam_half_angle: 0.218}", "[]", "parameters: a mapping"),
        (
            "sonar: {beam_half_angle: 0.218}",
            "sonar: {range_noise: -1}",
            "parameters: .*at least 0",
        ),
        ("name: hall", "name: hall\nname: room", "'name' is repeated"),
        ("name: hall", "1: hall", "a key must be a text"),
        ("name: hall", "name: &x hall\nnom: *x", r"aliases \(\*x\) are not allowed"),
        ("name: hall", "name: !!python/object:os.system hall", "no YAML document"),
        ("name: hall", "name: [", r"no YAML document: line \d+, column \d+: expected"),
        ("name: hall", "name: 2024-13-45", "a value that cannot be read"),
        ("name: hall", "name: 1:20", r"line 2: 1:20 is 80 to YAML, .* base 60; .*'1:20' if it is"),
        ("size: [6, 4]", "size: [6, 0:04.5]", r"line \d: 0:04.5 is 4.5 to YAML"),
        ("name: hall", "name: 1" + ":0" * 200, "a number is too large"),
        ("size: [6, 4]", "size: [6, 010]", r"line \d: 010 is 8 to YAML, .* base 8"),
    ],
)
def test_what_is_wrong_is_named(old, new, message):
    with pytest.raises(WorldError, match=message):
        parse_world(changed(old, new))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "position: [5.0, 3.0]",
            "position: [3.5, 1.1]",
            r"^goal.position: \(3.5, 1.1\) m lies inside polygons\[0\], 0.10 m from its surface; "
            r"move the goal, or write 'expected: unreachable'$",
        ),
        ("position: [5.0, 3.0]", "position: [4.5, 3.5]", r"inside circles\[0\], 0.20 m from"),
        (
            "position: [5.0, 3.0]",
            "position: [5.8, 3.0]",
            r"^goal.position: \(5.8, 3\) m is 0.20 m from walls\[0\], and the robot's body has a "
            r"radius of 0.23 m; move the goal",
        ),
        (
            "position: [1.0, 1.0]",
            "position: [1.8, 1.0]",
            r"^start.position: \(1.8, 1\) m is 0.20 m from walls\[1\], .* 0.23 m; move the start, "
            r"or give the robot a smaller robot.radius under 'parameters'$",
        ),
        ("position: [1.0, 1.0]", "position: [3.0, 3.0]", r"^start.position: .* moving\[1\]"),
        (
            "[[2, 0], [2, 1.5]], material: felt",
            "[[4, 2.2], [5.9, 2.2], [5.9, 3.9], [4, 3.9]], closed: true, material: felt",
            r"^goal.position: every way from the start to \(5, 3\) m crosses walls\[1\], a closed "
            r"line; open it, move the goal, or write 'expected: unreachable'$",
        ),
    ],
)
def test_a_mission_that_cannot_be_as_it_is_claimed_is_refused(old, new, message):
    with pytest.raises(WorldError, match=message):
        parse_world(changed(old, new))
    if "goal" in message:  # it may be that nobody can get there, if the world says so
        text = changed(old, new).replace("expected: reached", "expected: unreachable")
        assert parse_world(text).expected == "unreachable"


def test_what_comes_later_is_in_nobodys_way_and_the_robot_may_be_smaller():
    # The person stands at (1, 3) from the 2nd second on, the cart goes after 16 perceptions.
    assert parse_world(changed("position: [1.0, 1.0]", "position: [1.0, 3.0]")).start.y == 3.0
    assert parse_world(changed("position: [5.0, 3.0]", "position: [3.0, 3.0]")).goal == (3.0, 3.0)
    small = changed("position: [1.0, 1.0]", "position: [1.8, 1.0]").replace(
        "sonar: {beam_half_angle: 0.218}", "robot: {radius: 0.19}"
    )
    assert parse_world(small).start.x == 1.8


def test_drawn_worlds_and_those_of_the_paper_leave_the_robot_room():
    for row in ROWS.values():
        check_places(row.world(1), ROBOT_RADIUS)
    for kind in KINDS:
        check_places(generate(kind, 1), ROBOT_RADIUS)


@pytest.mark.parametrize("text", ["", "hall", "[]", "- name: hall", "null", "42"])
def test_what_is_no_world(text):
    with pytest.raises(WorldError, match="a mapping with the keys"):
        parse_world(text)


def test_deep_nesting_ends_in_a_message():
    with pytest.raises(WorldError, match="nested too deeply"):
        parse_world("[" * 50_000)
    deep = "{a: " * 900 + "1" + "}" * 900
    with pytest.raises(WorldError, match=r"nested too deeply|unknown parameter"):
        parse_world(changed("sonar: {beam_half_angle: 0.218}", f"sonar: {deep}"))


def test_a_billion_laughs_end_at_the_first_alias():
    lines = ["a: &a [x, x, x, x, x, x, x, x, x]"]
    for before, name in zip("abcdefgh", "bcdefghi", strict=True):
        lines.append(f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]")
    with pytest.raises(WorldError, match="aliases"):
        parse_world("\n".join(lines))


def test_sizes_are_bounded():
    with pytest.raises(WorldError, match="characters are more than"):
        parse_world("#" * (yaml_document.MAX_BYTES + 1))
    many = "[" + ", ".join(["[1, 1]"] * (yaml_document.MAX_ENTRIES + 1)) + "]"
    with pytest.raises(WorldError, match=r"walls\[1\].points: 4001 entries are more than"):
        parse_world(changed("[[2, 0], [2, 1.5]]", many))
    points = [f"[{k % 2}, {k / 1000}]" for k in range(2100)]
    walls = f"  - {{points: [{', '.join(points)}], material: wood}}\n"
    with pytest.raises(WorldError, match="corners are more than the 4000 allowed"):
        parse_world(changed("polygons:\n", f"{walls}{walls}polygons:\n"))


def test_a_huge_number_is_refused_and_not_printed():
    with pytest.raises(WorldError, match="a number from") as refused:
        parse_world(changed("radius: 0.2,", f"radius: 0x{'f' * 20_000},"))
    assert len(str(refused.value)) < 500


def test_an_outline_that_crosses_too_often_is_refused():
    ends = [f"[[0, {k / 50}], [6, {k / 50}]]" for k in range(150)]
    ends += [f"[[{k / 50 + 1}, 0], [{k / 50 + 1}, 4]]" for k in range(150)]
    walls = "\n".join(f"  - {{points: {e}, material: wood}}" for e in ends)
    with pytest.raises(WorldError, match="cross each other"):
        parse_world(changed("polygons:\n", f"{walls}\npolygons:\n"))


def test_random_polygons_cross_exactly_when_two_sides_do():
    """Compare with a scalar test of every pair of sides."""

    def orientation(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    rng = np.random.default_rng(7)
    outcomes = set()
    for _ in range(150):
        points = rng.random((int(rng.integers(4, 7)), 2)).round(3) * 3.0 + 0.5
        n = len(points)
        crossing = any(
            orientation(points[i], points[(i + 1) % n], points[j])
            * orientation(points[i], points[(i + 1) % n], points[(j + 1) % n])
            < 0
            and orientation(points[j], points[(j + 1) % n], points[i])
            * orientation(points[j], points[(j + 1) % n], points[(i + 1) % n])
            < 0
            for i in range(n)
            for j in range(i + 2, n)
            if (i, j) != (0, n - 1)
        )
        text = changed("[[3, 1], [4, 1], [3.5, 2]]", str(points.tolist()))
        text = text.replace("position: [1.0, 1.0]", "position: [5.5, 1.0]")  # beside all of them
        outcomes.add(crossing)
        if crossing:
            with pytest.raises(WorldError, match="crosses or touches itself"):
                parse_world(text)
        else:
            assert parse_world(text).polygons[0].points.tolist() == points.tolist()
    assert outcomes == {True, False}


class TestLoading:
    def test_by_name_and_by_path(self, tmp_path):
        assert load_world("lab").name == "lab"
        path = tmp_path / "hall.yaml"
        path.write_text(GOOD)
        assert load_world(path).name == "hall"
        assert load_world(str(path)).name == "hall"

    def test_a_misspelt_name(self):
        with pytest.raises(WorldError, match="unknown world 'labb'; did you mean 'lab'"):
            load_world("labb")

    def test_what_cannot_be_read(self, tmp_path):
        with pytest.raises(WorldError, match=r"cannot read world .*missing.yaml"):
            load_world(tmp_path / "missing.yaml")
        with pytest.raises(WorldError, match="cannot read world"):
            load_world(f"{tmp_path}/")
        binary = tmp_path / "binary.yaml"
        binary.write_bytes(b"\xff\xfe\x00\x01")
        with pytest.raises(WorldError, match="cannot read world"):
            load_world(binary)

    def test_the_file_is_named(self, tmp_path):
        path = tmp_path / "hall.yaml"
        path.write_text(GOOD.replace("goal:", "gaol:"))
        with pytest.raises(WorldError, match=r"hall.yaml: the world: unknown key 'gaol'"):
            load_world(path)

    def test_an_endless_file_is_not_read_to_its_end(self, tmp_path):
        path = tmp_path / "big.yaml"
        path.write_text(GOOD + "#" * 2_000_000)
        with pytest.raises(WorldError, match="more than"):
            load_world(path)

    def test_installed_worlds_are_found(self, tmp_path, monkeypatch):
        prefix = tmp_path / "install" / "nomad_sim"
        module = prefix / "lib" / "python3" / "site-packages" / "nomad_sim" / "world_io.py"
        monkeypatch.setattr(world_io, "__file__", str(module))
        with pytest.raises(FileNotFoundError, match="not installed"):
            world_names()
        share = prefix / "share" / "nomad_sim" / "worlds"
        share.mkdir(parents=True)
        (share / "hall.yaml").write_text(GOOD)
        assert world_names() == ["hall"]
        assert load_world("hall").name == "hall"
