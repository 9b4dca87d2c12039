"""What all transports have in common: waiting for bytes, counting what went wrong."""

import errno
import fcntl
import os
import select
import socket
import struct
import termios
from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import TracebackType
from typing import NamedTuple, Self

from link.errors import UserError
from link.transports.device import NetworkDevice

CHUNK_BYTES = 65536  # the largest datagram there is
DRAIN_BYTES_MAX = 1 << 16  # a flood must not keep the loop from its other work; 100 Mbit/s at 200 turns a second


@dataclass(frozen=True, slots=True, kw_only=True)
class TransportStatistics:
    """What a transport could not do.

    Attributes:
        errors: failed system calls, such as a refused connection.
        dropped: sends that reached nobody: no peer yet, or one that does not read.
        strangers: times that others than the pinned peer were heard and not listened to.
    """

    errors: int
    dropped: int
    strangers: int


class PeerBytes(NamedTuple):
    """Bytes from one of a transport's peers; `peer` numbers them in the order in which they were met."""

    peer: int
    data: bytes


class Transport(ABC):
    """Bytes in and out; also a context manager that closes itself.

    Attributes:
        is_datagram: whether what comes at a time from a peer is whole frames, instead of a piece of a stream.
    """

    is_datagram = False

    def __init__(self) -> None:
        self._errors = 0
        self._dropped = 0
        self._strangers = 0
        self._is_seeking = False
        self._pinned: int | None = None

    @property
    def statistics(self) -> TransportStatistics:
        """The counters as they stand."""
        return TransportStatistics(errors=self._errors, dropped=self._dropped, strangers=self._strangers)

    @abstractmethod
    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there.

        Args:
            timeout_s: how long to wait at most, 0 for not at all.

        Returns:
            What came, empty when nothing did.
        """

    def receive_by_peer(self, timeout_s: float) -> list[PeerBytes]:
        """Waits for bytes like `receive`, and tells which came from whom: each peer's are a stream of their own.

        Args:
            timeout_s: how long to wait at most, 0 for not at all.

        Returns:
            What came, in order.
        """
        data = self.receive(timeout_s)
        return [PeerBytes(0, data)] if data else []

    def seek_peer(self) -> None:
        """Hears everybody from now on but, where others have to speak first, sends to nobody, until `pin`."""
        self._is_seeking, self._pinned = True, None

    def pin(self, peer: int) -> None:
        """Hears this peer only from now on, and sends to no other, until `seek_peer`.

        Args:
            peer: as the last `receive_by_peer` numbers it; where there can only be one, this changes nothing.
        """
        self._is_seeking, self._pinned = False, peer

    @abstractmethod
    def send(self, data: bytes) -> None:
        """Sends bytes to every peer, if there is one, without waiting.

        Args:
            data: whole frames.
        """

    @abstractmethod
    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""

    @abstractmethod
    def close(self) -> None:
        """Gives the device back; may be called twice."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def wait_readable(descriptor: int, timeout_s: float) -> bool:
    """Whether a descriptor has bytes within the time; just waits when it is -1."""
    descriptors = [descriptor] if descriptor >= 0 else []
    return bool(select.select(descriptors, [], [], max(timeout_s, 0.0))[0])


def held_bytes(descriptor: int) -> int:
    """How many bytes written to a socket or serial port the system still holds: tcp(7) SIOCOUTQ, which is TIOCOUTQ.

    Raises:
        OSError: The descriptor has gone.
    """
    return int(struct.unpack("i", fcntl.ioctl(descriptor, termios.TIOCOUTQ, bytes(4)))[0])


def resolve(device: NetworkDevice, kind: socket.SocketKind) -> tuple[socket.AddressFamily, tuple[str, int]]:
    """The address of a device's host.

    Raises:
        UserError: The host is unknown.
    """
    try:
        found = socket.getaddrinfo(device.host, device.port, type=kind)
    except (OSError, UnicodeError) as error:
        raise UserError(f"{device}: host {device.host!r} is unknown; check its name or write its address") from error
    family, _, _, _, address = min(found, key=lambda one: one[0] != socket.AF_INET)
    return family, (str(address[0]), device.port)


def bind(bound: socket.socket, address: tuple[str, int], device: NetworkDevice) -> None:
    """Binds a socket.

    Raises:
        UserError: The port is in use, not allowed, or the address is not this machine's.
    """
    try:
        bound.bind(address)
    except OSError as error:
        bound.close()
        raise UserError(f"{device}: {_bind_problem(error, device)}") from error


def _bind_problem(error: OSError, device: NetworkDevice) -> str:
    match error.errno:
        case errno.EADDRINUSE:
            return f"port {device.port} is in use; stop the program that has it or choose another port"
        case errno.EADDRNOTAVAIL:
            return f"{device.host} is no address of this machine; write 0.0.0.0 or 127.0.0.1"
        case errno.EACCES:
            return f"port {device.port} needs privileges; choose one from 1024 up"
        case _:
            return f"cannot be opened ({os.strerror(error.errno or 0)}); choose another host or port"
