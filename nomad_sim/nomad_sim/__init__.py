# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A simulated NOMAD 200 in worlds of segments, and the whole loop around it."""
