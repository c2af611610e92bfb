# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pace and lockstep, in a wall time that the test makes."""

from collections.abc import Callable

import pytest

from nomad_sim.ros.tick_gate import BACKLOG, SETTLE_TIME, TickGate


def run(gate: TickGate, until: float, cost: Callable[[float], float], now: float = 0.0) -> list:
    """Take every tick when it is due, each lasting `cost`, and return when they began."""
    ticks = []
    while True:
        now += gate.wait(now)
        if now >= until:
            return ticks
        ticks.append(now)
        gate.ticked(now)
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
        gate.ticked(now)
    assert gate.dropped == 0.0


def test_in_lockstep_each_tick_has_one_command() -> None:
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    assert gate.wait(0.0) == 0.0  # nobody commands yet
    gate.ticked(0.0)
    gate.commanded(0.1)
    assert gate.engaged
    gate.commanded(0.25)  # an answer to an older tick: there is a backlog
    assert gate.wait(0.35) == pytest.approx(0.25 + SETTLE_TIME - 0.35)
    now = 0.25 + SETTLE_TIME
    assert gate.wait(now) == 0.0
    for _ in range(10):
        gate.ticked(now)
        assert gate.wait(now + 0.4) == pytest.approx(0.6)
        now += 0.5
        gate.commanded(now)
        assert gate.wait(now) == 0.0
    assert gate.timeouts == 0


def test_a_backlog_of_answers_puts_nobody_out_of_step() -> None:
    """A commander that is ten ticks behind when it begins is none behind afterwards."""
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    now, ticks, answered = 0.0, 10, 0
    for _ in range(400):
        now += 0.02  # the commander takes this long for an answer, if there is a tick to answer
        if answered < ticks:
            answered += 1
            gate.commanded(now)
        if gate.wait(now) == 0.0:
            assert answered == ticks
            gate.ticked(now)
            ticks += 1
    assert ticks > 300


def test_the_wait_for_silence_is_bounded() -> None:
    gate = TickGate(0.0, 0.0, lockstep=True, timeout=1.0)
    now = 0.0
    while gate.wait(now) > 0.0 or now == 0.0:
        gate.commanded(now)  # somebody who commands at a pace of his own
        now += 0.05
    assert now == pytest.approx(1.0, abs=0.06)


def test_in_lockstep_an_early_command_does_not_break_the_pace() -> None:
    gate = TickGate(0.0, 0.2, lockstep=True)
    gate.commanded(0.0)
    assert gate.wait(0.1) == pytest.approx(0.1)
    gate.ticked(0.2)
    gate.commanded(0.21)
    assert gate.wait(0.21) == pytest.approx(0.19)


def test_a_command_that_does_not_come_is_waited_for_once() -> None:
    gate = TickGate(0.0, 0.01, lockstep=True, timeout=1.0)
    gate.commanded(0.0)
    gate.ticked(SETTLE_TIME)
    assert gate.wait(SETTLE_TIME) == pytest.approx(1.0)
    late = SETTLE_TIME + 1.001
    assert gate.wait(late) == 0.0
    assert gate.timeouts == 1
    assert not gate.engaged
    gate.ticked(late)
    assert gate.wait(late) <= 0.01  # goes on at its pace
    gate.commanded(late)
    assert gate.engaged


def test_free_ticks_ignore_commands() -> None:
    gate = TickGate(0.0, 0.01)
    gate.commanded(0.0)
    assert not gate.engaged
    assert gate.wait(0.01) == 0.0


def test_changes_take_effect_with_the_next_tick() -> None:
    gate = TickGate(0.0, 10.0, lockstep=True)
    gate.commanded(1.0)
    gate.configure(2.0, 0.5, lockstep=False, timeout=1.0)
    assert not gate.engaged
    assert gate.wait(2.0) == 0.5


def test_the_backlog_bounds_how_many_ticks_follow_at_once() -> None:
    gate = TickGate(0.0, 0.05)
    gate.ticked(0.05)
    burst = 0
    while gate.wait(0.05 + BACKLOG + 0.04) == 0.0:
        gate.ticked(0.05 + BACKLOG + 0.04)
        burst += 1
    assert burst <= BACKLOG / 0.05 + 1
