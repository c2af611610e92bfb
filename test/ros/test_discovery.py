# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Nodes announce themselves twice a second to this machine, unless the user has said otherwise."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzy_map_building.ros.discovery import DISCOVERY_RANGE, PROFILES, set_discovery
from ros.harness import NodeProcess

#: Participants on one machine that announcements go to one by one.
PEERS = 32


def test_what_the_user_has_set_stays() -> None:
    environment = {DISCOVERY_RANGE: "SUBNET", PROFILES: "/of/the/user.xml"}
    set_discovery(given := dict(environment))
    assert given == environment
    set_discovery(given := {})
    assert given[DISCOVERY_RANGE] == "LOCALHOST"
    assert Path(given[PROFILES]).is_file()


def listener() -> socket.socket:
    """Return a socket where the metatraffic of a participant would come, the last that is free.

    Port numbers are those of the DDSI-RTPS specification, section 9.6.1.
    """
    first = 7400 + 250 * int(os.environ["ROS_DOMAIN_ID"]) + 10
    for participant in reversed(range(PEERS)):
        heard = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            heard.bind(("127.0.0.1", first + 2 * participant))
        except OSError:
            heard.close()
        else:
            return heard
    raise AssertionError("every port is taken")


def announcements(heard: socket.socket, seconds: float) -> int:
    """Return how many messages come in a time."""
    end = time.monotonic() + seconds
    count = 0
    while (left := end - time.monotonic()) > 0.0:
        heard.settimeout(left)
        try:
            count += heard.recv(65536).startswith(b"RTPS")
        except TimeoutError:
            break
    return count


@pytest.mark.parametrize(("own", "fewest", "most"), [(True, 8, 14), (False, 0, 4)])
def test_nodes_announce_themselves_twice_a_second(
    own: bool,
    fewest: int,
    most: int,
    start_node: Callable[..., NodeProcess],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """With profiles of the user's that say nothing of it they do so every three seconds."""
    monkeypatch.delenv(PROFILES, raising=False)
    if not own:
        file = tmp_path / "of_the_user.xml"
        file.write_text('<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"/>')
        monkeypatch.setenv(PROFILES, str(file))
    with listener() as heard:
        node = start_node("planner")
        node.wait_for_output("planning by")
        announcements(heard, 2.0)  # more at first
        assert fewest <= announcements(heard, 6.0) <= most
        assert "XMLPARSER" not in node.output()
