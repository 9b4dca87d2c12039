"""Authority: pymavlink's own signing."""

import hashlib
import itertools
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import SIGNING_EPOCH_NS, Signing, read_key, signing_timestamp

KEY = hashlib.sha256(b"decklander").digest()
NOW_NS = SIGNING_EPOCH_NS + 350_000_000 * 10**9
NOW = signing_timestamp(NOW_NS)
S = 100_000  # timestamp units a second


def beat(custom_mode: int = 7) -> Message:
    return mavlink.MAVLink_heartbeat_message(2, 3, 81, custom_mode, 3, 3)


def theirs(timestamp: int = NOW, *, key: bytes = KEY, link_id: int = 3) -> mavlink.MAVLink:
    """Pymavlink as a signing ground station."""
    other = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    other.signing.secret_key = key
    other.signing.link_id = link_id
    other.signing.timestamp = timestamp
    other.signing.sign_outgoing = True
    return other


def ours(*, takes_unsigned: bool = False) -> MavlinkCodec:
    return MavlinkCodec(1, 1, signing=Signing(KEY, 5, NOW, takes_unsigned=takes_unsigned))


def taken(codec: MavlinkCodec, *frames: bytes) -> int:
    return len(codec.decode(b"".join(frames)))


@given(
    message=st.builds(beat, st.integers(0, 2**32 - 1))
    | st.builds(mavlink.MAVLink_statustext_message, st.integers(0, 7), st.binary(max_size=50)),
    timestamp=st.integers(0, 2**48 - 10),
)
def test_a_signed_frame_is_the_one_that_pymavlink_makes(message: Message, timestamp: int) -> None:
    other = theirs(timestamp + 1)
    expected = message.pack(other)
    signed = Signing(KEY, 3, timestamp).sign(message.pack(mavlink.MAVLink(None, srcSystem=255, srcComponent=190)))
    assert signed == expected


def test_pymavlink_takes_what_we_sign_and_we_take_what_it_signs() -> None:
    codec, other = ours(), theirs()
    assert other.decode(bytearray(codec.encode(beat()))).get_signed()
    assert taken(codec, beat().pack(other), beat().pack(other)) == 2


def test_timestamps_only_grow_even_when_the_clock_goes_back() -> None:
    signing = Signing(KEY, timestamp=NOW)
    frame = MavlinkCodec(1, 1).encode(beat())
    stamps = []
    for t_ns in (NOW_NS + 10**9, NOW_NS, 0, NOW_NS + 2 * 10**9):
        signing.advance(t_ns)
        stamps += [int.from_bytes(signing.sign(frame)[-12:-6], "little") for _ in range(3)]
    assert all(later > earlier for earlier, later in itertools.pairwise(stamps))
    assert stamps[-1] - stamps[0] == S + 2


@pytest.mark.parametrize(
    "frame",
    [
        pytest.param(beat().pack(mavlink.MAVLink(None, 255, 190)), id="unsigned"),
        pytest.param(beat().pack(theirs(key=bytes(32))), id="another key"),
        pytest.param(beat().pack(theirs(NOW - 61 * S)), id="a new stream more than a minute late"),
        pytest.param(beat().pack(mavlink.MAVLink(None, 255, 190), force_mavlink1=True), id="version 1"),
    ],
)
def test_a_frame_without_a_right_signature_is_refused(frame: bytes) -> None:
    codec = ours()
    assert taken(codec, frame) == 0
    assert (codec.statistics.refused_messages, codec.statistics.bad_frames) == (1, 0)
    assert taken(ours(takes_unsigned=True), frame) == 1


def test_a_frame_is_taken_once_and_never_again() -> None:
    codec, frame = ours(), beat().pack(theirs())
    assert taken(codec, frame, frame, frame) == 1


def test_a_frame_thirty_seconds_late_is_refused_on_a_stream_that_is_known() -> None:
    codec, late = ours(), theirs(NOW - 30 * S)
    assert taken(codec, beat().pack(theirs())) == 1
    assert taken(codec, beat().pack(late)) == 0
    assert taken(codec, beat().pack(theirs(NOW - 30 * S, link_id=4))) == 1


def test_a_replay_on_another_link_that_shares_the_key_is_refused() -> None:
    streams: dict[tuple[int, int, int], int] = {}
    links = [MavlinkCodec(1, 1, signing=Signing(KEY, link, NOW, streams=streams)) for link in (1, 2)]
    frame = beat().pack(theirs())
    assert [taken(link, frame) for link in links] == [1, 0]


def test_our_clock_follows_a_peer_that_is_ahead_but_no_forger() -> None:
    ahead, codec = NOW + 3600 * S, ours()
    forged = bytearray(beat().pack(theirs(ahead * 2, link_id=9)))
    forged[-1] ^= 1
    taken(codec, bytes(forged), beat().pack(theirs(ahead)))
    assert int.from_bytes(codec.encode(beat())[-12:-6], "little") == ahead + 1


@given(st.data())
def test_any_flipped_bit_of_a_signed_frame_is_noticed(data: st.DataObject) -> None:
    frame = bytearray(beat().pack(theirs()))
    frame[data.draw(st.integers(0, len(frame) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    assert taken(ours(), bytes(frame)) == 0


def test_a_radio_needs_no_key() -> None:
    status = mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7)
    assert taken(ours(), MavlinkCodec(51, 68).encode(status)) == 1


def test_a_key_is_read_as_bytes_or_as_digits(tmp_path: Path) -> None:
    for content in (KEY, KEY.hex().encode(), f"{KEY.hex()}\n".encode()):
        tmp_path.joinpath("key").write_bytes(content)
        assert read_key(tmp_path / "key") == KEY


@pytest.mark.parametrize("content", [b"", b"secret", KEY[:-1], KEY.hex().encode()[2:], b"\xff" * 64])
def test_a_file_that_holds_no_key_is_one_clear_line(tmp_path: Path, content: bytes) -> None:
    tmp_path.joinpath("key").write_bytes(content)
    with pytest.raises(UserError, match="is no signing key; write 32 bytes"):
        read_key(tmp_path / "key")
    with pytest.raises(UserError, match="cannot be read"):
        read_key(tmp_path / "none")


def test_a_key_of_another_length_is_an_error() -> None:
    with pytest.raises(ValueError, match="32 bytes, not 3"):
        Signing(b"key")


def test_a_session_with_a_key_finds_an_autopilot_that_requires_one_and_no_other() -> None:
    session, signed, unsigned = MavlinkSession(1, signing=Signing(KEY)), ours(), MavlinkCodec(2, 1)
    assert session.receive(unsigned.encode(beat()), NOW_NS) == []
    session.receive(signed.encode(beat()), NOW_NS)
    session.poll(NOW_NS)
    assert session.link_up
    assert len(signed.decode(b"".join(session.take_output()))) == 2


def test_timestamps_count_tens_of_microseconds_since_2015() -> None:
    begun_ns = round(datetime(2015, 1, 1, tzinfo=UTC).timestamp()) * 10**9
    assert [signing_timestamp(begun_ns + later_ns) for later_ns in (-1, 0, 9_999, 10_000, 10**9)] == [0, 0, 0, 1, S]


def test_each_system_component_and_link_has_a_stream_of_its_own() -> None:
    signing = Signing(KEY, 5, NOW)
    senders = [(1, 1, 3), (2, 1, 3), (1, 2, 3), (1, 1, 4)]
    later_first = [
        MavlinkCodec(system, component, signing=Signing(KEY, link_id, NOW + 100 - 10 * number)).encode(beat())
        for number, (system, component, link_id) in enumerate(senders)
    ]
    assert all(signing.accepts(frame) for frame in later_first)
    assert not any(signing.accepts(frame) for frame in later_first)  # the same again


@pytest.mark.parametrize("version", [1, 2])
def test_of_what_is_unsigned_only_a_radios_own_status_is_taken(version: int) -> None:
    other = mavlink.MAVLink(None, srcSystem=51, srcComponent=68)
    radio = mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7)
    frames = [message.pack(other, force_mavlink1=version == 1) for message in (radio, beat())]
    assert [Signing(KEY, 5, NOW).accepts(frame) for frame in frames] == [True, False]


@pytest.mark.parametrize("length", [0, 31, 33])
def test_key_of_another_length_is_refused(length: int) -> None:
    with pytest.raises(ValueError, match=f"not {length}"):
        Signing(bytes(length))


def test_last_timestamp_is_signed_again_and_none_is_beyond_it() -> None:
    frame = Signing(KEY, timestamp=2**48 - 1).sign(MavlinkCodec(1, 1).encode(beat()))
    assert frame[-12:-6] == b"\xff" * 6


def test_first_frame_of_a_stream_is_taken_up_to_a_minute_late_and_not_longer() -> None:
    for late, is_taken in ((60 * S, True), (60 * S + 1, False)):
        frame = MavlinkCodec(1, 1, signing=Signing(KEY, 3, NOW - late - 1)).encode(beat())  # signs the next one
        assert Signing(KEY, 5, NOW).accepts(frame) is is_taken


@pytest.mark.parametrize("version", [1, 2])
def test_a_radios_status_without_a_key_is_none_of_who_has_signed_and_hides_no_silence(version: int) -> None:
    session = MavlinkSession(1, target_system_id=1, signing=Signing(KEY, timestamp=NOW))
    session.receive(MavlinkCodec(1, 1, signing=Signing(KEY, 1, NOW)).encode(beat()), NOW_NS)
    forger = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    radio = mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7)
    for tenths in range(1, 41):
        session.receive(radio.pack(forger, force_mavlink1=version == 1), NOW_NS + tenths * 10**8)
        session.poll(NOW_NS + tenths * 10**8)
    assert session.statistics.codec.refused_messages == 40
    assert not session.link_up
