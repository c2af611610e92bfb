# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Risk-aware path planning and motion on fuzzy maps."""
