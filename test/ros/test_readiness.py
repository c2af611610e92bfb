# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Who is up says so to who started it, by the protocol of sd_notify."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from fuzzy_map_building.ros.readiness import NOTIFY_SOCKET, ReadyWatch, tell_ready


def test_all_are_up_when_each_has_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    with ReadyWatch(["one", "other"]) as watch:
        assert not watch.all_up
        for _ in range(2):  # one of them twice is not both
            monkeypatch.setenv(NOTIFY_SOCKET, watch.environment("one")[NOTIFY_SOCKET])
            tell_ready()
            assert not watch.all_up
        monkeypatch.setenv(NOTIFY_SOCKET, watch.environment("other")[NOTIFY_SOCKET])
        tell_ready()
        assert watch.all_up
        assert watch.all_up
    tell_ready()  # nobody is there any more
    monkeypatch.delenv(NOTIFY_SOCKET)
    tell_ready()  # nobody wants to know


def test_what_is_no_readiness_is_none() -> None:
    with ReadyWatch(["one"]) as watch, socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        address = "\0" + watch.environment("one")[NOTIFY_SOCKET][1:]
        for text in (b"", b"STATUS=READY=1", b"READY=0", bytes(5000)):
            sender.sendto(text, address)
        assert not watch.all_up
        sender.sendto(b"STATUS=well\nREADY=1\n", address)
        assert watch.all_up


def test_the_socket_may_be_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "s"))
        monkeypatch.setenv(NOTIFY_SOCKET, str(tmp_path / "s"))
        tell_ready()
        listener.settimeout(5.0)
        assert listener.recv(100) == b"READY=1"
