"""One TCP connection: frames that the other end does not take in time do not reach it later either.

The system acknowledges for a program that does not read, as long as it has room for it: that cannot be called back.
"""

import socket
import struct

from link.transports.send_queue import UNDER_WAY_MAX_S, SendQueue
from link.transports.transport import CHUNK_BYTES, DRAIN_BYTES_MAX, held_bytes

_SEND_BUFFER_BYTES = 16384  # the system's own part in what is under way; Linux takes it twice
_RESET_AT_ONCE = struct.pack("ii", 1, 0)  # socket(7), SO_LINGER: what is unsent is thrown away


class TcpConnection:
    """A connected socket that never blocks and never raises.

    Args:
        connected: the socket, which is the connection's from now on.
        is_patient: stay connected however late the other end reads what the system holds for it.
    """

    def __init__(self, connected: socket.socket, *, is_patient: bool = False) -> None:
        connected.setblocking(False)
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if not is_patient:
            _set_impatient(connected)
        self._socket, self._is_patient = connected, is_patient
        self._queue = SendQueue()
        self.is_open = True
        self.has_stalled = False

    def send(self, data: bytes, now_s: float) -> int:
        """Takes whole frames to be sent, at a monotonic time; returns how many given to it never will be."""
        refused = not self._queue.put(data, now_s)
        return refused + self.flush(now_s)

    def flush(self, now_s: float) -> int:
        """Sends what the other end takes, and ends a connection that stalls; returns how many never will be sent."""
        if not self.is_open:
            return 0
        dropped = 0
        try:
            dropped = self._queue.write(self._socket.send, now_s)
            if self._is_patient or not self._queue.is_overdue(held_bytes(self._socket.fileno()), now_s):
                return dropped
            self.has_stalled = True
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET_AT_ONCE)
        except OSError as error:  # the connection is lost, which ends it just so
            self.has_stalled = self.has_stalled or isinstance(error, TimeoutError)
        dropped += len(self._queue)
        self.close()
        return dropped

    def read(self) -> bytes:
        """Takes what is there; the connection is closed afterwards when the other end has closed it."""
        received = bytearray()
        while self.is_open and len(received) < DRAIN_BYTES_MAX:
            try:
                data = self._socket.recv(CHUNK_BYTES)
            except BlockingIOError:
                break
            except OSError as error:
                self.has_stalled = self.has_stalled or isinstance(error, TimeoutError)
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
        self.is_open = False


def _set_impatient(connected: socket.socket) -> None:
    """Let the system hold little, and see a stall even while this program does nothing, where it can."""
    connected.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES)
    if hasattr(socket, "TCP_USER_TIMEOUT"):  # Linux
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(UNDER_WAY_MAX_S * 1000.0))
