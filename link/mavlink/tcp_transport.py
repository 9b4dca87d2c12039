"""TCP: `tcp` is a client that connects again whenever it has to, `tcpin` a server for one client at a time."""

import contextlib
import select
import socket
import time

from link.mavlink.device import NetworkDevice
from link.mavlink.transport import CHUNK_BYTES, DRAIN_BYTES_MAX, Transport, bind, resolve, wait_readable

_RECONNECT_S = 0.5
_UNSENT_BYTES_MAX = 65536  # more than a second of setpoints; to a peer that reads so late they are no use


class _TcpTransport(Transport):
    """A connection that may come and go."""

    def __init__(self) -> None:
        super().__init__()
        self._connection: socket.socket | None = None
        self._unsent = bytearray()

    @property
    def is_connected(self) -> bool:
        """Whether there is somebody at the other end."""
        return self._connection is not None

    def send(self, data: bytes) -> None:
        """Sends bytes if there is somebody to send them to."""
        if self._connection is None or len(self._unsent) + len(data) > _UNSENT_BYTES_MAX:
            self._dropped += 1
            self._flush()
            return
        self._unsent += data
        self._flush()

    def close(self) -> None:
        """Gives the device back."""
        if self._connection is not None:
            self._connection.close()
        self._connection = None
        self._unsent.clear()

    def _adopt(self, connection: socket.socket) -> None:
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connection = connection

    def _flush(self) -> None:
        """Sends what the other end takes, and keeps the rest, since a frame must not be cut off."""
        if self._connection is None or not self._unsent:
            return
        try:
            del self._unsent[: self._connection.send(self._unsent)]
        except BlockingIOError:
            return
        except OSError:
            self._lose()

    def _read(self, connection: socket.socket) -> bytes:
        received = bytearray()
        while len(received) < DRAIN_BYTES_MAX:
            try:
                data = connection.recv(CHUNK_BYTES)
            except BlockingIOError:
                break
            except OSError:
                data = b""
            if not data:
                self._lose()
                break
            received += data
        return bytes(received)

    def _lose(self) -> None:
        self._errors += 1
        _TcpTransport.close(self)


class TcpClientTransport(_TcpTransport):
    """Connects to a server, and again after each loss.

    Raises:
        UserError: The host is unknown.
    """

    def __init__(self, device: NetworkDevice) -> None:
        super().__init__()
        self._family, self._address = resolve(device, socket.SOCK_STREAM)
        self._attempt: socket.socket | None = None
        self._next_attempt_s = 0.0
        self._connect(0.0)

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        if self._connection is None:
            self._connect(timeout_s)
            return b""
        self._flush()
        if self._connection is None or not wait_readable(self._connection.fileno(), timeout_s):
            return b""
        return self._read(self._connection)

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""
        return -1 if self._connection is None else self._connection.fileno()

    def close(self) -> None:
        """Gives the device back."""
        super().close()
        self._abandon()
        self._next_attempt_s = float("inf")

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
            self._attempt.connect_ex(self._address)
        if select.select([], [self._attempt], [], timeout_s)[1]:
            self._finish(self._attempt)

    def _finish(self, attempt: socket.socket) -> None:
        if attempt.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
            self._errors += 1
            self._abandon()
            return
        self._attempt = None
        self._adopt(attempt)

    def _abandon(self) -> None:
        if self._attempt is not None:
            self._attempt.close()
        self._attempt = None


class TcpServerTransport(_TcpTransport):
    """Serves one client at a time; the next one waits until the first is gone.

    Raises:
        UserError: The host is unknown or the port in use.
    """

    def __init__(self, device: NetworkDevice) -> None:
        super().__init__()
        family, address = resolve(device, socket.SOCK_STREAM)
        self._listener = socket.socket(family, socket.SOCK_STREAM)
        # Without this the port of a server that has just ended stays taken for a minute.
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._listener.setblocking(False)
        bind(self._listener, address, device)
        self._listener.listen(1)

    @property
    def port(self) -> int:
        """Our own port."""
        return int(self._listener.getsockname()[1])

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        self._flush()
        if self.fileno() < 0 or not wait_readable(self.fileno(), timeout_s):
            return b""
        if self._connection is not None:
            return self._read(self._connection)
        with contextlib.suppress(OSError):  # the client has gone again before it was served
            self._adopt(self._listener.accept()[0])
        return b""

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""
        return self._listener.fileno() if self._connection is None else self._connection.fileno()

    def close(self) -> None:
        """Gives the device back."""
        super().close()
        self._listener.close()
