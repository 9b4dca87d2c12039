"""The service manager's side of a program: ready, status, watchdog, as datagrams to systemd where it asks for them.

Source: sd_notify(3): `NAME=VALUE` lines to the unix socket in NOTIFY_SOCKET, where a leading @ means an abstract one;
within WATCHDOG_USEC a `WATCHDOG=1` has to come, and half of it is advised.
"""

import os
import socket
from collections.abc import Mapping

_NS_PER_US = 1000


class Service:
    """Talks to systemd, or to nobody where the program was started by hand.

    Args:
        environ: the program's environment.
    """

    def __init__(self, environ: Mapping[str, str] = os.environ) -> None:
        self._address = _address(environ.get("NOTIFY_SOCKET", ""))
        watchdog_us = environ.get("WATCHDOG_USEC", "")
        is_meant = environ.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
        self._period_ns = int(watchdog_us) * _NS_PER_US // 2 if is_meant and watchdog_us.isdecimal() else 0
        self._due_ns: int | None = None
        self._is_ready = False
        self._status = ""
        self._socket: socket.socket | None = None
        if self._address is not None:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
            self._socket.setblocking(False)

    def ready(self) -> None:
        """Say, once, that the program does its work."""
        if not self._is_ready:
            self._is_ready = True
            self._send("READY=1")

    def alive(self, t_ns: int) -> None:
        """Say that the loop turns; call it in every turn, with the monotonic time."""
        if self._period_ns and (self._due_ns is None or t_ns >= self._due_ns):
            self._due_ns = t_ns + self._period_ns
            self._send("WATCHDOG=1")

    def status(self, text: str) -> None:
        """Say what it does, for `systemctl status`; the same again is not sent."""
        line = " ".join(text.split())
        if line != self._status:
            self._status = line
            self._send(f"STATUS={line}")

    def stopping(self) -> None:
        """Say that it ends."""
        self._send("STOPPING=1")

    def close(self) -> None:
        """Give the socket back."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, text: str) -> None:
        if self._socket is None or self._address is None:
            return
        try:
            self._socket.sendto(text.encode(), self._address)
        except OSError:  # a manager that does not listen must not stop a flight
            return


def _address(text: str) -> str | None:
    if text.startswith("@"):
        return "\0" + text[1:]
    return text if text.startswith("/") else None
