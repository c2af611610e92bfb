# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Cone consistency and infrared evidence against their formulas, in scalar loops."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.sonar_guard import cut_rays
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from unit.fuzzy_map_building.scalar_mapper import (
    ScalarMapper,
    limit_of_lost_echo,
    modulation,
    union,
)

TOLERANCE = 1e-9


class ConsistentScalarMapper(ScalarMapper):
    """Section 6 of the method beside the equations of the paper."""

    def centre_range(self, reading: SonarReading, usable: list) -> float:
        s = self.p.sonar
        if reading.range == math.inf:
            return limit_of_lost_echo(reading, usable, self.p) + s.mount_radius
        return max(reading.range, s.min_range) + s.mount_radius

    def consistency(self, reading: SonarReading, usable: list, theta: float) -> float:
        """C of the direction at an angle from the reading's axis."""
        q = self.p.consistency
        b = reading.pose.theta + reading.bearing
        r = self.centre_range(reading, usable)
        worst = 0.0
        for other in usable:
            if other.range == math.inf and self.p.sonar.lost_echo == "ignore":
                continue
            turn = math.remainder(other.pose.theta + other.bearing - b, 2.0 * math.pi)
            if abs(theta - turn) > q.half_width:
                continue
            x, y = other.pose.x - reading.pose.x, other.pose.y - reading.pose.y
            if abs(y * math.cos(b) - x * math.sin(b)) > q.max_offset:
                continue
            reach = self.centre_range(other, usable) + x * math.cos(b) + y * math.sin(b)
            worst = max(worst, min(max((reach - r - q.threshold) / q.ramp, 0.0), 1.0))
        return 1.0 - worst

    def arc(self, reading: SonarReading, usable: list, theta: float, m: float) -> float:
        if not self.p.consistency.enabled:
            return m
        half, width = self.p.sonar.field_of_view / 2, self.p.consistency.half_width
        b = reading.pose.theta + reading.bearing
        turns = [math.remainder(o.pose.theta + o.bearing - b, 2 * math.pi) for o in usable]
        borders = {t + side for t in turns for side in (-width, width)}
        borders = sorted({x for x in borders if abs(x) < half} | {-half, half})
        most = 0.0
        for low, high in itertools.pairwise(borders):
            if high - low < 1e-8:
                continue  # the same border of two readings
            c = self.consistency(reading, usable, 0.5 * (low + high))
            nearest = min(max(0.0, low), high)
            most = max(most, math.sqrt(modulation(nearest, self.p)) * c)
        if most <= self.p.consistency.floor:
            return m
        return math.sqrt(m) * self.consistency(reading, usable, theta) / most

    def rays(self, readings: list, x: float, y: float) -> tuple[float, float]:
        """Max E_I and max O_I of a cell."""
        q, ring = self.p.infrared_evidence, self.p.infrared
        e_most = o_most = 0.0
        for reading in readings:
            value = ring.min_range if reading.range == -math.inf else reading.range
            if not (ring.min_range <= value <= ring.max_range or value == math.inf):
                continue
            to = reading.pose.theta + reading.bearing
            dx, dy = x - reading.pose.x, y - reading.pose.y
            rho = math.hypot(dx, dy)
            along = dx * math.cos(to) + dy * math.sin(to)
            across = abs(dy * math.cos(to) - dx * math.sin(to))
            wide = max(q.widening * rho, self.geometry.resolution / 2)
            if along < 0.0 or across > wide + 1e-9:
                continue
            free = ring.mount_radius + min(value, ring.max_range, reading.limit)
            if rho < free - q.range_margin:
                e_most = max(e_most, q.certainty)
            elif rho < free:
                e_most = max(e_most, q.certainty * ((free - rho) / q.range_margin) ** 2)
            off = rho - (ring.mount_radius + value)
            if value != math.inf and abs(off) < q.range_margin:
                o_most = max(o_most, q.certainty * (1.0 - (off / q.range_margin) ** 2))
        return e_most, o_most

    def evidence(self, readings: list, x: float, y: float) -> tuple[float, float]:
        sonar = [r for r in readings if isinstance(r, SonarReading)]
        infrared = [r for r in readings if isinstance(r, InfraredReading)]
        e_k, o_k = super().evidence(sonar, x, y)
        e_i, o_i = self.rays(infrared, x, y)
        return union(e_k, e_i, self.p.evidence.dombi_lambda), max(o_k, o_i)


def ring_packet(rng: np.random.Generator, moving: float) -> list[SonarReading]:
    """48 directions, an obstacle among far walls, some echoes lost; taken while moving or not."""
    pose = Pose2(*rng.uniform(1.0, 2.0, 2), rng.uniform(-7, 7))
    near = rng.uniform(0.0, 2.0 * math.pi)
    readings = []
    for number in range(48):
        place = Pose2(pose.x + moving * number / 48, pose.y, pose.theta + moving)
        bearing = math.radians(22.5 * (number % 16) + 7.5 * (number // 16))
        off = abs(math.remainder(bearing - near, 2.0 * math.pi))
        value = rng.uniform(0.5, 0.55) if off < 0.35 else rng.choice([0.62, 0.7, 1.1, math.inf])
        readings.append(
            SonarReading(place, bearing, float(rng.choice([value] * 20 + [-math.inf])))
        )
    return readings


def infrared_sweep(rng: np.random.Generator) -> list[InfraredReading]:
    pose = Pose2(*rng.uniform(0.3, 2.7, 2), rng.uniform(-7, 7))
    values = [0.1, 0.33, 0.6, math.inf, math.inf, -math.inf, math.nan, 0.7, -0.1]
    return [
        InfraredReading(
            pose,
            math.radians(22.5 * i),
            float(rng.choice(values)),
            limit=float(rng.choice([math.inf, math.inf, 0.2, -0.05])),
        )
        for i in range(16)
    ]


def assert_equal(mapper: FuzzyMapper, scalar: ScalarMapper) -> None:
    for name, truth in (
        ("empty", scalar.e),
        ("occupied", scalar.o),
        ("motion_risk", scalar.m_m),
        ("planning_risk", scalar.m_p),
    ):
        error = np.abs(getattr(mapper, name) - truth)
        assert error.max() < TOLERANCE, f"{name}: {error.max()} at {error.argmax()}"
    np.testing.assert_array_equal(mapper.count, scalar.n)


@pytest.mark.parametrize("moving", [0.0, 0.3])
@pytest.mark.parametrize("apex", ["center", "mount"])
def test_cone_consistency_equals_its_formula(apex: str, moving: float) -> None:
    rng = np.random.default_rng([int(10 * moving), len(apex)])
    parameters = mapper_parameters(overrides={"sonar.apex": apex})
    plain = mapper_parameters(overrides={"sonar.apex": apex, "consistency.enabled": False})
    geometry = GridGeometry(30, 30, 0.1)
    mapper, scalar = (kind(geometry, parameters) for kind in (FuzzyMapper, ConsistentScalarMapper))
    for _ in range(3):
        packet = ring_packet(rng, moving)
        mapper.update(packet)
        scalar.update(packet)
        assert_equal(mapper, scalar)
    # And it does something.
    without, once = FuzzyMapper(geometry, plain), FuzzyMapper(geometry, parameters)
    without.update(packet)
    once.update(packet)
    np.testing.assert_array_equal(without.empty, once.empty)
    assert np.abs(without.occupied - once.occupied).max() > 0.1


def random_parameters(rng: np.random.Generator) -> MapperParameters:
    return mapper_parameters(
        "consistent",
        {
            "sonar.lost_echo": ("neighbours", "full", "ignore")[int(rng.integers(3))],
            "sonar.mount_radius": float(rng.uniform(0.0, 0.3)),
            "consistency.half_width": float(rng.uniform(0.05, 0.3)),
            "consistency.threshold": float(rng.uniform(0.0, 0.2)),
            "consistency.ramp": float(rng.uniform(0.01, 0.5)),
            "consistency.floor": float(rng.uniform(0.0, 0.5)),
            "infrared.mount_radius": float(rng.uniform(0.0, 0.3)),
            "infrared_evidence.certainty": float(rng.uniform(0.1, 1.0)),
            "infrared_evidence.range_margin": float(rng.uniform(0.02, 0.2)),
            "infrared_evidence.widening": float(rng.uniform(0.0, 0.2)),
            "sonar_guard.enabled": False,
        },
    )


@pytest.mark.parametrize("seed", range(4))
def test_a_packet_of_both_kinds_equals_the_formulas(seed: int) -> None:
    rng = np.random.default_rng(seed)
    parameters = random_parameters(rng)
    geometry = GridGeometry(30, 28, 0.107, (0.03, -0.04))
    mapper, scalar = (kind(geometry, parameters) for kind in (FuzzyMapper, ConsistentScalarMapper))
    for _ in range(2):
        sweeps = [reading for _ in range(4) for reading in infrared_sweep(rng)]
        packet = [*ring_packet(rng, 0.0), *sweeps]
        report = mapper.update(packet)
        scalar.update(packet)
        assert_equal(mapper, scalar)
        values = [r.range for r in sweeps]
        assert report.infrared_rejected["nan"] == sum(map(math.isnan, values))
        assert report.infrared_rejected["out_of_range"] == sum(v in (0.7, -0.1) for v in values)
        assert report.infrared_accepted + sum(report.infrared_rejected.values()) == 64
        assert report.accepted + sum(report.rejected.values()) == 48
    assert (mapper.count > 1).any()


def test_the_guard_limits_rays_before_they_are_fused() -> None:
    rng = np.random.default_rng(8)
    parameters = mapper_parameters("consistent")
    geometry = GridGeometry(30, 30, 0.1)
    mapper, scalar = (kind(geometry, parameters) for kind in (FuzzyMapper, ConsistentScalarMapper))
    sonar = ring_packet(rng, 0.0)
    pose = sonar[0].pose
    infrared = [InfraredReading(pose, math.radians(22.5 * i), math.inf) for i in range(16)]
    p = parameters
    cut = cut_rays(sonar, infrared, p.sonar, p.infrared, p.sonar_guard, 0.6, 0.23)
    assert 0 < sum(math.isfinite(reading.limit) for reading in cut) < 16
    mapper.update([*sonar, *infrared])
    scalar.update([*sonar, *cut])
    assert_equal(mapper, scalar)


def test_by_hand_a_longer_neighbour_takes_its_side_of_the_arc() -> None:
    # The cone looks along x; a reading 7.5 deg to the left goes 1 m farther. It looks to 8 deg
    # around its axis, so that of the arc what lies beyond 0.5 deg on its side is vetoed.
    parameters = mapper_parameters("consistent", {"evidence.range_margin": 0.1})
    geometry = GridGeometry(400, 200, 0.01, (0.0, -1.0))
    mapper = FuzzyMapper(geometry, parameters)
    pose = Pose2(0.0, 0.0)
    mapper.update([SonarReading(pose, 0.0, 0.77), SonarReading(pose, math.radians(7.5), 1.77)])
    column = geometry.cell_of(1.0, 0.0)[1]
    # Centres from 0.105 m to the right of the axis to 0.115 m to the left.
    across = [(i + 0.5) * 0.01 for i in range(-11, 12)]
    for y in across:
        found = mapper.occupied[geometry.cell_of(1.0, y)[0], column]
        theta, rho = math.atan2(y, 1.005), math.hypot(1.005, y)
        if theta >= math.radians(-0.5):
            assert found == 0.0
            continue
        arc = math.sqrt(modulation(theta, parameters) / modulation(math.radians(0.5), parameters))
        assert found == pytest.approx(0.4 * (1 - ((1.0 - rho) / 0.1) ** 2) * arc, abs=1e-9)


def test_by_hand_a_ray() -> None:
    parameters = mapper_parameters("consistent")
    geometry = GridGeometry(30, 11, 0.1, (-0.55, -0.55))
    mapper = FuzzyMapper(geometry, parameters)
    behind = SonarReading(Pose2(0.0, 0.0), math.pi, 0.3)
    mapper.update([behind, InfraredReading(Pose2(0.0, 0.0), 0.0, 0.57)])
    # Cell centres at multiples of 0.1 m; the hit lies at 0.8 m.
    row = geometry.cell_of(0.0, 0.0)[0]
    ray = slice(geometry.cell_of(0.1, 0.0)[1], None)
    np.testing.assert_allclose(mapper.empty[row, ray][:9], [0.9] * 7 + [0.0] * 2, atol=1e-9)
    np.testing.assert_allclose(mapper.occupied[row, ray][6:9], [0.0, 0.9, 0.0], atol=1e-9)
    # Half a cell to either side, no more (0.07 of 0.8 m is 0.056 m).
    assert mapper.empty[row + 1, ray].max() == mapper.empty[row - 1, ray].max() == 0.0
