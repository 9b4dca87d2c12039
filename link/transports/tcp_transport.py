"""TCP: `tcp` is a client that connects again whenever it has to, `tcpin` a server for several clients."""

import errno
import select
import socket
import time
from collections.abc import Set

from link.transports.device import NetworkDevice
from link.transports.tcp_connection import TcpConnection
from link.transports.transport import PeerBytes, Transport, bind, resolve, wait_readable

_RECONNECT_S = 0.5
_CLIENTS_MAX = 16


class TcpClientTransport(Transport):
    """Connects to a server, and again after each loss.

    Args:
        device: the server.
        is_patient: stay connected to one that does not read.

    Raises:
        UserError: The host is unknown.
    """

    def __init__(self, device: NetworkDevice, *, is_patient: bool = False) -> None:
        super().__init__()
        self._is_patient = is_patient
        self._family, self._address = resolve(device, socket.SOCK_STREAM)
        self._connection: TcpConnection | None = None
        self._attempt: socket.socket | None = None
        self._next_attempt_s = 0.0
        self._awaits_sign = False
        self._connect(0.0)

    @property
    def is_connected(self) -> bool:
        """Whether there is somebody at the other end."""
        return self._connection is not None

    def send(self, data: bytes) -> None:
        """Sends bytes if there is somebody to send them to."""
        if self._connection is None or self._awaits_sign:
            self._dropped += 1
        else:
            self._dropped += self._connection.send(data, time.monotonic())
        self._check()

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        if self._connection is None:
            self._connect(timeout_s)
            return b""
        self._dropped += self._connection.flush(time.monotonic())
        if self._connection.is_open and not wait_readable(self._connection.fileno(), timeout_s):
            return b""
        data = self._connection.read()
        self._awaits_sign = self._awaits_sign and not data
        self._check()
        return data

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""
        return -1 if self._connection is None else self._connection.fileno()

    def close(self) -> None:
        """Gives the device back."""
        if self._connection is not None:
            self._connection.close()
        self._connection = None
        self._abandon()
        self._next_attempt_s = float("inf")

    def _check(self) -> None:
        """Takes note of a loss.

        After a stall the other end has to be heard first: its system also connects and takes frames for a program that
        sleeps, which would read them late. Whoever speaks MAVLink says so each second.
        """
        if self._connection is not None and not self._connection.is_open:
            self._errors += 1
            self._awaits_sign = self._awaits_sign or self._connection.has_stalled
            self._connection = None

    def _connect(self, timeout_s: float) -> None:
        """Goes on with connecting, for the given time at most."""
        if self._attempt is None:
            pause_s = self._next_attempt_s - time.monotonic()
            if pause_s > 0.0:
                wait_readable(-1, min(pause_s, timeout_s))
                return
            self._next_attempt_s = time.monotonic() + _RECONNECT_S
            self._attempt = socket.socket(self._family, socket.SOCK_STREAM)
            self._attempt.setblocking(False)
            if self._attempt.connect_ex(self._address) not in {0, errno.EINPROGRESS}:  # no way there, for now
                self._errors += 1
                self._abandon()
                return
        if select.select([], [self._attempt], [], timeout_s)[1]:
            self._finish(self._attempt)

    def _finish(self, attempt: socket.socket) -> None:
        if attempt.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
            self._errors += 1
            self._abandon()
            return
        self._attempt = None
        self._connection = TcpConnection(attempt, is_patient=self._is_patient)

    def _abandon(self) -> None:
        if self._attempt is not None:
            self._attempt.close()
        self._attempt = None


class TcpServerTransport(Transport):
    """Serves clients, each of which gets everything that is sent.

    A further one than there is room for takes the place of the one that has been silent for longest, never that of the
    pinned one: whoever connects and says nothing keeps nobody out.

    Args:
        device: where.
        is_patient: keep clients that do not read.

    Raises:
        UserError: The host is unknown or the port in use.
    """

    def __init__(self, device: NetworkDevice, *, is_patient: bool = False) -> None:
        super().__init__()
        self._is_patient = is_patient
        family, address = resolve(device, socket.SOCK_STREAM)
        self._listener = socket.socket(family, socket.SOCK_STREAM)
        # Without this the port of a server that has just ended stays taken for a minute.
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._listener.setblocking(False)
        bind(self._listener, address, device)
        self._listener.listen(_CLIENTS_MAX)
        self._waiting = select.epoll()  # one descriptor that is readable when any of them is
        self._waiting.register(self._listener, select.EPOLLIN)
        self._clients: dict[int, TcpConnection] = {}  # the latest that came or was heard is the last
        self._met = 0

    @property
    def port(self) -> int:
        """Our own port."""
        return int(self._listener.getsockname()[1])

    @property
    def is_connected(self) -> bool:
        """Whether there is a client."""
        return bool(self._clients)

    def send(self, data: bytes) -> None:
        """Sends bytes to every client, if there is one."""
        clients = [client for number, client in self._clients.items() if self._is_served(number)]
        if not clients:
            self._dropped += 1
        now_s = time.monotonic()
        for client in clients:
            self._dropped += client.send(data, now_s)
        self._let_go()

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        return b"".join(data for _, data in self.receive_by_peer(timeout_s))

    def receive_by_peer(self, timeout_s: float) -> list[PeerBytes]:
        """Waits for bytes and takes all that are there, each client's apart."""
        now_s = time.monotonic()
        for client in self._clients.values():
            self._dropped += client.flush(now_s)
        self._let_go()
        if self.fileno() < 0 or not wait_readable(self.fileno(), timeout_s):
            return []
        received = [PeerBytes(number, data) for number, client in self._clients.items() if (data := client.read())]
        for number, _ in received:
            self._clients[number] = self._clients.pop(number)
        self._let_go()
        self._accept({self._pinned, *(number for number, _ in received)})
        heard = [one for one in received if self._pinned in {None, one.peer}]
        self._strangers += len(received) - len(heard)
        return heard

    def _is_served(self, number: int) -> bool:
        return not self._is_seeking and self._pinned in {None, number}

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 when closed."""
        return -1 if self._waiting.closed else self._waiting.fileno()

    def close(self) -> None:
        """Gives the device back."""
        for client in self._clients.values():
            client.close()
        self._clients.clear()
        self._waiting.close()
        self._listener.close()

    def _accept(self, kept: Set[int | None]) -> None:
        """Take a client that has come; where there is no room, another one goes, but none of `kept`."""
        try:
            connected = self._listener.accept()[0]
        except OSError:  # nobody new, or gone again before it was served
            return
        if len(self._clients) == _CLIENTS_MAX and not self._make_room(kept):
            connected.close()
            return
        self._clients[self._met] = TcpConnection(connected, is_patient=self._is_patient)
        self._met += 1
        self._waiting.register(connected, select.EPOLLIN)

    def _make_room(self, kept: Set[int | None]) -> bool:
        silent = next((number for number in self._clients if number not in kept), None)
        if silent is None:
            return False
        self._clients.pop(silent).close()
        return True

    def _let_go(self) -> None:
        """Forgets those that have gone; epoll forgets a closed socket by itself."""
        gone = [number for number, client in self._clients.items() if not client.is_open]
        for number in gone:
            self._errors += 1
            del self._clients[number]
