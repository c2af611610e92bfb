# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fusion by fuzzy sets: aggregation (6)-(10) and the risk maps (11)-(13)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.fuzzy_sets import bounded_product, complement, dombi_union, weighted_mean
from fuzzy_map_building.jit import for_kernel, njit
from fuzzy_map_building.params import EvidenceParameters, FusionParameters

__all__ = ["FuzzyFusion"]

FloatArray = NDArray[np.float64]
Int32Array = NDArray[np.int32]

#: Aggregations by their number in the kernel.
_AGGREGATIONS = ("mean", "dombi", "max")


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
        self._lambda = float(evidence.dombi_lambda)
        self._aggregation = _AGGREGATIONS.index(fusion.aggregation)
        self._max_count = int(fusion.max_count)

    def fuse(
        self,
        empty: FloatArray,
        occupied: FloatArray,
        count: Int32Array,
        new_empty: FloatArray,
        new_occupied: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Return the beliefs after a packet; where it says nothing they are as before.

        Parameters
        ----------
        empty, occupied : ndarray of float64
            Beliefs before, all arrays of one shape.
        count : ndarray of int32
            Perceptions that spoke of each cell, this one included.
        new_empty, new_occupied : ndarray of float64
            Evidence E^k and O^k of the packet, both 0 where it says nothing.

        Returns
        -------
        empty, occupied : ndarray of float64
            Beliefs after.
        """
        after = np.empty((2, *empty.shape))
        _aggregate(
            _cells(empty),
            _cells(occupied),
            _cells(count),
            _cells(new_empty),
            _cells(new_occupied),
            self._aggregation,
            self._max_count,
            self._lambda,
            _cells(after[0]),
            _cells(after[1]),
        )
        return after[0], after[1]

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
        # Unexplored is a risk for motion and none for planning; that is most of a large map.
        motion, planning = np.ones(empty.shape), np.zeros(empty.shape)
        known = np.flatnonzero((empty > 0.0) | (occupied > 0.0))
        _risks(
            for_kernel(known),
            _cells(empty),
            _cells(occupied),
            self._lambda,
            _cells(motion),
            _cells(planning),
        )
        return motion, planning


def _cells(array: NDArray[Any]) -> Any:
    """Return an array as the one row of cells that the kernels take."""
    return for_kernel(np.ascontiguousarray(array).reshape(-1))


@njit
def _aggregate(
    empty: FloatArray,
    occupied: FloatArray,
    count: Int32Array,
    new_empty: FloatArray,
    new_occupied: FloatArray,
    aggregation: int,
    max_count: int,
    lam: float,
    empty_after: FloatArray,
    occupied_after: FloatArray,
) -> None:
    """Fill in the beliefs after a packet, as `FuzzyFusion.fuse` says; all shape (n,)."""
    for k in range(len(empty)):
        e = empty[k]
        o = occupied[k]
        e_new = new_empty[k]
        o_new = new_occupied[k]
        if e_new > 0.0 or o_new > 0.0:
            if aggregation == 0:  # (8), (9) with the saturated count of (10)
                n = min(count[k], max_count)
                e = weighted_mean(e, e_new, n)
                o = weighted_mean(o, o_new, n)
            elif aggregation == 1:  # (6), (7)
                e = dombi_union(e, e_new, lam)
                o = dombi_union(o, o_new, lam)
            else:  # Lachekhab et al., section 3.3
                e = max(e, e_new)
                o = max(o, o_new)
        empty_after[k] = e
        occupied_after[k] = o


@njit
def _risks(
    known: NDArray[np.int64],
    empty: FloatArray,
    occupied: FloatArray,
    lam: float,
    motion: FloatArray,
    planning: FloatArray,
) -> None:
    """Fill in the two risks of some cells, as `FuzzyFusion.risks` says."""
    for i in range(len(known)):
        k = known[i]
        e = empty[k]
        o = occupied[k]
        ambiguous = bounded_product(e, o)  # (11)
        indeterminate = bounded_product(complement(e), complement(o))
        safe = bounded_product(bounded_product(e * e, complement(o)), complement(ambiguous))
        # (12) and (13)
        motion[k] = complement(bounded_product(safe, complement(indeterminate)))
        planning[k] = complement(dombi_union(safe, indeterminate, lam))
