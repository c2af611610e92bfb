# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pace and lockstep, in a wall time that the test makes."""

from collections.abc import Callable

import pytest

from nomad_sim.ros.tick_gate import BACKLOG, TickGate


def run(gate: TickGate, until: float, cost: Callable[[float], float], now: float = 0.0) -> list:
    """Take every tick when it is due, each lasting `cost`, and return when they began."""
    ticks = []
    while True:
        now += gate.wait(now)
        if now >= until:
            return ticks
        ticks.append(now)
        gate.ticked(now, None)
        now += cost(now)


def test_ticks_keep_the_pace() -> None:
    ticks = run(TickGate(0.0, 0.01), 1.0, lambda _: 0.002)
    assert ticks == pytest.approx([0.01 * (i + 1) for i in range(len(ticks))])
    assert len(ticks) in (98, 99)


def test_a_short_delay_is_made_up_for() -> None:
    gate = TickGate(0.0, 0.01)
    ticks = run(gate, 1.005, lambda now: 0.2 if 0.495 < now < 0.505 else 0.001)
    assert len(ticks) == 100
    assert gate.dropped == 0.0


def test_a_long_delay_is_given_up_and_told() -> None:
    gate = TickGate(0.0, 0.01)
    ticks = run(gate, 3.005, lambda now: 1.0 if 0.495 < now < 0.505 else 0.001)
    assert 195 <= len(ticks) <= 205
    assert gate.dropped == pytest.approx(1.0, abs=0.03)


def test_without_a_pace_the_next_tick_is_due_at_once() -> None:
    gate = TickGate(5.0, 0.0)
    for now in (5.0, 5.1, 7.0):
        assert gate.wait(now) == 0.0
        gate.ticked(now, None)
    assert gate.dropped == 0.0


def test_in_lockstep_each_tick_waits_for_its_answer() -> None:
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    assert gate.wait(0.0) == 0.0  # nobody commands yet
    now, pose = 0.0, 10.0
    gate.ticked(now, pose)
    gate.answered(0.1, pose)
    assert gate.engaged
    for _ in range(10):
        assert gate.wait(now + 0.1) == 0.0
        pose += 0.05
        gate.ticked(now, pose)
        assert gate.wait(now + 0.4) == pytest.approx(0.6)
        now += 0.5
        gate.answered(now, pose)
    assert gate.timeouts == 0


@pytest.mark.parametrize("pause", [0.02, 0.3])
def test_a_backlog_of_answers_puts_nobody_out_of_step(pause: float) -> None:
    """A commander that is ten ticks behind when it begins is none behind afterwards."""
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    poses, answered, now = [0.05 * i for i in range(10)], 0, 0.0
    for pose in poses:
        gate.ticked(now, pose)
    for i in range(400):
        # Long after the first answer, as it does on a busy machine, or at its own pace.
        now += pause if i == 1 else 0.02
        if answered < len(poses):
            gate.answered(now, poses[answered])
            answered += 1
        if gate.wait(now) == 0.0:
            assert answered == len(poses)
            poses.append(0.05 * len(poses))
            gate.ticked(now, poses[-1])
    assert len(poses) > 300


def test_what_answers_no_pose_or_an_older_one_lets_no_tick_pass() -> None:
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    gate.ticked(0.0, 5.0)
    for stamp in (4.95, 5.05, 0.0, 5.0 + 2.0):
        gate.answered(0.1, stamp)
        assert gate.wait(0.1) > 0.0
    gate.answered(0.2, 5.0 + 2.4e-7)  # rounded: a stamp of today in floating point
    assert gate.wait(0.2) == 0.0


def test_a_tick_that_tells_no_pose_has_no_answer_to_wait_for() -> None:
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    gate.ticked(0.0, 5.0)
    gate.answered(0.0, 5.0)
    gate.ticked(0.1, None)
    assert gate.wait(0.1) == 0.0
    assert gate.engaged


def test_a_pose_that_nobody_answered_is_not_waited_for_after_a_tick_without_one() -> None:
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    gate.ticked(0.0, 5.0)  # nobody commands yet
    gate.ticked(0.1, None)
    gate.answered(0.2, 4.0)
    assert gate.engaged
    assert gate.wait(0.2) == 0.0


def test_in_lockstep_an_early_command_does_not_break_the_pace() -> None:
    gate = TickGate(0.0, 0.2, lockstep=True)
    gate.ticked(0.0, 0.0)
    gate.answered(0.0, 0.0)
    assert gate.wait(0.3) == pytest.approx(0.1)
    gate.ticked(0.4, 0.05)
    gate.answered(0.41, 0.05)
    assert gate.wait(0.41) == pytest.approx(0.19)


def test_a_command_that_does_not_come_is_waited_for_once() -> None:
    gate = TickGate(0.0, 0.01, lockstep=True, timeout=1.0)
    gate.answered(0.0, 0.0)
    gate.ticked(0.2, 0.05)
    assert gate.wait(0.2) == pytest.approx(1.0)
    late = 1.201
    assert gate.wait(late) == 0.0
    assert gate.timeouts == 1
    assert not gate.engaged
    gate.ticked(late, 0.1)
    assert gate.wait(late) <= 0.01  # goes on at its pace
    gate.answered(late, 0.1)
    assert gate.engaged


def test_free_ticks_ignore_commands() -> None:
    gate = TickGate(0.0, 0.01)
    gate.ticked(0.0, 0.0)
    gate.answered(0.0, -0.05)
    assert not gate.engaged
    assert gate.wait(0.02) == 0.0


def test_changes_take_effect_with_the_next_tick() -> None:
    gate = TickGate(0.0, 10.0, lockstep=True)
    gate.answered(1.0, 0.0)
    gate.configure(2.0, 0.5, lockstep=False, timeout=1.0)
    assert not gate.engaged
    assert gate.wait(2.0) == 0.5


def test_the_backlog_bounds_how_many_ticks_follow_at_once() -> None:
    gate = TickGate(0.0, 0.05)
    gate.ticked(0.05, None)
    burst = 0
    while gate.wait(0.05 + BACKLOG + 0.04) == 0.0:
        gate.ticked(0.05 + BACKLOG + 0.04, None)
        burst += 1
    assert burst <= BACKLOG / 0.05 + 1
