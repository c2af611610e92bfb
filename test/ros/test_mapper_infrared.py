# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mapper with infrared readings as evidence, against the core in this process."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import pytest
from builtin_interfaces.msg import Time
from fuzzy_msgs.action import BuildMap
from sensor_msgs.msg import Range

from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import mapper_parameters
from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import stamp_from_seconds
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading
from ros.fake_robot import range_to_msg
from ros.harness import Probe, wait_until
from ros.test_mapper_input import K_EMPTY, Bench, assert_equals_core

PARAMETERS = mapper_parameters("consistent", {"evidence.k_empty": K_EMPTY})
BEARINGS = PARAMETERS.infrared.bearings


class InfraredBench(Bench):
    """The bench with infrared sensors."""

    def __init__(self, probe: Probe, *arguments: object) -> None:
        super().__init__(probe, *arguments, preset="consistent")  # type: ignore[arg-type]
        self._infrared = probe.publisher(Range, names.INFRARED, qos.RANGES)

    def infrared(self, after: float, sensor: int, value: float, **header: object) -> None:
        message = range_to_msg(0, stamp_from_seconds(self.start + after), value)
        message.radiation_type = Range.INFRARED
        message.header.frame_id = names.infrared_frame(sensor)
        for name, changed in header.items():
            setattr(message.header, name, changed)
        self._infrared.publish(message)


@pytest.fixture(scope="module")
def shared_bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[InfraredBench]:
    probe = Probe()
    bench = InfraredBench(probe, tmp_path_factory.mktemp("mapper") / "mapper.log")
    yield bench
    bench.mapper.close()
    probe.close()


@pytest.fixture
def bench(shared_bench: InfraredBench) -> InfraredBench:
    shared_bench.begin()
    return shared_bench


def core() -> FuzzyMapper:
    return FuzzyMapper(PARAMETERS.area.geometry(), PARAMETERS)


def test_sweeps_of_the_way_join_a_packet_and_bad_ones_are_counted(bench: InfraredBench) -> None:
    # Driving along x at 1 m/s. A sweep of three sensors every 5 cm, of which each second counts.
    values = {0: 0.3, 4: math.inf, 12: 0.4}
    for after in (0.05, 0.10, 0.15):
        for sensor, value in values.items():
            bench.infrared(after, sensor, value + after)
    bench.infrared(0.15, 7, math.nan)
    bench.infrared(0.15, 8, 2.0)
    bench.infrared(0.15, 99, 0.3)
    bench.infrared(0.15, 0, 0.3, stamp=Time())
    bench.infrared(0.15, 0, 0.3, frame_id="sonar_0")
    for sensor in range(8):
        bench.range(0.2, sensor, 1.0)
    bench.wait_for_value("waiting_readings", 8 + 9 + 2)
    for after, x in ((0.0, 2.0), (0.4, 2.4)):
        bench.joint(after, 0.0)
        bench.pose(after, x, 3.0)
    expected = core()
    rays = [
        InfraredReading(Pose2(2.0 + after, 3.0), BEARINGS[sensor], round(value + after, 4))
        for after in (0.05, 0.15)
        for sensor, value in values.items()
    ]
    expected.update(
        [
            *(SonarReading(Pose2(2.2, 3.0), k * math.radians(22.5), 1.0) for k in range(8)),
            *rays,
        ]
    )
    assert_equals_core(bench.maps.wait_for(), expected)
    bench.wait_for_rejected(
        {
            "infrared.nan": 1,
            "infrared.out_of_range": 1,
            "infrared.unknown_frame": 2,
            "infrared.no_stamp": 1,
        }
    )
    # What was fused is not fused again.
    bench.maps.clear()
    for sensor in range(8):
        bench.range(0.3, sensor, 1.2)
    again = [SonarReading(Pose2(2.3, 3.0), k * math.radians(22.5), 1.2) for k in range(8)]
    expected.update(again)
    assert_equals_core(bench.maps.wait_for(), expected)


def test_a_perception_takes_a_sweep_at_each_stand(bench: InfraredBench) -> None:
    client = bench.probe.action_client(BuildMap, names.BUILD_MAP)
    taken: list[int] = []
    handle = bench.probe.send_goal(
        client, BuildMap.Goal(), lambda m: taken.append(m.feedback.readings)
    )
    result = handle.get_result_async()
    stamps = itertools.count(0.0, 0.002)
    angles = PARAMETERS.turret.angles
    for stage, angle in enumerate(angles):
        calls = itertools.count()

        def all_taken(
            angle: float = angle,
            wanted: int = 16 * (stage + 1),
            calls: Iterator[int] = calls,
        ) -> bool:
            # Again and again: ranges may get lost.
            before, between, behind = (next(stamps) for _ in range(3))
            sonars_too = next(calls) > 0  # with the sonars' last reading the stand is over
            for after in (before, behind):
                bench.joint(after, angle)
                bench.pose(after, 2.0, 3.0)
            for sensor in range(16):
                bench.infrared(between, sensor, 0.4)
                if sonars_too:
                    bench.range(between, sensor, 1.0)
            bench.infrared(between, 99, 0.4)
            return result.done() or wanted in taken

        wait_until(all_taken, f"the readings of stand {stage}", step=0.2)
    built = bench.probe.result_of(result).result
    assert (built.readings, built.rejected) == (48, 0)
    assert built.infrared_readings >= 48  # and the sweep of where it came from
    assert built.infrared_rejected >= 1  # what no known sensor sent
    expected = core()
    pose = Pose2(2.0, 3.0)
    bearings = PARAMETERS.sonar.bearings
    sonars = [SonarReading(pose, b + angle, 1.0) for angle in angles for b in bearings]
    expected.update([*sonars, *(InfraredReading(pose, b, 0.4) for b in BEARINGS)])
    assert expected.occupied.max() > 0.8  # an infrared hit, which no sonar gives
    assert_equals_core(bench.maps.wait_for(), expected)
