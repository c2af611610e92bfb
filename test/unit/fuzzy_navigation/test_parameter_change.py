# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parameters that change under a mission: what it still knows, and from when on they hold."""

import math
from typing import Any

import numpy as np
import pytest

from fuzzy_map_building.occupancy import Hundredths, risk_to_int8
from fuzzy_map_building.parameter_schema import flatten
from fuzzy_navigation.concurrent_mission import ConcurrentMission, mission_of
from fuzzy_navigation.explored_area import ExploredArea
from fuzzy_navigation.mission_types import Commands, Drive, Outcome, Perceive, Phase
from fuzzy_navigation.parameter_change import ParameterChange
from fuzzy_navigation.params import MotionParameters, motion_parameters
from unit.fuzzy_navigation.mission_script import DT, GEOMETRY, Script, finish_of, wall_at


class Coded(Script):
    """A script whose maps come as the mapper's do, in hundredths."""

    def show_map(self) -> Commands:
        codes = Hundredths(risk_to_int8(self.risk))
        return self.take(self.mission.on_map(self.now, GEOMETRY, codes))


def adopt(script: Script, **changes: Any) -> None:
    """Have a script's mission go by other parameters."""
    values = {name.replace("__", "."): value for name, value in changes.items()}
    script.parameters = motion_parameters(overrides={**flatten(script.parameters), **values})
    script.mission = mission_of(script.parameters, script.mission)


def cancelled() -> Script:
    """Return a script whose mission was cancelled half way, in sight of a wall."""
    script = Coded()
    script.seen = wall_at(3.7)
    script.risk = np.where(np.arange(60)[None, :] > 40, 0.8, np.zeros(GEOMETRY.shape))
    script.set_out((3.05, 2.05))
    while script.pose.x < 2.0:
        script.tick()
    script.take(script.mission.cancel(script.now))
    return script


@pytest.mark.parametrize("concurrent", [False, True])
def test_an_idle_mission_that_adopts_parameters_knows_what_it_knew(concurrent: bool) -> None:
    script = cancelled()
    before, log, maps = script.mission.feedback(), script.mission.log, script.mission.motion_map
    assert (before.perceptions, before.distance_remaining > 0.5) == (1, True)
    script.mission.maps_on_the_way = 7
    adopt(script, concurrent=concurrent, beta=0.75, watch__pose_jump=0.2)
    mission = script.mission
    assert isinstance(mission, ConcurrentMission) == concurrent
    assert (mission.feedback(), mission.log, mission.maps_on_the_way) == (before, log, 7)
    assert maps is not None
    assert mission.motion_map is not None
    np.testing.assert_array_equal(mission.motion_map.codes, maps.codes)
    # The pose is known, and with it where the goal lies: no "no pose has come yet".
    commands = script.start(3.05, 2.05)
    assert [type(command) for command in commands] == [Perceive]
    assert script.mission.feedback().hold == ""
    finish = finish_of(script.start(1.05, 2.05, tolerance=2.0))
    assert (finish.mission, finish.outcome) == (3, Outcome.REACHED)
    # What the sensors told is known as well: the robot need not wait for them.
    assert not mission._around.distrusted(script.now)


def test_other_rules_of_the_body_judge_the_map_that_is_known() -> None:
    script = cancelled()
    codes = Hundredths(risk_to_int8(script.risk))
    for changes in ({"beta": 0.7}, {"robot_radius": 0.4}, {"augmentation": "square"}):
        adopt(script, **changes)
        p = script.parameters
        rules = p.beta, p.robot_radius, p.augmentation
        anew = ExploredArea(GEOMETRY, codes, *rules, script.pose)
        area = script.mission._area
        assert area is not None
        np.testing.assert_array_equal(area.cells, anew.cells)
    assert 0 < np.count_nonzero(anew.cells) < anew.cells.size
    # A map that came in other numbers is not at hand any more: the next one counts.
    script.mission.on_map(script.now, GEOMETRY, script.risk)
    adopt(script, beta=0.8)
    assert script.mission._area is None


def test_a_smaller_speed_holds_on_the_way_and_is_braked_down_to() -> None:
    for before, after in ((0.6, 0.2), (0.2, 0.6)):
        script = Script()
        adopt(script, follower__max_linear=before)
        script.set_out((5.55, 2.05))
        while script.pose.x < 2.0:
            script.tick()
        assert script.mission.phase is Phase.MOVING
        assert speed(script) == pytest.approx(before)
        adopt(script, follower__max_linear=after)
        speeds = [before, *(speed(script) for _ in range(40))]
        assert speeds[-1] == pytest.approx(after)
        assert np.abs(np.diff(speeds)).max() <= 0.6 * DT + 1e-9
    assert finish_of(script.run()).outcome is Outcome.REACHED


def speed(script: Script) -> float:
    (drive,) = script.tick()
    assert isinstance(drive, Drive)
    return drive.linear


def test_while_a_mission_runs_only_what_its_path_does_not_rest_on_holds_at_once() -> None:
    change = ParameterChange(MotionParameters())
    wanted = {
        "attempts": 7,
        "timeout.lost": 20.0,
        "watch.pose_jump": 0.5,
        "follower.max_linear": 0.3,
        "follower.linear_acceleration": 0.3,
        "layer.closed": 0.03,
        "clearance.override": 0.03,
        "beta": 0.8,
        "patience": 3,
        "concurrent": True,
    }
    late = {name for name in wanted if name.split(".")[0] not in ("attempts", "timeout", "watch")}
    late.remove("follower.max_linear")
    assert change.want(motion_parameters(overrides=wanted), active=True)
    values, default = flatten(change.in_force), flatten(MotionParameters())
    for name, value in wanted.items():
        assert values[name] == (default[name] if name in late else value), name
    assert set(change.waiting) == late
    assert "taken, but beta will hold only when the goal" in change.remark(["attempts", "beta"])
    assert change.remark(["attempts", "no_parameter"]) == ""
    assert change.remark(late).count(", ") == 4
    assert "and 2 more will hold" in change.remark(late)
    # Nothing else is new; with the end of the mission all of it holds.
    assert not change.want(motion_parameters(overrides=wanted), active=True)
    assert change.want(motion_parameters(overrides=wanted), active=False)
    assert flatten(change.in_force) == {**default, **wanted}
    assert (change.waiting, change.remark(late)) == ((), "")
    # Taken back before it held.
    assert not change.want(motion_parameters(overrides={**wanted, "beta": 0.7}), active=True)
    assert change.waiting == ("beta",)
    assert not change.want(motion_parameters(overrides=wanted), active=True)
    assert change.waiting == ()


def test_before_the_first_goal_no_distance_to_one_is_told() -> None:
    script = Script()
    script.tick()
    assert math.isnan(script.mission.feedback().distance_remaining)
