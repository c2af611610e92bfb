# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Numbers in words."""

import math

import numpy as np
import pytest

from fuzzy_map_building.wording import as_meant


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (float(np.float32(5.3)), "5.3"),
        (-0.1, "-0.1"),
        (1e308, "1e+308"),  # beyond 32 bits, where a comparison with one of them warns
        (-1e308, "-1e+308"),
        (math.inf, "inf"),
        (math.nan, "nan"),
    ],
)
def test_a_number_reads_as_it_was_meant(value: float, words: str) -> None:
    assert as_meant(value) == words
