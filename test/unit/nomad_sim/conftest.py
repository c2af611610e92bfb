# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A world whose missions are over within a second."""

from pathlib import Path

import pytest

SMALL = """
name: small
description: an empty room
area: {origin: [0.0, 0.0], size: [3.0, 2.4]}
start: {position: [0.7, 0.7], heading_deg: 0.0}
goal: {position: [2.3, 1.6]}
expected: EXPECTED
walls:
  - {material: painted_wall, closed: true,
     points: [[-0.05, -0.05], [3.05, -0.05], [3.05, 2.45], [-0.05, 2.45]]}
"""


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """File of an empty room, whose goal is reached after a few perceptions."""
    path = tmp_path / "small.yaml"
    path.write_text(SMALL.replace("EXPECTED", "reached"), encoding="utf-8")
    return path


@pytest.fixture
def misjudged(tmp_path: Path) -> Path:
    """The same room, said to have no way to the goal."""
    path = tmp_path / "misjudged.yaml"
    path.write_text(SMALL.replace("EXPECTED", "unreachable"), encoding="utf-8")
    return path
