# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What every test stands on: its own corner of the network, repeatable draws, recorded data."""

import contextlib
import os
import signal
from pathlib import Path

import hypothesis
import pytest

from nomad_sim.ros.domain import reserved_domain

hypothesis.settings.register_profile("repeatable", derandomize=True, deadline=None)
hypothesis.settings.load_profile("repeatable")


def pytest_configure(config: pytest.Config) -> None:
    """Set ROS up before any test module imports it, for this process and those it starts."""
    patch = pytest.MonkeyPatch()
    config.add_cleanup(patch.undo)
    patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    # Message setters check their values only with this; it is read when a message is imported.
    patch.setenv("ROS_PYTHON_CHECK_FIELDS", "1")
    # Pictures are written to files; no test needs a screen.
    patch.setenv("MPLBACKEND", "Agg")
    # A shell that starts the tests in its background lets them ignore interrupts, and whatever
    # they start inherits that.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    reserved = contextlib.ExitStack()
    config.add_cleanup(reserved.close)
    patch.setenv("ROS_DOMAIN_ID", str(reserved.enter_context(reserved_domain())))


@pytest.fixture(scope="session")
def fuzzy_nav_data() -> Path:
    """Folder of the recorded data; the test is skipped where it is not given."""
    folder = os.environ.get("FUZZY_NAV_DATA")
    if not folder:
        pytest.skip("needs recorded data: set FUZZY_NAV_DATA to their folder")
    path = Path(folder)
    if not path.is_dir():
        raise FileNotFoundError(f"FUZZY_NAV_DATA is {folder!r}, which is not a folder")
    return path
