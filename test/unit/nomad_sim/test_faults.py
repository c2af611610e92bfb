# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Each fault against its definition, on telemetry made by hand."""

import functools
import math
from collections import Counter
from collections.abc import Callable

import pytest

from fuzzy_map_building.parameter_schema import ParameterError
from fuzzy_map_building.types import Pose2
from nomad_sim.fault_injection import FaultInjector
from nomad_sim.faults import KINDS, parse_faults
from nomad_sim.headless import run_mission
from nomad_sim.params import simulator_parameters
from nomad_sim.simulator import Simulator
from nomad_sim.telemetry import PoseReport, RangeReport, Telemetry, TurretReport, telemetry_of
from nomad_sim.world_io import load_world

TICK = 0.05
#: Ticks of a run: 10 s, and what 16 sensors measure in them.
RUN = range(200)
MEASURED = 16 * len(RUN)


@functools.cache
def sent(k: int) -> Telemetry:
    """What a robot tells in tick k: it drives along x at 0.4 m/s; no two values are the same."""
    time = round(k * TICK, 9)
    ranges = tuple(RangeReport(time, 1.0 + 0.001 * k + 0.01 * i, i) for i in range(16))
    return Telemetry(
        time,
        time,
        ranges,
        ranges,
        (TurretReport(time, 0.001 * k),),
        (PoseReport(time, Pose2(0.4 * time, 2.0, 0.3)),),
    )


def told(faults: str, seed: int = 0) -> list[Telemetry]:
    injector = FaultInjector(parse_faults(faults, 16, 16), seed)
    return [injector.apply(sent(k)) for k in RUN]


def changed(faults: str, ring: str) -> dict[tuple[int, int], float | None]:
    """Return by (tick, sensor) what differs from what was sent; None: it did not come."""
    differs: dict[tuple[int, int], float | None] = {}
    for k, tick in zip(RUN, told(faults), strict=True):
        came = {report.sensor: report.value for report in getattr(tick, ring)}
        for report in getattr(sent(k), ring):
            if came.get(report.sensor) != report.value:
                differs[k, report.sensor] = came.get(report.sensor)
    return differs


def test_without_faults_what_is_told_is_the_truth() -> None:
    assert told("") == [sent(k) for k in RUN]
    simulator = Simulator(load_world("lab"), simulator_parameters({"seed": 3}))
    simulator.step(0.3, 0.1)
    tick = telemetry_of(simulator)
    assert [r.value for r in tick.infrared] == simulator.infrared().tolist()
    assert [(r.stamp, r.sensor, r.value) for r in tick.sonar] == [
        (e.stamp, e.sensor, e.range) for e in simulator.sonar_events
    ]
    assert tick.pose == ((simulator.time, simulator.pose),)
    assert tick.turret == ((simulator.time, simulator.turret_angle),)


#: From 2 s on for 1 s: ticks 40 to 59.
WINDOW = {(k, i) for k in range(40, 60) for i in (3, 5)}


@pytest.mark.parametrize("ring", ["sonar", "infrared"])
@pytest.mark.parametrize(
    ("kind", "value"),
    [
        ("dead", lambda k, i: None),
        ("deaf", lambda k, i: math.inf),
        ("stuck", lambda k, i: 1.04 + 0.01 * i),
        ("biased offset=-0.3", lambda k, i: 0.7 + 0.001 * k + 0.01 * i),
        ("dazzled range=0.07", lambda k, i: 0.07),
    ],
)
def test_what_a_fault_of_a_sensor_makes_of_it(
    ring: str, kind: str, value: Callable[[int, int], float | None]
) -> None:
    name, *settings = kind.split()
    differs = changed(f"{name} {ring} sensors=3,5 start=2 end=3 {' '.join(settings)}", ring)
    # The first that a stuck sensor tells is true.
    assert set(differs) == {(k, i) for k, i in WINDOW if name != "stuck" or k > 40}
    for (k, i), came in differs.items():
        expected = value(k, i)
        assert came == (None if expected is None else pytest.approx(expected))


def test_a_faulty_sensor_reports_nan() -> None:
    differs = changed("faulty sonar sensors=3,5 start=2 end=3", "sonar")
    assert set(differs) == WINDOW
    assert all(value is not None and math.isnan(value) for value in differs.values())


@pytest.mark.parametrize("kind", ["faulty", "deaf", "dazzled", "noisy"])
def test_a_share_of_the_readings_is_befallen_and_no_other(kind: str) -> None:
    differs = changed(f"{kind} infrared share=0.25", "infrared")
    deviation = math.sqrt(0.25 * 0.75 / MEASURED)
    assert len(differs) / MEASURED == pytest.approx(0.25, abs=4.0 * deviation)
    by_sensor = Counter(sensor for _, sensor in differs)
    assert len(by_sensor) == 16


def test_noise_is_anything_up_to_a_range() -> None:
    values = [v for v in changed("noisy sonar range=2 share=1", "sonar").values() if v is not None]
    assert 0.0 <= min(values) < 0.05
    assert 1.95 < max(values) <= 2.0
    # Uniform: mean and variance.
    mean = sum(values) / len(values)
    assert mean == pytest.approx(1.0, abs=4.0 * math.sqrt(4.0 / 12.0 / len(values)))


def test_nothing_is_shorter_than_none_and_what_is_no_distance_stays() -> None:
    injector = FaultInjector(parse_faults("biased sonar offset=-2", 16, 16), 0)
    for value, expected in ((0.5, 0.0), (math.inf, math.inf), (-math.inf, -math.inf)):
        tick = Telemetry(0.0, 0.0, (), (RangeReport(0.0, value, 0),), (), ())
        assert injector.apply(tick).sonar[0].value == expected


def test_a_fault_that_comes_again() -> None:
    differs = changed("deaf infrared sensors=1 start=1 end=1.5 every=3", "infrared")
    assert {k for k, _ in differs} == {
        k for k in RUN if k * TICK >= 1.0 and math.fmod(k * TICK - 1.0 + 1e-9, 3.0) < 0.5
    }


def messages(faults: str, kind: str) -> list[tuple[int, float, int]]:
    """Return (tick of arrival, stamp, sensor) of all messages of a kind, as they came."""
    return [
        (k, report.stamp, getattr(report, "sensor", 0))
        for k, tick in zip(RUN, told(faults), strict=True)
        for report in getattr(tick, kind)
    ]


KINDS_OF_MESSAGES = ("sonar", "infrared", "turret", "pose")


@pytest.mark.parametrize("kind", KINDS_OF_MESSAGES)
def test_late_messages_come_later_as_they_were(kind: str) -> None:
    punctual = messages("", kind)
    late = messages(f"late {kind} delay=0.3 start=2 end=3", kind)
    arrival = {(stamp, sensor): k for k, stamp, sensor in late}
    assert len(late) == len(arrival) == len(punctual)
    for k, stamp, sensor in punctual:
        assert arrival[stamp, sensor] == (k + 6 if 40 <= k < 60 else k)


@pytest.mark.parametrize("kind", KINDS_OF_MESSAGES)
def test_lost_and_duplicated_messages(kind: str) -> None:
    punctual = messages("", kind)
    count = len(punctual)
    deviation = math.sqrt(0.3 * 0.7 / count)
    lost = messages(f"lost {kind} share=0.3", kind)
    kept = set(lost)
    assert lost == [message for message in punctual if message in kept]
    assert len(lost) / count == pytest.approx(0.7, abs=4.0 * deviation)
    twice = Counter(messages(f"duplicated {kind} share=0.3", kind))
    assert set(twice) == set(punctual)
    assert set(twice.values()) == {1, 2}
    assert sum(twice.values()) / count == pytest.approx(1.3, abs=4.0 * deviation)
    assert [*dict.fromkeys(messages(f"duplicated {kind}", kind))] == punctual


@pytest.mark.parametrize("kind", KINDS_OF_MESSAGES)
def test_reordered_messages_come_behind_those_of_the_next_tick(kind: str) -> None:
    punctual = {(stamp, sensor): k for k, stamp, sensor in messages("", kind)}
    came = messages(f"reordered {kind} share=0.3 end=9", kind)
    assert len(came) == len(punctual)
    kept = [m for m in came if m[0] != punctual[m[1], m[2]]]
    assert len(kept) / (0.9 * len(came)) == pytest.approx(
        0.3, abs=4.0 * math.sqrt(0.21 / len(came))
    )
    for k, stamp, sensor in kept:
        assert k == punctual[stamp, sensor] + 1
    for k in RUN:
        stamps = [stamp for at, stamp, _ in came if at == k]
        assert stamps == sorted(stamps, reverse=True)


def test_a_pose_that_jumps_and_jumps_back() -> None:
    for k, tick in zip(RUN, told("jumping pose x=0.5 y=-0.2 theta=3 start=2 end=3"), strict=True):
        true, off = sent(k).pose[0].pose, tick.pose[0].pose
        if 40 <= k < 60:
            assert (off.x, off.y) == pytest.approx((true.x + 0.5, true.y - 0.2))
            assert off.theta == pytest.approx(3.3 - 2.0 * math.pi)
        else:
            assert off == true


def test_a_pose_and_a_turret_that_stay_where_they_are() -> None:
    for k, tick in zip(RUN, told("stuck pose start=2 end=3; stuck turret start=4"), strict=True):
        assert tick.pose[0].stamp == sent(k).time
        assert tick.pose[0].pose == sent(40 if 40 <= k < 60 else k).pose[0].pose
        assert tick.turret[0].angle == sent(min(k, 80)).turret[0].angle


def test_a_drift_grows_with_the_root_of_the_way() -> None:
    strays = []
    (fault,) = parse_faults("drifting pose distance=0.05 theta=0.02", 16, 16)
    poses = [Telemetry(tick.time, tick.clock, (), (), (), tick.pose) for tick in map(sent, RUN)]
    for seed in range(200):
        injector = FaultInjector([fault], seed)
        pose = [injector.apply(tick) for tick in poses][-1].pose[0].pose
        true = sent(RUN[-1]).pose[0].pose
        strays.append((pose.x - true.x, pose.y - true.y, pose.theta - true.theta))
    way = 0.4 * TICK * (len(RUN) - 1)
    for axis, deviation in enumerate((0.05, 0.05, 0.02)):
        squares = sum(stray[axis] ** 2 for stray in strays) / len(strays)
        assert math.sqrt(squares) == pytest.approx(deviation * math.sqrt(way), rel=0.2)


def test_a_clock_that_is_set_back_takes_all_stamps_with_it() -> None:
    for k, tick in zip(
        RUN, told("set_back clock by=1.5 start=2; late pose delay=0.1"), strict=True
    ):
        back = 1.5 if k >= 40 else 0.0
        assert tick.time == sent(k).time
        assert tick.clock == pytest.approx(sent(k).time - back)
        for report in (*tick.infrared, *tick.sonar, *tick.turret):
            assert report.stamp == pytest.approx(tick.clock)
        # What is on its way when it happens keeps its stamp.
        for pose in tick.pose:
            assert pose.stamp == pytest.approx(sent(k - 2).time - (1.5 if k - 2 >= 40 else 0.0))


def test_the_same_seed_gives_the_same_faults_and_another_others() -> None:
    text = "noisy sonar; lost pose; drifting pose"
    assert told(text, 4) == told(text, 4)
    assert told(text, 4) != told(text, 5)


def test_faults_of_a_mission_begin_in_time() -> None:
    """Up to its start a fault changes nothing, in the same noise."""
    true = run_mission("lab", seed=3, preset="consistent", time_limit=6.0)
    late = run_mission(
        "lab", seed=3, preset="consistent", time_limit=6.0,
        simulator={"faults": "dazzled infrared start=6.5"},
    )  # fmt: skip
    early = run_mission(
        "lab", seed=3, preset="consistent", time_limit=6.0,
        simulator={"faults": "dazzled infrared start=3"},
    )  # fmt: skip
    assert (true.travelled == late.travelled).all()
    assert len(early.travelled) != len(true.travelled)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("stuk sonar", "unknown kind 'stuk'; did you mean 'stuck'"),
        ("stuck", "KIND TARGET"),
        ("stuck clock", "'stuck' is of sonar or infrared or turret or pose, got 'clock'"),
        ("deaf sonar shar=0.3", "unknown name 'shar'; did you mean 'share'"),
        ("deaf sonar share", "unknown name 'share'"),
        ("deaf sonar share=2", "share is a number from 0 to 1, got '2'"),
        ("deaf sonar share=nan", "got 'nan'"),
        ("deaf sonar share=x", "got 'x'"),
        ("deaf sonar sensors=16", "numbers from 0 to 15"),
        ("deaf sonar sensors=-1", "numbers from 0 to 15"),
        ("deaf sonar sensors=1,,2", "numbers from 0 to 15"),
        ("deaf sonar sensors=99999999999", "numbers from 0 to 15"),
        ("late pose sensors=1", "unknown name 'sensors'"),
        ("late pose start=3 end=3", "start must be before end"),
        ("late pose;" * 101, "more than 100"),
    ],
)
def test_what_is_no_fault_is_refused(text: str, message: str) -> None:
    with pytest.raises(ParameterError, match="'faults'") as refusal:
        simulator_parameters({"faults": text})
    assert message in str(refusal.value)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_can_be_written_with_all_its_numbers(kind: str) -> None:
    for target in KINDS[kind].targets:
        numbers = " ".join(f"{name}={v.default}" for name, v in KINDS[kind].values.items())
        (fault,) = parse_faults(f" {kind}  {target} {numbers} ; ", 16, 16)
        assert (fault.kind, fault.target, fault.sensors) == (kind, target, ())
        injector = FaultInjector([fault], 0)
        assert [injector.apply(sent(k)) for k in RUN] != [sent(k) for k in RUN]
