# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions by script with clearance layer, sub-cell targets and sonar guard."""

import math

import numpy as np
import pytest

from fuzzy_navigation.mission_types import Drive, Outcome, Perceive, Plan, Stop
from fuzzy_navigation.params import motion_parameters
from unit.fuzzy_navigation.mission_script import (
    RADIUS,
    Script,
    cells_along,
    corridor,
    finish_of,
    hall,
    paper_script,
    wall_at,
)

GOAL = (3.05, 2.05)


def script_of(**overrides: object) -> Script:
    return Script(motion_parameters("consistent", overrides))


def test_the_planner_is_told_what_was_hit() -> None:
    script = script_of()
    script.seen = wall_at(1.75)
    script.tick()
    commands = script.start(*GOAL)
    for _ in range(3):
        script.tick()
    (plan,) = (c for c in script.perceive(commands) if isinstance(c, Plan))
    assert plan.hits
    for x, y in plan.hits:
        assert x == pytest.approx(1.75)
        assert math.dist((x, y), (1.05, 2.05)) <= RADIUS + 0.6
    oriolo = paper_script()
    oriolo.seen = wall_at(1.75)
    oriolo.tick()
    commands = oriolo.start(*GOAL)
    oriolo.tick()
    assert oriolo.perceive(commands)[-1].hits == ()


def test_the_planner_is_told_of_the_slimmer_robot() -> None:
    for script, radius in ((paper_script(slim_radius=0.1), 0.1), (script_of(), 0.0)):
        script.tick()
        (plan,) = (c for c in script.perceive(script.start(*GOAL)) if isinstance(c, Plan))
        assert (plan.slim_radius, plan.slim_above) == (radius, 0.6)
        # By the paper the robot drives from cell to cell.
        assert plan.any_angle == (radius == 0.0)


#: Clearance down to which each rung goes: 0.12 - 0.07 (alpha - 0.6) / 0.4.
@pytest.mark.parametrize(("alpha", "least"), [(0.6, 0.12), (0.8, 0.085), (1.0, 0.05)])
@pytest.mark.parametrize("x_wall", [2.45, 2.47, 2.52])
def test_it_stops_before_a_wall_by_the_rung_of_its_path(
    alpha: float, least: float, x_wall: float
) -> None:
    script = script_of(**{"layer.slack": 0.0})
    script.seen = wall_at(x_wall)
    commands = script.set_out(GOAL, alpha=alpha)
    commands = script.run()
    assert any(isinstance(c, Perceive) for c in commands)
    assert script.mission.feedback().last_stop is Stop.CLEARANCE
    clearance = x_wall - script.pose.x - RADIUS
    # In the last cell whose best place, 4.5 cm off its centre, is allowed.
    centres = np.arange(1.05, 3.0, 0.1)
    best = x_wall - (centres - 0.045) - RADIUS
    last = centres[best >= least - 1e-9][-1]
    assert script.pose.x == pytest.approx(last, abs=0.06)
    assert clearance >= 0.05 - 0.005


def test_it_drives_where_a_narrow_corridor_leaves_it_most_room() -> None:
    """The corridor's middle is 4.5 cm beside the cells' centres."""
    script = script_of()
    script.seen = corridor(2.095 - 0.33, 2.095 + 0.33)
    script.set_out(GOAL, alpha=0.9)
    commands = script.run()
    assert finish_of(commands).outcome is Outcome.REACHED
    on_the_way = [p for p in script.poses if 1.35 < p.x < 2.75]
    assert len(on_the_way) > 20
    assert all(abs(p.y - 2.095) < 0.012 for p in on_the_way)


def test_without_sub_cell_targets_it_keeps_to_the_centres() -> None:
    script = script_of(subcell_target=False)
    script.seen = corridor(2.095 - 0.4, 2.095 + 0.4)
    script.set_out(GOAL)
    assert finish_of(script.run()).outcome is Outcome.REACHED
    assert all(abs(p.y - 2.05) < 0.005 for p in script.poses)


def test_what_comes_into_sight_on_the_way_moves_the_targets_without_a_stop() -> None:
    script = script_of()
    script.seen = corridor(2.005 - 0.33, 2.005 + 0.33, x_from=2.3)
    script.set_out(GOAL, alpha=0.9)
    assert finish_of(script.run()).outcome is Outcome.REACHED
    inside = [p for p in script.poses if 2.4 < p.x < 2.8]
    assert inside
    assert all(abs(p.y - 2.005) < 0.015 for p in inside)
    speeds = [
        c.linear
        for c, p in zip(
            [c for c in script.commands if isinstance(c, Drive)], script.poses, strict=False
        )
        if 1.3 < p.x < 2.7
    ]
    assert min(speeds) > 0.05


def test_glass_that_only_sonars_see_stops_it_only_with_the_guard() -> None:
    for guard in (True, False):
        script = script_of(**{"sonar_guard.enabled": guard})
        script.heard = lambda *ray: min(wall_at(2.45)(*ray), hall(*ray))
        script.set_out(GOAL)
        commands = script.run()
        if guard:
            assert any(isinstance(c, Perceive) for c in commands)
            assert script.mission.feedback().last_stop is Stop.CLEARANCE
            assert 0.05 < 2.45 - script.pose.x - RADIUS < 0.2
            # From where it hears the glass it could always have stopped.
            drives = [c for c in script.commands if isinstance(c, Drive)]
            for pose, drive in zip(script.poses[-len(drives) :], drives, strict=True):
                room = 2.45 - pose.x - RADIUS - 0.12
                if 0.05 < room < 0.4:
                    assert drive.linear <= math.sqrt(2.0 * 0.6 * room) + 0.03
        else:
            assert finish_of(commands).outcome is Outcome.REACHED
            assert script.pose.x > 2.45


def test_the_guard_at_a_perception_tells_the_planner() -> None:
    script = script_of()
    script.heard = wall_at(1.85)
    script.tick()
    commands = script.start(*GOAL)
    script.tick()
    (plan,) = (c for c in script.perceive(commands) if isinstance(c, Plan))
    # Echoes within 0.6 m of the body: straight ahead, and at 22.5 deg, 0.8 / cos(22.5 deg) is
    # 0.87 m from the centre, too far.
    assert plan.hits == (pytest.approx((1.85, 2.05)),)


def test_the_memory_ends_with_the_next_perception() -> None:
    script = script_of()
    script.seen = wall_at(2.45)
    script.set_out(GOAL)
    commands = script.run()
    script.seen = lambda x, y, direction: math.inf
    for _ in range(12):  # older readings of the ring die out
        script.tick()
    commands = script.perceive(commands)
    assert commands[-1].hits == ()
    here = (script.pose.x, script.pose.y)
    script.plan(commands, cells_along(here, GOAL))
    assert finish_of(script.run()).outcome is Outcome.REACHED


@pytest.mark.parametrize("impasse", [0.15, 0.0])
def test_a_place_where_looks_find_no_room_is_barred_or_a_livelock(impasse: float) -> None:
    """The planner has no other way than through the wall."""
    script = script_of(**{"livelock_limit": 2, "clearance.impasse": impasse, "look_turn": 0.0})
    script.seen = wall_at(2.45)
    script.set_out(GOAL)
    for _ in range(3):
        commands = script.run()
        (plan,) = (c for c in script.perceive(commands) if isinstance(c, Plan))
        assert [2.15, 2.05] not in np.round(plan.barred, 9).tolist()
        here = (script.pose.x, script.pose.y)
        commands = script.plan((plan,), cells_along(here, GOAL), 0.6)
    commands = script.run()
    if impasse == 0.0:
        assert finish_of(commands).outcome is Outcome.LIVELOCK
    else:
        (plan,) = (c for c in script.perceive(commands) if isinstance(c, Plan))
        assert [2.15, 2.05] in np.round(plan.barred, 9).tolist()
