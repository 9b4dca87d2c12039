"""Somebody else who sends MAVLink to the companion's port, without a key: what they reach, and what they do not."""

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import AutopilotRestarted, Event, MessageReceived
from link.mavlink.pinned_peer import PinnedPeer
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import SIGNING_EPOCH_NS, Signing
from link.transports.device import NetworkDevice
from link.transports.opening import open_transport
from link.transports.tcp_transport import TcpServerTransport
from link.transports.transport import Transport
from link.transports.udp_transport import UdpInTransport
from tests.link.mavlink.fake_autopilot import MS, START_NS, FakeAutopilot, Pair, S, of_kind

DEADLINE_S = 20.0
KEY = bytes(range(32))
NOW_NS = SIGNING_EPOCH_NS + 350_000_000 * S


def beat(custom_mode: int) -> Message:
    return mavlink.MAVLink_heartbeat_message(2, 12, 0, custom_mode, 4, 3)


def until(condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end_s


class Companion:
    """A session behind a listening port; `t_ns` is its local time."""

    def __init__(self, transport: Transport, signing: Signing | None = None) -> None:
        self.transport = transport
        self.session = MavlinkSession(1, target_system_id=1, signing=signing)
        self.peer = PinnedPeer(transport, self.session)
        self.t_ns = NOW_NS
        self.modes: list[int] = []

    def turn(self) -> int:
        """Take what has come and send what is due; return how many datagrams were heard."""
        received = self.transport.receive_by_peer(0.01)
        for data in self.peer.heard(received):
            self._take(self.session.receive(data, self.t_ns, is_datagram=self.transport.is_datagram))
        self._take(self.session.poll(self.t_ns))
        for frame in self.session.take_output():
            self.transport.send(frame)
        return len(received)

    def hear(self, count: int) -> None:
        """Turn until so many datagrams were heard, of strangers or not."""
        before, heard = self.transport.statistics.strangers, 0

        def is_done() -> bool:
            nonlocal heard
            heard += self.turn()
            return heard + self.transport.statistics.strangers - before >= count

        until(is_done)

    def _take(self, events: list[Event]) -> None:
        messages = [event.message for event in of_kind(events, MessageReceived)]
        self.modes += [message.custom_mode for message in messages if message.get_type() == "HEARTBEAT"]


@pytest.fixture
def listener() -> UdpInTransport:
    return UdpInTransport(NetworkDevice(kind="udpin", host="127.0.0.1", port=0))


def test_only_the_address_and_port_where_the_autopilot_was_found_is_listened_to_and_sent_to(
    listener: UdpInTransport,
) -> None:
    device, own, forger = f"udpout:127.0.0.1:{listener.port}", MavlinkCodec(1, 1), MavlinkCodec(1, 1)
    with listener, open_transport(device) as autopilot, open_transport(device) as stranger:
        companion = Companion(listener)
        autopilot.send(own.encode(beat(1)))
        companion.hear(1)
        stranger.send(forger.encode(beat(2)))
        companion.hear(1)
        companion.t_ns += S
        autopilot.send(own.encode(beat(3)))
        companion.hear(1)
        assert companion.modes == [1, 3]
        assert listener.statistics.strangers == 1
        assert autopilot.receive(0.5) != b""
        assert stranger.receive(0.01) == b""


def test_crowd_of_strangers_that_speaks_with_the_autopilot_keeps_nobody_from_being_pinned(
    listener: UdpInTransport,
) -> None:
    device, own = f"udpout:127.0.0.1:{listener.port}", MavlinkCodec(1, 1)
    with listener, open_transport(device) as autopilot, ExitStack() as stack:
        crowd = [stack.enter_context(open_transport(device)) for _ in range(40)]
        companion = Companion(listener)
        autopilot.send(own.encode(beat(1)))
        for stranger in crowd:
            stranger.send(b"here")
        companion.hear(1 + len(crowd))
        companion.t_ns += S
        companion.turn()
        assert autopilot.receive(0.5) != b""
        assert [stranger.receive(0.0) for stranger in crowd] == [b""] * len(crowd)


def test_autopilot_that_comes_back_by_another_port_after_a_silence_is_found_there(listener: UdpInTransport) -> None:
    device = f"udpout:127.0.0.1:{listener.port}"
    with listener, open_transport(device) as before, open_transport(device) as after:
        companion = Companion(listener)
        before.send(MavlinkCodec(1, 1).encode(beat(1)))
        companion.hear(1)
        companion.t_ns += 4 * S
        companion.turn()  # it is missed
        companion.turn()  # and looked for
        after.send(MavlinkCodec(1, 1).encode(beat(2)))
        companion.hear(1)
        assert companion.modes == [1, 2]
        assert companion.session.link_up


def test_sender_without_the_key_is_neither_listened_to_nor_sent_to(listener: UdpInTransport) -> None:
    device, signed = f"udpout:127.0.0.1:{listener.port}", MavlinkCodec(1, 1, signing=Signing(KEY, 1))
    assert signed.signing is not None
    signed.signing.advance(NOW_NS)
    with listener, open_transport(device) as autopilot, open_transport(device) as stranger:
        companion = Companion(listener, Signing(KEY))
        companion.turn()
        stranger.send(MavlinkCodec(1, 1).encode(beat(2)))
        companion.hear(1)
        companion.t_ns += S
        companion.turn()
        autopilot.send(signed.encode(beat(1)))
        companion.hear(1)
        companion.t_ns += S
        companion.turn()
        assert companion.modes == [1]
        assert autopilot.receive(0.5) != b""
        assert stranger.receive(0.01) == b""


class Crowd:
    """Connections to a port that say nothing unless they are told to."""

    def __init__(self, port: int) -> None:
        self._port = port
        self.connections: list[socket.socket] = []

    def grow(self, count: int) -> None:
        for _ in range(count):
            self.connections.append(socket.create_connection(("127.0.0.1", self._port)))
            self.connections[-1].setblocking(False)

    def loses(self, lost: range, turn: Callable[[], object]) -> None:
        """Turn until nothing more comes and just these are closed, by their numbers."""
        until(lambda: not turn() and [_is_closed(one) for one in self.connections].count(True) >= len(lost))
        assert [number for number, one in enumerate(self.connections) if _is_closed(one)] == list(lost)


def _is_closed(connection: socket.socket) -> bool:
    try:
        return connection.recv(4096) == b""
    except BlockingIOError:
        return False


@pytest.fixture
def server() -> Iterator[TcpServerTransport]:
    with TcpServerTransport(NetworkDevice(kind="tcpin", host="127.0.0.1", port=0)) as transport:
        yield transport


@pytest.fixture
def crowd(server: TcpServerTransport) -> Iterator[Crowd]:
    crowd = Crowd(server.port)
    yield crowd
    for one in crowd.connections:
        one.close()


def test_silent_connections_keep_no_autopilot_out_and_put_out_none_that_was_found(
    server: TcpServerTransport, crowd: Crowd
) -> None:
    signed = MavlinkCodec(1, 1, signing=Signing(KEY, 1))
    assert signed.signing is not None
    signed.signing.advance(NOW_NS)
    companion = Companion(server, Signing(KEY))
    crowd.grow(16)
    with open_transport(f"tcp:127.0.0.1:{server.port}") as autopilot:
        crowd.loses(range(1), lambda: companion.turn() or autopilot.receive(0.01))
        autopilot.send(signed.encode(beat(1)))
        until(lambda: companion.turn() > 0)
        for count in range(17, 57):
            crowd.grow(1)
            crowd.loses(range(count - 15), companion.turn)
        companion.t_ns += S
        companion.turn()
        assert companion.modes == [1]
        assert autopilot.receive(0.5) != b""


def test_connection_that_speaks_outstays_the_silent_ones(server: TcpServerTransport, crowd: Crowd) -> None:
    crowd.grow(1)
    for count in range(1, 41):
        crowd.connections[0].send(b"here")
        until(lambda: server.receive(0.01) == b"here")
        crowd.grow(1)
        crowd.loses(range(1, count - 14), lambda: server.receive(0.01))


@pytest.mark.parametrize("ahead_ns", [S // 5, 9 * S // 10, 3 * S])
def test_single_message_from_a_boot_time_ahead_is_not_believed_and_restarts_nothing(ahead_ns: int) -> None:
    run = Pair(MavlinkSession(1, target_system_id=1), FakeAutopilot())
    run.run(2.0)
    ahead_ms = (run.autopilot.boot_ns(run.t_ns) + ahead_ns) // MS
    forged = mavlink.MAVLink_local_position_ned_message(ahead_ms, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert run.session.receive(run.autopilot.codec.encode(forged), run.t_ns) == []
    assert of_kind(run.run(6.0), AutopilotRestarted) == []


@pytest.mark.parametrize("ahead_ns", [S // 2, 3 * S])
def test_boot_time_that_goes_on_ahead_is_believed(ahead_ns: int) -> None:
    run = Pair(MavlinkSession(1, target_system_id=1), FakeAutopilot())
    run.run(2.0)
    run.autopilot.boot_at_ns -= ahead_ns
    events = run.run(6.0)
    times = [one.message for one in of_kind(events, MessageReceived) if one.message.get_type() == "SYSTEM_TIME"]
    assert run.t_ns > START_NS
    assert len(times) >= 5
