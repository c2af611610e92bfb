# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fusion by fuzzy sets: aggregation (6)-(10) and the risk maps (11)-(13)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.fuzzy_sets import bounded_product, complement, dombi_union, weighted_mean
from fuzzy_map_building.params import EvidenceParameters, FusionParameters

__all__ = ["FuzzyFusion"]

FloatArray = NDArray[np.float64]


class FuzzyFusion:
    """The fusion of Oriolo, Ulivi and Vendittelli (1998), section III-C.

    Parameters
    ----------
    evidence : EvidenceParameters
        Gives lambda of the Dombi union.
    fusion : FusionParameters
        The aggregation operator and N_max.
    """

    def __init__(self, evidence: EvidenceParameters, fusion: FusionParameters) -> None:
        self._lambda = evidence.dombi_lambda
        self._aggregation = fusion.aggregation
        self._max_count = fusion.max_count

    def fuse(
        self,
        empty: FloatArray,
        occupied: FloatArray,
        count: NDArray[np.int32],
        new_empty: FloatArray,
        new_occupied: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Return the beliefs after a packet, at cells of which it speaks.

        Parameters
        ----------
        empty, occupied : ndarray of float64, shape (n,)
            Beliefs before.
        count : ndarray of int32, shape (n,)
            Perceptions that spoke of each cell, this one included.
        new_empty, new_occupied : ndarray of float64, shape (n,)
            Evidence E^k and O^k of the packet.

        Returns
        -------
        empty, occupied : ndarray of float64, shape (n,)
            Beliefs after.
        """
        if self._aggregation == "mean":  # (8), (9) with the saturated count of (10)
            n = np.minimum(count, self._max_count)
            return weighted_mean(empty, new_empty, n), weighted_mean(occupied, new_occupied, n)
        if self._aggregation == "dombi":  # (6), (7)
            return (
                dombi_union(empty, new_empty, self._lambda),
                dombi_union(occupied, new_occupied, self._lambda),
            )
        # Lachekhab et al., section 3.3
        return np.maximum(empty, new_empty), np.maximum(occupied, new_occupied)

    def risks(self, empty: FloatArray, occupied: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the membership of each cell in the motion map and in the planning map.

        Parameters
        ----------
        empty, occupied : ndarray of float64
            Beliefs.

        Returns
        -------
        motion : ndarray of float64
            M_m: what is not known to be free is a risk.
        planning : ndarray of float64
            M_p: what is not known at all is no risk.
        """
        not_occupied = complement(occupied)
        ambiguous = bounded_product(empty, occupied)  # (11)
        indeterminate = bounded_product(complement(empty), not_occupied)
        safe = bounded_product(empty**2, not_occupied, complement(ambiguous))
        safe_for_motion = bounded_product(safe, complement(indeterminate))  # (12)
        safe_for_planning = dombi_union(safe, indeterminate, self._lambda)  # (13)
        return complement(safe_for_motion), complement(safe_for_planning)
