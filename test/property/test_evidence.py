# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What holds for the evidence and the maps of any packet."""

import math
from random import Random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzy_map_building.evidence.fuzzy import FuzzyFusion
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.mapper import FuzzyMapper
from fuzzy_map_building.params import (
    EvidenceParameters,
    FusionParameters,
    MapperParameters,
    mapper_parameters,
)
from fuzzy_map_building.types import InfraredReading, Pose2, SonarReading

GRID = GridGeometry(30, 20, 0.1, (-1.0, -1.0))
ARRAYS = ("empty", "occupied", "motion_risk", "planning_risk")

RANGES = st.one_of(
    st.floats(0.12, 3.0),
    st.sampled_from([math.inf, -math.inf, math.nan]),
    st.floats(allow_nan=True, allow_infinity=True),
)
COORDINATE = st.one_of(st.floats(-1.5, 2.5), st.floats(-1e308, 1e308))
POSES = st.builds(Pose2, COORDINATE, COORDINATE, st.floats(-10.0, 10.0))
READINGS = st.builds(
    lambda kind, *values: kind(*values),
    st.sampled_from([SonarReading] * 6 + [InfraredReading]),
    POSES,
    st.floats(-10.0, 10.0),
    RANGES,
)
PACKETS = st.lists(READINGS, max_size=20)
PARAMETERS = st.builds(
    lambda **values: mapper_parameters(
        overrides={k.replace("__", "."): v for k, v in values.items()}
    ),
    sonar__apex=st.sampled_from(["center", "mount"]),
    sonar__lost_echo=st.sampled_from(["neighbours", "full", "ignore"]),
    sonar__field_of_view=st.floats(0.01, math.pi),
    evidence__k_empty=st.floats(0.0, 1.0),
    evidence__k_occupied=st.floats(0.0, 1.0),
    evidence__range_margin=st.floats(0.001, 1.0),
    evidence__visibility_radius=st.floats(0.01, 3.0),
    evidence__dombi_lambda=st.floats(0.05, 20.0),
    consistency__enabled=st.booleans(),
    consistency__half_width=st.floats(0.0, math.pi),
    consistency__floor=st.floats(0.0, 1.0),
    infrared_evidence__enabled=st.booleans(),
    infrared_evidence__certainty=st.floats(0.0, 1.0),
    infrared_evidence__widening=st.floats(0.0, 1.0),
    sonar_guard__enabled=st.booleans(),
    fusion__aggregation=st.sampled_from(["mean", "dombi", "max"]),
    fusion__max_count=st.integers(1, 5),
)


@given(PARAMETERS, st.lists(PACKETS, max_size=4))
def test_memberships_stay_memberships_and_every_reading_is_accounted_for(
    parameters: MapperParameters, packets: list
) -> None:
    mapper = FuzzyMapper(GRID, parameters)
    for number, packet in enumerate(packets):
        before = {name: getattr(mapper, name).copy() for name in (*ARRAYS, "count")}
        perceptions = mapper.perceptions
        report = mapper.update(packet)
        infrared = report.infrared_accepted + sum(report.infrared_rejected.values())
        assert report.accepted + sum(report.rejected.values()) + infrared == len(packet)
        assert mapper.perceptions == perceptions + (report.accepted > 0)
        for name in ARRAYS:
            array = getattr(mapper, name)
            # NaN fails, too.
            assert array.min() >= 0.0, (name, number)
            assert array.max() <= 1.0, (name, number)
        changed = np.zeros(GRID.shape, dtype=bool)
        for name, old in before.items():
            changed |= getattr(mapper, name) != old
        changed[report.window.slices] = False
        assert not changed.any()
        grown = mapper.count - before["count"]
        assert set(np.unique(grown)) <= {0, 1}
    # What no reading ever spoke of is as unexplored as at the start.
    untouched = mapper.count == 0
    assert (mapper.motion_risk[untouched] == 1.0).all()
    assert (mapper.planning_risk[untouched] == 0.0).all()


@given(PARAMETERS, PACKETS, st.randoms(use_true_random=False))
def test_the_order_of_a_packet_is_free(
    parameters: MapperParameters, packet: list, random: Random
) -> None:
    first, second = FuzzyMapper(GRID, parameters), FuzzyMapper(GRID, parameters)
    shuffled = list(packet)
    random.shuffle(shuffled)
    reports = first.update(packet), second.update(shuffled)
    assert reports[0].rejected == reports[1].rejected
    assert reports[0].infrared_rejected == reports[1].infrared_rejected
    for name in ARRAYS:
        np.testing.assert_allclose(getattr(first, name), getattr(second, name), atol=1e-9)


@given(PACKETS, PACKETS)
@settings(max_examples=50)
def test_restoring_and_going_on_is_going_on(first: list, second: list) -> None:
    through = FuzzyMapper(GRID)
    through.update(first)
    resumed = FuzzyMapper(GRID)
    resumed.restore(through.state())
    through.update(second)
    resumed.update(second)
    for name in (*ARRAYS, "count"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(through, name))


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_more_belief_in_an_obstacle_is_never_less_risk_of_motion(o1: float, o2: float) -> None:
    low, high = sorted((o1, o2))
    rule = FuzzyFusion(EvidenceParameters(), FusionParameters())
    for e in np.linspace(0.0, 1.0, 11):
        # Where e + o < 1, S_m = e^2 - o - (1 - e - o) does not depend on o: equal, not less.
        risk, _ = rule.risks(np.array([e, e]), np.array([low, high]))
        assert risk[1] >= risk[0] - 1e-12
