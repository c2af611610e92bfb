# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The loop in one process: repeatable, and put together as said."""

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fuzzy_map_building.mapper import UpdateReport
from fuzzy_map_building.types import InfraredReading, Pose2, RangeReading
from fuzzy_navigation.mission import Mission
from fuzzy_navigation.mission_types import Command, Outcome, Plan
from fuzzy_navigation.planner import Planner, PlanResult
from nomad_sim.headless import CONTROL_PERIOD, HeadlessMission, random_start, run_mission
from nomad_sim.simulator import Simulator
from nomad_sim.world import World
from nomad_sim.world_io import load_world


@pytest.fixture
def room(small: Path) -> World:
    return load_world(small)


def test_the_same_seed_gives_the_same_log(room: World) -> None:
    one, other = (run_mission(room, seed=4) for _ in range(2))
    for name in ("outcome", "message", "entries", "path_length", "min_clearance", "duration"):
        assert getattr(one, name) == getattr(other, name), name
    for name in ("travelled", "motion_risk", "planning_risk"):
        assert (getattr(one, name) == getattr(other, name)).all(), name


def test_the_planner_is_asked_for_all_that_the_mission_wants(
    room: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted: list[Plan] = []
    asked: list[dict[str, object]] = []
    on_plan, plan = Mission._plan, Planner.plan

    def noting(mission: Mission) -> list[Command]:
        commands = on_plan(mission)
        wanted.extend(c for c in commands if isinstance(c, Plan))
        return commands

    def answering(planner: Planner, start: Pose2, goal: Pose2, **request: object) -> PlanResult:
        asked.append({"start": start, "goal": goal, **request})
        return plan(planner, start, goal, **request)

    monkeypatch.setattr(Mission, "_plan", noting)
    monkeypatch.setattr(Planner, "plan", answering)
    run_mission(room, seed=4, preset="oriolo1998")
    assert wanted
    names = [field.name for field in fields(Plan) if field.name != "request"]
    assert asked == [{name: getattr(p, name) for name in names} for p in wanted]
    assert asked[0]["slim_radius"] > 0.0


def test_it_is_sent_on_with_the_map_that_it_has(room: World) -> None:
    robot = HeadlessMission(room, seed=4)
    first = robot.run()
    robot.send((robot.start.x, robot.start.y))
    assert robot.verdict is None
    back = robot.run()
    assert (first.outcome, back.outcome) == (Outcome.REACHED, Outcome.REACHED)
    assert robot.simulator.pose.distance_to(robot.start.x, robot.start.y) < 0.2
    assert robot.mapper.perceptions == first.perceptions + back.perceptions
    with pytest.raises(ValueError, match="goal"):
        robot.send((99.0, 0.0))
    assert robot.goal == (robot.start.x, robot.start.y)


def test_another_seed_gives_other_maps(room: World) -> None:
    one, other = (run_mission(room, seed=seed) for seed in (4, 5))
    assert one.motion_risk.shape == other.motion_risk.shape
    assert (one.motion_risk != other.motion_risk).any()


def test_a_world_is_found_by_name_by_file_and_as_it_is(small: Path) -> None:
    for world in (small, str(small), load_world(small)):
        assert HeadlessMission(world).world.name == "small"
    assert HeadlessMission("lab").world.name == "lab"


def test_the_log_tells_what_happened(room: World) -> None:
    start = Pose2(0.8, 0.6, 1.0)
    seen: list[int] = []
    poses: list[tuple[float, float]] = []
    mission = HeadlessMission(room, start, (2.2, 1.7), seed=1)

    def note(now: HeadlessMission) -> None:
        assert now is mission
        seen.append(now.mission.log[-1].perception)
        poses.append((now.simulator.pose.x, now.simulator.pose.y))

    log = mission.run(note)
    assert (log.world, log.seed, log.start, log.goal) == ("small", 1, start, (2.2, 1.7))
    assert log.outcome is Outcome.REACHED
    assert log.reached
    assert log.truthful
    assert seen == [entry.perception for entry in log.entries]
    assert seen == list(range(1, log.perceptions + 1))
    # Obstacles that come and go with perceptions learn of each.
    assert mission.simulator.perceptions == log.perceptions
    # The robot stands still while it perceives.
    for entry, pose in zip(log.entries, poses, strict=True):
        assert (entry.pose.x, entry.pose.y) == pytest.approx(pose, abs=1e-6)
    # The way: from the start to near the goal, its length that of its pieces.
    assert log.travelled[0] == pytest.approx((start.x, start.y), abs=0.01)
    end = mission.simulator.pose
    assert math.hypot(end.x - 2.2, end.y - 1.7) <= 0.3
    pieces = np.hypot(*np.diff(log.travelled, axis=0).T)
    assert log.path_length == pytest.approx(pieces.sum(), rel=0.02, abs=0.03)
    assert log.duration == pytest.approx(mission.simulator.time, abs=2 * CONTROL_PERIOD)
    assert log.contacts == 0
    assert log.min_clearance == mission.simulator.least_clearance


def test_a_verdict_against_the_world_is_not_true(misjudged: Path) -> None:
    log = run_mission(misjudged)
    assert (log.outcome, log.truthful) == (Outcome.REACHED, False)


def test_too_long_a_mission_is_cancelled(room: World) -> None:
    log = run_mission(room, time_limit=2.0)
    assert log.outcome is Outcome.CANCELED
    assert "2 s" in log.message
    assert not log.truthful
    assert 2.0 < log.duration < 2.0 + 3 * CONTROL_PERIOD


@pytest.mark.parametrize("limit", [math.nan, -1.0])
def test_no_time_is_no_time_limit(room: World, limit: float) -> None:
    with pytest.raises(ValueError, match="time limit must be 0 s or longer"):
        run_mission(room, time_limit=limit)


def test_maps_reach_the_planner_as_messages_carry_them(room: World) -> None:
    """In whole percent, of the area that the world has."""
    mission = HeadlessMission(room, seed=2, planner={"robot_radius": 0.0})
    mission.run()
    geometry = mission.mapper.geometry
    assert (geometry.width, geometry.height) == (30, 24)
    risk = mission.planner.augmented_risk
    assert risk is not None
    assert risk == pytest.approx(np.round(100.0 * mission.mapper.planning_risk) / 100.0, abs=1e-9)
    assert 0.0 < risk.max() <= 1.0


def test_infrareds_of_stands_and_of_the_way_are_in_the_packets(room: World) -> None:
    mission = HeadlessMission(room, seed=1)
    packets, places = [], []
    update = mission.mapper.update

    def keep(readings: Sequence[RangeReading]) -> UpdateReport:
        packets.append(list(readings))
        places.append(mission.simulator.pose)
        return update(readings)

    mission.mapper.update = keep  # type: ignore[method-assign]
    log = mission.run()
    assert log.outcome is Outcome.REACHED
    assert len(packets) >= 2
    for number, (packet, pose) in enumerate(zip(packets, places, strict=True)):
        infrared = [r for r in packet if isinstance(r, InfraredReading)]
        assert len(packet) - len(infrared) == 48
        sweeps = {r.stamp: r.pose for r in infrared}
        assert len(infrared) == 16 * len(sweeps)
        way = [p for p in sweeps.values() if p.distance_to(pose.x, pose.y) > 0.01]
        if number == 0:  # where the robot starts, and nowhere else
            assert (len(sweeps), way) == (4, [])
            continue
        # Three at the stands, on the way one for each 0.1 m or a tick more.
        before = places[number - 1]
        distance = before.distance_to(pose.x, pose.y)
        assert distance / 0.14 - 1 <= len(sweeps) - 3 <= 1.3 * distance / 0.1 + 1
        for p in way:
            assert p.distance_to(before.x, before.y) >= 0.1 - 1e-6
    assert mission.mapper.perceptions == len(packets)


def test_single_parameters_override_the_preset(room: World) -> None:
    mission = HeadlessMission(
        room,
        mapper={"evidence.k_empty": 0.3, "area.size_x": 2.9},
        planner={"epsilon": 0.1},
        motion={"perception_cap": 1},
        simulator={"noise": False},
        seed=9,
    )
    assert mission.mapper.parameters.evidence.k_empty == 0.3
    assert mission.mapper.geometry.width == 29
    assert mission.planner.parameters.epsilon == 0.1
    assert (mission.simulator.parameters.seed, mission.simulator.parameters.noise) == (9, False)
    log = mission.run()
    assert (log.outcome, log.perceptions) == (Outcome.UNREACHABLE, 1)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_robot_without_infrareds_is_guarded_by_its_sonars(seed: int) -> None:
    none: dict[str, Any] = {"infrared.frame_ids": (), "infrared.bearings": ()}
    mission = HeadlessMission("lab", seed=seed, mapper=none, motion=none, simulator=none)
    log = mission.run()
    assert (log.outcome, log.contacts) == (Outcome.REACHED, 0)
    # Walls came close enough to be touched.
    assert 0.0 < log.min_clearance < 0.25


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"preset": "orolo1998"}, "did you mean 'oriolo1998'"),
        ({"mapper": {"evidence.kempty": 1.0}}, "did you mean 'evidence.k_empty'"),
        ({"planner": {"epsilom": 1.0}}, "did you mean 'epsilon'"),
        ({"motion": {"beta": 2.0}}, "at most"),
        ({"simulator": {"noize": True}}, "did you mean 'noise'"),
        ({"start": Pose2(0.1, 0.1, 0.0)}, "overlap an obstacle"),
        ({"start": Pose2(-9.0, 0.1, 0.0)}, r"the start \(-9, 0.1\) m lies outside the area"),
        ({"start": (1.0, 1.0, 0.0)}, "must be a Pose2"),
        ({"goal": (99.0, 1.0)}, r"the goal \(99, 1\) m lies outside the area"),
        ({"goal": (math.nan, 1.0)}, r"the goal \(nan, 1\) m lies outside"),
        ({"goal": (1,)}, r"must be a position \(x, y\) \[m\], got \(1,\)"),
        ({"goal": 1}, r"must be a position \(x, y\) \[m\], got 1"),
        ({"goal": ("a", "b")}, r"must be a position"),
    ],
)
def test_what_does_not_fit_is_refused(room: World, options: dict, message: str) -> None:  # type: ignore[type-arg]
    with pytest.raises(ValueError, match=message):
        HeadlessMission(room, **options)


def test_random_starts_are_near_clear_and_repeatable() -> None:
    lab = load_world("lab")
    starts = [random_start(lab, seed) for seed in range(1, 41)]
    assert starts == [random_start(lab, seed) for seed in range(1, 41)]
    assert len({(s.x, s.y, s.theta) for s in starts}) == 40
    for start in starts:
        assert max(abs(start.x - 1.25), abs(start.y - 5.25)) <= 0.3
        assert Simulator(lab, start=start).clearance() >= 0.05
    # Drawn from all of the square and of the circle.
    assert max(abs(s.x - 1.25) for s in starts) > 0.2
    assert min(s.theta for s in starts) < -2.0 < 2.0 < max(s.theta for s in starts)


def test_a_start_keeps_its_distance_where_it_is_narrow(room: World) -> None:
    """Drawn from all of the room, none is nearer to a wall than asked."""
    for seed in range(30):
        start = random_start(room, seed, spread=3.0, clearance=0.6)
        # Room for the centre: 0.23 + 0.6 m from walls 5 cm outside.
        assert 0.78 <= start.x <= 2.22
        assert 0.78 <= start.y <= 1.62


def test_no_room_for_a_start_is_told(room: World) -> None:
    with pytest.raises(ValueError, match=r"no start with 2 m of clearance .* 'small'"):
        random_start(room, 1, clearance=2.0)
    elsewhere = replace(room, start=Pose2(50.0, 50.0, 0.0))
    with pytest.raises(ValueError, match="no start"):
        random_start(elsewhere, 1)
