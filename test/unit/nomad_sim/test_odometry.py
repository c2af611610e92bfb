# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Drift of the odometry against the statistics that its parameters promise."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import Pose2
from nomad_sim.odometry import Odometry
from nomad_sim.params import OdometryParameters
from nomad_sim.robot import arc


def test_without_noise_it_is_the_true_pose():
    odometry, pose = Odometry(OdometryParameters(), Pose2(1.0, 2.0, 0.3), None), Pose2(1, 2, 0.3)
    for _ in range(50):
        odometry.add([(0.01, 0.02)])
        pose = arc(pose, 0.01, 0.02, 1.0)
    assert odometry.pose == pose


@pytest.mark.parametrize("pieces", [10, 100])
def test_errors_grow_with_the_root_of_the_way_whatever_its_pieces(pieces):
    parameters = OdometryParameters(distance_noise=0.02, turning_noise=0.0, heading_drift=0.0)
    noise = np.random.default_rng(1)
    ends = []
    for _ in range(800):
        odometry = Odometry(parameters, Pose2(0.0, 0.0, 0.0), noise)
        for _ in range(pieces):
            odometry.add([(4.0 / pieces, 0.0)])
        ends.append(odometry.pose.x)
    assert np.mean(ends) == pytest.approx(4.0, abs=4 * 0.04 / math.sqrt(800))
    # 2 cm at 1 m is 4 cm at 4 m; the deviation of 800 draws is known to 2.5 %.
    assert np.std(ends) == pytest.approx(0.04, rel=0.1)


def test_heading_drifts_with_turning_and_with_driving():
    parameters = OdometryParameters(distance_noise=0.0, turning_noise=0.03, heading_drift=0.04)
    noise = np.random.default_rng(2)
    ends = []
    for _ in range(1500):
        odometry = Odometry(parameters, Pose2(0.0, 0.0, 0.0), noise)
        odometry.add([(1.0, 1.0)])
        ends.append(odometry.pose.theta)
    assert np.std(ends) == pytest.approx(0.05, rel=0.1)


def test_standing_still_does_not_drift():
    odometry = Odometry(OdometryParameters(), Pose2(1.0, 2.0, 0.3), np.random.default_rng(0))
    for _ in range(100):
        odometry.add([(0.0, 0.0)])
    assert odometry.pose == Pose2(1.0, 2.0, 0.3)
