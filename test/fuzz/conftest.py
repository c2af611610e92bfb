# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the parser says that rclpy imports with its first message type is nobody's fault here."""

from __future__ import annotations

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Let its warnings pass."""
    for module in ("sre_parse", "sre_constants"):
        config.addinivalue_line(
            "filterwarnings", f"ignore:module '{module}' is deprecated:DeprecationWarning"
        )
