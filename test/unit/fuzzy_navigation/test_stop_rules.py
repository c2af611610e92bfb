# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which steps the stop rules forbid, against tables by hand."""

import math

import numpy as np
import pytest

from fuzzy_navigation.params import ClearanceParameters, LayerParameters
from fuzzy_navigation.stop_rules import (
    ClosingClearance,
    LayerClearance,
    StrictClearance,
    stop_rule,
)


#: Clearances here and at three places ahead, and which steps are forbidden.
@pytest.mark.parametrize(
    ("clearances", "vain", "closing"),
    [
        ((0.30, 0.25, 0.20, 0.15), 0, (False, False, False)),
        ((0.30, 0.20, 0.119, 0.13), 0, (False, True, False)),
        ((0.30, 0.20, 0.120, 0.12), 0, (False, False, False)),
        ((0.10, 0.09, 0.10, 0.11), 0, (True, False, False)),
        ((0.10, 0.10, 0.10, 0.30), 0, (False, False, False)),
        ((0.10, 0.09, 0.05, 0.049), 1, (False, False, True)),
        ((0.04, 0.03, 0.04, 0.05), 5, (True, False, False)),
        ((math.inf, math.inf, 0.1, math.inf), 0, (False, True, False)),
    ],
)
def test_closing(clearances: tuple[float, ...], vain: int, closing: tuple[bool, ...]) -> None:
    rule = ClosingClearance(0.12, 0.05)
    assert tuple(rule.blocked(np.array(clearances), 0.6, vain)) == closing


@pytest.mark.parametrize("vain", [0, 1])
def test_strict_forbids_to_leave_as_well(vain: int) -> None:
    rule = StrictClearance(0.12)
    blocked = rule.blocked(np.array([0.1, 0.5, 0.119, 0.12, 0.1]), 0.6, vain)
    assert blocked.tolist() == [True, False, True, False]


@pytest.mark.parametrize(
    ("alpha", "clearances", "layer"),
    [
        # At the first rung it is the least clearance of the paper.
        (0.6, (0.30, 0.20, 0.1199, 0.13), (False, True, False)),
        (0.6, (0.30, 0.20, 0.1200, 0.12), (False, False, False)),
        # Noise is no approach: 1 mm less is, 0.9 mm less is not.
        (0.6, (0.100, 0.0991, 0.097, 0.1), (False, True, False)),
        # Each rung comes down by 1.75 cm, the last one to 5 cm.
        (0.7, (0.13, 0.1026, 0.1024, 0.09), (False, False, True)),
        (0.8, (0.13, 0.0851, 0.08, 0.09), (False, True, False)),
        (0.9, (0.13, 0.0676, 0.06, 0.09), (False, True, False)),
        (1.0, (0.13, 0.0500, 0.0489, 0.09), (False, True, False)),
        (0.5, (0.30, 0.1333, 0.1330, 0.09), (False, False, True)),
        (0.6, (math.inf, math.inf, 0.1, math.inf), (False, True, False)),
    ],
)
def test_the_layer_s_rule(
    alpha: float, clearances: tuple[float, ...], layer: tuple[bool, ...]
) -> None:
    rule = LayerClearance(LayerParameters(slack=0.0))
    assert tuple(rule.blocked(np.array(clearances), alpha, 0)) == layer


@pytest.mark.parametrize(
    ("alpha", "allowed", "forbidden"),
    [(0.6, 0.1051, 0.1049), (0.8, 0.0701, 0.0699), (1.0, 0.0351, 0.0349)],
)
def test_the_slack_is_a_sweep_s_noise(alpha: float, allowed: float, forbidden: float) -> None:
    rule = LayerClearance(LayerParameters(slack=0.015))
    assert not rule.blocked(np.array([0.2, allowed]), alpha, 0)[0]
    assert rule.blocked(np.array([0.2, forbidden]), alpha, 0)[0]


@pytest.mark.parametrize(
    ("alpha", "allowed", "forbidden"), [(0.6, 0.1026, 0.1024), (1.0, 0.0501, 0.0499)]
)
def test_a_perception_without_progress_allows_the_next_rung(
    alpha: float, allowed: float, forbidden: float
) -> None:
    """At 0.7 that is 0.12 - 0.07 / 4 m; what is closed stays so."""
    rule = LayerClearance(LayerParameters(slack=0.0))
    assert not rule.blocked(np.array([0.2, allowed]), alpha, 1)[0]
    assert rule.blocked(np.array([0.2, forbidden]), alpha, 1)[0]
    assert rule.blocked(np.array([0.2, 0.1199]), 0.6, 0)[0]


@pytest.mark.parametrize(
    ("vain", "least"), [(0, 0.12), (1, 0.1025), (2, 0.1025), (3, 0.085), (4, 0.085), (5, 0.0675)]
)
def test_every_second_perception_in_vain_adds_a_rung(vain: int, least: float) -> None:
    """From 0.6 on, a rung is 0.1 / 0.4 of the 7 cm between limit and closed."""
    rule = LayerClearance(LayerParameters(slack=0.0))
    assert not rule.blocked(np.array([0.2, least + 1e-4]), 0.6, vain)[0]
    assert rule.blocked(np.array([0.2, least - 1e-4]), 0.6, vain)[0]
    assert rule.blocked(np.array([0.2, 0.0499]), 1.0, vain)[0]


def test_the_parameter_names_the_rule() -> None:
    clearances = np.array([0.1, 0.2])
    layer = LayerParameters(limit=0.13, slack=0.0)
    closing = stop_rule(ClearanceParameters(), layer)
    assert not closing.blocked(clearances, 0.6, 0)[0]
    strict = stop_rule(ClearanceParameters(rule="strict", limit=0.15), layer)
    assert strict.blocked(clearances, 0.6, 0)[0]
    by_layer = stop_rule(ClearanceParameters(rule="layer"), layer)
    assert by_layer.blocked(np.array([0.2, 0.125]), 0.6, 0)[0]
    assert not by_layer.blocked(np.array([0.2, 0.125]), 0.7, 0)[0]
