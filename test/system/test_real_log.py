# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A real robot's log, 8 sonars along a corridor, through the mapper."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.packet import ReadingAssembler
from fuzzy_map_building.params import PAPER_PRESET, MapperParameters, mapper_parameters
from fuzzy_map_building.types import Pose2

BEARINGS = tuple(math.radians(b) for b in (-90, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90))
NO_ECHO = 5.11
#: True walls [m], and where they end.
RIGHT, LEFT, END = -0.92, 1.18, 9.0
BETA = 0.9


def ring(preset: str) -> MapperParameters:
    """The log's sonars; their mount radius is not known."""
    return mapper_parameters(
        preset,
        {
            "sonar.frame_ids": [f"sonar_{i}" for i in range(8)],
            "sonar.bearings": BEARINGS,
            "sonar.mount_radius": 0.0,
            "sonar.max_range": 5.0,
            "turret.joint": "",
            "area.size_x": 12.0,
            "area.size_y": 4.0,
            "area.origin_x": -1.0,
            "area.origin_y": -2.0,
        },
    )


class Log:
    """The log as numbers: m, rad, s."""

    def __init__(self, folder: Path) -> None:
        measured = np.loadtxt(folder / "measurement.txt")
        poses = np.loadtxt(folder / "poses.txt")
        assert measured.shape == (181, 9)
        assert poses.shape == (181, 4)
        np.testing.assert_array_equal(measured[:, 0], poses[:, 0])
        self.stamps = measured[:, 0] / 1000.0
        self.ranges = measured[:, 1:] / 1000.0
        self.ranges[self.ranges >= NO_ECHO] = math.inf  # a code of this log, not of REP 117
        self.xy = poses[:, 1:3] / 1000.0
        self.headings = np.radians(poses[:, 3] / 10.0)

    def map(self, parameters: MapperParameters) -> FuzzyMapper:
        """Play it into a mapper as a node in continuous mode does."""
        mapper = FuzzyMapper(parameters.area.geometry(), parameters)
        assembler = ReadingAssembler(parameters)
        packet = []
        for k, stamp in enumerate(self.stamps.tolist()):
            assembler.add_pose(stamp, Pose2(*self.xy[k].tolist(), float(self.headings[k])), stamp)
            # Between firings the log repeats a value: only a changed one is a measurement.
            for sensor in np.flatnonzero(self.ranges[k] != self.ranges[k - 1]) if k else ():
                value = float(self.ranges[k, sensor])
                assert assembler.add_range(int(sensor), stamp, value, stamp)
            packet += assembler.release(stamp)
            while len(packet) >= parameters.packet_size:
                mapper.update(packet[: parameters.packet_size])
                del packet[: parameters.packet_size]
        mapper.update(packet)
        assert assembler.rejected == {}
        assert assembler.waiting == 0
        return mapper

    def driven(self, geometry: GridGeometry) -> set[tuple[int, int]]:
        """The cells that the robot's centre passed, between the log's samples as well."""
        line = [
            start + fraction * (end - start)
            for start, end in zip(self.xy[:-1], self.xy[1:], strict=True)
            for fraction in np.linspace(0.0, 1.0, 20)
        ]
        return {geometry.cell_of(float(x), float(y)) for x, y in line if x < END}


@pytest.fixture(scope="module")
def log(fuzzy_nav_data: Path) -> Log:
    return Log(fuzzy_nav_data / "sonar8_corridor")


@pytest.fixture(scope="module")
def mapper(log: Log) -> FuzzyMapper:
    return log.map(ring("sparse_ring"))


def wall(mapper: FuzzyMapper, side: int) -> np.ndarray:
    """Return y [m] where occupancy is believed most in each column, where it is believed."""
    x, y = mapper.geometry.centres()
    found = []
    for column in np.flatnonzero((x > 0.0) & (x < END)):
        row = int(np.where(side * y > 0.0, mapper.occupied[:, column], -1.0).argmax())
        occupied = mapper.occupied[row, column]
        if occupied >= 0.5 and occupied > mapper.empty[row, column]:
            found.append(y[row])
    return np.array(found)


@pytest.mark.parametrize(
    ("side", "truth", "columns"),
    # Of 90 columns: the sonar on the right changed its value 43 times, the left one 56 times.
    [(-1, RIGHT, 35), (1, LEFT, 65)],
    ids=["right", "left"],
)
def test_walls_are_where_they_are(
    mapper: FuzzyMapper, side: int, truth: float, columns: int
) -> None:
    found = wall(mapper, side)
    assert len(found) >= columns
    assert np.abs(found - truth).max() <= 0.2
    assert abs(np.median(found) - truth) <= 0.1


def test_driven_cells_are_safe(mapper: FuzzyMapper, log: Log) -> None:
    driven = log.driven(mapper.geometry)
    unsafe = {cell for cell in driven if mapper.motion_risk[cell] > BETA}
    assert len(driven) > 90
    # The log begins at a standstill: of the first cells under the robot itself nothing was
    # measured. All others are in the beta-cut.
    x = [mapper.geometry.centre_of(*cell)[0] for cell in unsafe]
    assert max(x, default=0.0) < 0.3
    assert len(unsafe) <= 0.05 * len(driven)


def test_nothing_behind_the_walls_is_safe(mapper: FuzzyMapper) -> None:
    x, y = mapper.geometry.centres()
    inside = (x > 0.0) & (x < END)
    beyond = (y < RIGHT - 0.25) | (y > LEFT + 0.25)
    assert (mapper.motion_risk[np.ix_(beyond, inside)] > BETA).all()


def test_the_weighted_mean_leaves_driven_cells_unsafe(log: Log, mapper: FuzzyMapper) -> None:
    """Why this ring has a preset of its own: the paper's aggregation needs its turret."""
    mean = log.map(ring(PAPER_PRESET))
    driven = log.driven(mean.geometry)
    share = {
        m.parameters.fusion.aggregation: np.mean([m.motion_risk[cell] <= BETA for cell in driven])
        for m in (mean, mapper)
    }
    assert share["mean"] < 0.8 < 0.95 < share["dombi"]
