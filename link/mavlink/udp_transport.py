"""UDP: `udpin` listens and answers whoever spoke last, `udpout` speaks to one address."""

import socket
from typing import Any

from link.errors import UserError
from link.mavlink.device import NetworkDevice
from link.mavlink.transport import CHUNK_BYTES, DRAIN_BYTES_MAX, Transport, bind, resolve, wait_readable

_RECEIVE_BUFFER_BYTES = 1 << 20  # rides out a pause of the program; the system may grant less


class _UdpTransport(Transport):
    def __init__(self, device: NetworkDevice) -> None:
        super().__init__()
        family, self._address = resolve(device, socket.SOCK_DGRAM)
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
        self._peer: Any = None  # an address, whose form is the address family's

    @property
    def port(self) -> int:
        """Our own port."""
        return int(self._socket.getsockname()[1])

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        if self._socket.fileno() < 0 or not wait_readable(self._socket.fileno(), timeout_s):
            return b""
        received = bytearray()
        while len(received) < DRAIN_BYTES_MAX:
            try:
                data, self._peer = self._socket.recvfrom(CHUNK_BYTES)
            except BlockingIOError:
                break
            except OSError:  # a datagram of ours was refused, which says nothing of the next one
                self._errors += 1
                continue
            received += data
        return bytes(received)

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""
        return self._socket.fileno()

    def close(self) -> None:
        """Gives the device back."""
        self._socket.close()

    def send(self, data: bytes) -> None:
        """Sends bytes if there is somebody to send them to."""
        if self._peer is None:
            self._dropped += 1
            return
        try:
            self._transmit(data)
        except BlockingIOError:
            self._dropped += 1
        except OSError:
            self._errors += 1

    def _transmit(self, data: bytes) -> None:
        self._socket.sendto(data, self._peer)


class UdpInTransport(_UdpTransport):
    """Listens on an address.

    Raises:
        UserError: The host is unknown or the port in use.
    """

    def __init__(self, device: NetworkDevice) -> None:
        super().__init__(device)
        bind(self._socket, self._address, device)


class UdpOutTransport(_UdpTransport):
    """Speaks to one address, and hears only that.

    Raises:
        UserError: The host is unknown or there is no way to it.
    """

    def __init__(self, device: NetworkDevice) -> None:
        super().__init__(device)
        try:
            self._socket.connect(self._address)
        except OSError as error:
            self._socket.close()
            raise UserError(f"{device}: there is no way to this host ({error.strerror}); check the network") from error
        self._peer = self._address

    def _transmit(self, data: bytes) -> None:
        self._socket.send(data)
