# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The planner as a process: answers equal to the core's, refusals that say why."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from fuzzy_msgs.srv import PlanPath
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.conversions import path_from_msg
from fuzzy_navigation.agreement import shared_parameters
from fuzzy_navigation.params import PlannerParameters, planner_parameters
from fuzzy_navigation.plan_request import MOST_HITS
from fuzzy_navigation.planner import Planner, PlanStatus
from ros.harness import NodeProcess, Probe, wait_until
from ros.planner_driver import GEOMETRY, GOAL, START, Driver, at, map_message, request, world


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Driver]:
    """One process for all tests of this module."""
    log = tmp_path_factory.mktemp("planner") / "planner.log"
    probe = Probe()
    process = NodeProcess("planner", log)
    try:
        yield Driver(probe, process)
        process.assert_clean_stop()
    finally:
        process.close()
        probe.close()


@pytest.fixture
def planner(running: Driver) -> Driver:
    """The process with the map that the tests reckon with."""
    running.give_and_wait(map_message(world()))
    running.plans.clear()
    return running


def core(parameters: PlannerParameters | None = None) -> Planner:
    """The core on the same map: what goes over the wire is percent."""
    out = Planner(GEOMETRY, parameters)
    out.set_map(world() / 100.0)
    return out


def change(planner: Driver, name: str, value: Any) -> Any:
    """Set a parameter of the node and return what came of it."""
    changed = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
    service = f"{names.PLANNER_NODE}/set_parameters"
    return planner.probe.call(SetParameters, service, changed).results[0]


REQUESTS: list[dict[str, Any]] = [
    {},
    {"cost": PlanPath.Request.G1},
    {"cost": PlanPath.Request.G2},
    {"cost": PlanPath.Request.G3},
    {"adjacency": 4},
    {"cost": PlanPath.Request.G3, "adjacency": 8},
    {"alpha": 0.7},
    {"alpha": 0.05},
    {"alpha": 1.0},
    {"tolerance": 0.05},
    {"goal": at(GOAL, frame="")},
    {"goal": at((1.05, 3.45)), "tolerance": 0.6},
    {"start": at(GOAL), "goal": at(START)},
    {"goal": at(START)},
    {"barred": [Point(x=1.05, y=1.85), Point(x=1.05, y=1.65), Point(x=90.0, y=0.0)]},
    {"barred": [Point(x=1.05, y=y) for y in np.arange(1.35, 2.1, 0.1)], "alpha": 0.6},
    {"hits": [Point(x=1.05, y=y) for y in np.arange(1.35, 2.1, 0.1)]},
    {"slim_radius": 0.12, "slim_above": 0.05},
    {"any_angle": True},
]
COSTS = {0: None, 1: "g1", 2: "g2", 3: "g3"}


def test_plan_path_answers_what_the_core_answers(planner: Driver) -> None:
    statuses = set()
    for fields in REQUESTS:
        asked = request(**fields)
        expected = core().plan(
            (asked.start.pose.position.x, asked.start.pose.position.y),
            (asked.goal.pose.position.x, asked.goal.pose.position.y),
            COSTS[asked.cost],
            asked.alpha,
            asked.adjacency,
            asked.tolerance,
            barred=[(point.x, point.y) for point in asked.barred],
            hits=[(point.x, point.y) for point in asked.hits],
            slim_radius=asked.slim_radius,
            slim_above=asked.slim_above,
            any_angle=asked.any_angle,
        )
        response = planner.plan(**fields)
        assert response.status == expected.status, fields
        assert response.message == expected.message
        assert (response.g1, response.g2, response.g3) == (expected.g1, expected.g2, expected.g3)
        assert response.alpha == pytest.approx(expected.alpha, abs=1e-6)
        assert response.expanded_cells == expected.expanded
        assert tuple(response.parameters) == shared_parameters(PlannerParameters())
        assert 0.0 < response.planning_time < 10.0
        poses = path_from_msg(response.path)
        assert [(p.x, p.y) for p in poses] == [(p.x, p.y) for p in expected.poses]
        assert [p.theta for p in poses] == pytest.approx([p.theta for p in expected.poses])
        assert response.path.header.frame_id == "map"
        assert response.path.header.stamp == Time(sec=1)
        statuses.add(expected.status)
    assert statuses == {PlanStatus.FOUND, PlanStatus.NO_PATH}


def test_hits_count_as_long_as_the_layer_is_on(planner: Driver) -> None:
    hits = [Point(x=1.05, y=1.35), Point(x=1.05, y=1.45)]
    positions = [(point.x, point.y) for point in hits]
    expected = core().plan(START, GOAL, hits=positions)
    response = planner.plan(hits=hits)
    assert response.message == expected.message
    assert [(p.x, p.y) for p in path_from_msg(response.path)] == [
        (p.x, p.y) for p in expected.poses
    ]
    without = planner.plan()
    assert path_from_msg(response.path) != path_from_msg(without.path)
    refused = planner.plan(hits=[Point(x=math.nan, y=1.0)])
    assert refused.status == PlanPath.Response.BAD_REQUEST
    assert "hits positions must be finite" in refused.message
    refused = planner.plan(hits=[Point()] * (MOST_HITS + 1))
    assert refused.status == PlanPath.Response.BAD_REQUEST
    assert f"{MOST_HITS} at most" in refused.message
    assert change(planner, "layer.enabled", False).successful
    try:
        assert path_from_msg(planner.plan(hits=hits).path) == path_from_msg(without.path)
    finally:
        assert change(planner, "layer.enabled", True).successful


def test_get_plan_and_the_topic_plan(planner: Driver) -> None:
    asked = GetPlan.Request(start=at(START), goal=at(GOAL))
    plan = planner.probe.call(GetPlan, names.GET_PLAN, asked).plan
    expected = core().plan(START, GOAL)
    assert [(p.x, p.y) for p in path_from_msg(plan)] == [(p.x, p.y) for p in expected.poses]
    assert planner.plans.wait_for() == plan
    # Latched: whoever comes later sees the plan as well.
    late = planner.probe.subscribe(Path, names.PLAN, qos.LATCHED)
    assert late.wait_for() == plan


def test_get_plan_answers_an_empty_path_when_there_is_none(planner: Driver) -> None:
    asked = GetPlan.Request(start=at(START), goal=at((50.0, 50.0)))
    assert not planner.probe.call(GetPlan, names.GET_PLAN, asked).plan.poses
    planner.process.wait_for_output("the goal (50.00, 50.00) m lies outside the map")
    assert not planner.plans.messages


def test_every_request_of_a_burst_is_answered(planner: Driver) -> None:
    """Many more than the ten requests that wait by ROS's default."""
    client = planner.probe.node.create_client(PlanPath, names.PLAN_PATH, qos_profile=qos.REQUESTS)
    wait_until(client.service_is_ready, "the service")
    sent = planner.probe.run(lambda: [client.call_async(request()) for _ in range(60)])
    answers = [planner.probe.result_of(future, "an answer") for future in sent]
    assert {answer.status for answer in answers} == {PlanPath.Response.FOUND}
    planner.probe.run(lambda: planner.probe.node.destroy_client(client))


def turned(**quaternion: float) -> PoseStamped:
    message = at(GOAL)
    message.pose.orientation.w = 0.0
    for name, value in quaternion.items():
        setattr(message.pose.orientation, name, value)
    return message


BAD_REQUESTS: list[tuple[dict[str, Any], str]] = [
    ({"start": at(START, "odom")}, "the start is in frame 'odom', expected 'map'"),
    ({"goal": at(GOAL, "base_link")}, "the goal is in frame 'base_link', expected 'map'"),
    ({"start": at((math.nan, 1.0))}, "the start has a position that is not finite"),
    ({"goal": at((1.0, math.inf))}, "the goal has a position that is not finite"),
    ({"goal": at((1e300, 1.0))}, "the goal lies beyond"),
    ({"goal": turned(w=math.nan)}, "the goal has an orientation that is not finite"),
    ({"goal": turned()}, "the goal has an orientation of norm 0"),
    ({"goal": turned(x=1.0)}, "the goal is tilted"),
    ({"alpha": -0.1}, "alpha must lie in [0, 1]"),
    ({"alpha": 1.5}, "alpha must lie in [0, 1]"),
    ({"alpha": math.nan}, "alpha must lie in [0, 1]"),
    ({"adjacency": 6}, "adjacency must be 0, 4 or 8, got 6"),
    ({"cost": 4}, "cost must be one of 0, 1, 2, 3, got 4"),
    ({"barred": [Point(x=math.nan)]}, "barred"),
    ({"slim_radius": -0.1}, "slim_radius must lie in [0, 5] m"),
    ({"slim_above": math.nan}, "slim_above must lie in [0, 1]"),
    ({"tolerance": -0.1}, "tolerance must lie in [0, 10] m"),
    ({"tolerance": 10.5}, "tolerance must lie in [0, 10] m"),
    ({"tolerance": math.inf}, "tolerance must lie in [0, 10] m"),
]


def test_bad_requests_are_refused_with_a_reason_and_counted(planner: Driver) -> None:
    before = planner.counts()
    for fields, reason in BAD_REQUESTS:
        response = planner.plan(**fields)
        assert response.status == PlanPath.Response.BAD_REQUEST, fields
        assert reason in response.message
        assert not response.path.poses
    outside = planner.plan(start=at((-1.05, 1.0)))
    assert outside.status == PlanPath.Response.START_OUTSIDE
    assert "the start (-1.05, 1.00) m lies outside the map" in outside.message
    assert planner.plan(goal=at((1.0, 3.55))).status == PlanPath.Response.GOAL_OUTSIDE
    assert not planner.plans.messages
    planner.wait_for_counts(
        before,
        {
            "rejected.plan_path.bad_request": len(BAD_REQUESTS),
            "plans.start_outside": 1,
            "plans.goal_outside": 1,
        },
    )
    assert planner.plan().status == PlanPath.Response.FOUND


def broken(**changes: Any) -> OccupancyGrid:
    """A map that differs from a good one in the named places."""
    message = map_message(world(), stamp=2)
    for name, value in changes.items():
        *path, last = name.split("__")
        target = message
        for step in path:
            target = getattr(target, step)
        setattr(target, last, value)
    return message


def with_value(value: int) -> OccupancyGrid:
    values = world()
    values[3, 5] = value
    return map_message(values, stamp=2)


BAD_MAPS: list[tuple[OccupancyGrid, str]] = [
    (OccupancyGrid(), "wrong_frame"),
    (broken(header__frame_id="odom"), "wrong_frame"),
    (broken(info__width=0), "geometry"),
    (broken(info__height=2**32 - 1), "geometry"),
    (broken(info__width=41), "size"),
    (broken(data=[]), "size"),
    (broken(info__resolution=0.0), "geometry"),
    (broken(info__resolution=-0.1), "geometry"),
    (broken(info__resolution=math.nan), "geometry"),
    (broken(info__origin__position__x=math.nan), "not_finite"),
    (broken(info__origin__orientation__z=0.6, info__origin__orientation__w=0.8), "rotated"),
    (broken(info__origin__orientation__w=0.0), "quaternion_norm"),
    (with_value(-1), "unknown"),
    (with_value(101), "value"),
    (with_value(-7), "value"),
]


def test_bad_maps_are_refused_and_the_last_good_one_stays(planner: Driver) -> None:
    before = planner.counts()
    for message, reason in BAD_MAPS:
        planner.give(message)
        response = planner.plan()
        assert response.path.header.stamp == Time(sec=1), reason
        assert response.g2 == core().plan(START, GOAL).g2
    planner.wait_for_counts(
        before, Counter(f"rejected.planning_map.{reason}" for _, reason in BAD_MAPS)
    )
    # A map of another size is taken.
    planner.give_and_wait(map_message(np.zeros((50, 60), np.int8), stamp=3))
    assert planner.plan(goal=at((4.5, 5.0))).status == PlanPath.Response.FOUND


def test_a_parameter_changes_the_plans_at_once(planner: Driver) -> None:

    assert change(planner, "cost", "g1").successful
    assert change(planner, "robot_radius", 0.0).successful
    expected = core(planner_parameters(overrides={"cost": "g1", "robot_radius": 0.0}))
    response = planner.plan()
    assert response.g1 == expected.plan(START, GOAL).g1
    assert response.g1 != core().plan(START, GOAL, "g1").g1
    refused = change(planner, "alpha_ladder", [0.9, 0.6])
    assert not refused.successful
    assert "rise" in refused.reason
    assert planner.plan().g1 == response.g1
    assert change(planner, "cost", "g2").successful
    assert change(planner, "robot_radius", PlannerParameters().robot_radius).successful
