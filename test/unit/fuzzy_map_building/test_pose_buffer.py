# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Poses and angles between their samples."""

import math

import numpy as np
import pytest

from fuzzy_map_building.pose_buffer import MOST_SAMPLES, AngleBuffer, PoseBuffer
from fuzzy_map_building.types import Pose2


def arc(t: float) -> Pose2:
    """A robot on a circle, turning through +-pi."""
    return Pose2(math.cos(t), math.sin(t), math.remainder(3.0 + 2.0 * t, 2 * math.pi))


def test_between_samples_a_smooth_motion_is_followed() -> None:
    poses = PoseBuffer(0.5, 100.0)
    for t in np.arange(0.0, 10.0, 0.05):
        assert poses.add(float(t), arc(float(t)))
    for t in np.random.default_rng(0).uniform(0.0, 9.9, 200):
        found = poses.at(float(t))
        truth = arc(float(t))
        assert found is not None
        assert found.distance_to(truth.x, truth.y) < 1e-3
        assert abs(math.remainder(found.theta - truth.theta, 2 * math.pi)) < 1e-9
        assert -math.pi <= found.theta < math.pi


def test_a_sample_s_own_stamp_gives_it_back() -> None:
    poses = PoseBuffer(0.5, 100.0)
    pose = Pose2(1.0, 2.0, 7.0)
    poses.add(3.0, pose)
    assert poses.at(3.0) is pose


def test_nothing_is_extrapolated() -> None:
    poses = PoseBuffer(0.5, 100.0)
    assert poses.at(1.0) is None
    assert not poses.missed(1.0)
    assert poses.newest is None
    poses.add(1.0, Pose2(0, 0))
    poses.add(1.4, Pose2(1, 0))
    assert poses.at(1.41) is None
    assert not poses.missed(1.41)  # the next pose may answer
    assert poses.at(0.99) is None
    assert poses.missed(0.99)  # none can
    assert poses.newest == 1.4


def test_a_gap_is_not_bridged() -> None:
    poses = PoseBuffer(0.5, 100.0)
    poses.add(1.0, Pose2(0, 0))
    poses.add(1.6, Pose2(1, 0))
    assert poses.at(1.3) is None
    assert poses.missed(1.3)
    assert poses.at(1.6) == Pose2(1, 0)
    poses.add(2.1, Pose2(2, 0))  # exactly as far as allowed
    assert poses.at(1.85) == Pose2(1.5, 0)


def test_what_is_out_of_order_is_refused_and_counted() -> None:
    poses = PoseBuffer(0.5, 100.0)
    assert poses.add(2.0, Pose2(0, 0))
    assert not poses.add(2.0, Pose2(1, 0))
    assert not poses.add(1.0, Pose2(1, 0))
    assert not poses.add(math.nan, Pose2(1, 0))
    assert not poses.add(math.inf, Pose2(1, 0))
    assert poses.rejected == {"duplicate": 1, "out_of_order": 1, "not_finite": 2}
    assert len(poses) == 1
    assert poses.at(2.0) == Pose2(0, 0)


def test_memory_is_bounded_by_the_horizon() -> None:
    poses = PoseBuffer(0.5, 2.0)
    for k in range(10_000):
        poses.add(0.1 * k, Pose2(k, 0))
        assert len(poses) <= 44
    for stamp in (997.95, 998.55, 999.85):
        assert poses.at(stamp) is not None
    assert poses.missed(900.0)


def test_clear_allows_earlier_stamps() -> None:
    poses = PoseBuffer(0.5, 2.0)
    poses.add(100.0, Pose2(0, 0))
    poses.clear()
    assert poses.add(1.0, Pose2(1, 0))
    assert poses.at(1.0) == Pose2(1, 0)


def test_angles_turn_the_short_way() -> None:
    angles = AngleBuffer(1.0, 10.0)
    angles.add(0.0, math.radians(350.0))
    angles.add(1.0, math.radians(10.0))
    for fraction in (0.25, 0.5, 0.75):
        found = angles.at(fraction)
        assert found is not None
        difference = found - math.radians(350.0 + 20.0 * fraction)
        assert math.remainder(difference, 2 * math.pi) == pytest.approx(0.0, abs=1e-12)
    assert not angles.add(2.0, math.nan)
    assert angles.rejected == {"not_finite": 1}


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_limits_are_positive(bad: float) -> None:
    with pytest.raises(ValueError, match="max_gap"):
        PoseBuffer(bad, 1.0)
    with pytest.raises(ValueError, match="horizon"):
        PoseBuffer(1.0, bad)


def test_a_flood_within_the_horizon_keeps_the_newest_only() -> None:
    angles = AngleBuffer(0.5, 100.0)
    for k in range(3 * MOST_SAMPLES):
        assert angles.add(1e-6 * k, float(k % 2))
        assert len(angles) <= MOST_SAMPLES
    assert angles.at(1e-6 * (3 * MOST_SAMPLES - 1)) == 1.0
    assert angles.at(0.0) is None
    assert angles.missed(0.0)
