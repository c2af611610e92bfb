# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Theories of evidence: one module a fusion rule, all behind one small protocol."""
