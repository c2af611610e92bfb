# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Values that cross module borders."""

import math

import numpy as np
import pytest

from fuzzy_map_building.types import InfraredReading, Pose2, RangeReading, SonarReading, wrap_angle


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [
        (0.0, 0.0),
        (math.pi, -math.pi),
        (-math.pi, -math.pi),
        (3 * math.pi / 2, -math.pi / 2),
        (-7.0, -7.0 + 2 * math.pi),
        (100.0, 100.0 - 32 * math.pi),
    ],
)
def test_wrap_angle(angle: float, wrapped: float) -> None:
    assert wrap_angle(angle) == pytest.approx(wrapped, abs=1e-12)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["x", "y", "theta"])
def test_a_pose_is_finite(name: str, bad: float) -> None:
    values = {"x": 1.0, "y": 2.0, "theta": 3.0, name: bad}
    with pytest.raises(ValueError, match=f"Pose2.{name} must be finite"):
        Pose2(**values)


@pytest.mark.parametrize("bad", ["1", None, 1j, 10**400, np.zeros(2), Pose2(0.0, 0.0)])
def test_what_is_no_number_is_refused_by_name(bad: object) -> None:
    with pytest.raises(ValueError, match=r"Pose2\.theta must be a finite number, got "):
        Pose2(1.0, 2.0, bad)
    with pytest.raises(ValueError, match=r"SonarReading\.bearing must be a finite number, got "):
        SonarReading(Pose2(0.0, 0.0), bad, 1.0)


def test_distance() -> None:
    assert Pose2(1.0, 2.0, 0.5).distance_to(4.0, -2.0) == 5.0


@pytest.mark.parametrize("kind", [SonarReading, InfraredReading])
def test_a_reading_has_a_finite_direction_and_stamp_but_any_range(kind: type) -> None:
    for value in (math.nan, math.inf, -math.inf, -1.0):
        reading = kind(Pose2(0.0, 0.0), 0.1, value)
        assert isinstance(reading, RangeReading)
        assert reading.range == value or math.isnan(value)
    with pytest.raises(ValueError, match=rf"{kind.__name__}\.bearing"):
        kind(Pose2(0.0, 0.0), math.nan, 1.0)
    with pytest.raises(ValueError, match=rf"{kind.__name__}\.stamp"):
        kind(Pose2(0.0, 0.0), 0.0, 1.0, math.inf)
