# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The evidence of two kinds of sensors made one."""

from __future__ import annotations

import numpy as np

from fuzzy_map_building.evidence.protocols import LocalEvidence
from fuzzy_map_building.fuzzy_sets import dombi_union

__all__ = ["united_evidence"]


def united_evidence(sonar: LocalEvidence, infrared: LocalEvidence, lam: float) -> LocalEvidence:
    """Return the evidence of a packet of sonar and infrared readings.

    Beliefs of empty are united by the Dombi union, beliefs of occupied by the maximum: that
    two kinds of sensors hear of free space adds up, but an arc and a ray that hits it are
    about the same surface.

    Parameters
    ----------
    sonar, infrared : LocalEvidence
        What either kind says of the cells of its window.
    lam : float
        lambda of the Dombi union.

    Returns
    -------
    LocalEvidence
        Over the smallest window that holds both; ``accepted`` and ``rejected`` are the sonars'.
    """
    window = sonar.window.union(infrared.window)
    empty, occupied = np.zeros((2, *window.shape))
    part = _part(sonar, window.row0, window.col0)
    empty[part], occupied[part] = sonar.empty, sonar.occupied
    part = _part(infrared, window.row0, window.col0)
    empty[part] = dombi_union(empty[part], infrared.empty, lam)
    occupied[part] = np.maximum(occupied[part], infrared.occupied)
    return LocalEvidence(window, empty, occupied, sonar.accepted, dict(sonar.rejected))


def _part(local: LocalEvidence, row0: int, col0: int) -> tuple[slice, slice]:
    """Return where the window of some evidence lies in a larger one."""
    w = local.window
    return slice(w.row0 - row0, w.row1 - row0), slice(w.col0 - col0, w.col1 - col0)
