# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The method cell by cell, reading by reading: slow, by trigonometry, easy to check."""

from __future__ import annotations

import math

import numpy as np

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.params import MapperParameters
from fuzzy_map_building.types import SonarReading


def bessel_j1(z: float) -> float:
    """J1 by Bessel's integral; the trapezoidal rule converges exponentially."""
    n = 64
    angles = (math.pi * (i + 0.5) / n for i in range(n))
    return sum(math.cos(t - z * math.sin(t)) for t in angles) / n


def modulation(theta: float, p: MapperParameters) -> float:
    s = p.sonar
    if abs(theta) > s.field_of_view / 2:
        return 0.0
    z = 2 * math.pi * s.frequency / s.speed_of_sound * s.piston_radius * math.sin(theta)
    return 1.0 if abs(z) < 1e-12 else 2 * bessel_j1(z) / z


def f_empty(rho: float, r: float, p: MapperParameters) -> float:
    k, dr = p.evidence.k_empty, p.evidence.range_margin
    if rho < r - dr:
        return k
    return k * ((r - rho) / dr) ** 2 if rho < r else 0.0


def f_occupied(rho: float, r: float, p: MapperParameters) -> float:
    k, dr = p.evidence.k_occupied, p.evidence.range_margin
    return k * (1 - ((r - rho) / dr) ** 2) if abs(r - rho) < dr else 0.0


def union(a: float, b: float, lam: float) -> float:
    if a == 0.0 or b == 0.0:
        return max(a, b)
    if a == 1.0 or b == 1.0:
        return 1.0
    return 1 / (1 + ((1 / a - 1) ** -lam + (1 / b - 1) ** -lam) ** (-1 / lam))


def intersection(a: float, b: float) -> float:
    return max(0.0, a + b - 1)


def heading(reading: SonarReading) -> float:
    return math.degrees(reading.pose.theta + reading.bearing)


def faulty(reading: SonarReading, p: MapperParameters) -> bool:
    r = reading.range
    return math.isnan(r) or (math.isfinite(r) and not p.sonar.min_range <= r <= p.sonar.max_range)


def limit_of_lost_echo(reading: SonarReading, usable: list, p: MapperParameters) -> float:
    """The shorter return among readings of the same direction and the nearest on each side."""
    if p.sonar.lost_echo == "full":
        return p.sonar.max_range
    left, right, counted = [], [], []
    for other in usable:
        turn = (heading(other) - heading(reading) + 180.0) % 360.0 - 180.0
        if abs(turn) <= 1.0:
            counted.append(other)
            continue
        left.append((turn % 360.0, other))
        right.append((-turn % 360.0, other))
    for side in (left, right):
        if side:
            nearest = min(turn for turn, _ in side)
            counted += [other for turn, other in side if turn <= nearest + 1.0]
    returns = [max(o.range, p.sonar.min_range) for o in counted if o.range != math.inf]
    return min([*returns, p.sonar.max_range])


class ScalarMapper:
    """The method, cell by cell."""

    def __init__(self, geometry: GridGeometry, parameters: MapperParameters) -> None:
        self.geometry = geometry
        self.p = parameters
        self.e, self.o, self.m_m, self.m_p = np.zeros((4, *geometry.shape))
        self.m_m += 1.0
        self.n = np.zeros(geometry.shape, dtype=int)

    def evidence(self, readings: list, x: float, y: float) -> tuple[float, float]:
        p = self.p
        usable = [r for r in readings if not faulty(r, p)]
        e_k = o_k = 0.0
        for reading in usable:
            if reading.range == math.inf and p.sonar.lost_echo == "ignore":
                continue
            direction = reading.pose.theta + reading.bearing
            ax, ay, longer = reading.pose.x, reading.pose.y, p.sonar.mount_radius
            if p.sonar.apex == "mount":
                ax += p.sonar.mount_radius * math.cos(direction)
                ay += p.sonar.mount_radius * math.sin(direction)
                longer = 0.0
            rho = math.hypot(x - ax, y - ay)
            # A cell at exactly rho_v is visible whichever way the distance was rounded.
            if rho > p.evidence.visibility_radius + 1e-9:
                continue
            theta = 0.0
            if rho > 0.0:
                theta = math.remainder(math.atan2(y - ay, x - ax) - direction, 2 * math.pi)
            m = modulation(theta, p)
            if m == 0.0:
                continue
            if reading.range == math.inf:
                limit = limit_of_lost_echo(reading, usable, p) + longer
                e_i, o_i = f_empty(rho, limit, p) * m, 0.0
            elif reading.range == -math.inf:
                e_i, o_i = 0.0, f_occupied(rho, p.sonar.min_range + longer, p)
            else:
                e_i = f_empty(rho, reading.range + longer, p) * m
                o_i = f_occupied(rho, reading.range + longer, p)
            if o_i > 0.0:
                o_i *= self.arc(reading, usable, theta, m)
            e_k = union(e_k, e_i, p.evidence.dombi_lambda)  # (4)
            o_k = union(o_k, o_i, p.evidence.dombi_lambda)  # (5)
        return e_k, o_k

    def arc(self, reading: SonarReading, usable: list, theta: float, m: float) -> float:
        """Return what stands beside f_O at an angle from the axis: m(theta)."""
        return m

    def aggregate(self, old: float, new: float, n: int) -> float:
        if self.p.fusion.aggregation == "max":
            return max(old, new)
        if self.p.fusion.aggregation == "dombi":
            return union(old, new, self.p.evidence.dombi_lambda)  # (6), (7)
        n = min(self.p.fusion.max_count, n)  # (10)
        return ((n - 1) * old + new) / n  # (8), (9)

    def update(self, readings: list) -> None:
        for row in range(self.geometry.height):
            for col in range(self.geometry.width):
                e_k, o_k = self.evidence(readings, *self.geometry.centre_of(row, col))
                if e_k == 0.0 and o_k == 0.0:
                    continue
                self.n[row, col] += 1
                n = int(self.n[row, col])
                e = self.e[row, col] = self.aggregate(float(self.e[row, col]), e_k, n)
                o = self.o[row, col] = self.aggregate(float(self.o[row, col]), o_k, n)
                a = intersection(e, o)  # (11)
                i = intersection(1 - e, 1 - o)
                core = intersection(intersection(e * e, 1 - o), 1 - a)
                self.m_m[row, col] = 1 - intersection(core, 1 - i)  # (12)
                self.m_p[row, col] = 1 - union(core, i, self.p.evidence.dombi_lambda)  # (13)
