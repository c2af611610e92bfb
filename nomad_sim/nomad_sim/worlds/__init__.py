# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worlds without end: drawn by kind and seed, or cut out of floor plans."""

from nomad_sim.worlds.generated import KINDS, generate

__all__ = ["KINDS", "generate"]
