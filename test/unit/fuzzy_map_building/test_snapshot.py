# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Snapshots: equal to the state, written in the middle of the work, taken over or refused."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from fuzzy_map_building import map_io
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_io import MapFileError, load_map, save_map
from fuzzy_map_building.map_state import MapState
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.snapshot import Snapshot, rules_of
from fuzzy_map_building.types import Pose2, SonarReading

GEOMETRY = GridGeometry(90, 70, 0.1)


def new_mapper(parameters: MapperParameters | None = None) -> FuzzyMapper:
    return FuzzyMapper(GEOMETRY, parameters if parameters is not None else mapper_parameters())


def packet(rng: random.Random) -> list[SonarReading]:
    """Return a ring of readings from anywhere, near the borders as well."""
    pose = Pose2(rng.uniform(0.0, 9.0), rng.uniform(0.0, 7.0))
    return [SonarReading(pose, 0.4 * i, rng.uniform(0.3, 2.0)) for i in range(16)]


def assert_equal(state: MapState, mapper: FuzzyMapper) -> None:
    assert (state.geometry, state.perceptions) == (mapper.geometry, mapper.perceptions)
    for name in ("empty", "occupied", "count"):
        np.testing.assert_array_equal(getattr(state, name), getattr(mapper, name))


def test_each_snapshot_is_the_state_at_its_taking(tmp_path: Path) -> None:
    mapper, rng = new_mapper(), random.Random(1)
    snapshot = Snapshot(tmp_path / "s.map", rules_of(mapper.parameters))
    assert not snapshot.due
    for step in range(30):
        for _ in range(rng.randrange(3)):
            snapshot.changed(mapper.update(packet(rng)).window)
        if step == 20:
            mapper.reset()
            snapshot.discard()
            assert os.listdir(tmp_path) == []
        if not snapshot.due:
            continue
        snapshot.take(mapper)
        taken = mapper.state()
        # The mapper goes on before the write: what is written must not.
        later = mapper.update(packet(rng))
        snapshot.write()
        written = load_map(tmp_path / "s.map")
        assert written.perceptions == taken.perceptions
        for name in ("empty", "occupied", "count"):
            np.testing.assert_array_equal(getattr(written, name), getattr(taken, name))
        snapshot.changed(later.window)
        assert snapshot.due


def test_a_mapper_goes_on_where_the_one_before_was(tmp_path: Path) -> None:
    one, rng = new_mapper(), random.Random(2)
    for _ in range(5):
        one.update(packet(rng))
    file = tmp_path / "s.map"
    before = Snapshot(file, rules_of(one.parameters, node="/robot"))
    before.changed()
    before.take(one)
    before.write()
    # As a write that was killed leaves it; others' files are none of ours.
    (tmp_path / f".s.map.{'a1' * 8}.tmp").write_bytes(b"half")
    (tmp_path / f".t.map.{'a1' * 8}.tmp").write_bytes(b"another's")
    other = new_mapper()
    after = Snapshot(file, rules_of(other.parameters, node="/robot"))
    assert after.restore(other)
    assert not after.due
    assert_equal(one.state(), other)
    assert sorted(os.listdir(tmp_path)) == [f".t.map.{'a1' * 8}.tmp", "s.map"]
    more = packet(rng)
    one.update(more)
    after.changed(other.update(more).window)
    assert_equal(one.state(), other)
    np.testing.assert_array_equal(one.motion_risk, other.motion_risk)
    np.testing.assert_array_equal(one.planning_risk, other.planning_risk)
    after.take(other)
    after.write()
    assert_equal(load_map(file), other)


def test_where_there_is_none_nothing_is_restored(tmp_path: Path) -> None:
    mapper = new_mapper()
    assert not Snapshot(tmp_path / "s.map", rules_of(mapper.parameters)).restore(mapper)
    assert mapper.perceptions == 0


@pytest.mark.parametrize(
    ("geometry", "overrides", "node", "reason"),
    [
        (GEOMETRY, {"fusion.max_count": 7}, "/a", "fusion.max_count is 3 there and 7 here"),
        (GEOMETRY, {"sonar.bearings": (0.0,), "sonar.frame_ids": ("s",)}, "/a", "sonar.bearings"),
        (GEOMETRY, {}, "/b", "node is '/a' there and '/b' here"),
        (GEOMETRY, {}, "/" + 60_000 * "b", r"node is '/a' there and '/b+\.\.\.b+' here"),
        (GridGeometry(90, 71, 0.1), {}, "/a", "the area and resolution of the saved map"),
        (GridGeometry(90, 70, 0.1, (0.1, 0.0)), {}, "/a", "area and resolution"),
    ],
)
def test_a_snapshot_of_another_map_is_refused_and_kept(
    tmp_path: Path, geometry: GridGeometry, overrides: dict, node: str, reason: str
) -> None:
    mapper = new_mapper()
    mapper.update(packet(random.Random(3)))
    file = tmp_path / "s.map"
    snapshot = Snapshot(file, rules_of(mapper.parameters, node="/a"))
    snapshot.changed()
    snapshot.take(mapper)
    snapshot.write()
    parameters = mapper_parameters(overrides=overrides)
    other = FuzzyMapper(geometry, parameters)
    refusing = Snapshot(file, rules_of(parameters, node=node))
    with pytest.raises(MapFileError, match=f"{reason}.*set aside as 's.map.refused'"):
        refusing.restore(other)
    assert other.perceptions == 0
    assert other.empty.max() == 0.0
    assert os.listdir(tmp_path) == ["s.map.refused"]
    assert_equal(load_map(tmp_path / "s.map.refused"), mapper)
    assert not refusing.restore(other)


def test_what_does_not_bear_on_beliefs_may_differ() -> None:
    changed = {
        "mode": "continuous",
        "packet_size": 16,
        "turret.timeout": 9.0,
        "snapshot.period": 2,
    }
    assert rules_of(mapper_parameters(overrides=changed)) == rules_of(mapper_parameters())


@pytest.mark.parametrize("damage", ["cut", "map without parameters", "parameters of a kind"])
def test_what_is_no_snapshot_is_refused(tmp_path: Path, damage: str) -> None:
    mapper, file = new_mapper(), tmp_path / "s.map"
    mapper.update(packet(random.Random(4)))
    parameters = {"": 1} if damage == "parameters of a kind" else None
    save_map(file, mapper.state(), parameters)
    if damage == "cut":
        file.write_bytes(file.read_bytes()[:-100])
    other = new_mapper()
    with pytest.raises(MapFileError, match="set aside"):
        Snapshot(file, rules_of(other.parameters)).restore(other)
    assert other.perceptions == 0
    assert os.listdir(tmp_path) == ["s.map.refused"]


def test_a_failed_write_leaves_the_snapshot_before_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mapper, rng = new_mapper(), random.Random(5)
    snapshot = Snapshot(tmp_path / "s.map", rules_of(mapper.parameters))
    snapshot.changed(mapper.update(packet(rng)).window)
    snapshot.take(mapper)
    snapshot.write()
    before = mapper.state()
    snapshot.changed(mapper.update(packet(rng)).window)
    snapshot.take(mapper)

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(map_io.os, "fsync", fail)
    with pytest.raises(MapFileError, match="No space left"):
        snapshot.write()
    monkeypatch.undo()
    assert os.listdir(tmp_path) == ["s.map"]
    np.testing.assert_array_equal(load_map(tmp_path / "s.map").empty, before.empty)
    snapshot.write()
    assert_equal(load_map(tmp_path / "s.map"), mapper)


#: Writes one snapshot after the other until it is killed.
WRITER = """
import sys
from pathlib import Path
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.snapshot import Snapshot, rules_of

mapper = FuzzyMapper(GridGeometry(300, 300, 0.1))
snapshot = Snapshot(Path(sys.argv[1]), rules_of(mapper.parameters))
while True:
    snapshot.changed()
    snapshot.take(mapper)
    snapshot.write()
    print(flush=True)
"""


def test_a_writer_that_is_killed_leaves_a_whole_snapshot(tmp_path: Path) -> None:
    rng, file = random.Random(6), tmp_path / "s.map"
    mapper = FuzzyMapper(GridGeometry(300, 300, 0.1))
    for _ in range(4):
        writer = subprocess.Popen(
            [sys.executable, "-c", WRITER, str(file)], stdout=subprocess.PIPE
        )
        assert writer.stdout is not None
        writer.stdout.readline()
        time.sleep(rng.uniform(0.0, 0.05))  # the point is to kill it anywhere
        writer.send_signal(signal.SIGKILL)
        writer.wait()
        writer.stdout.close()
        assert Snapshot(file, rules_of(mapper.parameters)).restore(mapper)
        assert os.listdir(tmp_path) == ["s.map"]
