# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Perceptions by the robot's way and its turret."""

import math

from fuzzy_map_building.types import Pose2
from nomad_sim.perception_count import PerceptionCount
from nomad_sim.simulator import Simulator
from nomad_sim.world import World
from nomad_sim.worlds.shapes import outer_walls

HALL = World(
    name="hall",
    origin=(0.0, 0.0),
    size=(8.0, 2.0),
    start=Pose2(0.5, 1.0, 0.0),
    goal=(7.5, 1.0),
    expected="reached",
    walls=outer_walls((8.0, 2.0), ["painted_wall"]),
)
STANDS = [math.radians(angle) for angle in (0.0, 7.5, 15.0, 15.0, 7.5, 0.0)]


def driven(simulator: Simulator, seconds: float, *, sweeping: bool) -> None:
    """Drive on, with a turret that goes to another stand every 0.2 s or holds still."""
    for tick in range(round(seconds / 0.05)):
        if sweeping and tick % 4 == 0:
            simulator.command_turret(STANDS[tick // 4 % 6])
        simulator.step(0.5, 0.0, 0.05)


def test_a_robot_that_maps_on_its_way_takes_one_every_80_cm() -> None:
    simulator = Simulator(HALL)
    driven(simulator, 10.0, sweeping=True)
    way = simulator.pose.x - 0.5
    # At 0.5 m/s, the turret sent elsewhere every 0.2 s or after 0.4 s: up to 0.2 m late.
    assert way / 1.0 - 1.0 <= simulator.perceptions <= way / 0.8
    assert simulator.perceptions >= 4


def test_a_robot_that_stands_for_them_takes_only_those() -> None:
    simulator = Simulator(HALL)
    for taken in range(1, 4):
        driven(simulator, 3.0, sweeping=False)
        for _ in range(40):
            simulator.step(0.0, 0.0, 0.05)
        # The turret's turns before the perception, and those within it.
        for angle in STANDS:
            simulator.command_turret(angle)
            simulator.step(0.0, 0.0, 0.2)
        assert simulator.perceptions == taken - 1
        simulator.perception_taken()
        assert simulator.perceptions == taken


def test_a_perception_that_begins_before_the_robot_rests_counts_once() -> None:
    count = PerceptionCount()
    count.drive(2.0)
    for _ in range(3):
        count.turn(0.4)
    assert count.taken == 0
    count.take()
    count.drive(-0.7)
    for _ in range(9):
        count.turn(0.4)
    assert count.taken == 1
    count.drive(-0.2)
    count.turn(-0.4)
    assert count.taken == 2
