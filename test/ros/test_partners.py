# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The motion's clients, and partners that are missing."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import Plan
from fuzzy_navigation.ros.partners import MapperClient, PlannerClient
from ros.harness import Probe

LIMIT = 2.0


@pytest.mark.parametrize("partner", ["mapper", "planner"])
def test_who_was_held_up_has_not_waited_meanwhile(
    probe: Probe, monkeypatch: pytest.MonkeyPatch, partner: str
) -> None:
    wall = SimpleNamespace(now=50.0)
    clock = SimpleNamespace(monotonic=lambda: wall.now)
    monkeypatch.setattr("fuzzy_map_building.ros.clock.time", clock)
    failed: list[str] = []
    client: MapperClient | PlannerClient
    if partner == "mapper":
        client = MapperClient(probe.node, lambda _, ok, message: failed.append(message))
        client.ask(1, LIMIT)
    else:
        client = PlannerClient(
            probe.node, lambda *_: None, lambda _, message: failed.append(message), lambda: ()
        )
        client.ask(Plan(1, Pose2(0.0, 0.0), Pose2(1.0, 0.0), 0.1), 0.0, LIMIT)
    wall.now += 100.0
    for _ in range(round(0.9 * LIMIT / 0.05)):
        wall.now += 0.05
        client.watch()
    assert failed == []
    for _ in range(round(0.2 * LIMIT / 0.05)):
        wall.now += 0.05
        client.watch()
    assert len(failed) == 1
    assert "nobody serves" in failed[0]
