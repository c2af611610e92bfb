# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Named sets of the mapper's parameters, each given as what it changes of the defaults."""

from __future__ import annotations

import math
from typing import Any

__all__ = ["DEFAULT_PRESET", "PAPER_PRESET", "PRESETS"]

DEFAULT_PRESET = "consistent"
#: The rules of the paper, with the mends that its noise needs.
PAPER_PRESET = "oriolo1998"

#: Bearings of the eight front sonars of a Pioneer 2 [rad], from the left to the right.
_PIONEER_BEARINGS = tuple(math.radians(b) for b in (90, 50, 30, 10, -10, -30, -50, -90))

#: The paper's evidence, without the rules that go beyond it.
_PAPER: dict[str, Any] = {
    "evidence.k_empty": 0.4,
    "evidence.k_occupied": 0.4,
    "evidence.range_margin": 0.15,
    "consistency.enabled": False,
    "infrared_evidence.enabled": False,
    "sonar_guard.enabled": False,
}

#: Named sets of parameters, as changes of the defaults.
PRESETS: dict[str, dict[str, Any]] = {
    # The defaults. Rules beyond the paper, for navigating: echoes that the packet agrees on,
    # infrareds beside sonars, sonars as a guard where infrared light sees nothing.
    DEFAULT_PRESET: {},
    # Section V: navigating among obstacles that may move.
    PAPER_PRESET: {
        **_PAPER,
        "evidence.visibility_radius": 1.5,
        "evidence.dombi_lambda": 0.4,
        "fusion.aggregation": "mean",
        "fusion.max_count": 3,
    },
    # Fig. 8: 43 perceptions of a corridor. Not fit for navigating: k_E is so small that one
    # perception never opens the beta-cut.
    "map_building": {
        **_PAPER,
        "evidence.k_empty": 0.1,
        "evidence.k_occupied": 0.25,
        "evidence.visibility_radius": 1.2,
        "evidence.dombi_lambda": 0.4,
        "fusion.aggregation": "dombi",
        "area.size_x": 18.0,
        "area.size_y": 12.0,
    },
    # A few sonars on a base without a turret, mapping a place that stays as it is while
    # driving. The weighted mean takes every perception of a cell for a full opinion; here
    # the last one is often the rim of a single cone that grazes the cell as it falls
    # behind, and undoes what the cones in front had agreed on. The union keeps it. A packet
    # is three sweeps of the ring, in place of the three angles of a turret.
    "sparse_ring": {
        **_PAPER,
        "mode": "continuous",
        "packet_size": 24,
        "fusion.aggregation": "dombi",
        "turret.joint": "",
        "turret.angles": (0.0,),
    },
    # Lachekhab et al., Table II: a Pioneer 2 without a turret, aggregation by max.
    "lachekhab": {
        **_PAPER,
        "sonar.frame_ids": tuple(f"sonar_{i}" for i in range(8)),
        "sonar.bearings": _PIONEER_BEARINGS,
        "sonar.min_range": 0.1,
        "sonar.max_range": 5.0,
        "evidence.k_empty": 0.1,
        "evidence.k_occupied": 0.1,
        "evidence.range_margin": 0.2,
        "evidence.visibility_radius": 1.2,
        "evidence.dombi_lambda": 0.4,
        "fusion.aggregation": "max",
        "area.size_x": 6.0,
        "area.size_y": 7.0,
        "turret.joint": "",
        "turret.angles": (0.0,),
        "packet_size": 8,
    },
}
