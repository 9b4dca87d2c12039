"""What is made to be slow to decode, or to hold back what follows it."""

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.framing import WAIT_MAX_NS
from scenarios.attack.crafted import COST_MAX, CRAFTED, cost_ratio

S = 10**9


def beat(custom_mode: int) -> Message:
    return mavlink.MAVLink_heartbeat_message(2, 12, 0, custom_mode, 4, 3)


def broken(claim: int) -> bytes:
    """The frame of a heartbeat of which a bit is wrong, with what looks like a longer frame inside."""
    frame = bytearray(MavlinkCodec(1, 1).encode(mavlink.MAVLink_statustext_message(6, b"\xfd" + bytes([claim]) * 40)))
    frame[-1] ^= 1
    frame[13:22] = bytes([claim, 0, 0, 0, 1, 1, 0, 0, 0])  # behind the text's first character: a heartbeat's header
    return bytes(frame)


def modes(messages: list[Message]) -> list[int]:
    return [message.custom_mode for message in messages if message.get_type() == "HEARTBEAT"]


@pytest.mark.parametrize("is_datagram", [True, False])
@pytest.mark.parametrize("kind", CRAFTED)
def test_crafted_bytes_cost_at_most_five_times_what_random_ones_do(kind: str, *, is_datagram: bool) -> None:
    assert cost_ratio(kind, is_datagram=is_datagram) < COST_MAX


@pytest.mark.parametrize("claim", [60, 253, 255])
def test_frame_that_claims_more_than_its_datagram_holds_nothing_back(claim: int) -> None:
    codec, sender = MavlinkCodec(1, 191), MavlinkCodec(1, 1)
    heard = codec.decode(broken(claim), is_datagram=True)
    heard += codec.decode(sender.encode(beat(1)), is_datagram=True)
    assert modes(heard) == [1]


@pytest.mark.parametrize("claim", [60, 253, 255])
def test_stream_waits_no_longer_than_that_for_the_rest_of_what_is_no_frame(claim: int) -> None:
    codec, sender = MavlinkCodec(1, 191), MavlinkCodec(1, 1)
    heard = codec.decode(broken(claim) + sender.encode(beat(1)), t_ns=S)
    assert codec.flush(S + WAIT_MAX_NS // 2) == []
    heard += [message for _, message in codec.flush(S + WAIT_MAX_NS + 1)]
    assert modes(heard) == [1]


def test_frame_whose_rest_comes_in_time_is_taken() -> None:
    codec, frame = MavlinkCodec(1, 191), MavlinkCodec(1, 1).encode(beat(7))
    t_ns = S
    for place in range(0, len(frame) - 1, 4):
        assert codec.decode(frame[place : place + 4], t_ns=t_ns) == []
        t_ns += WAIT_MAX_NS // 8
        assert codec.flush(t_ns) == []
    assert modes(codec.decode(frame[-1:], t_ns=t_ns)) == [7]


def test_messages_behind_noise_are_only_taken_with_a_checksum() -> None:
    codec = MavlinkCodec(1, 191)
    unknown = bytes([0xFD, 1, 0, 0, 0, 1, 1, 0xFF, 0xFF, 0x7F, 5, 0, 0])
    codec.decode(b"\0" + unknown, is_datagram=True)
    assert codec.statistics.unknown_messages == 0
    codec.decode(unknown, is_datagram=True)
    assert codec.statistics.unknown_messages == 1
