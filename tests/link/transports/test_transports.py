import os
import pty
import socket
import time
import tty
from collections.abc import Callable

import pytest

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.session import MavlinkSession
from link.transports.opening import open_transport
from link.transports.tcp_transport import TcpClientTransport, TcpServerTransport
from link.transports.transport import Transport
from link.transports.udp_transport import UdpInTransport, UdpPeers

DEADLINE_S = 10.0


def until(condition: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline_s, "nothing happened in time"


def received(transport: Transport, count: int) -> bytes:
    """Waits for a number of bytes."""
    data = bytearray()

    def is_complete() -> bool:
        data.extend(transport.receive(0.05))
        return len(data) >= count

    until(is_complete)
    return bytes(data)


def udp_in() -> UdpInTransport:
    transport = open_transport("udpin:127.0.0.1:0")
    assert isinstance(transport, UdpInTransport)
    return transport


def tcp_in(port: int = 0) -> TcpServerTransport:
    transport = open_transport(f"tcpin:127.0.0.1:{port}")
    assert isinstance(transport, TcpServerTransport)
    return transport


def tcp_out(port: int) -> TcpClientTransport:
    transport = open_transport(f"tcp:127.0.0.1:{port}")
    assert isinstance(transport, TcpClientTransport)
    return transport


def connect(client: TcpClientTransport, server: TcpServerTransport) -> None:
    def is_connected() -> bool:
        return (client.receive(0.01), server.receive(0.01)) == (b"", b"") and (
            client.is_connected and server.is_connected
        )

    until(is_connected)


def closed_port(kind: socket.SocketKind) -> int:
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def test_udp_carries_both_ways_and_takes_all_that_is_there() -> None:
    with udp_in() as listener, open_transport(f"udpout:127.0.0.1:{listener.port}") as speaker:
        for part in (b"one", b"two", b"three"):
            speaker.send(part)
        assert received(listener, 11) == b"onetwothree"
        listener.send(b"answer")
        assert received(speaker, 6) == b"answer"


def test_udpin_answers_everybody_who_has_spoken() -> None:
    with (
        udp_in() as listener,
        open_transport(f"udpout:127.0.0.1:{listener.port}") as first,
        open_transport(f"udpout:127.0.0.1:{listener.port}") as second,
    ):
        for speaker in (first, second):
            speaker.send(b"here")
            received(listener, 4)
        listener.send(b"you")
        assert received(first, 3) == received(second, 3) == b"you"


def test_a_silent_udp_peer_is_forgotten_but_never_the_last_one() -> None:
    peers = UdpPeers()
    assert [peers.heard(address, 0.0) for address in ("a", "b")] == [0, 1]
    assert peers.heard("b", 20.0) == 1
    peers.forget_silent(31.0)
    assert peers.addresses == ["b"]
    peers.forget_silent(1e9)
    assert peers.addresses == ["b"]


def test_more_udp_peers_than_can_be_served_push_out_the_most_silent() -> None:
    peers = UdpPeers()
    for number in range(1000):
        assert peers.heard(number, float(number)) == number
    assert peers.addresses == list(range(984, 1000))


def test_udpout_with_a_port_of_its_own_speaks_first_and_hears_others_there() -> None:
    own_port = closed_port(socket.SOCK_DGRAM)
    with (
        udp_in() as listener,
        open_transport(f"udpout:127.0.0.1:{listener.port}:{own_port}") as speaker,
        open_transport(f"udpout:127.0.0.1:{own_port}") as other,
    ):
        speaker.send(b"hello")
        assert received(listener, 5) == b"hello"
        for client in (listener, other):
            client.send(b"here")
            received(speaker, 4)
        speaker.send(b"you")
        assert received(listener, 3) == received(other, 3) == b"you"
        assert listener.receive(0.0) == b""


def test_bytes_of_several_peers_are_told_apart() -> None:
    with tcp_in() as server, tcp_out(server.port) as first, tcp_out(server.port) as second:
        connect(first, server)
        connect(second, server)
        first.send(b"one")
        second.send(b"two")
        got: dict[int, bytes] = {}

        def is_all_there() -> bool:
            for peer, data in server.receive_by_peer(0.05):
                got[peer] = got.get(peer, b"") + data
            return sum(map(len, got.values())) == 6

        until(is_all_there)
        assert sorted(got.values()) == [b"one", b"two"]
        server.send(b"both")
        assert received(first, 4) == received(second, 4) == b"both"


def test_udpin_keeps_still_until_somebody_has_spoken() -> None:
    with udp_in() as listener:
        listener.send(b"nobody")
        assert (listener.statistics.dropped, listener.statistics.errors) == (1, 0)


def test_a_refused_datagram_is_counted_and_raises_nothing() -> None:
    with open_transport(f"udpout:127.0.0.1:{closed_port(socket.SOCK_DGRAM)}") as speaker:

        def is_refused() -> bool:
            speaker.send(b"anybody?")
            return speaker.receive(0.01) == b"" and speaker.statistics.errors > 0

        until(is_refused)


def test_waiting_for_nothing_takes_the_time_given_and_gives_nothing() -> None:
    with udp_in() as listener:
        start_s = time.monotonic()
        assert listener.receive(0.05) == b""
        assert time.monotonic() - start_s >= 0.049


def test_a_session_and_an_autopilot_find_each_other_over_udp() -> None:
    session, autopilot = MavlinkSession(1), MavlinkCodec(1, 1)
    with udp_in() as companion_side, open_transport(f"udpout:127.0.0.1:{companion_side.port}") as autopilot_side:
        autopilot_side.send(autopilot.encode(mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 3, 3)))
        session.receive(received(companion_side, 12), 1)
        session.poll(1)
        for frame in session.take_output():
            companion_side.send(frame)
        assert session.link_up
        assert autopilot.decode(received(autopilot_side, 12))[0].get_type() == "HEARTBEAT"


def test_tcp_carries_both_ways() -> None:
    with tcp_in() as server, tcp_out(server.port) as client:
        connect(client, server)
        client.send(b"question")
        assert received(server, 8) == b"question"
        server.send(b"answer")
        assert received(client, 6) == b"answer"


def test_a_tcp_client_connects_again_when_the_server_comes_back() -> None:
    with tcp_in() as server:
        port = server.port
        client = tcp_out(port)
        connect(client, server)
    with client:
        until(lambda: client.receive(0.01) == b"" and not client.is_connected)
        client.send(b"nobody")
        assert client.statistics.dropped == 1
        with tcp_in(port) as server:
            connect(client, server)
            client.send(b"again")
            assert received(server, 5) == b"again"


def test_a_tcp_client_waits_for_a_server_that_is_not_there_yet() -> None:
    with tcp_out(closed_port(socket.SOCK_STREAM)) as client:
        until(lambda: client.receive(0.01) == b"" and client.statistics.errors > 0)
        assert client.fileno() == -1


def test_a_tcp_server_goes_on_with_the_others_when_a_client_has_gone() -> None:
    with tcp_in() as server, tcp_out(server.port) as stays:
        connect(stays, server)
        with tcp_out(server.port) as goes:
            connect(goes, server)
        until(lambda: server.receive(0.01) == b"" and server.statistics.errors > 0)
        server.send(b"still here")
        assert received(stays, 10) == b"still here"


def test_a_tcp_server_takes_the_next_client_when_the_first_is_gone() -> None:
    with tcp_in() as server:
        with tcp_out(server.port) as first:
            connect(first, server)
        until(lambda: server.receive(0.01) == b"" and not server.is_connected)
        with tcp_out(server.port) as second:
            connect(second, server)
            second.send(b"next")
            assert received(server, 4) == b"next"


def test_a_port_in_use_is_one_clear_line() -> None:
    with udp_in() as first, pytest.raises(UserError, match=f"port {first.port} is in use; stop the program"):
        open_transport(f"udpin:127.0.0.1:{first.port}")
    with tcp_in() as other, pytest.raises(UserError, match=f"port {other.port} is in use; stop the program"):
        open_transport(f"tcpin:127.0.0.1:{other.port}")


@pytest.mark.parametrize("kind", ["udpin", "udpout", "tcp", "tcpin"])
def test_an_unknown_host_is_one_clear_line(kind: str) -> None:
    with pytest.raises(UserError, match=r"host 'no host' is unknown; check its name"):
        open_transport(f"{kind}:no host:14540")


def test_an_address_of_another_machine_is_one_clear_line() -> None:
    with pytest.raises(UserError, match="is no address of this machine"):
        open_transport("udpin:192.0.2.1:14540")


def test_a_missing_serial_device_is_one_clear_line() -> None:
    with pytest.raises(UserError, match=r"^/dev/ttyNONE,57600: there is no such device"):
        open_transport("/dev/ttyNONE,57600")


def test_a_file_that_is_no_serial_port_is_one_clear_line() -> None:
    with pytest.raises(UserError, match="cannot be opened as a serial port"):
        open_transport("/dev/null,57600")


def test_a_serial_port_carries_both_ways() -> None:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    with open_transport(f"{os.ttyname(theirs)},57600") as transport:
        os.write(ours, bytes(range(256)))
        assert received(transport, 256) == bytes(range(256))
        transport.send(b"\xfd\x00\x11\x13")
        assert os.read(ours, 16) == b"\xfd\x00\x11\x13"
    os.close(ours)
    os.close(theirs)


def test_a_serial_port_pulled_out_is_counted_and_raises_nothing() -> None:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    with open_transport(f"{os.ttyname(theirs)},57600") as transport:
        os.close(ours)
        os.close(theirs)
        until(lambda: transport.receive(0.01) == b"" and transport.statistics.errors > 0)
        transport.send(b"gone")
        assert transport.statistics.dropped == 1
        assert transport.fileno() == -1


def test_a_serial_port_that_another_program_has_is_one_clear_line_and_is_left_to_it() -> None:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    device = f"{os.ttyname(theirs)},57600"
    with open_transport(device) as first:
        with pytest.raises(UserError, match="^" + device + ": another program has it open"):
            open_transport(device)
        os.write(ours, b"all of it")
        assert received(first, 9) == b"all of it"
    open_transport(device).close()
    os.close(ours)
    os.close(theirs)


@pytest.mark.parametrize("device", ["udpin:127.0.0.1:0", "tcpin:127.0.0.1:0", "tcp:127.0.0.1:9", "udpout:127.0.0.1:9"])
def test_a_closed_transport_gives_nothing_and_may_be_closed_again(device: str) -> None:
    transport = open_transport(device)
    transport.close()
    transport.close()
    assert transport.receive(0.0) == b""
    transport.send(b"nothing")
    assert transport.fileno() == -1
