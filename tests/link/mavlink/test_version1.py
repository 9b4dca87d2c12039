"""Authority: pymavlink's MAVLink 1 dialect."""

import pytest
from pymavlink.dialects.v10 import ardupilotmega as version1

from link.mavlink.codec import MavlinkCodec
from link.mavlink.contents import base_size
from link.mavlink.dialect import Message, mavlink

BEAT = mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 3, 3)


def heard(codec: MavlinkCodec, *, version: int) -> None:
    """Let `codec` hear a ground station of a version."""
    codec.decode(BEAT.pack(mavlink.MAVLink(None, 255, 190), force_mavlink1=version == 1))


def test_each_message_is_as_long_as_in_version_1() -> None:
    both = set(version1.mavlink_map) & set(mavlink.mavlink_map)
    assert len(both) > 100
    assert {one: base_size(one) for one in both} == {one: version1.mavlink_map[one].unpacker.size for one in both}


@pytest.mark.parametrize(
    "message",
    [
        BEAT,
        mavlink.MAVLink_attitude_quaternion_message(5, 1.0, 0.0, 0.0, 0.0, 0.125, 0.25, 0.0, (1.0, 2.0, 3.0, 4.0)),
        mavlink.MAVLink_command_ack_message(400, 4, 7, 8, 255, 190),
        mavlink.MAVLink_statustext_message(4, b"a text that is rather short"),
    ],
)
def test_a_version_1_client_understands_what_is_answered(message: Message) -> None:
    codec, client = MavlinkCodec(1, 1, answers_version1=True), version1.MAVLink(None)
    heard(codec, version=1)
    (got,) = client.parse_buffer(codec.encode(message))
    assert got.get_type() == message.get_type()
    for name in got.get_fieldnames():
        value, sent = getattr(got, name), getattr(message, name)
        assert value == (sent.decode() if isinstance(sent, bytes) else pytest.approx(sent))


def test_a_message_that_version_1_does_not_have_is_left_out_without_a_gap() -> None:
    codec = MavlinkCodec(1, 1, answers_version1=True)
    heard(codec, version=1)
    assert codec.encode(mavlink.MAVLink_current_mode_message(0, 1, 1)) == b""
    assert [codec.encode(BEAT)[2] for _ in range(3)] == [0, 1, 2]


@pytest.mark.parametrize(
    ("versions", "marker"), [((), 0xFD), ((2,), 0xFD), ((1,), 0xFE), ((1, 2), 0xFD), ((2, 1), 0xFD)]
)
def test_version_1_is_spoken_only_where_nothing_else_was_heard(versions: tuple[int, ...], marker: int) -> None:
    codec = MavlinkCodec(1, 1, answers_version1=True)
    for version in versions:
        heard(codec, version=version)
    assert codec.encode(BEAT)[0] == marker


def test_a_companion_keeps_to_version_2() -> None:
    codec = MavlinkCodec(1, 191)
    heard(codec, version=1)
    assert codec.encode(BEAT)[0] == 0xFD
