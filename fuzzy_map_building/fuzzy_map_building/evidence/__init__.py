# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Rules that fuse the evidence of a packet into a global belief."""
