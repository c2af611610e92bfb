# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A mission under events in any order: what it never does."""

import math

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_types import Commands, Drive, Finish, Perceive, Phase, Plan
from fuzzy_navigation.params import PAPER_PRESET, MotionParameters, motion_parameters
from fuzzy_navigation.planner import PlanResult, PlanStatus

GEOMETRY = GridGeometry(30, 20, 0.1)
STAND = Drive(0.0, 0.0)


class AnyEvents(RuleBasedStateMachine):
    """Poses, maps, answers true and stale, goals, cancellations, silence, in any order."""

    preset = PAPER_PRESET

    def __init__(self) -> None:
        super().__init__()
        self.parameters: MotionParameters = motion_parameters(
            self.preset,
            {
                "livelock_limit": 2,
                "perception_cap": 4,
                "timeout.lost": 2.0,
                "timeout.plan": 2.0,
                "timeout.build_map": 2.0,
            },
        )
        self.mission = Mission(self.parameters)
        self.now = 1000.0
        self.x, self.y, self.theta = 0.55, 1.05, 0.0
        self.drive = STAND
        self.request = 0
        self.started = 0
        self.finished: list[int] = []

    def take(self, commands: Commands, pose: bool = False) -> None:
        """Hold what comes out against what must never happen."""
        drives = [c for c in commands if isinstance(c, Drive)]
        finishes = [c for c in commands if isinstance(c, Finish)]
        for k, command in enumerate(commands):
            if isinstance(command, Finish):
                assert commands[k - 1] == STAND
                assert command.message
                assert command.duration >= 0.0
                self.finished.append(command.mission)
            elif isinstance(command, Perceive | Plan):
                if isinstance(command, Plan):
                    assert np.isfinite(np.reshape(command.hits, (-1, 2))).all()
                assert command.request == self.request + 1
                self.request = command.request
        for drive in drives:
            assert 0.0 <= drive.linear <= self.parameters.follower.max_linear
            assert abs(drive.angular) <= self.parameters.follower.max_angular
            if drive != STAND:
                assert pose, "only a pose makes the robot move"
                assert self.mission.phase is Phase.MOVING
                assert not finishes
            self.drive = drive
        if pose:
            assert len(drives) == (1 if self.mission.active or finishes else 0)
        if self.mission.active and self.mission.phase is not Phase.MOVING:
            assert self.drive == STAND or not pose

    @rule(
        seconds=st.sampled_from([0.05, 0.05, 0.05, 0.02, 0.0, 0.3, 1.2, -3.0]),
        ranges=st.sampled_from(["far", "far", "far", "far", "near", "none", "faulty", "some"]),
        ticks=st.integers(1, 8),
        moves=st.sampled_from([True, True, True, True, False]),
    )
    def poses(self, seconds: float, ranges: str, ticks: int, moves: bool) -> None:
        for _ in range(ticks):
            self.now += seconds
            if moves:
                self.x += self.drive.linear * seconds * math.cos(self.theta)
                self.y += self.drive.linear * seconds * math.sin(self.theta)
                self.theta += self.drive.angular * seconds
            pose = Pose2(self.x, self.y, self.theta)
            distance = {"near": 0.06, "faulty": math.nan}.get(ranges, math.inf)
            sensors = {"none": 0, "some": 9}.get(ranges, 16)
            readings = [
                InfraredReading(pose, k * math.pi / 8.0, distance, self.now, k)
                for k in range(sensors)
            ]
            echo = {"near": 0.2, "faulty": math.nan, "some": -math.inf}.get(ranges, math.inf)
            echoes = [
                SonarReading(pose, k * math.pi / 8.0, echo if k == 0 else math.inf, self.now, k)
                for k in range(sensors)
            ]
            self.take(self.mission.on_pose(self.now, pose, readings, echoes), pose=True)

    @rule(seconds=st.sampled_from([0.1, 0.1, 0.6, 1.5, -2.0]))
    def silence(self, seconds: float) -> None:
        self.now += seconds
        self.take(self.mission.on_tick(self.now))

    @rule(
        risk=st.sampled_from([0.0, 0.0, 0.0, 0.95, 1.0]),
        column=st.integers(0, 29),
        age=st.sampled_from([0.0, 0.0, 5.0]),
        geometry=st.sampled_from([GEOMETRY] * 5 + [GridGeometry(8, 20, 0.1)]),
    )
    def new_map(self, risk: float, column: int, age: float, geometry: GridGeometry) -> None:
        values = np.zeros(geometry.shape)
        values[:, column:] = risk
        self.take(self.mission.on_map(self.now, geometry, values, self.now - age))

    @rule(late=st.integers(0, 2), ok=st.sampled_from([True, True, True, False]))
    def perceived(self, late: int, ok: bool) -> None:
        self.take(self.mission.on_perception(self.now, self.request - late, ok, "no"))

    @rule(
        late=st.integers(0, 1),
        status=st.sampled_from([PlanStatus.FOUND] * 6 + list(PlanStatus)),
        cells=st.lists(st.sampled_from([(0, 1), (0, 1), (1, 1), (-1, 1), (3, 0)]), max_size=9),
        alpha=st.sampled_from([0.6, 1.0]),
    )
    def planned(
        self, late: int, status: PlanStatus, cells: list[tuple[int, int]], alpha: float
    ) -> None:
        row, column = math.floor(self.y / 0.1), math.floor(self.x / 0.1)
        poses = [Pose2(0.1 * column + 0.05, 0.1 * row + 0.05)]
        for rows, columns in cells:
            row, column = row + rows, column + columns
            poses.append(Pose2(0.1 * column + 0.05, 0.1 * row + 0.05))
        found = tuple(poses) if status is PlanStatus.FOUND else ()
        result = PlanResult(status, "said so", poses=found, alpha=alpha)
        self.take(self.mission.on_plan(self.now, self.request - late, result))

    @precondition(lambda self: self.mission.active)
    @rule(
        cells=st.lists(st.sampled_from([(0, 1), (0, 1), (1, 1), (-1, 1)]), max_size=9),
        ticks=st.integers(0, 60),
    )
    def all_as_it_should_be(self, cells: list[tuple[int, int]], ticks: int) -> None:
        """What a robot and partners do that work, so that missions come far."""
        self.poses(0.05, "far", 1, True)
        if self.mission.phase is Phase.PERCEIVING:
            self.take(self.mission.on_map(self.now, GEOMETRY, np.zeros(GEOMETRY.shape)))
            self.perceived(0, True)
        if self.mission.phase is Phase.PLANNING:
            self.planned(0, PlanStatus.FOUND, cells, 0.6)
        self.poses(0.05, "far", ticks, True)

    @rule(late=st.integers(0, 1))
    def plan_failed(self, late: int) -> None:
        self.take(self.mission.on_plan_error(self.now, self.request - late, "gone"))

    @precondition(lambda self: not self.mission.active or self.started % 3 == 0)
    @rule(
        goal=st.sampled_from([(2.05, 1.05), (1.45, 1.25), (0.95, 1.05), (0.55, 1.05), (-0.5, 1)]),
        tolerance=st.sampled_from([0.0, 0.1]),
    )
    def goal(self, goal: tuple[float, float], tolerance: float) -> None:
        self.started += 1
        self.take(self.mission.start(self.now, goal, tolerance))

    @precondition(lambda self: self.mission.phase is Phase.MOVING or self.started % 4 == 0)
    @rule()
    def cancel(self) -> None:
        was_active = self.mission.active
        commands = self.mission.cancel(self.now)
        assert len(commands) == (2 if was_active else 0)
        self.take(commands)
        assert not self.mission.active

    @invariant()
    def each_mission_ends_once(self) -> None:
        ended = self.started - 1 if self.mission.active else self.started
        assert self.finished == list(range(1, ended + 1))

    @invariant()
    def what_it_says_of_itself_holds(self) -> None:
        feedback = self.mission.feedback()
        assert feedback.phase is self.mission.phase
        assert feedback.perceptions == len(self.mission.log)
        assert feedback.perceptions <= self.parameters.perception_cap
        assert math.isnan(feedback.distance_remaining) or feedback.distance_remaining >= 0.0

    def teardown(self) -> None:
        """Whatever went before, a mission left alone comes to an end."""
        for _ in range(3000):
            if not self.mission.active:
                break
            self.now += 0.1
            self.take(self.mission.on_tick(self.now))
        assert not self.mission.active
        self.each_mission_ends_once()


class AnyEventsConsistent(AnyEvents):
    """The same with layer, sub-cell targets and sonar guard."""

    preset = "consistent"


TestAnyEvents = AnyEvents.TestCase
TestAnyEvents.settings = settings(max_examples=100, stateful_step_count=40)
TestAnyEventsConsistent = AnyEventsConsistent.TestCase
TestAnyEventsConsistent.settings = settings(max_examples=50, stateful_step_count=40)
