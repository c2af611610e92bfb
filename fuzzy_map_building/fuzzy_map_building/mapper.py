# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""FuzzyMapper: a packet of readings in, the motion map and the planning map out."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fuzzy_map_building.evidence.fuzzy import FuzzyFusion
from fuzzy_map_building.evidence.protocols import EvidenceSource, FusionRule, LocalEvidence
from fuzzy_map_building.evidence.union import united_evidence
from fuzzy_map_building.frozen_state import FrozenState
from fuzzy_map_building.grid import GridGeometry, Window
from fuzzy_map_building.infrared_model import InfraredModel
from fuzzy_map_building.infrared_packet import InfraredPacket
from fuzzy_map_building.map_state import MAX_PERCEPTIONS, MapState
from fuzzy_map_building.params import PAPER_PRESET, MapperParameters, mapper_parameters
from fuzzy_map_building.sonar_guard import ray_limits
from fuzzy_map_building.sonar_model import SonarModel
from fuzzy_map_building.types import InfraredReading, Pose2, RangeReading, SonarReading

__all__ = ["FuzzyMapper", "UpdateReport", "warm_up"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class UpdateReport:
    """What an update did.

    Attributes
    ----------
    accepted : int
        Sonar readings that gave evidence; 0: the map is as it was.
    rejected : dict of str to int
        Readings that did not, by reason: ``nan``, ``out_of_range``, ``lost_echo``,
        ``outside_map``, ``no_model`` (a kind of reading that no sensor model takes).
    window : Window
        Cells that may have changed.
    infrared_accepted : int
        Infrared readings that gave evidence.
    infrared_rejected : dict of str to int
        Infrared readings that did not, by reason: ``nan``, ``out_of_range``,
        ``outside_map``, ``no_sonar`` (no sonar reading of the packet could be used).
    """

    accepted: int
    rejected: dict[str, int]
    window: Window
    infrared_accepted: int = 0
    infrared_rejected: dict[str, int] = field(default_factory=dict)


class FuzzyMapper:
    """Belief of empty and of occupied for every cell, and the risk maps they stand for.

    Beliefs and counts take 20 bytes a cell. The risk maps follow from the beliefs; whoever asks
    for them whole, not by windows, has them kept from then on, for 16 bytes more.

    Parameters
    ----------
    geometry : GridGeometry
        The cells of the map.
    parameters : MapperParameters, optional
        Sensors, evidence and fusion; the paper's if not given.

    Examples
    --------
    >>> from fuzzy_map_building.types import Pose2
    >>> mapper = FuzzyMapper(GridGeometry(76, 63, 0.1))
    >>> ahead = SonarReading(Pose2(1.25, 5.25), bearing=0.0, range=2.0)
    >>> mapper.update([ahead]).accepted
    1
    >>> round(float(mapper.empty[52, 15]), 12), float(mapper.motion_risk[0, 0])
    (0.4, 1.0)
    """

    def __init__(self, geometry: GridGeometry, parameters: MapperParameters | None = None) -> None:
        p = parameters if parameters is not None else mapper_parameters(PAPER_PRESET)
        self._geometry = geometry
        self._parameters = p
        self._sonar: EvidenceSource[SonarReading] = SonarModel(p.sonar, p.evidence, p.consistency)
        self._infrared = InfraredModel(p.infrared, p.infrared_evidence)
        self._rule: FusionRule = FuzzyFusion(p.evidence, p.fusion)
        self._kept_risks: tuple[FloatArray, FloatArray] | None = None
        self._frozen: list[FrozenState] = []
        self.reset()

    def reset(self) -> None:
        """Forget everything: nothing is believed of any cell."""
        shape = self._geometry.shape
        cells = (np.zeros(shape), np.zeros(shape), np.zeros(shape, dtype=np.int32))
        self._put(*cells, 0)

    @property
    def geometry(self) -> GridGeometry:
        """Where the cells of the map lie."""
        return self._geometry

    @property
    def parameters(self) -> MapperParameters:
        """The parameters of the mapper."""
        return self._parameters

    @property
    def empty(self) -> FloatArray:
        """Belief E that a cell is empty, in [0, 1], shape (height, width), read-only."""
        return _read_only(self._empty)

    @property
    def occupied(self) -> FloatArray:
        """Belief O that a cell is occupied, in [0, 1], shape (height, width), read-only."""
        return _read_only(self._occupied)

    @property
    def motion_risk(self) -> FloatArray:
        """Motion map M_m in [0, 1], 1 where unexplored, shape (height, width), read-only."""
        return _read_only(self._risk_maps()[0])

    @property
    def planning_risk(self) -> FloatArray:
        """Planning map M_p in [0, 1], 0 where unexplored, shape (height, width), read-only."""
        return _read_only(self._risk_maps()[1])

    def risks(self, window: Window) -> tuple[FloatArray, FloatArray]:
        """Return motion map and planning map of some cells.

        Parameters
        ----------
        window : Window
            The cells.

        Returns
        -------
        motion, planning : ndarray of float64, shape of the window
            What `motion_risk` and `planning_risk` hold there, without need of either.
        """
        cells = window.slices
        return self._rule.risks(self._empty[cells], self._occupied[cells])

    def _risk_maps(self) -> tuple[FloatArray, FloatArray]:
        """Return both risk maps; they are kept from the first time on that they are asked for."""
        if self._kept_risks is None:
            self._kept_risks = self._rule.risks(self._empty, self._occupied)
        return self._kept_risks

    @property
    def count(self) -> NDArray[np.int32]:
        """Number N of perceptions that spoke of each cell, shape (height, width), read-only."""
        view = self._count.view()
        view.flags.writeable = False
        return view

    @property
    def perceptions(self) -> int:
        """Number of packets that gave evidence."""
        return self._perceptions

    def update(self, readings: Sequence[RangeReading]) -> UpdateReport:
        """Fuse one packet of readings: processing and fusion, (1)-(13).

        The packet is one perception: its readings are united, then enter the map at once.
        A packet without a usable sonar reading changes nothing and counts as no perception:
        infrareds, which look through glass, only add to what the sonars say.

        Parameters
        ----------
        readings : sequence of RangeReading
            Sonar readings and, where ``infrared_evidence`` is enabled, infrared readings, each
            placed at the pose that it was taken from, in any order.

        Returns
        -------
        UpdateReport
            What was accepted and what was rejected why.

        Raises
        ------
        ValueError
            If it is no sequence, or an element is no RangeReading. The map is then as it was.
        """
        sonar, infrared, others = _sorted_by_kind(readings)
        if not self._parameters.infrared_evidence.enabled:
            infrared, others = [], others + len(infrared)
        local = self._sonar.evidence(sonar, self._geometry)
        rejected = dict(local.rejected)
        if others:
            rejected["no_model"] = others
        if local.accepted == 0:
            useless = {"no_sonar": len(infrared)} if infrared else {}
            return UpdateReport(0, rejected, local.window, 0, useless)
        if not infrared:
            self._fuse(local)
            return UpdateReport(local.accepted, rejected, local.window)
        rays = self._infrared.evidence_of(self._guarded(sonar, infrared), self._geometry)
        united = united_evidence(local, rays, self._parameters.evidence.dombi_lambda)
        self._fuse(united)
        return UpdateReport(local.accepted, rejected, united.window, rays.accepted, rays.rejected)

    def _guarded(
        self, sonar: Sequence[SonarReading], infrared: Sequence[InfraredReading]
    ) -> InfraredPacket:
        """Return the infrared readings as far as the sonars let them be believed."""
        p = self._parameters
        packet = InfraredPacket.from_readings(infrared, p.infrared)
        if not p.sonar_guard.enabled:
            return packet
        # The sonars sit on the body's rim: its radius is theirs.
        reach, radius = p.sonar_guard.perception_reach, p.sonar.mount_radius
        limits = ray_limits(sonar, packet, p.sonar, p.sonar_guard, reach, radius)
        return packet if limits is None else packet.limited(limits)

    def _fuse(self, local: LocalEvidence) -> None:
        """Let evidence enter the map, only in the cells of which it speaks."""
        # "The number of perceptions that have involved cell C": those with evidence of it.
        spoken = (local.empty > 0.0) | (local.occupied > 0.0)
        window = local.window.slices
        count = np.minimum(self._count[window] + spoken, MAX_PERCEPTIONS)
        empty, occupied = self._rule.fuse(
            self._empty[window], self._occupied[window], count, local.empty, local.occupied
        )
        risks = self._rule.risks(empty, occupied) if self._kept_risks is not None else None
        self._frozen = [frozen for frozen in self._frozen if not frozen.copied]
        for frozen in self._frozen:
            frozen.keep(local.window)
        # Everything is computed; from here on nothing can fail half-way.
        self._count[window] = count
        self._empty[window] = empty
        self._occupied[window] = occupied
        if self._kept_risks is not None and risks is not None:
            for kept, risk in zip(self._kept_risks, risks, strict=True):
                kept[window] = risk
        self._perceptions += self._perceptions < MAX_PERCEPTIONS

    def state(self) -> MapState:
        """Return a copy of all that the mapper remembers."""
        return MapState(
            self._geometry,
            self._empty.copy(),
            self._occupied.copy(),
            self._count.copy(),
            self._perceptions,
        )

    def freeze(self) -> FrozenState:
        """Return all that the mapper remembers now, for another thread to copy.

        It takes no time. Until it is copied, each update puts aside what it changes.
        """
        arrays = (self._empty, self._occupied, self._count)
        frozen = FrozenState(self._geometry, *arrays, self._perceptions)
        self._frozen.append(frozen)
        return frozen

    def restore(self, state: MapState) -> None:
        """Take over a state; the risk maps follow from it exactly.

        Raises
        ------
        ValueError
            If the state is of another grid. The map is then as it was.
        """
        self._check_grid(state)
        arrays = (state.empty.copy(), state.occupied.copy(), state.count.copy())
        self._put(*arrays, state.perceptions)

    def adopt(self, state: MapState) -> None:
        """Take over a state as `restore`, and its arrays with it, which nobody else may use.

        It takes no time, however large the map is.

        Raises
        ------
        ValueError
            If the state is of another grid. The map is then as it was.
        """
        self._check_grid(state)
        self._put(state.empty, state.occupied, state.count, state.perceptions)

    def with_parameters(self, parameters: MapperParameters) -> FuzzyMapper:
        """Return a mapper with other parameters that goes on with this map, in place of this one.

        It takes no time, however large the map is: the two have the same arrays.
        """
        other = FuzzyMapper(self._geometry, parameters)
        other._put(self._empty, self._occupied, self._count, self._perceptions)
        other._frozen = self._frozen
        return other

    def _check_grid(self, state: MapState) -> None:
        if state.geometry != self._geometry:
            raise ValueError(
                f"the state is of the grid {state.geometry}, this map of {self._geometry}; "
                f"start the mapper with the area and resolution of the saved map"
            )

    def _put(
        self,
        empty: FloatArray,
        occupied: FloatArray,
        count: NDArray[np.int32],
        perceptions: int,
    ) -> None:
        """Go on with other arrays; what was frozen keeps those that were there."""
        self._empty, self._occupied, self._count = empty, occupied, count
        self._perceptions = perceptions
        self._kept_risks = None
        self._frozen = []


def warm_up() -> None:
    """Compile the kernels, or load them from the cache, so that no later call has to."""
    here = Pose2(0.0, 0.0)
    mapper = FuzzyMapper(GridGeometry(2, 2, 1.0), mapper_parameters("consistent"))
    mapper.update([SonarReading(here, 0.0, 0.5), InfraredReading(here, 0.0, 0.5)])


def _sorted_by_kind(
    readings: Sequence[RangeReading],
) -> tuple[list[SonarReading], list[InfraredReading], int]:
    """Return the sonar readings, the infrared readings, and the number of others.

    Raises
    ------
    ValueError
        If it is no sequence, or an element is no reading at all.
    """
    if not isinstance(readings, Collection):
        raise ValueError(
            f"a packet is a sequence of readings, got a {type(readings).__name__}; an empty list "
            "is a packet without any; the map was not changed"
        )
    sonar = [r for r in readings if isinstance(r, SonarReading)]
    infrared = [r for r in readings if isinstance(r, InfraredReading)]
    others = len(readings) - len(sonar) - len(infrared)
    if others:
        for number, reading in enumerate(readings):
            if not isinstance(reading, RangeReading):
                raise ValueError(
                    f"reading {number} of the packet is a {type(reading).__name__}, not a "
                    f"RangeReading; the map was not changed"
                )
    return sonar, infrared, others


def _read_only(array: FloatArray) -> FloatArray:
    view = array.view()
    view.flags.writeable = False
    return view
