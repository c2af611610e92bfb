# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The gathering of one packet, with a turret played by the test."""

import math

import pytest

from fuzzy_map_building.params import MapperParameters, mapper_parameters
from fuzzy_map_building.perception import PerceptionSequence
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading

PARAMETERS = mapper_parameters()


class Robot:
    """A turret of limited rate and sonars that fire in turn, 20 steps a second."""

    def __init__(
        self,
        parameters: MapperParameters,
        rate: float = math.radians(60.0),
        silent: frozenset[int] = frozenset(),
        deaf_until: float = 0.0,
        blind: frozenset[int] = frozenset(),
    ) -> None:
        self.sequence = PerceptionSequence(parameters)
        self.turret = parameters.turret.joint != ""
        self.bearings = parameters.sonar.bearings
        self.now = 100.0
        self.angle = self.target = -0.4
        self.rate = rate
        self.silent = silent
        self.blind = blind
        self.deaf_until = 100.0 + deaf_until
        self.commands: list[tuple[float, float]] = []

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.sequence.active and self.now < end:
            command = self.sequence.step(self.now)
            if command is not None:
                self.commands.append((self.now, command))
                if self.now >= self.deaf_until:
                    self.target = command
            self.now += 0.05
            step = self.rate * 0.05
            self.angle += min(step, max(-step, self.target - self.angle))
            if self.turret:
                self.sequence.on_turret(self.now, self.angle)
            for sensor in set(range(16)) - self.blind:
                self.sequence.on_infrared(InfraredReading(Pose2(0, 0), 0.0, 0.5, self.now, sensor))
            group = round(self.now / 0.05) % 4
            for sensor in range(group, len(self.bearings), 4):
                if sensor not in self.silent:
                    bearing = self.bearings[sensor] + (self.angle if self.turret else 0.0)
                    self.sequence.on_reading(
                        SonarReading(Pose2(0, 0), bearing, 1.0, self.now, sensor)
                    )


def test_one_reading_of_each_sonar_at_each_angle() -> None:
    robot = Robot(PARAMETERS)
    robot.sequence.start(robot.now)
    assert robot.sequence.active
    robot.run(10.0)
    sequence = robot.sequence
    assert sequence.done
    assert sequence.failed == ""
    assert len(sequence.readings) == sequence.expected == 48
    wanted = {
        (sensor, round(math.degrees(bearing + angle), 6))
        for sensor, bearing in enumerate(PARAMETERS.sonar.bearings)
        for angle in PARAMETERS.turret.angles
    }
    assert {(r.sensor, round(math.degrees(r.bearing), 6)) for r in sequence.readings} == wanted
    assert [round(math.degrees(a), 6) for _, a in robot.commands] == [0.0, 7.5, 15.0]
    # Turning from -23 to 15 degrees takes 0.63 s; firing all, three times, 0.6 s.
    assert robot.now - 100.0 < 2.5


def test_a_reading_from_before_the_turret_stood_is_not_taken() -> None:
    sequence = PerceptionSequence(PARAMETERS)
    sequence.start(1.0)
    assert sequence.step(1.0) == 0.0
    sequence.on_turret(1.1, math.radians(2.0))
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.1, 0))
    sequence.on_turret(1.2, math.radians(0.4))  # within the tolerance
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.19, 0))
    assert sequence.readings == []
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.2, 0))
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 2.0, 1.3, 0))  # has its reading
    assert [r.range for r in sequence.readings] == [1.0]
    # Pushed away, the turret stands no more.
    sequence.on_turret(1.4, math.radians(3.0))
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.4, 1))
    assert len(sequence.readings) == 1


def test_a_stand_from_before_the_command_does_not_count() -> None:
    sequence = PerceptionSequence(PARAMETERS)
    sequence.start(5.0)
    sequence.on_turret(4.9, 0.0)  # it happened to be there
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 4.95, 0))
    assert sequence.readings == []
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 5.0, 0))
    assert len(sequence.readings) == 1


def test_settling_time_is_waited_for() -> None:
    sequence = PerceptionSequence(mapper_parameters(overrides={"perception.settle": 0.3}))
    sequence.start(1.0)
    sequence.on_turret(1.1, 0.0)
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.35, 0))
    assert sequence.readings == []
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.41, 0))
    assert len(sequence.readings) == 1


def test_silent_sonars_cost_a_bounded_wait_and_the_rest_is_used() -> None:
    robot = Robot(PARAMETERS, silent=frozenset({3, 7}))
    robot.sequence.start(robot.now)
    robot.run(20.0)
    assert robot.sequence.done
    assert len(robot.sequence.readings) == 42
    assert robot.sequence.expected == 48
    assert 3 * 2.0 < robot.now - 100.0 < 3 * 2.0 + 2.0


def test_no_reading_at_all_is_a_failure_in_words() -> None:
    robot = Robot(PARAMETERS, silent=frozenset(range(16)))
    robot.sequence.start(robot.now)
    robot.run(20.0)
    assert not robot.sequence.done
    assert "no reading of any of the 16 sonars" in robot.sequence.failed


def test_a_turret_that_does_not_turn_is_a_failure_in_words() -> None:
    robot = Robot(PARAMETERS, rate=0.0)
    robot.sequence.start(robot.now)
    robot.run(20.0)
    assert not robot.sequence.done
    assert robot.sequence.readings == []
    assert "did not reach 0.0 degrees within 5 s" in robot.sequence.failed
    assert "'turret_joint'" in robot.sequence.failed
    assert robot.now - 100.0 == pytest.approx(5.05, abs=0.11)


def test_a_turret_that_came_up_late_is_told_again() -> None:
    robot = Robot(PARAMETERS, deaf_until=1.2)
    robot.sequence.start(robot.now)
    robot.run(20.0)
    assert robot.sequence.done
    repeats = [t for t, angle in robot.commands if angle == 0.0]
    assert len(repeats) == 4  # at 0, 0.5, 1.0 and 1.5 s
    assert len(robot.sequence.readings) == 48


def test_without_a_turret_one_reading_each() -> None:
    robot = Robot(mapper_parameters("lachekhab"))
    robot.sequence.start(robot.now)
    robot.run(5.0)
    assert robot.sequence.done
    assert robot.commands == []
    assert sorted(r.sensor for r in robot.sequence.readings) == list(range(8))


def test_start_begins_anew_and_cancel_ends() -> None:
    robot = Robot(PARAMETERS)
    robot.sequence.start(robot.now)
    robot.run(1.0)
    assert robot.sequence.readings
    robot.sequence.start(robot.now)
    assert robot.sequence.readings == []
    robot.run(0.5)
    robot.sequence.cancel()
    assert not robot.sequence.active
    assert not robot.sequence.done
    assert "canceled" in robot.sequence.failed
    assert robot.sequence.step(robot.now) is None
    robot.sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, robot.now, 0))
    assert robot.sequence.readings == []
    robot.sequence.start(robot.now)
    robot.run(10.0)
    assert robot.sequence.done


def test_nothing_happens_before_the_start() -> None:
    sequence = PerceptionSequence(PARAMETERS)
    sequence.on_turret(1.0, 0.0)
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.0, 0))
    assert sequence.step(1.0) is None
    assert not sequence.active
    assert not sequence.done
    assert sequence.readings == []


@pytest.mark.parametrize("sensor", [-1, 16])
def test_a_reading_of_an_unknown_sonar_is_an_error(sensor: int) -> None:
    sequence = PerceptionSequence(PARAMETERS)
    sequence.start(1.0)
    with pytest.raises(ValueError, match="cannot belong to a ring of 16"):
        sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.0, sensor))


def test_odd_joint_states_are_ignored() -> None:
    sequence = PerceptionSequence(PARAMETERS)
    sequence.start(1.0)
    sequence.on_turret(math.nan, 0.0)
    sequence.on_turret(1.1, math.nan)
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.2, 0))
    assert sequence.readings == []
    sequence.on_turret(1.3, 2 * math.pi)  # a whole turn is the same stand
    sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, 1.3, 0))
    assert len(sequence.readings) == 1


@pytest.mark.parametrize("rate", [1.0, 20.0])
def test_limits_are_measured_by_the_clock_of_patience(rate: float) -> None:
    # Simulated time goes `rate` times as fast as the clock of patience. Ranges of all sonars
    # but one come, at each stand half a second of patience after the turret.
    sequence = PerceptionSequence(PARAMETERS)
    sequence.start(100.0)
    angle, stood = None, 0.0
    for tick in range(1000):
        patience = 100.0 + 0.05 * tick
        now = 100.0 + rate * (patience - 100.0)
        command = sequence.step(now, patience)
        if not sequence.active:
            break
        if command is not None:
            angle, stood = command, patience
        sequence.on_turret(now, angle)
        if patience - stood > 0.5:
            for sensor in range(15):
                sequence.on_reading(SonarReading(Pose2(0, 0), 0.0, 1.0, now, sensor))
    assert sequence.done
    assert len(sequence.readings) == 45
    assert patience - 100.0 == pytest.approx(3 * PARAMETERS.perception.timeout, abs=0.5)


def test_a_stuck_turret_is_given_up_by_the_clock_of_patience() -> None:
    sequence = PerceptionSequence(PARAMETERS)
    sequence.start(100.0)
    sequence.step(100.0, 100.0)
    sequence.step(300.0, 104.9)
    assert sequence.active
    sequence.step(300.1, 105.1)
    assert "did not reach" in sequence.failed


def test_one_infrared_sweep_at_each_stand_and_no_waiting_for_it() -> None:
    robot = Robot(mapper_parameters("consistent"), blind=frozenset({3}))
    robot.sequence.start(robot.now)
    robot.run(10.0)
    sequence = robot.sequence
    assert sequence.done
    assert len(sequence.readings) == 48
    assert len(sequence.infrared) == 45
    assert sequence.packet == [*sequence.readings, *sequence.infrared]
    # Each while the turret stood, as the sonars of that stand.
    stamps = sorted({reading.stamp for reading in sequence.infrared})
    assert len(stamps) == 3
    for stand, stamp in enumerate(stamps):
        sonars = [r.stamp for r in sequence.readings[16 * stand : 16 * (stand + 1)]]
        assert min(sonars) - 0.051 <= stamp <= max(sonars)
        assert {r.sensor for r in sequence.infrared if r.stamp == stamp} == set(range(16)) - {3}
    sequence.start(robot.now)
    assert sequence.packet == []


def test_infrareds_are_not_taken_where_they_are_no_evidence() -> None:
    robot = Robot(mapper_parameters(overrides={"infrared_evidence.enabled": False}))
    assert not robot.sequence.wants_infrared(robot.now)
    robot.sequence.start(robot.now)
    robot.run(10.0)
    assert robot.sequence.packet == robot.sequence.readings
