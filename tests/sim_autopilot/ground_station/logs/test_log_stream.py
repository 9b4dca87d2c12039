"""A log that PX4 streams: its head acknowledged piece by piece, then rows."""

import struct

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.ground_station.memory import station_of
from tests.sim_autopilot.pilot import Pilot, command

pytestmark = pytest.mark.slow

START = command(mavlink.MAV_CMD_LOGGING_START)
STOP = command(mavlink.MAV_CMD_LOGGING_STOP)


def acknowledge(piece: Message) -> Message:
    return mavlink.MAVLink_logging_ack_message(1, 1, piece.sequence)


def with_head(pilot: Pilot) -> bytes:
    """Take the head of a stream that has begun."""
    data = b""
    while not data or (stream := station_of(pilot.node.memory).log_stream) is None or stream.head:
        piece = pilot.last("LOGGING_DATA_ACKED")
        data += bytes(piece.data[: piece.length])
        pilot.step(acknowledge(piece))
        pilot.step()
    return data


def test_a_log_is_streamed_whose_pieces_say_where_a_message_begins() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(START) == [0]
    data = with_head(pilot)
    assert data[:7] == b"ULog\x01\x12\x35"
    pilot.run(2.0)
    pieces = pilot.all("LOGGING_DATA")
    assert [piece.length for piece in pieces] == [249] * len(pieces)
    assert 14 <= len(pieces) <= 17  # 41 bytes fifty times a second
    data += b"".join(bytes(piece.data) for piece in pieces)
    begins, at = {0}, 16
    while at < len(data):
        begins.add(at)
        at += 3 + struct.unpack_from("<H", data, at)[0]
    at = 0
    for piece in {piece.sequence: piece for piece in (*pilot.all("LOGGING_DATA_ACKED"), *pieces)}.values():
        inside = [begin - at for begin in sorted(begins) if at <= begin < at + piece.length]
        assert piece.first_message_offset == (inside[0] if inside else 255)
        at += piece.length
    assert at == len(data)


def test_a_stream_is_not_answered_for_while_its_head_is_on_the_way_and_ends_without_acknowledgements() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(START) == [0]
    assert pilot.acknowledged(STOP) == []
    assert pilot.acknowledged(START) == []
    pilot.run(3.0)
    pieces = pilot.all("LOGGING_DATA_ACKED")
    assert {piece.sequence for piece in pieces} == {0}
    assert len(pieces) == 50
    assert pilot.acknowledged(STOP) == [0]
    assert pilot.acknowledged(START) == [0]


def test_a_stream_is_ended_and_only_one_runs_at_a_time() -> None:
    pilot = Pilot()
    pilot.step(START)
    with_head(pilot)
    assert pilot.acknowledged(START) == [mavlink.MAV_RESULT_TEMPORARILY_REJECTED]
    assert pilot.acknowledged(STOP) == [mavlink.MAV_RESULT_IN_PROGRESS, 0]
    pilot.received.clear()
    pilot.run(1.0)
    assert pilot.all("LOGGING_DATA") == []
