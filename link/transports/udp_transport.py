"""UDP: `udpin` listens and answers everybody who has spoken, `udpout` speaks to one address."""

import socket
import time
from typing import Any

from link.errors import UserError
from link.transports.device import NetworkDevice
from link.transports.transport import CHUNK_BYTES, DRAIN_BYTES_MAX, PeerBytes, Transport, bind, resolve, wait_readable

_RECEIVE_BUFFER_BYTES = 1 << 20  # rides out a pause of the program; the system may grant less
_PEERS_MAX = 16
_PEER_SILENT_S = 30.0  # thirty heartbeats missed: it has gone, and its port may be somebody else's soon


class UdpPeers:
    """Who is at the other end of a UDP port: everybody who spoke lately, and who spoke last in any case."""

    def __init__(self) -> None:
        self._heard_s: dict[Any, float] = {}  # address, whose form is the address family's; the latest is the last
        self._numbers: dict[Any, int] = {}
        self._met = 0

    @property
    def addresses(self) -> list[Any]:
        """Their addresses."""
        return list(self._heard_s)

    def heard(self, address: Any, now_s: float) -> int:
        """Takes note that a peer spoke; returns its number."""
        self._heard_s.pop(address, None)
        self._heard_s[address] = now_s
        if address not in self._numbers:
            self._numbers[address] = self._met
            self._met += 1
            if len(self._heard_s) > _PEERS_MAX:
                self._forget(next(iter(self._heard_s)))
        return self._numbers[address]

    def forget_silent(self, now_s: float) -> None:
        """Drops those who have been silent for long, but never the last one left."""
        while len(self._heard_s) > 1:
            address, heard_s = next(iter(self._heard_s.items()))
            if now_s - heard_s <= _PEER_SILENT_S:
                return
            self._forget(address)

    def _forget(self, address: Any) -> None:
        del self._heard_s[address], self._numbers[address]


class _UdpTransport(Transport):
    is_datagram = True

    def __init__(self, device: NetworkDevice) -> None:
        super().__init__()
        family, self._address = resolve(device, socket.SOCK_DGRAM)
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
        self._peers = UdpPeers()
        self._senders: dict[int, Any] = {}  # of what came last, by number: a crowd of others pushes none of them out
        self._pinned_address: Any = None

    @property
    def port(self) -> int:
        """Our own port."""
        return int(self._socket.getsockname()[1])

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        return b"".join(data for _, data in self.receive_by_peer(timeout_s))

    def receive_by_peer(self, timeout_s: float) -> list[PeerBytes]:
        """Waits for datagrams and takes all that are there, each with its sender."""
        if self._socket.fileno() < 0 or not wait_readable(self._socket.fileno(), timeout_s):
            return []
        received: list[PeerBytes] = []
        self._senders.clear()
        size, now_s = 0, time.monotonic()
        while size < DRAIN_BYTES_MAX:
            try:
                data, address = self._socket.recvfrom(CHUNK_BYTES)
            except BlockingIOError:
                break
            except OSError:  # a datagram of ours was refused, which says nothing of the next one
                self._errors += 1
                continue
            size += len(data) or 1  # an empty datagram, too, is work
            if self._pinned_address in {None, address}:
                peer = self._peers.heard(address, now_s)
                self._senders[peer] = address
                received.append(PeerBytes(peer, data))
            else:
                self._strangers += 1
        self._peers.forget_silent(now_s)
        return received

    def seek_peer(self) -> None:
        """Hears everybody from now on but, where others have to speak first, sends to nobody, until `pin`."""
        super().seek_peer()
        self._pinned_address = None

    def pin(self, peer: int) -> None:
        """Hears this peer's address and port only from now on, and sends to no other, until `seek_peer`."""
        super().pin(peer)
        self._pinned_address = self._senders.get(peer)

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""
        return self._socket.fileno()

    def close(self) -> None:
        """Gives the device back."""
        self._socket.close()

    def send(self, data: bytes) -> None:
        """Sends bytes to every peer, if there is one."""
        addresses = self._receivers()
        if not addresses:
            self._dropped += 1
        for address in addresses:
            try:
                self._transmit(data, address)
            except BlockingIOError:
                self._dropped += 1
            except OSError:
                self._errors += 1

    def _receivers(self) -> list[Any]:
        if self._pinned_address is not None:
            return [self._pinned_address]
        return [] if self._is_seeking else self._peers.addresses

    def _transmit(self, data: bytes, address: Any) -> None:
        self._socket.sendto(data, address)


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

    def _receivers(self) -> list[Any]:
        return [self._address]

    def _transmit(self, data: bytes, address: Any) -> None:
        del address
        self._socket.send(data)


class UdpBoundTransport(_UdpTransport):
    """Speaks to one address from a port of its own, where others may speak to it, as firmware simulators do.

    Raises:
        UserError: The host is unknown or our port in use.
    """

    def __init__(self, device: NetworkDevice) -> None:
        super().__init__(device)
        own_port = device.own_port or 0
        host, _port = self._address
        # To this machine only, unless the other end is elsewhere.
        own_host = host if host in {"127.0.0.1", "::1"} else "::" if ":" in host else "0.0.0.0"  # noqa: S104 (an autopilot elsewhere)
        bind(self._socket, (own_host, own_port), NetworkDevice(kind="udpin", host=own_host, port=own_port))

    def _receivers(self) -> list[Any]:
        if self._pinned_address is not None:
            return [self._pinned_address]
        others = (one for one in super()._receivers() if one[:2] != self._address)
        return [self._address, *others]
