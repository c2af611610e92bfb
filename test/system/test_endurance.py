# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The long runs can be started; how they end takes hours, and is told in the README."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = sorted((Path(__file__).resolve().parents[1] / "endurance").glob("*.py"))


def run(script: Path, *options: str) -> str:
    done = subprocess.run(
        [sys.executable, script, *options], capture_output=True, text=True, timeout=100
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_long_run_says_what_it_does_and_how_to_make_it_short(script: Path) -> None:
    assert "--quick" in run(script, "--help")


def test_a_soak_drives_missions_and_reports_memory() -> None:
    (soak,) = (script for script in SCRIPTS if script.stem == "soak")
    told = run(soak, "--quick", "--parts", "core", "--limit", "60")
    assert "memory" in told
    assert "reached" in told
