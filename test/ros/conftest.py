# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the tests with real node processes: whatever a test starts is ended after it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from nomad_sim.ros.domain import reserved_domain
from ros.harness import NodeProcess, Probe


def pytest_configure(config: pytest.Config) -> None:
    """Let pass what the parser says that rclpy imports with its first message type."""
    for module in ("sre_parse", "sre_constants"):
        config.addinivalue_line(
            "filterwarnings", f"ignore:module '{module}' is deprecated:DeprecationWarning"
        )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep a module's tests together where tests run side by side: they share processes."""
    if config.pluginmanager.hasplugin("xdist"):
        for item in items:
            if item.path.is_relative_to(Path(__file__).parent):
                item.add_marker(pytest.mark.xdist_group(item.path.stem))


@pytest.fixture(scope="module", autouse=True)
def domain() -> Iterator[None]:
    """A domain of the module's own: what one leaves behind must not answer the next."""
    with reserved_domain() as number, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(number))
        yield


@pytest.fixture
def probe() -> Iterator[Probe]:
    """A node of the test itself."""
    probe = Probe()
    yield probe
    probe.close()


@pytest.fixture
def start_node(tmp_path: Path) -> Iterator[Callable[..., NodeProcess]]:
    """Start an executable; every process is ended after the test."""
    started: list[NodeProcess] = []

    def start(executable: str, **keywords: Any) -> NodeProcess:
        log = tmp_path / f"{executable}_{len(started)}.log"
        process = NodeProcess(executable, log, **keywords)
        started.append(process)
        return process

    yield start
    for process in reversed(started):
        process.close()
