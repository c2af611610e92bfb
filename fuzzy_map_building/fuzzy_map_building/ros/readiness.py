# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""How a process tells the one that started it that it is up, by the protocol of sd_notify.

Whoever wants to know puts the address of a datagram socket into ``NOTIFY_SOCKET``, as systemd
does for services of type ``notify``; the process sends ``READY=1`` there.
"""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterable
from types import TracebackType
from typing import Final

__all__ = ["NOTIFY_SOCKET", "ReadyWatch", "tell_ready"]

#: Environment variable with the address; one that begins with @ is of no file.
NOTIFY_SOCKET: Final = "NOTIFY_SOCKET"
_READY: Final = b"READY=1"
_LONGEST: Final = 4096


def tell_ready() -> None:
    """Tell whoever started this process that it is up, if he wants to know."""
    address = os.environ.get(NOTIFY_SOCKET, "")
    if not address:
        return
    # Nobody there any more: then nobody wants to know.
    with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        sender.sendto(_READY, "\0" + address[1:] if address[0] == "@" else address)


class ReadyWatch:
    """Hears from processes that they are up. A context manager.

    Parameters
    ----------
    names : iterable of str
        What to call the processes.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._sockets: dict[str, socket.socket] = {}
        self._waiting = set(names)
        for name in self._waiting:
            listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            listener.setblocking(False)
            listener.bind("")  # the kernel chooses an address of no file
            self._sockets[name] = listener

    def __enter__(self) -> ReadyWatch:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        for listener in self._sockets.values():
            listener.close()

    def environment(self, name: str) -> dict[str, str]:
        """Return the variable that the process of this name has to be given."""
        address: bytes = self._sockets[name].getsockname()
        return {NOTIFY_SOCKET: "@" + address[1:].decode()}

    @property
    def all_up(self) -> bool:
        """Whether every process has told that it is up."""
        self._waiting = {name for name in self._waiting if not self._heard(name)}
        return not self._waiting

    def _heard(self, name: str) -> bool:
        try:
            while True:
                if _READY in self._sockets[name].recv(_LONGEST).splitlines():
                    return True
        except BlockingIOError:
            return False
