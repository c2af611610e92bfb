# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fuzzy maps from range readings: belief of empty, belief of occupied, two risk maps."""
