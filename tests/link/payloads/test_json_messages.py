"""The JSON payloads: the contract's names, strict reading, and a schema that fits what is sent."""

import json
from math import inf, nan
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.messages import (
    Command,
    CommandReply,
    ContactForecast,
    LandingStatus,
    LinkStatus,
    Order,
    PadGeometry,
    Station,
    StationFrame,
)
from link.payloads.json_messages import LANDING_STATUS_SCHEMA, Message, PayloadError, decode, encode
from link.records import replace

PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.55, antenna_to_pad_m=(-0.4, 0.25, 0.1))
STATUS = LandingStatus(
    stamp_ns=1_763_708_400_123_456_789,
    phase="descend",
    reason="",
    relative_position_enu_m=(0.1, -0.2, 1.5),
    relative_velocity_enu_m_s=(0.01, 0.02, -0.5),
    height_above_pad_m=1.3,
    time_to_contact_s=2.6,
    links=LinkStatus(mavlink_bad_bytes=3),
    armed=True,
    fix_age_s=0.12,
    flown_by="companion",
    battery_share=0.73,
)
STATUS_NAMES = {*LandingStatus.__struct_fields__, *LinkStatus.__struct_fields__} - {"links"}
UNKNOWING = replace(
    STATUS,
    relative_position_enu_m=None,
    relative_velocity_enu_m_s=None,
    height_above_pad_m=None,
    time_to_contact_s=None,
    fix_age_s=None,
    flown_by="",
    battery_share=None,
)
DESCENDING = replace(
    STATUS,
    contact_forecast=ContactForecast(
        in_s=1.2,
        s1=0.9,
        s2=0.8,
        unsafe=0.02,
        broken_off=0.08,
        misses_position=0.005,
        misses_speed=0.015,
        misses_sink=0.0,
        misses_tilt=0.0,
    ),
)
MESSAGES: list[Message] = [
    PAD,
    Order(command=Command.START),
    Order(command=Command.ABORT),
    Order(command=Command.FOLLOW, station=Station(offset_m=(-6.5, 2.25, 3.0), frame=StationFrame.NORTH)),
    CommandReply(accepted=False, reason="der Pilot fliegt: «höher»"),
    STATUS,
    DESCENDING,
    UNKNOWING,
]
TYPES: list[type[Message]] = [PadGeometry, Order, CommandReply, LandingStatus]


@pytest.mark.parametrize("message", MESSAGES, ids=str)
def test_message_returns_from_its_bytes(message: Message) -> None:
    assert decode(type(message), encode(message)) == message


def test_pad_has_the_names_of_the_contract() -> None:
    assert json.loads(encode(PAD)) == {
        "size_m": [1.5, 1.2],
        "height_m": 1.55,
        "antenna_to_pad_m": [-0.4, 0.25, 0.1],
        "is_afloat": False,
    }


def test_a_follow_without_a_frame_looks_where_the_vehicle_heads() -> None:
    order = decode(Order, b'{"command": "follow", "offset_m": [-6, 2, 3.5]}')
    assert order.station == Station(offset_m=(-6.0, 2.0, 3.5), frame=StationFrame.VEHICLE)


def test_command_and_reply_have_the_names_of_the_contract() -> None:
    assert json.loads(encode(Order(command=Command.ABORT))) == {"command": "abort"}
    assert json.loads(encode(CommandReply(accepted=True, reason=""))) == {"accepted": True, "reason": ""}


def test_status_says_null_where_it_does_not_know() -> None:
    sent = json.loads(encode(UNKNOWING))
    assert sent["height_above_pad_m"] is None
    assert set(sent) == STATUS_NAMES


def test_schema_names_every_field_of_the_status() -> None:
    assert set(LANDING_STATUS_SCHEMA["properties"]) == set(LANDING_STATUS_SCHEMA["required"]) == STATUS_NAMES
    assert json.loads(json.dumps(LANDING_STATUS_SCHEMA)) == LANDING_STATUS_SCHEMA


def test_a_status_of_a_later_version_may_hold_more() -> None:
    assert decode(LandingStatus, json.dumps(json.loads(encode(STATUS)) | {"wind_m_s": 3.0}).encode()) == STATUS


def test_a_whole_number_is_a_length() -> None:
    payload = b'{"size_m": [2, 1], "height_m": 0, "antenna_to_pad_m": [0, 0, 0]}'
    assert decode(PadGeometry, payload).size_m == (2.0, 1.0)


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"null",
        b'"start"',
        b"{}",
        b'{"command": "land"}',
        b'{"command": "START"}',
        b'{"command": 1}',
        b'{"command": "start", "speed_m_s": 3}',
        b'\xff{"command": "start"}',
        b'{"command": "start", "offset_m": [1, 2, 3]}',
        b'{"command": "follow"}',
        b'{"command": "follow", "offset_m": [1, 2]}',
        b'{"command": "follow", "offset_m": [1, 2, 3], "frame": "east"}',
        b'{"command": "follow", "offset_m": [1, 2, NaN]}',
        b"[" * 100_000,
    ],
    ids=lambda payload: payload[:20],
)
def test_what_is_no_command_is_refused(payload: bytes) -> None:
    with pytest.raises(PayloadError):
        decode(Order, payload)


def test_what_an_order_lacks_is_told_in_our_own_words() -> None:
    with pytest.raises(PayloadError, match=r"^follow needs offset_m, \[ahead, left, up\] in m$"):
        decode(Order, b'{"command": "follow"}')


@pytest.mark.parametrize(
    ("message_type", "payload", "name"),
    [
        (Order, b'{"command": "hold", "command": "start"}', "command"),
        (Order, b'{"command": "hold", "command": "hold"}', "command"),
        (Order, b'{"command": "hold", "\\u0063ommand": "start"}', "command"),
        (Order, b'{"command": "follow", "offset_m": [-5, 2, 3], "offset_m": [5, 2, 3]}', "offset_m"),
        (PadGeometry, encode(PAD)[:-1] + b', "height_m": 0.5}', "height_m"),
        (PadGeometry, encode(PAD)[:-1] + b', "later": [{"a": 1, "a": 2}]}', "a"),
        (CommandReply, b'{"accepted": false, "reason": "", "accepted": true}', "accepted"),
        (LandingStatus, encode(STATUS)[:-1] + b', "armed": false}', "armed"),
    ],
)
def test_what_is_given_twice_is_refused(message_type: type[Message], payload: bytes, name: str) -> None:
    with pytest.raises(PayloadError, match=rf"^{name}: given twice$"):
        decode(message_type, payload)


@pytest.mark.parametrize("later", [b"1" * 4300, b"[" * 150 + b"]" * 150, b'"\\u00e4"', b"1e308", b"-0"])
def test_a_pad_of_a_later_version_may_hold_whatever_json_can(later: bytes) -> None:
    assert decode(PadGeometry, encode(PAD)[:-1] + b', "later": ' + later + b"}") == PAD


@pytest.mark.parametrize(
    "changes",
    [
        {"size_m": [0.0, 1.0]},
        {"size_m": [1.5]},
        {"size_m": ["1.5", "1.5"]},
        {"height_m": -0.1},
        {"height_m": True},
        {"antenna_to_pad_m": [0.0, 0.0, nan]},
        {"antenna_to_pad_m": [0.0, 0.0, inf]},
        {"antenna_to_pad_m": None},
        {"antenna_to_pad_m": [0.0, -25.3, 0.0]},
        {"antenna_to_pad_m": [0.0, 0.0, 8.1]},
        {"size_m": [1.5, 1e308]},
        {"height_m": 1e308},
    ],
    ids=str,
)
def test_a_pad_that_cannot_be_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(PayloadError, match=next(iter(changes))):
        decode(PadGeometry, json.dumps(json.loads(encode(PAD)) | changes).encode())


@pytest.mark.parametrize(
    "message",
    [replace(STATUS, height_above_pad_m=nan), replace(STATUS, stamp_ns=-1), replace(PAD, size_m=(inf, 1.0))],
    ids=["nan", "negative stamp", "infinite size"],
)
def test_what_must_not_be_sent_is_not_encoded(message: Message) -> None:
    with pytest.raises(PayloadError):
        encode(message)


@pytest.mark.slow
@pytest.mark.parametrize("message_type", TYPES, ids=lambda message_type: message_type.__name__)
@given(payload=st.binary(max_size=300))
def test_random_bytes_raise_nothing_but_payload_error(message_type: type[Message], payload: bytes) -> None:
    with pytest.raises(PayloadError):
        decode(message_type, payload)


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text("aé0\n", max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["command", "size_m", "phase"]), inner),
    max_leaves=8,
)


@pytest.mark.slow
@given(changes=st.dictionaries(st.sampled_from(sorted(STATUS_NAMES)), JSON_VALUES))
def test_any_json_in_a_status_raises_nothing_but_payload_error(changes: dict[str, Any]) -> None:
    payload = json.dumps(json.loads(encode(STATUS)) | changes).encode()
    try:
        status = decode(LandingStatus, payload)
    except PayloadError:
        return
    assert decode(LandingStatus, encode(status)) == status
