# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A mapper under anything in any order: packets good and bad, files, parameters, time."""

from __future__ import annotations

import math
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_folder import MapFolder
from fuzzy_map_building.map_io import load_map, save_map
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.types import InfraredReading, Pose2, RangeReading, SonarReading

AREA = {"area.size_x": 2.0, "area.size_y": 1.6, "area.resolution": 0.1}
NAMES = ("a", "b", "deep/c", "../out", "/etc/passwd", "up/out", "")
#: What no packet can use: by the reading itself, or for where it was taken.
UNUSABLE = (math.nan, -1.0, 0.01, 99.0, 6.6)
USABLE = (0.4, 0.8, 2.0, math.inf)


@dataclass
class Model:
    """What the map has to be: the arrays and the number of perceptions."""

    arrays: list[np.ndarray]
    perceptions: int


def snapshot(mapper: FuzzyMapper) -> Model:
    arrays = [mapper.empty, mapper.occupied, mapper.count, mapper.motion_risk]
    return Model([a.copy() for a in (*arrays, mapper.planning_risk)], mapper.perceptions)


def same(a: Model, b: Model) -> bool:
    return a.perceptions == b.perceptions and all(map(np.array_equal, a.arrays, b.arrays))


class AnyMapper(RuleBasedStateMachine):
    """Every step is held against what the step before left."""

    @initialize(preset=st.sampled_from(["oriolo1998", "consistent", "sparse_ring"]))
    def begin(self, preset: str) -> None:
        self.preset = preset
        self.parameters = mapper_parameters(preset, AREA)
        self.mapper = FuzzyMapper(self.parameters.area.geometry(), self.parameters)
        self.assembler = ReadingAssembler(self.parameters)
        self.top = Path(tempfile.mkdtemp())
        (self.top / "maps" / "deep").mkdir(parents=True)
        (self.top / "maps" / "up").symlink_to("..")
        self.folder = MapFolder(str(self.top / "maps"))
        self.files: dict[str, Model] = {}
        self.now = 1000.0
        self.handed = self.out = 0
        self.known = snapshot(self.mapper)

    def teardown(self) -> None:
        shutil.rmtree(self.top)

    @rule(
        place=st.sampled_from([(1.0, 0.8), (0.3, 0.3), (1.95, 1.55)]),
        ranges=st.lists(st.sampled_from(USABLE + UNUSABLE), max_size=5),
        rays=st.lists(st.sampled_from(USABLE + UNUSABLE), max_size=3),
    )
    def packet(self, place: tuple[float, float], ranges: list[float], rays: list[float]) -> None:
        pose = Pose2(*place, 0.3)
        readings: list[RangeReading] = [
            SonarReading(pose, 0.9 * k, value) for k, value in enumerate(ranges)
        ]
        readings += [InfraredReading(pose, 0.4 * k, value) for k, value in enumerate(rays)]
        report = self.mapper.update(readings)
        assert report.accepted + sum(report.rejected.values()) >= len(ranges)
        if not set(ranges) & set(USABLE):
            assert report.accepted == 0
        if report.accepted == 0:
            assert same(snapshot(self.mapper), self.known)
        else:
            assert self.mapper.perceptions == self.known.perceptions + 1
            grown = self.mapper.count - self.known.arrays[2]
            assert ((grown == 0) | (grown == 1)).all()
            # What nothing was said of is as it was.
            for before, after in zip(self.known.arrays, snapshot(self.mapper).arrays, strict=True):
                assert np.array_equal(before[grown == 0], after[grown == 0])
        self.known = snapshot(self.mapper)

    @rule(bad=st.sampled_from([None, "reading", 3.0, Pose2(0.0, 0.0)]))
    def no_reading(self, bad: object) -> None:
        good = SonarReading(Pose2(1.0, 0.8), 0.0, 0.5)
        try:
            self.mapper.update([good, bad])  # type: ignore[list-item]
        except ValueError:
            assert same(snapshot(self.mapper), self.known)
        else:
            raise AssertionError(f"{bad!r} passed for a reading")

    @rule()
    def reset(self) -> None:
        self.mapper.reset()
        assert self.mapper.perceptions == 0
        assert not self.mapper.count.any()
        self.known = snapshot(self.mapper)

    @rule(name=st.sampled_from(NAMES))
    def save(self, name: str) -> None:
        try:
            save_map(self.folder.file_to_write(name), self.mapper.state())
        except ValueError:
            assert name not in ("a", "b", "deep/c")
            return
        assert name in ("a", "b", "deep/c")
        self.files[name] = self.known

    @rule(name=st.sampled_from(NAMES))
    def load(self, name: str) -> None:
        try:
            file = self.folder.file_to_read(name)
            self.mapper.restore(load_map(file, self.mapper.geometry))
        except ValueError:
            assert name not in self.files
            return
        loaded = snapshot(self.mapper)
        assert loaded.perceptions == self.files[name].perceptions
        assert all(map(np.array_equal, loaded.arrays[:3], self.files[name].arrays[:3]))
        self.known = loaded

    @rule(name=st.sampled_from(["a", "b"]), place=st.integers(0, 400), value=st.integers(0, 255))
    def damaged(self, name: str, place: int, value: int) -> None:
        if name not in self.files:
            return
        data = bytearray((self.top / "maps" / name).read_bytes())
        data[place % len(data)] = value
        (self.top / "damaged").write_bytes(data)
        try:
            self.mapper.restore(load_map(self.top / "damaged", self.mapper.geometry))
        except ValueError:
            assert same(snapshot(self.mapper), self.known)
        self.known = snapshot(self.mapper)

    @rule(shape=st.sampled_from([(19, 16), (20, 15), (16, 20)]))
    def of_another_grid(self, shape: tuple[int, int]) -> None:
        other = FuzzyMapper(GridGeometry(*shape, 0.1), self.parameters).state()
        try:
            self.mapper.restore(other)
        except ValueError:
            assert same(snapshot(self.mapper), self.known)
        else:
            raise AssertionError("a state of another grid was taken")

    @rule(
        name=st.sampled_from(["evidence.k_empty", "evidence.k_occupied", "fusion.aggregation"]),
        value=st.sampled_from([0.3, 0.9, 1.5, math.nan, "max", "mean", "least", 10**400, None]),
    )
    def other_parameters(self, name: str, value: object) -> None:
        """As the node goes on with what is known."""
        try:
            changed: MapperParameters = mapper_parameters(self.preset, {**AREA, name: value})
        except ValueError:
            return
        state = self.mapper.state()
        self.mapper = FuzzyMapper(state.geometry, changed)
        self.mapper.restore(state)
        self.assembler = ReadingAssembler(changed)
        self.handed = self.out = 0
        kept = snapshot(self.mapper)
        assert all(map(np.array_equal, kept.arrays[:3], self.known.arrays[:3]))
        self.known = kept

    @rule(
        step=st.sampled_from([0.02, 0.1, 0.6, 5.0, -0.01, -3.0]),
        sensor=st.integers(0, 7),
        value=st.sampled_from(USABLE + UNUSABLE),
        after=st.sampled_from([0.0, 0.0, 0.2, 0.5001, 60.0]),
    )
    def time_and_ranges(self, step: float, sensor: int, value: float, after: float) -> None:
        """Every range that is handed in comes out placed, is counted as refused, or waits."""
        self.now += step
        if step < -1.0:
            self.out += self.assembler.waiting  # dropped with a word
            self.assembler.clear()
        self.assembler.add_pose(self.now, Pose2(1.0, 0.8, 0.1), self.now)
        self.assembler.add_turret(self.now, 0.0, self.now)
        self.assembler.add_range(sensor, self.now + after, value, self.now)
        self.handed += 1
        released = self.assembler.release(self.now)
        self.out += len(released)
        refused = sum(self.assembler.rejected.values())
        assert self.handed == self.out + refused + self.assembler.waiting
        assert all(abs(r.pose.x - 1.0) < 1e-9 and r.sensor < 8 for r in released)

    @invariant()
    def memberships_are_memberships(self) -> None:
        if not hasattr(self, "mapper"):
            return
        m = self.mapper
        for values in (m.empty, m.occupied, m.motion_risk, m.planning_risk):
            assert ((values >= 0.0) & (values <= 1.0)).all()
        assert m.count.min() >= 0
        assert m.count.max() <= m.perceptions
        assert not (self.top / "out").exists()


TestAnyMapper = AnyMapper.TestCase
TestAnyMapper.settings = settings(max_examples=25, stateful_step_count=25)
