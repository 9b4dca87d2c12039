import os
import pty
import select
import socket
import time
import tty
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.transports.device import NetworkDevice, SerialDevice
from link.transports.send_queue import UNDER_WAY_MAX_S, WAITING_MAX_S, SendQueue
from link.transports.serial_transport import SerialTransport
from link.transports.tcp_connection import TcpConnection
from link.transports.tcp_transport import TcpClientTransport
from link.transports.transport import Transport

SETPOINT = bytes(range(65))
DEADLINE_S = 20.0


class Reader:
    """The other end: it takes as many bytes in each write as it is told, none when it is told nothing."""

    def __init__(self, *takes: int) -> None:
        self.takes = list(takes)
        self.got = bytearray()

    def write(self, data: bytes) -> int:
        count = min(self.takes.pop(0), len(data)) if self.takes else 0
        if not count:
            raise BlockingIOError
        self.got += data[:count]
        return count


def frame(number: int) -> bytes:
    """Its length, then its number as often as it has bytes left."""
    size = 2 + number % 7
    return bytes([size]) + bytes([number % 256]) * (size - 1)


def frames_in(stream: bytes) -> list[bytes]:
    """The whole frames at the beginning of a stream, the last one perhaps cut off by its end."""
    found = []
    while stream:
        found.append(stream[: stream[0]])
        stream = stream[stream[0] :]
    return found


def filled(connection: TcpConnection) -> int:
    """Sends setpoints, all at one instant, until no more are taken; returns how many were."""
    sent = 0
    while not connection.send(SETPOINT, 0.0):
        sent += 1
    return sent


def both_ends(*, is_patient: bool) -> tuple[TcpConnection, socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        ours = socket.create_connection(server.getsockname())
        return TcpConnection(ours, is_patient=is_patient), server.accept()[0]


@pytest.fixture
def ends() -> tuple[TcpConnection, socket.socket]:
    return both_ends(is_patient=False)


@pytest.fixture
def patient_ends() -> tuple[TcpConnection, socket.socket]:
    return both_ends(is_patient=True)


def test_a_frame_that_nobody_takes_in_time_is_never_sent() -> None:
    queue, reader = SendQueue(), Reader()
    queue.put(b"old", 0.0)
    queue.put(b"new", WAITING_MAX_S)
    assert queue.write(reader.write, WAITING_MAX_S) == 0
    reader.takes = [10, 10]
    assert queue.write(reader.write, WAITING_MAX_S + 0.01) == 1
    assert bytes(reader.got) == b"new"


def test_a_frame_that_is_begun_goes_on_with_its_rest_however_old_it_is() -> None:
    queue, reader = SendQueue(), Reader(2)
    queue.put(b"begun", 0.0)
    queue.put(b"waits", 0.0)
    assert queue.write(reader.write, 0.0) == 0
    queue.put(b"new", 5.0)
    reader.takes = [10, 10, 10]
    assert queue.write(reader.write, 5.0) == 1
    assert bytes(reader.got) == b"begunnew"


def test_more_than_there_is_room_for_is_refused() -> None:
    queue = SendQueue()
    assert queue.put(bytes(60_000), 0.0)
    assert not queue.put(bytes(10_000), 0.0)
    assert len(queue) == 1


@pytest.mark.slow
@given(st.lists(st.tuples(st.floats(0.0, 0.3), st.lists(st.integers(0, 9), max_size=3)), max_size=40))
def test_the_stream_is_always_whole_frames_in_order(turns: list[tuple[float, list[int]]]) -> None:
    queue, reader, now_s, dropped = SendQueue(), Reader(), 0.0, 0
    sent = [frame(number) for number in range(len(turns))]
    for number, (pause_s, takes) in enumerate(turns):
        now_s += pause_s
        queue.put(sent[number], now_s)
        reader.takes = takes
        dropped += queue.write(reader.write, now_s)
    found = frames_in(bytes(reader.got))
    rest = iter(sent)
    assert all(any(part == one[: len(part)] for one in rest) for part in found)
    assert all(len(part) == part[0] for part in found[:-1])
    is_cut = bool(found) and len(found[-1]) < found[-1][0]
    assert len(found) - is_cut + len(queue) + dropped == len(sent)


def test_a_stream_is_overdue_when_the_system_holds_something_for_too_long() -> None:
    queue, reader = SendQueue(), Reader(10, 10)
    queue.put(b"first", 0.0)
    queue.put(b"second", 0.5)
    queue.write(reader.write, 0.1)
    assert not queue.is_overdue(11, UNDER_WAY_MAX_S)
    assert not queue.is_overdue(6, UNDER_WAY_MAX_S + 0.4)
    assert queue.is_overdue(1, UNDER_WAY_MAX_S + 0.6)
    assert not queue.is_overdue(0, UNDER_WAY_MAX_S + 0.6)


@pytest.mark.parametrize("taken", [0, 2])
def test_a_stream_is_overdue_when_nothing_more_is_taken_for_too_long(taken: int) -> None:
    queue, reader = SendQueue(), Reader(taken)
    queue.put(b"frame", 0.0)
    queue.write(reader.write, 0.0)
    assert not queue.is_overdue(0, UNDER_WAY_MAX_S)
    assert queue.is_overdue(0, UNDER_WAY_MAX_S + 0.01)


def test_a_queue_with_nothing_under_way_is_never_overdue() -> None:
    queue, reader = SendQueue(), Reader(10)
    queue.put(b"frame", 0.0)
    queue.write(reader.write, 0.0)
    assert not queue.is_overdue(0, 1e9)


def test_a_tcp_peer_that_reads_late_but_in_time_gets_whole_frames(ends: tuple[TcpConnection, socket.socket]) -> None:
    connection, peer = ends
    sent = filled(connection)
    got = bytearray()
    while len(got) < sent * len(SETPOINT):
        got += peer.recv(65536)
        connection.flush(0.0)
    assert bytes(got) == SETPOINT * sent
    connection.close()
    peer.close()


def test_a_tcp_peer_that_reads_nothing_is_not_sent_what_has_waited(ends: tuple[TcpConnection, socket.socket]) -> None:
    connection, peer = ends
    sent = filled(connection)
    assert connection.flush(UNDER_WAY_MAX_S + 0.01) > 1000  # setpoints of 20 s
    assert not connection.is_open
    assert len(read_until_reset(peer)) < sent * len(SETPOINT) - 65000
    peer.close()


@pytest.mark.slow
def test_a_patient_connection_stays_and_goes_on_with_whole_frames(
    patient_ends: tuple[TcpConnection, socket.socket],
) -> None:
    connection, peer = patient_ends
    sent = filled(connection)
    dropped = connection.flush(100.0)
    assert connection.is_open
    assert dropped > 1000
    got = bytearray()
    while len(got) < (sent - dropped) * len(SETPOINT):
        got += peer.recv(65536)
        connection.flush(100.0)
    connection.send(b"new", 100.0)
    got += peer.recv(3, socket.MSG_WAITALL)
    assert bytes(got) == SETPOINT * (sent - dropped) + b"new"
    connection.close()
    peer.close()


def read_until_reset(peer: socket.socket) -> bytes:
    got = bytearray()
    while True:
        try:
            got += peer.recv(65536)
        except ConnectionResetError:
            return bytes(got)


def sent_until(transport: Transport, condition: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline_s, "nothing happened in time"
        transport.send(SETPOINT * 10)
        transport.receive(0.005)


def test_a_tcp_client_leaves_a_server_that_stops_reading_and_speaks_again_when_it_is_heard() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        device = NetworkDevice(kind="tcp", host="127.0.0.1", port=server.getsockname()[1])
        with TcpClientTransport(device) as client:
            sent_until(client, lambda: client.statistics.errors > 0)
            sent_until(client, lambda: client.is_connected)
            asleep, awake = server.accept()[0], server.accept()[0]
            client.send(b"to somebody who may be asleep")
            awake.sendall(b"sign of life")
            awake.settimeout(DEADLINE_S)
            deadline_s = time.monotonic() + DEADLINE_S
            while client.receive(0.05) != b"sign of life":
                assert time.monotonic() < deadline_s
            client.send(b"to somebody who is awake")
            assert awake.recv(64) == b"to somebody who is awake"
            asleep.close()
            awake.close()


def test_a_serial_line_that_takes_nothing_is_emptied_and_opened_anew() -> None:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    with SerialTransport(SerialDevice(path=os.ttyname(theirs), baud=57600)) as transport:
        sent_until(transport, lambda: transport.statistics.errors > 0)
        assert transport.statistics.dropped > 0
        os.set_blocking(ours, False)
        assert len(os.read(ours, 65536)) <= 4096  # that is the other end's already, of 19 kB
        with pytest.raises(BlockingIOError):
            os.read(ours, 1)
        sent_until(transport, lambda: transport.fileno() >= 0)
    os.close(ours)
    os.close(theirs)


@pytest.mark.parametrize(("held_bytes", "is_written"), [(1152, True), (1153, False)])
def test_a_serial_line_is_given_no_more_than_it_takes_in_time(
    held_bytes: int, is_written: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    monkeypatch.setattr("link.transports.serial_transport.held_bytes", lambda _descriptor: held_bytes)
    with SerialTransport(SerialDevice(path=os.ttyname(theirs), baud=57600)) as transport:
        transport.send(SETPOINT)
        assert (len(select.select([ours], [], [], 0.0)[0]) == 1) == is_written
    os.close(ours)
    os.close(theirs)
