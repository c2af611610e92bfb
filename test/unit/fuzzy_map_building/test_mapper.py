# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""FuzzyMapper as its users meet it: what changes, what must not, what it costs."""

import dataclasses
import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.map_state import MAX_PERCEPTIONS, MapState
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import DEFAULT_PRESET, PAPER_PRESET, mapper_parameters
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from unit.fuzzy_map_building.ring import LAB, perception

ARRAYS = ("empty", "occupied", "motion_risk", "planning_risk", "count")


def snapshot(mapper: FuzzyMapper) -> dict[str, np.ndarray]:
    return {name: getattr(mapper, name).copy() for name in ARRAYS}


def assert_same(mapper: FuzzyMapper, before: dict[str, np.ndarray]) -> None:
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(mapper, name), before[name], err_msg=name)


def test_a_new_map_knows_nothing() -> None:
    mapper = FuzzyMapper(LAB)
    assert mapper.geometry == LAB
    assert mapper.parameters == mapper_parameters(PAPER_PRESET)
    assert mapper.perceptions == 0
    for name, value in (("empty", 0), ("occupied", 0), ("planning_risk", 0), ("count", 0)):
        assert (getattr(mapper, name) == value).all()
    assert (mapper.motion_risk == 1.0).all()


def test_maps_are_read_only_views() -> None:
    mapper = FuzzyMapper(LAB)
    view = mapper.empty
    for name in ARRAYS:
        with pytest.raises(ValueError, match="read-only"):
            getattr(mapper, name)[0, 0] = 1
    mapper.update(perception(Pose2(3.8, 3.1)))
    assert view.max() > 0.0  # a view, no copy


@pytest.mark.parametrize("preset", [DEFAULT_PRESET, PAPER_PRESET])
def test_one_perception_of_the_paper_s_ring_opens_a_way_in_every_direction(preset: str) -> None:
    # Without this the robot never starts: all cells around it must enter the beta-cut.
    mapper = FuzzyMapper(LAB, mapper_parameters(preset))
    pose = Pose2(3.83, 3.12, 0.3)
    report = mapper.update(perception(pose, ranges=3.0))
    assert (report.accepted, report.rejected, mapper.perceptions) == (48, {}, 1)
    x, y = LAB.centres()
    near = np.hypot(x[None, :] - pose.x, y[:, None] - pose.y) <= 1.45
    assert mapper.motion_risk[near].max() <= 0.9
    assert near.sum() > 600


def test_with_the_apex_at_the_mounts_it_does_not() -> None:
    mapper = FuzzyMapper(LAB, mapper_parameters(overrides={"sonar.apex": "mount"}))
    mapper.update(perception(Pose2(3.83, 3.12), ranges=3.0))
    x, y = LAB.centres()
    distance = np.hypot(x[None, :] - 3.83, y[:, None] - 3.12)
    assert mapper.motion_risk[distance < 0.4].min() > 0.9


def test_what_is_switched_off_changes_no_bit() -> None:
    # Whatever its parameters, and whatever infrareds see.
    switched_off = {
        "consistency.half_width": 0.4,
        "consistency.floor": 0.9,
        "infrared.mount_radius": 0.1,
        "infrared_evidence.certainty": 1.0,
        "sonar_guard.enabled": True,
        "sonar_guard.perception_reach": 5.0,
    }
    plain = FuzzyMapper(LAB, mapper_parameters(PAPER_PRESET))
    other = FuzzyMapper(LAB, mapper_parameters(PAPER_PRESET, switched_off))
    for seed in range(3):
        pose = Pose2(3.0 + 0.3 * seed, 3.0, 0.5 * seed)
        sonar = perception(pose, seed)
        rays = [InfraredReading(pose, math.radians(22.5 * i), 0.2) for i in range(16)]
        plain.update(sonar)
        report = other.update([*sonar[:20], *rays, *sonar[20:]])
        assert (report.accepted, report.rejected) == (48, {"no_model": 16})
        assert_same(other, snapshot(plain))


def test_infrareds_touch_their_rays_and_nothing_else() -> None:
    # Sonars and infrareds of places 2 m apart: a window that holds both, and cells of neither.
    mapper = FuzzyMapper(LAB, mapper_parameters("consistent"))
    mapper.update(perception(Pose2(3.8, 3.1), 3))
    before = snapshot(mapper)
    here, there = Pose2(5.0, 1.0), Pose2(2.0, 4.9, 1.0)
    rays = [InfraredReading(there, math.radians(22.5 * i), math.inf) for i in range(16)]
    report = mapper.update([*perception(here, 4, ranges=0.3), *rays])
    assert (report.accepted, report.infrared_accepted) == (48, 16)
    x, y = LAB.centres()
    near = np.zeros(LAB.shape, dtype=bool)
    for pose, reach in ((here, 0.63), (there, 0.83)):
        near |= np.hypot(x[None, :] - pose.x, y[:, None] - pose.y) <= reach + 1e-9
    window = np.zeros(LAB.shape, dtype=bool)
    window[report.window.slices] = True
    assert window.sum() > 2 * near.sum()
    for name in ARRAYS:
        after = getattr(mapper, name)
        np.testing.assert_array_equal(after[~near], before[name][~near])
        assert not np.array_equal(after[near], before[name][near])
    assert window[near].all()


def test_infrareds_alone_are_no_perception() -> None:
    mapper = FuzzyMapper(LAB, mapper_parameters("consistent"))
    before = snapshot(mapper)
    pose = Pose2(3.8, 3.1)
    rays = [InfraredReading(pose, 0.4 * i, 0.3) for i in range(16)]
    for sonar in ([], [SonarReading(pose, 0.0, math.nan)]):
        report = mapper.update([*sonar, *rays])
        assert (report.accepted, report.infrared_accepted) == (0, 0)
        assert report.infrared_rejected == {"no_sonar": 16}
        assert_same(mapper, before)
    assert mapper.perceptions == 0


def test_outside_the_visibility_circle_no_bit_changes() -> None:
    mapper = FuzzyMapper(LAB)
    for seed in range(6):
        mapper.update(perception(Pose2(1.0 + seed, 3.0), seed))
    before = snapshot(mapper)
    pose = Pose2(3.4, 3.3, 1.0)
    report = mapper.update(perception(pose, 99))
    x, y = LAB.centres()
    outside = np.hypot(x[None, :] - pose.x, y[:, None] - pose.y) > 1.5 + 1e-9
    window = np.zeros(LAB.shape, dtype=bool)
    window[report.window.slices] = True
    for name in ARRAYS:
        after = getattr(mapper, name)
        for untouched in (outside, ~window):
            np.testing.assert_array_equal(after[untouched], before[name][untouched])
        assert (after[~outside] != before[name][~outside]).any()


def test_the_count_grows_by_one_where_a_perception_spoke() -> None:
    mapper = FuzzyMapper(LAB)
    readings = perception(Pose2(3.8, 3.1), 1)
    mapper.update(readings)
    spoken = (mapper.empty > 0) | (mapper.occupied > 0)
    np.testing.assert_array_equal(mapper.count, spoken)
    for _ in range(4):  # beyond N_max = 3
        mapper.update(readings)
    np.testing.assert_array_equal(mapper.count, 5 * spoken)
    # The mean of equal opinions is that opinion.
    once = FuzzyMapper(LAB)
    once.update(readings)
    np.testing.assert_allclose(mapper.empty, once.empty, atol=1e-12)


@pytest.mark.parametrize("aggregation", ["mean", "dombi", "max"])
def test_a_packet_without_a_usable_reading_is_no_perception(aggregation: str) -> None:
    overrides = {"fusion.aggregation": aggregation, "infrared_evidence.enabled": False}
    mapper = FuzzyMapper(LAB, mapper_parameters(overrides=overrides))
    mapper.update(perception(Pose2(3.8, 3.1)))
    before = snapshot(mapper)
    pose = Pose2(3.8, 3.1)
    useless = {
        "nan": SonarReading(pose, 0.0, math.nan),
        "out_of_range": SonarReading(pose, 0.0, 0.05),
        "outside_map": SonarReading(Pose2(-50.0, 0.0), 0.0, 1.0),
        "no_model": InfraredReading(pose, 0.0, 1.0),
    }
    report = mapper.update([])
    assert (report.accepted, report.rejected) == (0, {})
    for reason, reading in useless.items():
        report = mapper.update([reading])
        assert (report.accepted, report.rejected) == (0, {reason: 1})
        assert report.window.empty
    report = mapper.update(list(useless.values()))
    assert report.rejected == dict.fromkeys(useless, 1)
    assert mapper.perceptions == 1
    assert_same(mapper, before)


@pytest.mark.parametrize("packet", [None, 3.0, SonarReading(Pose2(1.0, 1.0), 0.0, 1.0)])
def test_what_is_no_packet_is_refused(packet: object) -> None:
    mapper = FuzzyMapper(LAB)
    kind = type(packet).__name__
    with pytest.raises(ValueError, match=f"sequence of readings, got a {kind}"):
        mapper.update(packet)  # type: ignore[arg-type]
    assert mapper.perceptions == 0


def test_a_packet_with_a_stranger_is_refused_whole() -> None:
    mapper = FuzzyMapper(LAB)
    before = snapshot(mapper)
    with pytest.raises(ValueError, match="reading 1 of the packet is a float"):
        mapper.update([SonarReading(Pose2(3.8, 3.1), 0.0, 1.0), 2.0])  # type: ignore[list-item]
    assert_same(mapper, before)
    assert mapper.perceptions == 0


def test_a_failure_inside_leaves_the_map_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    mapper = FuzzyMapper(LAB)
    mapper.update(perception(Pose2(3.8, 3.1)))
    before = snapshot(mapper)

    def fail(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(mapper._rule, "risks", fail)
    with pytest.raises(MemoryError):
        mapper.update(perception(Pose2(3.8, 3.1), 1))
    assert_same(mapper, before)
    assert mapper.perceptions == 1


def test_a_turned_world_gives_a_turned_map() -> None:
    # A quarter turn of everything maps cells onto cells.
    square = GridGeometry(60, 60, 0.1, (-3.0, -3.0))
    straight, turned = FuzzyMapper(square), FuzzyMapper(square)
    straight.update(perception(Pose2(0.73, 0.41, 0.2), 4))
    turned.update(perception(Pose2(-0.41, 0.73, 0.2 + math.pi / 2), 4))
    for name in ("empty", "occupied", "motion_risk", "planning_risk"):
        np.testing.assert_allclose(
            np.rot90(getattr(straight, name), -1), getattr(turned, name), atol=1e-9
        )


def test_a_wall_is_seen_as_a_wall() -> None:
    # Ranges as a wall at y = 4 gives them to sonars that see it under less than 25 degrees.
    mapper = FuzzyMapper(LAB)
    for x in np.arange(2.0, 6.0, 0.2):
        pose = Pose2(float(x), 3.0)
        ranges = [0.77 if abs(b - 90) <= 12.5 else math.inf for b in (7.5 * k for k in range(48))]
        mapper.update([SonarReading(pose, math.radians(7.5 * k), r) for k, r in enumerate(ranges)])
    # The centre plus the mount radius: the wall stands 1 m away.
    _, y = LAB.centres()
    found = y[mapper.occupied[:, 25:55].argmax(axis=0)]
    assert np.abs(found - 4.0).max() <= 0.051
    assert mapper.motion_risk[30, 25:55].max() < 0.5
    assert mapper.motion_risk[45:, :].min() == 1.0


def test_reset_forgets_all() -> None:
    mapper = FuzzyMapper(LAB)
    fresh = snapshot(mapper)
    mapper.update(perception(Pose2(3.8, 3.1)))
    mapper.reset()
    assert_same(mapper, fresh)
    assert mapper.perceptions == 0


def test_state_is_a_copy_and_restores_exactly() -> None:
    mapper = FuzzyMapper(LAB)
    mapper.update(perception(Pose2(3.8, 3.1)))
    state = mapper.state()
    then = snapshot(mapper)
    mapper.update(perception(Pose2(4.0, 3.1), 1))
    assert (state.empty == then["empty"]).all()
    other = FuzzyMapper(LAB)
    other.restore(state)
    assert_same(other, then)
    assert other.perceptions == 1
    # And goes on as if nothing had happened; the state stays what it was.
    other.update(perception(Pose2(4.0, 3.1), 1))
    assert_same(other, snapshot(mapper))
    assert (state.empty == then["empty"]).all()


def test_what_can_be_counted_ends_and_the_state_stays_one() -> None:
    mapper = FuzzyMapper(LAB)
    report = mapper.update(perception(Pose2(3.8, 3.1)))
    state = mapper.state()
    full = np.where(state.count > 0, MAX_PERCEPTIONS, 0).astype(state.count.dtype)
    mapper.restore(dataclasses.replace(state, count=full, perceptions=MAX_PERCEPTIONS))
    assert mapper.update(perception(Pose2(3.8, 3.1))).accepted == report.accepted
    after = mapper.state()  # which a file takes: it checks itself
    assert after.perceptions == after.count.max() == MAX_PERCEPTIONS
    assert (after.empty > state.empty).any()


def test_risks_of_a_window_are_those_of_the_whole_maps() -> None:
    mapper, asked = FuzzyMapper(LAB), FuzzyMapper(LAB)
    for seed in range(4):
        readings = perception(Pose2(2.0 + seed, 3.0), seed)
        report = mapper.update(readings)
        asked.update(readings)
        # One that keeps its risk maps from the start, and one that is asked by windows only.
        for window in (report.window, Window(0, 63, 0, 76), Window(20, 21, 30, 40)):
            motion, planning = mapper.risks(window)
            np.testing.assert_array_equal(asked.motion_risk[window.slices], motion)
            np.testing.assert_array_equal(asked.planning_risk[window.slices], planning)
    assert mapper._kept_risks is None


def test_a_state_of_another_grid_is_refused() -> None:
    mapper = FuzzyMapper(LAB)
    mapper.update(perception(Pose2(3.8, 3.1)))
    before = snapshot(mapper)
    state = FuzzyMapper(GridGeometry(76, 63, 0.1, (0.1, 0.0))).state()
    with pytest.raises(ValueError, match="area and resolution of the saved map"):
        mapper.restore(state)
    assert_same(mapper, before)


def bad_states() -> list[tuple[dict, str]]:
    e = np.zeros((2, 3))
    n = np.zeros((2, 3), dtype=np.int32)
    return [
        ({"empty": e[:1]}, r"the array 'empty' has shape \(1, 3\)"),
        ({"empty": e.astype(np.float32)}, "the array 'empty' must be of float64"),
        ({"occupied": [[0.0]]}, "the array 'occupied' must be of float64, got list"),
        ({"occupied": e + 1.5}, r"the beliefs 'occupied' are not all in \[0, 1\]"),
        ({"empty": e - 0.1}, r"not all in \[0, 1\]"),
        ({"empty": e * math.nan}, r"not all in \[0, 1\]"),
        ({"count": n - 1}, "negative"),
        ({"count": n + 9}, "a cell counts 9 perceptions, more than the 5 of the map"),
        ({"perceptions": 5.0}, "must be whole"),
        ({"perceptions": True}, "must be whole"),
        ({"perceptions": None}, "must be whole"),
        ({"perceptions": -1}, "more than the -1 of the map"),
    ]


@pytest.mark.parametrize(("values", "message"), bad_states())
def test_a_state_is_checked(values: dict, message: str) -> None:
    good = {
        "empty": np.zeros((2, 3)),
        "occupied": np.zeros((2, 3)),
        "count": np.zeros((2, 3), dtype=np.int32),
        "perceptions": 5,
    }
    MapState(GridGeometry(3, 2, 0.1), **good)
    with pytest.raises(ValueError, match=message):
        MapState(GridGeometry(3, 2, 0.1), **{**good, **values})
