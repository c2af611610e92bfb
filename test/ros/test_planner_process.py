# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The planner as a process: before its first map, and its end."""

from __future__ import annotations

from collections.abc import Callable

from builtin_interfaces.msg import Time
from fuzzy_msgs.srv import PlanPath

from fuzzy_map_building.ros import names
from ros.harness import NodeProcess, Probe
from ros.planner_driver import Driver, map_message, world


def test_without_a_map_it_says_so(probe: Probe, start_node: Callable[..., NodeProcess]) -> None:
    planner = Driver(probe, start_node("planner"))
    response = planner.plan()
    assert response.status == PlanPath.Response.NO_MAP
    assert "no planning map" in response.message
    assert not response.path.poses
    status = planner.diagnostics.wait_for().status[0]
    assert status.name == names.PLANNER_NODE
    assert "planning_map" in status.message
    # A bad request is one also without a map.
    assert planner.plan(cost=9).status == PlanPath.Response.BAD_REQUEST


def test_maps_of_another_time_are_refused_and_counted(
    probe: Probe, start_node: Callable[..., NodeProcess]
) -> None:
    planner = Driver(probe, start_node("planner"))
    planner.give_and_wait(map_message(world(), stamp=1000))
    before = planner.counts()
    planner.give(map_message(world(), stamp=800))
    planner.wait_for_counts(before, {"rejected.planning_map.outdated": 1})
    planner.give(map_message(world(), stamp=2**31 - 1))
    planner.wait_for_counts(before, {"rejected.planning_map.future": 1})
    assert planner.plan().path.header.stamp == Time(sec=1000)
    planner.give_and_wait(map_message(world(), stamp=990))  # overtaken on the way


def test_an_unknown_parameter_ends_the_start(start_node: Callable[..., NodeProcess]) -> None:
    process = start_node("planner", parameters={"alpha_leader": [0.5]})
    assert process.wait() == 2
    assert "did you mean 'alpha_ladder'" in process.output()
    assert "Traceback" not in process.output()
