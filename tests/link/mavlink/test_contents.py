"""A frame's contents are what pymavlink's own decoder makes of them, for every message that there is."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.mavlink.contents import frame_of, message_of, with_checksum
from link.mavlink.dialect import Message, mavlink

LISTENER = mavlink.MAVLink(None)
KINDS = st.sampled_from(sorted(mavlink.mavlink_map))


def framed(message_id: int, payload: bytes, *, version1: bool) -> bytearray:
    if version1:
        head = bytes((mavlink.PROTOCOL_MARKER_V1, len(payload), 3, 7, 191, message_id))
    else:
        low, middle, high = message_id.to_bytes(3, "little")
        head = bytes((mavlink.PROTOCOL_MARKER_V2, len(payload), 0, 5, 3, 7, 191, low, middle, high))
    return bytearray(with_checksum(head + payload, message_id))


def told(message: Message) -> tuple[dict[str, Any], dict[str, Any]]:
    """Everything but the payload, which pymavlink cuts out of a MAVLink 2 frame in the wrong place."""
    own = {name: value for name, value in vars(message).items() if name not in {"_header", "_payload"}}
    return own, vars(message.get_header())


def full_payload(message_id: int) -> bytes:
    """As many bytes as the message may have, all of them different from their neighbours."""
    size = mavlink.mavlink_map[message_id].unpacker.size
    return bytes(1 + (7 * place) % 90 for place in range(size))


@given(message_id=KINDS, payload=st.binary(max_size=255), version1=st.booleans())
def test_message_is_what_pymavlink_makes_of_the_frame(message_id: int, payload: bytes, version1: bool) -> None:
    frame = framed(message_id, payload, version1=version1 and message_id < 256)
    theirs, ours = LISTENER.decode(bytearray(frame)), message_of(bytearray(frame), message_id)
    assert ours is not None
    assert type(ours) is type(theirs)
    assert repr(told(ours)) == repr(told(theirs))  # NaN equals nothing, not even itself


@pytest.mark.slow
def test_every_message_is_read_whole() -> None:
    for message_id in mavlink.mavlink_map:
        frame = framed(message_id, full_payload(message_id), version1=False)
        assert repr(told(message_of(frame, message_id))) == repr(told(LISTENER.decode(frame)))


@given(message_id=KINDS, payload=st.binary(min_size=1, max_size=60), bit=st.integers(min_value=0))
def test_frame_with_a_spoilt_payload_holds_nothing(message_id: int, payload: bytes, bit: int) -> None:
    frame = framed(message_id, payload, version1=False)
    place = bit % (8 * len(payload))
    frame[mavlink.HEADER_LEN_V2 + place // 8] ^= 1 << place % 8
    assert message_of(frame, message_id) is None


def packed_by_pymavlink(message: Message, sequence: int) -> bytes:
    sender = mavlink.MAVLink(None, srcSystem=7, srcComponent=191)
    sender.seq = sequence
    return bytes(message.pack(sender))


@given(message_id=KINDS, payload=st.binary(max_size=255), sequence=st.integers(0, 255))
def test_frame_of_a_message_is_the_one_that_pymavlink_packs(message_id: int, payload: bytes, sequence: int) -> None:
    message = LISTENER.decode(framed(message_id, payload, version1=False))
    assert frame_of(message, sequence, 7, 191) == packed_by_pymavlink(message, sequence)


@pytest.mark.slow
def test_every_message_is_written_whole() -> None:
    for message_id in mavlink.mavlink_map:
        message = LISTENER.decode(framed(message_id, full_payload(message_id), version1=False))
        assert frame_of(message, 3, 7, 191) == packed_by_pymavlink(message, 3)
