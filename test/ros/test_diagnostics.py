# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a node says of itself, and that it says it once."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from fuzzy_map_building.ros import clock_gate, names, qos
from fuzzy_map_building.ros.clock_gate import ClockGate
from fuzzy_map_building.ros.diagnostics import Diagnostics
from ros.harness import Probe, Received

#: What the core tells of its refusals, and what is said of them.
SHOWN = {"late": "sonar 3 stamped 2.000 s", "nan": "sonar 4 stamped 2.100 s"}
TOLD = {"late": "too late for a pose", "nan": "faulty"}


class Bench:
    def __init__(self, probe: Probe) -> None:
        self.problem = ""
        self.node = probe.node
        self.received: Received[DiagnosticArray] = probe.subscribe(
            DiagnosticArray, names.DIAGNOSTICS, qos.RELIABLE
        )
        self.diagnostics = Diagnostics(
            probe.node, values=lambda: {"colour": "blue"}, problem=lambda: self.problem
        )

    def status(self) -> DiagnosticStatus:
        self.received.clear()
        self.diagnostics.publish()
        return self.received.wait_for().status[0]


@pytest.fixture
def bench(probe: Probe) -> Iterator[Bench]:
    return Bench(probe)


def values(status: DiagnosticStatus) -> dict[str, str]:
    return {v.key: v.value for v in status.values}


def test_a_node_without_troubles_is_ok(bench: Bench) -> None:
    bench.received.wait_for(what="a status without being asked, within a period")
    status = bench.status()
    assert status.name == "probe"
    assert status.level == DiagnosticStatus.OK
    assert status.message == "ok"
    assert values(status) == {"colour": "blue"}


def test_refusals_are_counted_by_source_and_reason(bench: Bench) -> None:
    bench.diagnostics.reject("pose", "no_stamp", "pose has no stamp")
    bench.diagnostics.reject("pose", "no_stamp", "pose has no stamp", 2)
    bench.diagnostics.reject("sonar", "nan", "faulty", 0)  # none: not even mentioned
    bench.diagnostics.reject("posed", "nan", "another source")
    assert bench.diagnostics.total("pose") == 3
    assert bench.diagnostics.total("sonar") == 0


def test_a_refusal_warns_for_one_period_and_is_remembered(bench: Bench) -> None:
    # Not spun by the timer meanwhile: the probe's thread would publish in between.
    bench.diagnostics._timer.cancel()
    bench.diagnostics.reject("pose", "no_stamp", "pose has no stamp", 3)
    first = bench.status()
    assert first.level == DiagnosticStatus.WARN
    assert first.message == "3 refused, last: pose: pose has no stamp"
    second = bench.status()
    assert second.level == DiagnosticStatus.OK
    assert values(first) == values(second) == {"colour": "blue", "rejected.pose.no_stamp": "3"}


def test_a_problem_warns_as_long_as_it_lasts(bench: Bench) -> None:
    bench.problem = "no pose has come"
    assert bench.status().message == "no pose has come"
    assert bench.status().level == DiagnosticStatus.WARN
    bench.problem = ""
    assert bench.status().level == DiagnosticStatus.OK


def test_counters_of_the_core_are_followed(bench: Bench) -> None:
    totals = {"late": 2}
    bench.diagnostics.follow("sonar", totals, TOLD, SHOWN)
    bench.diagnostics.follow("sonar", totals, TOLD, SHOWN)
    totals["late"] = 5
    totals["nan"] = 1
    bench.diagnostics.follow("sonar", totals, TOLD, SHOWN)
    assert bench.diagnostics.total("sonar") == 6
    assert bench.status().message.endswith("last: sonar: sonar 4 stamped 2.100 s: faulty")
    # A counter of a new object begins at nothing.
    bench.diagnostics.follow("sonar", {"late": 1}, TOLD, SHOWN)
    assert bench.diagnostics.total("sonar") == 7


def test_what_is_no_fault_is_counted_without_a_warning(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.diagnostics._timer.cancel()
    bench.diagnostics.follow("sonar", {"early": 3}, {"early": ""}, {"early": "sonar 1"})
    status = bench.status()
    assert (status.level, status.message) == (DiagnosticStatus.OK, "ok")
    assert values(status)["rejected.sonar.early"] == "3"
    assert "sonar" not in capfd.readouterr().err


def test_before_simulated_time_has_begun_stamps_are_no_fault_for_a_while(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.diagnostics._timer.cancel()
    now = [0.0]
    monkeypatch.setattr(clock_gate, "now_seconds", lambda _: now[0])
    gate = ClockGate(bench.node, bench.diagnostics)
    assert not gate.admits("pose")
    assert bench.status().level == DiagnosticStatus.OK
    assert capfd.readouterr().err == ""
    monkeypatch.setattr(clock_gate, "PATIENCE", 0.0)
    assert not gate.admits("pose")
    status = bench.status()
    assert "nothing comes by '/clock'" in status.message
    assert {k: v for k, v in values(status).items() if k != "colour"} == {
        "rejected.pose.before_clock": "1",
        "rejected.pose.no_clock": "1",
    }
    now[0] = 3.0
    assert gate.admits("pose")
