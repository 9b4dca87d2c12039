"""One TCP connection: what the other end does not take at once is kept, and a frame is never cut off."""

import socket

from link.mavlink.transport import CHUNK_BYTES, DRAIN_BYTES_MAX

_UNSENT_BYTES_MAX = 65536  # more than a second of setpoints; to a peer that reads so late they are no use


class TcpConnection:
    """A connected socket that never blocks and never raises.

    Args:
        connected: the socket, which is the connection's from now on.
    """

    def __init__(self, connected: socket.socket) -> None:
        connected.setblocking(False)
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connected
        self._unsent = bytearray()
        self.is_open = True

    def send(self, data: bytes) -> bool:
        """Takes whole frames to be sent; returns whether there was room for them."""
        has_room = len(self._unsent) + len(data) <= _UNSENT_BYTES_MAX
        if has_room:
            self._unsent += data
        self.flush()
        return has_room

    def flush(self) -> None:
        """Sends what the other end takes, and keeps the rest."""
        if not self.is_open or not self._unsent:
            return
        try:
            del self._unsent[: self._socket.send(self._unsent)]
        except BlockingIOError:
            return
        except OSError:
            self.close()

    def read(self) -> bytes:
        """Takes what is there; the connection is closed afterwards when the other end has closed it."""
        received = bytearray()
        while self.is_open and len(received) < DRAIN_BYTES_MAX:
            try:
                data = self._socket.recv(CHUNK_BYTES)
            except BlockingIOError:
                break
            except OSError:
                data = b""
            if not data:
                self.close()
            received += data
        return bytes(received)

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 when closed."""
        return self._socket.fileno()

    def close(self) -> None:
        """Gives the socket back."""
        self._socket.close()
        self._unsent.clear()
        self.is_open = False
