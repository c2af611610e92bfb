# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The sensor model: its functions at known points, its cones in the grid."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzy_map_building.directivity import Lobe, directivity, lobe_at
from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.params import EvidenceParameters, SonarParameters
from fuzzy_map_building.sonar_model import SonarModel, empty_certainty, occupied_certainty
from fuzzy_map_building.types import Pose2, SonarReading

GRID = GridGeometry(60, 60, 0.1, (-3.0, -3.0))
EVIDENCE = EvidenceParameters(k_empty=0.4, range_margin=0.15)
SONAR = SonarParameters(mount_radius=0.0)
ORIGIN = Pose2(0.0, 0.0)


def test_directivity_at_the_published_points() -> None:
    angles = np.radians([0.0, 7.5, 11.25, 12.5])
    np.testing.assert_allclose(directivity(angles), [1.0, 0.480, 0.108, 0.0148], atol=5e-4)
    np.testing.assert_array_equal(directivity(-angles), directivity(angles))


def test_directivity_is_the_bessel_function_to_rounding() -> None:
    # Bessel's integral: J1(z) = 1/pi int_0^pi cos(t - z sin t) dt.
    t = math.pi * (np.arange(64) + 0.5) / 64
    for theta in np.radians(np.linspace(0.2, 12.5, 30)):
        z = 2 * math.pi * 49410.0 / 343.0 * 0.01921 * math.sin(theta)
        j1 = np.cos(t - z * np.sin(t)).mean()
        assert directivity(theta) == pytest.approx(2 * j1 / z, abs=1e-14)


def test_directivity_ends_with_the_main_lobe() -> None:
    # z = 3.83 at 12.73 degrees; the side lobes (and the back) give no evidence.
    assert directivity(math.radians(12.7)) > 0.0
    np.testing.assert_array_equal(directivity(np.radians([12.8, 20.0, 45.0, 90.0, 170.0])), 0.0)


@pytest.mark.parametrize("width", [0.5, 25.0, 60.0, 180.0])
@pytest.mark.parametrize("piston", [1e-4, 0.01921, 0.03])
def test_the_table_is_the_closed_form(width: float, piston: float) -> None:
    sonar = SonarParameters(field_of_view=math.radians(width), piston_radius=piston)
    lobe = Lobe.of(sonar)
    assert lobe.half_angle <= math.radians(width / 2)
    # Up to the border of the cone, where that is the main lobe's D falls to nothing.
    for theta in [*np.linspace(0.0, lobe.half_angle - 1e-12, 1001), 1e-9]:
        found = lobe_at(lobe.table, lobe.fineness, math.sin(theta) ** 2)
        assert found == pytest.approx(float(directivity(theta, sonar)), abs=1e-10)


def test_the_cone_ends_with_the_main_lobe() -> None:
    # z = 3.83 at 12.73 degrees.
    assert math.degrees(Lobe.of(SonarParameters(field_of_view=1.0)).half_angle) == pytest.approx(
        12.73, abs=0.01
    )


def test_certainty_functions_at_their_corners() -> None:
    rho = [0.0, 1.84, 1.85, 1.925, 2.0, 2.075, 2.15, 2.2]
    # Down by the square of what is left of the margin, (2).
    found = [empty_certainty(d, 2.0, 0.4, 0.15) for d in rho]
    np.testing.assert_allclose(found, [0.4, 0.4, 0.4, 0.1, 0, 0, 0, 0], atol=1e-12)
    found = [occupied_certainty(d, 2.0, 0.4, 0.15) for d in rho]
    np.testing.assert_allclose(found, [0, 0, 0, 0.3, 0.4, 0.3, 0, 0], atol=1e-12)


def evidence(readings: list, sonar: SonarParameters = SONAR, **values: float) -> np.ndarray:
    """Return E^k and O^k over the whole grid."""
    local = SonarModel(sonar, replace(EVIDENCE, **values)).evidence(readings, GRID)
    out = np.zeros((2, *GRID.shape))
    out[0][local.window.slices] = local.empty
    out[1][local.window.slices] = local.occupied
    return out


def test_no_evidence_outside_of_the_cone_and_the_visibility_circle() -> None:
    for degrees in np.arange(0.0, 360.0, 7.5):
        e, o = evidence([SonarReading(ORIGIN, math.radians(degrees), 1.2)])
        rows, columns = np.nonzero((e > 0) | (o > 0))
        assert len(rows) > 20
        x, y = GRID.centres()
        theta = np.degrees(np.arctan2(y[rows], x[columns])) - degrees
        assert np.abs((theta + 180.0) % 360.0 - 180.0).max() <= 12.5
        assert np.hypot(x[columns], y[rows]).max() <= 1.2 + EVIDENCE.range_margin
        # Nothing of the cone is missing either: every cell well inside says something.
        inside = 0
        for row, yi in enumerate(y):
            for column, xi in enumerate(x):
                turn = (math.degrees(math.atan2(yi, xi)) - degrees + 180) % 360 - 180
                if abs(turn) < 12.4 and math.hypot(xi, yi) < 1.2 + EVIDENCE.range_margin - 0.01:
                    inside += 1
                    assert e[row, column] + o[row, column] > 0.0
        assert inside > 20


def test_a_cone_of_any_width_and_direction_lies_in_its_box() -> None:
    # A transducer so small that its main lobe is all around: only field_of_view limits it.
    for width in (5.0, 60.0, 120.0, 179.0, 180.0):
        sonar = SonarParameters(
            mount_radius=0.0, piston_radius=1e-4, field_of_view=math.radians(width)
        )
        for degrees in (0.0, 33.0, 45.0, 90.0, 171.0, 200.0, 301.0):
            e, _ = evidence([SonarReading(ORIGIN, math.radians(degrees), 6.0)], sonar)
            x, y = np.meshgrid(*GRID.centres())
            turn = (np.degrees(np.arctan2(y, x)) - degrees + 180) % 360 - 180
            inside = (np.abs(turn) <= width / 2) & (np.hypot(x, y) <= 1.5 + 1e-9)
            # On the very border rounding decides.
            clear = np.abs(np.abs(turn) - width / 2) > 1e-6
            np.testing.assert_array_equal((e > 0.0)[clear], inside[clear])


def test_a_cell_at_the_apex_counts_as_on_the_axis() -> None:
    pose = Pose2(*GRID.centre_of(30, 30))
    e, _ = evidence([SonarReading(pose, 1.0, 2.0)])
    assert e[30, 30] == pytest.approx(0.4, abs=1e-15)


def test_concordant_readings_add_up_and_their_order_is_free() -> None:
    rng = np.random.default_rng(0)
    readings = [
        SonarReading(ORIGIN, float(b), float(r))
        for b, r in zip(rng.uniform(-3, 3, 30), rng.uniform(0.2, 3, 30), strict=True)
    ]
    together = evidence(readings)
    shuffled = evidence([readings[i] for i in rng.permutation(30)])
    np.testing.assert_allclose(shuffled, together, rtol=1e-12)
    for reading in readings:
        assert (together >= evidence([reading]) - 1e-12).all()


def test_certain_evidence_is_certain_and_finite() -> None:
    e, o = evidence([SonarReading(ORIGIN, 0.0, 1.0)] * 2, k_empty=1.0, k_occupied=1.0)
    assert np.isfinite([e, o]).all()
    assert max(e.max(), o.max()) <= 1.0
    pose = Pose2(*GRID.centre_of(30, 30))
    e, _ = evidence([SonarReading(pose, 0.0, 1.0)], k_empty=1.0)
    assert e[30, 35] == 1.0


def test_readings_outside_of_the_map_are_counted() -> None:
    model = SonarModel(SONAR, EVIDENCE)
    away = SonarReading(Pose2(100.0, 0.0), 0.0, 1.0)
    far = SonarReading(Pose2(1e300, -1e300), 0.0, 1.0)
    local = model.evidence([away, far, SonarReading(ORIGIN, 0.0, math.nan)], GRID)
    assert local.accepted == 0
    assert local.rejected == {"outside_map": 2, "nan": 1}
    assert local.window.empty
    # From outside, a cone may reach in.
    local = model.evidence([SonarReading(Pose2(3.5, 0.05), math.pi, 1.0)], GRID)
    assert local.accepted == 1
    assert local.empty[:, -1].max() > 0.1
