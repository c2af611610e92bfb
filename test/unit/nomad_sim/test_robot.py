# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The unicycle against closed forms and against many small straight steps."""

import math

import pytest

from fuzzy_map_building.types import Pose2
from nomad_sim.params import RobotParameters
from nomad_sim.robot import Velocity, arc, next_velocity, turned

LIMITS = RobotParameters()


def after(velocity: Velocity, target: Velocity, dt: float = 0.01) -> Velocity:
    """Return the velocity after a time of bringing it to another."""
    p = LIMITS
    accelerations = p.linear_acceleration, p.linear_deceleration, p.angular_acceleration
    values = next_velocity(*velocity, *target, p.max_linear, p.max_angular, *accelerations, dt)
    return Velocity(*values)


@pytest.mark.parametrize("angular", [-1.0, -1e-7, 0.0, 1e-9, 0.3, 1.0])
@pytest.mark.parametrize("linear", [-0.4, 0.0, 0.6])
def test_arc_is_the_limit_of_small_straight_steps(linear, angular):
    x, y, theta, dt, parts = 0.3, -0.2, 2.5, 1.5, 20_000
    for _ in range(parts):
        middle = theta + 0.5 * angular * dt / parts
        x += linear * dt / parts * math.cos(middle)
        y += linear * dt / parts * math.sin(middle)
        theta += angular * dt / parts
    end = arc(Pose2(0.3, -0.2, 2.5), linear, angular, dt)
    assert (end.x, end.y) == pytest.approx((x, y), abs=1e-8)
    assert math.cos(end.theta - theta) == pytest.approx(1.0, abs=1e-12)
    assert -math.pi <= end.theta < math.pi


def test_a_full_circle_ends_where_it_began():
    end = arc(Pose2(1.0, 2.0, 0.5), 0.6, 0.5, 4.0 * math.pi)
    assert (end.x, end.y, end.theta) == pytest.approx((1.0, 2.0, 0.5), abs=1e-12)


def test_two_halves_make_the_whole():
    start = Pose2(1.0, 2.0, 0.5)
    whole = arc(start, 0.5, 0.8, 0.7)
    halves = arc(arc(start, 0.5, 0.8, 0.3), 0.5, 0.8, 0.4)
    assert (whole.x, whole.y, whole.theta) == pytest.approx(
        (halves.x, halves.y, halves.theta), abs=1e-12
    )


def test_speeds_grow_and_fall_within_the_limits():
    velocity, speeds = Velocity(), []
    for _ in range(100):
        velocity = after(velocity, Velocity(5.0, -9.0))
        speeds.append(velocity.linear)
    gains = [b - a for a, b in zip([0.0, *speeds], speeds, strict=False)]
    assert max(gains) <= LIMITS.linear_acceleration * 0.01 + 1e-12
    assert velocity == Velocity(LIMITS.max_linear, -LIMITS.max_angular)


def test_it_stands_within_the_time_that_braking_takes():
    velocity, steps = Velocity(0.6, 1.0), 0
    while velocity != Velocity():
        velocity = after(velocity, Velocity())
        steps += 1
    # 0.6 m/s at 6 m/s^2, 1 rad/s at 10 rad/s^2: both take 0.1 s.
    assert steps in (10, 11)


def test_turning_round_brakes_first_and_then_speeds_up():
    velocity = after(Velocity(0.05, 0.0), Velocity(-0.6, 0.0))
    assert velocity.linear == 0.0
    velocity = after(velocity, Velocity(-0.6, 0.0))
    assert velocity.linear == pytest.approx(-LIMITS.linear_acceleration * 0.01)


def test_the_turret_turns_at_its_rate_and_stops_at_its_target():
    assert turned(0.0, 1.0, 0.25) == 0.25
    assert turned(0.0, -1.0, 0.25) == -0.25
    assert turned(0.9, 1.0, 0.25) == 1.0
