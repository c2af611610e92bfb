# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A signal while a node is still importing what it needs ends it cleanly as well."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import pytest

EXECUTABLES = {
    "fuzzy_map_building": "mapper",
    "fuzzy_navigation": "planner",
    "nomad_sim": "sim",
}
# The signals are taken over before anything slow is imported: the word comes right after that.
SCRIPT = """
import importlib, sys
from fuzzy_map_building.ros import entry
take_over = entry.importlib.import_module
def told(name):
    print("begun", flush=True)
    return take_over(name)
entry.importlib = type("Importer", (), {"import_module": staticmethod(told)})
executable = getattr(importlib.import_module(sys.argv[1] + ".ros.entry"), sys.argv[2])
del sys.argv[1:]
sys.exit(executable())
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("package", EXECUTABLES)
@pytest.mark.parametrize("delay", [0.0, 0.3, 0.8])
def test_a_signal_during_the_imports(package: str, number: signal.Signals, delay: float) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT, package, EXECUTABLES[package]],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(delay)
    process.send_signal(number)
    _, errors = process.communicate(timeout=30.0)
    assert process.returncode == 0, errors
    assert "Traceback" not in errors
