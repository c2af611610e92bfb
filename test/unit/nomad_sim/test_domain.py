# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain of one's own."""

import socket

import pytest
from domain_coordinator import domain_id

from nomad_sim.ros import domain
from nomad_sim.ros.domain import reserved_domain


def test_two_at_once_get_different_domains() -> None:
    with reserved_domain() as first, reserved_domain() as second:
        assert first != second
        assert {first, second} <= set(domain.RESERVED)


def test_a_chosen_domain_is_used() -> None:
    with reserved_domain(7) as first, reserved_domain(7) as second:
        assert (first, second) == (7, 7)


def test_domains_of_tests_and_of_running_nodes_are_left_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with reserved_domain() as free, reserved_domain() as other:
        pass
    monkeypatch.setattr(domain, "RESERVED", (free, other))
    with domain_id(lambda: free), reserved_domain() as found:
        assert found == other
    # What a participant of DDS holds.
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as participant:
        participant.bind(("", 7410 + 250 * other))
        with reserved_domain() as found:
            assert found == free
        with domain_id(lambda: free), pytest.raises(OSError, match="in use"):
            reserved_domain().__enter__()
