"""Where frames begin and how long they are. Authority: the MAVLink guide's tables of both headers, and pymavlink."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.framing import MARKER_V1, MARKER_V2, NOT_A_FRAME, WAIT_MAX_NS, Stream, frame_size, message_id_at

S = 10**9
LONGEST = {mavlink.MAVLINK_MSG_ID_HEARTBEAT: (9, 9), mavlink.MAVLINK_MSG_ID_STATUSTEXT: (51, 54)}
"""Bytes of the payload without extensions and with them, as common.xml adds them up."""

HEARTBEAT = MavlinkCodec(1, 1).encode(mavlink.MAVLink_heartbeat_message(2, 12, 0, 7, 4, 3))


def framed(message_id: int, length: int) -> bytes:
    """A frame of version 1 with a payload of zeros, and two bytes for its checksum."""
    return bytes((MARKER_V1, length, 0, 1, 1, message_id)) + bytes(length + 2)


@given(message_id=st.integers(0, 2**24 - 1), before=st.binary(max_size=3))
def test_message_id_of_version_2_has_three_bytes_the_lowest_first(message_id: int, before: bytes) -> None:
    head = bytes((MARKER_V2, 0, 0, 0, 9, 1, 1)) + message_id.to_bytes(3, "little")
    assert message_id_at(before + head, len(before)) == message_id


@pytest.mark.parametrize("length", [0, 8, 9, 10, 50, 51, 52, 54, 55, 255])
@pytest.mark.parametrize("message_id", LONGEST)
def test_known_message_of_version_1_is_as_long_as_with_or_without_its_extensions(message_id: int, length: int) -> None:
    stream, frame, (shortest, longest) = Stream(), framed(message_id, length), LONGEST[message_id]
    stream.add(frame, None)
    assert (stream.find(ends=True) == (0, len(frame))) is (shortest <= length <= longest)


def bad_checksum() -> bytes:
    return HEARTBEAT[:-1] + bytes((HEARTBEAT[-1] ^ 1,))


def unheard_of() -> bytes:
    """A whole frame of a message that no dialect has."""
    return bytes((MARKER_V2, 5, 0, 0, 9, 1, 1, 0xFF, 0xFF, 0x7F)) + bytes(7)


@pytest.mark.parametrize("is_datagram", [True, False])
@pytest.mark.parametrize(
    ("junk", "cost"),
    [(bytes((MARKER_V2, 0, 0x80)), 1), (bad_checksum(), 4), (unheard_of(), 2)],
    ids=["begins nothing", "wrong checksum", "unknown message"],
)
def test_frame_is_looked_for_behind_64_markers_that_begin_nothing_and_one_more_in_32_bytes(
    junk: bytes, cost: int, *, is_datagram: bool
) -> None:
    """A wrong checksum costs as much time as four of them, a message that is not known as two."""
    count = next(k for k in range(1000) if cost * k > 64 + (k * len(junk) + len(HEARTBEAT)) // 32)
    for many, is_found in ((count - 1, True), (count, False)):
        heard = MavlinkCodec(1, 191).decode(many * junk + HEARTBEAT, is_datagram=is_datagram, t_ns=S)
        assert ([message.get_type() for message in heard] == ["HEARTBEAT"]) is is_found


@given(before=st.binary(max_size=40), after=st.binary(max_size=40))
def test_bytes_that_are_no_frame_are_counted_each_once(before: bytes, after: bytes) -> None:
    codec = MavlinkCodec(1, 191)
    plain = bytes(one & 0x7F for one in before), bytes(one & 0x7F for one in after)
    assert len(codec.decode(plain[0] + HEARTBEAT + plain[1], is_datagram=True)) == 1
    assert codec.statistics.bad_bytes == len(before) + len(after)


@pytest.mark.parametrize("count", [0, 1, 5])
def test_frames_with_a_wrong_checksum_are_counted_each_once(count: int) -> None:
    codec = MavlinkCodec(1, 191)
    codec.decode(count * bad_checksum() + HEARTBEAT, is_datagram=True)
    assert codec.statistics.bad_frames == count


def test_a_signature_is_the_only_flag_that_is_known_and_makes_a_frame_13_bytes_longer() -> None:
    sizes = [frame_size(bytes((MARKER_V2, 9, flags)) + bytes(7), 0) for flags in range(256)]
    assert sizes == [9 + 12, 9 + 12 + 13] + [NOT_A_FRAME] * 254


@pytest.mark.parametrize(("waits_ns", "is_taken"), [(WAIT_MAX_NS, True), (WAIT_MAX_NS + 1, False)])
def test_rest_of_a_frame_is_waited_for_until_then_and_no_longer(waits_ns: int, *, is_taken: bool) -> None:
    codec = MavlinkCodec(1, 191)
    codec.decode(HEARTBEAT[:12], t_ns=S)
    assert bool(codec.decode(HEARTBEAT[12:], t_ns=S + waits_ns)) is is_taken


@given(times=st.lists(st.none() | st.integers(S, 3 * S), max_size=6), cuts=st.integers(1, len(HEARTBEAT) - 1))
def test_bytes_with_and_without_a_time_raise_nothing(times: list[int | None], cuts: int) -> None:
    codec = MavlinkCodec(1, 191)
    for t_ns in times:
        codec.decode(HEARTBEAT[:cuts], t_ns=t_ns)
    assert codec.decode(HEARTBEAT, is_datagram=True)
