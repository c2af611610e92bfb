# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The simulated robot: time, motion, contact, readings at their moment, and repeatability."""

import math
import statistics
import time

import numpy as np
import pytest

from fuzzy_map_building.jit import compiled
from fuzzy_map_building.types import Pose2
from nomad_sim.params import simulator_parameters
from nomad_sim.robot import arc
from nomad_sim.simulator import Simulator
from nomad_sim.sonar import SonarRing
from nomad_sim.world import Circle, MovingObstacle, Polygon, Wall, World
from nomad_sim.world_io import load_world

RADIUS = 0.23


def room(width=6.0, height=4.0, start=(1.0, 2.0), **values):
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    fields = {"goal": (5.0, 2.0), "expected": "reached", **values}
    return World(
        name="room",
        origin=(0.0, 0.0),
        size=(width, height),
        start=Pose2(*start),
        walls=(Wall(corners, "painted_wall", closed=True),),
        **fields,
    )


def exact(world, **values):
    return Simulator(world, simulator_parameters({"noise": False, **values}))


def drive(simulator, steps, linear=0.3, angular=0.2):
    log = []
    for k in range(steps):
        simulator.step(linear, angular * math.cos(0.05 * k))
        log.append(
            (simulator.pose, simulator.odometry, simulator.infrared().tolist(),
             simulator.sonar_events, simulator.clearance())
        )  # fmt: skip
    return log


class TestRepeatability:
    def test_the_same_seed_gives_the_same_run_to_the_bit(self):
        parameters = simulator_parameters({"seed": 5, "sonar.lost_outliers": 0.1})
        runs = [drive(Simulator(load_world("lab"), parameters), 60) for _ in range(2)]
        assert runs[0] == runs[1]

    def test_reset_begins_the_same_run_again(self):
        simulator = Simulator(load_world("lab_person"))
        first = drive(simulator, 50)
        simulator.perception_taken()
        simulator.command_turret(0.2)
        simulator.reset()
        assert (simulator.time, simulator.perceptions, simulator.turret_angle) == (0.0, 0, 0.0)
        assert drive(simulator, 50) == first

    def test_another_seed_gives_other_readings_on_the_same_way(self):
        one, two = (
            drive(Simulator(load_world("lab"), simulator_parameters({"seed": s})), 50)
            for s in (1, 2)
        )
        assert [entry[0] for entry in one] == [entry[0] for entry in two]
        assert all(a[1] != b[1] for a, b in zip(one, two, strict=True))
        assert any(a[3] != b[3] for a, b in zip(one, two, strict=True))

    @pytest.mark.parametrize(
        ("values", "changed"),
        [
            ({"sonar.lost_outliers": 0.2}, {3}),
            ({"sonar.range_noise": 0.05}, {3}),
            ({"infrared.range_noise": 0.02}, {2}),
            ({"odometry.distance_noise": 0.1}, {1}),
        ],
    )
    def test_each_kind_of_noise_has_a_stream_of_its_own(self, values, changed):
        plain = drive(Simulator(load_world("lab")), 80)
        other = drive(Simulator(load_world("lab"), simulator_parameters(values)), 80)
        different = {
            kind
            for kind in range(5)
            if [entry[kind] for entry in plain] != [entry[kind] for entry in other]
        }
        assert different == changed

    def test_reading_twice_draws_once(self):
        simulator = Simulator(load_world("lab"))
        simulator.step(0.0, 0.0)
        assert simulator.infrared().tolist() == simulator.infrared().tolist()
        simulator.infrared()[:] = 0.0
        assert simulator.infrared().any()


class TestTime:
    def test_steps_add_up_without_rounding(self):
        simulator = exact(room())
        for _ in range(700):
            simulator.step(0.0, 0.0, 0.1)
        assert simulator.nanoseconds == 70 * 10**9
        assert simulator.time == 70.0

    def test_sonars_fire_at_their_times_whatever_the_steps(self):
        def events(dt, steps):
            simulator = Simulator(room())
            out = []
            for _ in range(steps):
                simulator.step(0.0, 0.0, dt)
                out += simulator.sonar_events
            return out

        fine = events(0.01, 100)
        assert events(0.05, 20) == fine
        assert events(0.25, 4) == fine
        stamps = sorted({event.stamp for event in fine})
        assert stamps == pytest.approx([0.04 * (k + 1) for k in range(25)], abs=1e-12)
        assert len(fine) == 100

    def test_each_reading_is_taken_at_its_own_pose_and_turret_angle(self):
        # An interval that never falls on the end of a step or of one of its parts.
        world = load_world("lab")
        simulator = exact(world, **{"sonar.firing_interval": 0.0437})
        simulator.command_turret(0.4)
        # At constant velocity the pose at every stamp is a point of one exact arc.
        for _ in range(40):
            simulator.step(0.3, 0.4)
        start, begin, turret = simulator.pose, simulator.time, simulator.turret_angle
        simulator.command_turret(-0.4)
        events = []
        for _ in range(10):
            simulator.step(0.3, 0.4)
            events += simulator.sonar_events
        ring = SonarRing(simulator.parameters.sonar, RADIUS, None, None)
        rate = simulator.parameters.turret.max_rate
        assert len(events) >= 40
        for event in events:
            elapsed = event.stamp - begin
            angle = max(-0.4, turret - rate * elapsed)
            assert event.turret_angle == pytest.approx(angle, abs=1e-9)
            pose = arc(start, 0.3, 0.4, elapsed)
            sensor = np.array([event.sensor])
            expected = ring.exact(sensor, pose, event.turret_angle, world.surfaces())[0]
            assert event.range == (
                pytest.approx(expected, abs=1e-6) if expected <= 6.5 else math.inf
            )

    def test_the_turret_takes_its_time(self):
        simulator = exact(room())
        simulator.command_turret(math.radians(15.0))
        simulator.step(0.0, 0.0, 0.1)
        assert simulator.turret_angle == pytest.approx(math.radians(6.0))
        for _ in range(4):
            simulator.step(0.0, 0.0, 0.1)
        assert simulator.turret_angle == math.radians(15.0)


class TestContact:
    def test_it_stops_at_a_wall_and_counts_one_touch(self):
        simulator = exact(room())
        for _ in range(300):
            simulator.step(0.6, 0.0)
        assert simulator.pose.x == pytest.approx(6.0 - RADIUS, abs=1e-6)
        assert -1e-9 <= simulator.clearance() < 1e-6
        assert simulator.contact
        assert simulator.contacts == 1
        assert simulator.velocity.linear == 0.0

    def test_away_and_back_is_a_second_touch(self):
        simulator = exact(room())
        for _ in range(300):
            simulator.step(0.6, 0.0)
        for _ in range(20):
            simulator.step(-0.3, 0.0)
        assert not simulator.contact
        assert simulator.clearance() > 0.1
        for _ in range(60):
            simulator.step(0.6, 0.0)
        assert simulator.contact
        assert simulator.contacts == 2

    def test_it_can_turn_and_drive_along_the_wall_that_it_touches(self):
        simulator = exact(room())
        for _ in range(300):
            simulator.step(0.6, 0.0)
        while simulator.pose.theta < math.pi / 2:
            simulator.step(0.0, 0.5)
        assert simulator.pose.x == pytest.approx(6.0 - RADIUS, abs=1e-6)
        before = simulator.pose.y
        for _ in range(20):
            simulator.step(0.3, 0.0)
        assert simulator.pose.y > before + 0.1
        assert simulator.contacts == 1

    def test_it_stops_at_the_tip_of_a_thin_wall_between_its_sensors(self):
        # The tip stands 0.1 m off the axis: the disc meets it where sqrt(R^2 - 0.1^2) is left.
        tip = Wall(np.array([[3.0, 2.1], [4.0, 2.1]]), "wood")
        world = room()
        simulator = exact(World(**{**vars_of(world), "walls": (*world.walls, tip)}))
        for _ in range(200):
            simulator.step(0.6, 0.0)
        assert simulator.pose.x == pytest.approx(3.0 - math.sqrt(RADIUS**2 - 0.01), abs=1e-6)
        assert simulator.contacts == 1

    def test_it_never_passes_through_anything(self):
        world = load_world("office")
        simulator = Simulator(world)
        rng = np.random.default_rng(4)
        least = math.inf
        for _ in range(60):
            linear, angular = rng.uniform(-0.6, 0.6), rng.uniform(-1.0, 1.0)
            for _ in range(10):
                simulator.step(linear, angular, 0.1)
                least = min(least, simulator.clearance())
        assert simulator.contacts > 2
        assert least >= -1.001e-9
        assert simulator.least_clearance <= least
        assert world.geometry(0.1).contains(simulator.pose.x, simulator.pose.y)

    def test_someone_walks_into_the_robot_and_it_gets_away(self):
        walker = MovingObstacle(
            "walker",
            Circle(0.0, 0.0, 0.25, "clothes"),
            np.array([[0.0, 3.0, 2.0], [10.0, 1.2, 2.0]]),
        )
        simulator = exact(room(moving=(walker,)))
        for _ in range(220):
            simulator.step(0.0, 0.0)
        assert simulator.contacts == 1
        assert simulator.clearance() == pytest.approx(0.2 - RADIUS - 0.25)
        for _ in range(30):
            simulator.step(-0.3, 0.0)
        assert not simulator.contact
        assert simulator.clearance() > 0.1
        assert simulator.contacts == 1

    def test_clearance_by_hand(self):
        pillar = Circle(3.0, 2.0, 0.3, "wood")
        box = Polygon(np.array([[0.5, 3.0], [1.5, 3.0], [1.5, 3.5], [0.5, 3.5]]), "wood")
        assert exact(room(circles=(pillar,))).clearance() == pytest.approx(1.0 - RADIUS)
        assert exact(room(polygons=(box,))).clearance() == pytest.approx(1.0 - RADIUS)
        near = exact(room(circles=(pillar,), start=(2.2, 2.0)))
        assert near.clearance() == pytest.approx(0.8 - 0.3 - RADIUS)


def vars_of(world):
    names = ("name", "origin", "size", "start", "goal", "expected", "walls")
    return {name: getattr(world, name) for name in names}


class TestObstaclesComeAndGo:
    def test_the_person_leaves_after_16_perceptions(self):
        simulator = exact(load_world("lab_person"), **{"sonar.firing_interval": 0.05})
        east = Pose2(2.5, 2.65, 0.0)
        simulator = Simulator(load_world("lab_person"), simulator.parameters, east)

        def ahead():
            for _ in range(4):
                simulator.step(0.0, 0.0)
                for event in simulator.sonar_events:
                    if event.sensor == 0:
                        return event.range
            raise AssertionError("sonar 0 did not fire")

        for _ in range(16):
            assert ahead() == pytest.approx(3.7 - 0.25 - 2.5 - RADIUS)
            simulator.perception_taken()
        assert ahead() > 4.0
        assert simulator.perceptions == 16

    def test_the_ground_truth_shows_who_is_there(self):
        simulator = exact(load_world("lab_person"))
        geometry = simulator.world.geometry(0.1)
        row, column = geometry.cell_of(3.7, 2.65)
        assert simulator.ground_truth_grid(geometry)[row, column]
        for _ in range(16):
            simulator.perception_taken()
        assert not simulator.ground_truth_grid(geometry)[row, column]


class TestRefusals:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ((math.nan, 0.0), "finite"),
            ((0.1, math.inf), "finite"),
            ((0.1, 0.1, 0.0), "between"),
            ((0.1, 0.1, -0.05), "between"),
            ((0.1, 0.1, math.nan), "between"),
            ((0.1, 0.1, 1e9), "between"),
        ],
    )
    def test_a_bad_step_changes_nothing(self, arguments, message):
        simulator = Simulator(room())
        simulator.step(0.3, 0.1)
        before = (simulator.time, simulator.pose, simulator.infrared().tolist())
        with pytest.raises(ValueError, match=message):
            simulator.step(*arguments)
        assert (simulator.time, simulator.pose, simulator.infrared().tolist()) == before

    @pytest.mark.parametrize("angle", [math.nan, math.inf, -math.inf, 1e6])
    def test_a_bad_turret_angle(self, angle):
        simulator = Simulator(room())
        with pytest.raises(ValueError, match="turret angle"):
            simulator.command_turret(angle)
        simulator.step(0.0, 0.0)
        assert simulator.turret_angle == 0.0

    @pytest.mark.parametrize("place", [(0.2, 2.0), (5.9, 3.9)])
    def test_a_start_in_contact(self, place):
        with pytest.raises(ValueError, match=r"cannot start at .*choose another start"):
            Simulator(room(), start=Pose2(*place))

    def test_a_start_inside_an_obstacle(self):
        with pytest.raises(ValueError, match="cannot start"):
            Simulator(load_world("lab"), start=Pose2(3.7, 1.0))


def test_commands_beyond_the_limits_are_cut():
    simulator = exact(room())
    for _ in range(40):
        simulator.step(9.0, 9.0)
    assert simulator.velocity.linear == pytest.approx(0.6)
    assert simulator.velocity.angular == pytest.approx(math.radians(60.0))


def test_the_world_sets_parameters_and_the_caller_overrides_them():
    world = room(parameters={"sonar": {"beam_half_angle": 0.2}})
    assert Simulator(world).parameters.sonar.beam_half_angle == 0.2
    given = simulator_parameters({"seed": 3}, world.parameters)
    assert Simulator(world, given).parameters.sonar.beam_half_angle == 0.2
    assert Simulator(world, simulator_parameters()).parameters.sonar.beam_half_angle != 0.2


@pytest.mark.skipif(not compiled(), reason="loops are compiled with numba only")
def test_a_control_step_takes_less_than_a_millisecond():
    simulator = Simulator(load_world("lab"))

    def median():
        times = []
        for _ in range(100):
            begin = time.perf_counter()
            simulator.step(0.1, 0.3)
            times.append(time.perf_counter() - begin)
        return statistics.median(times)

    # The best of several: what else the machine does must not decide.
    assert min(median() for _ in range(5)) < 1e-3
