# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain of one's own, so that two runs on one machine never hear each other."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator
from typing import Final

__all__ = ["DOMAINS", "RESERVED", "reserved_domain"]

#: Domains that there are: the ports of all fit below those that the system hands out.
DOMAINS: Final = range(102)
#: Those that one is reserved of; 0 is where everybody is who chose none.
RESERVED: Final = DOMAINS[1:]

# ROS 2's own domain_coordinator holds the TCP port of this number plus the domain while a
# test uses the domain. Holding the same port keeps clear of those as well.
_PORT_BASE: Final = 32768
# DDS: UDP port of the first participant's discovery, and ports from domain to domain.
_DISCOVERY_PORT: Final = 7410
_DOMAIN_GAIN: Final = 250


@contextlib.contextmanager
def reserved_domain(wanted: int | None = None) -> Iterator[int]:
    """Hold a domain while the context is open.

    Parameters
    ----------
    wanted : int, optional
        A domain that somebody has chosen; it is not looked at whether others use it.

    Yields
    ------
    int
        The domain.

    Raises
    ------
    OSError
        If every domain is in use.
    """
    if wanted is not None:
        yield wanted
        return
    # Everybody begins to look at a place of his own.
    first = os.getpid() % len(RESERVED)
    for domain in [*RESERVED[first:], *RESERVED[:first]]:
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as reservation:
            if _taken(reservation, _PORT_BASE + domain) or _inhabited(domain):
                continue
            yield domain
            return
    raise OSError(f"all ROS domains from {RESERVED[0]} to {RESERVED[-1]} are in use")


def _taken(sock: socket.socket, port: int) -> bool:
    """Whether the port belongs to somebody else; the socket holds it if not."""
    try:
        sock.bind(("", port))
    except OSError:
        return True
    return False


def _inhabited(domain: int) -> bool:
    """Whether a process on this machine takes part in the domain."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        return _taken(probe, _DISCOVERY_PORT + _DOMAIN_GAIN * domain)
