"""Parameters of the companion: listed, read and set as MAVLink has it, within what the configuration takes."""

import math

import pytest

from companion.component.parameters import answers
from companion.config.companion import CompanionConfig
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink

REAL32 = mavlink.MAV_PARAM_TYPE_REAL32
CONFIG = CompanionConfig()


def _told(message: Message, config: CompanionConfig = CONFIG) -> list[Message]:
    """What is answered to a message as it comes over the wire."""
    (heard,) = MavlinkCodec(1, 191).decode(MavlinkCodec(255, 190).encode(message))
    return list(answers(heard, config, may_change=True)[1])


def test_list_is_whole_and_numbered() -> None:
    told = _told(mavlink.MAVLink_param_request_list_message(1, 0))
    assert [one.param_index for one in told] == list(range(told[0].param_count))
    assert {one.param_type for one in told} == {REAL32}
    values = {one.param_id: one.param_value for one in told}
    assert values["DL_WAIT_ALT"] == CONFIG.takeoff.waiting_height_m


@pytest.mark.parametrize(
    ("name", "value", "held"),
    [
        (b"DL_WAIT_ALT", 7.3, 7.3),
        (b"DL_WAIT_ALT", -1.0, 5.0),
        (b"DL_WAIT_ALT", math.nan, 5.0),
        (b"DL_WAIT_ALT", 120.0, 120.0),
        (b"DL_WAIT_ALT", 5000.0, 5.0),
        (b"DL_CHASE_ALT", 5000.0, 3.5),
        (b"DL_RETRIES", 2.0, 2.0),
        (b"DL_RETRIES", 2.5, 3.0),
        (b"DL_RETRIES", math.inf, 3.0),
        (b"DL_FRAMES", 1.0, 1.0),
        (b"DL_FRAMES", 3.0, 0.0),
    ],
)
def test_value_is_set_to_what_the_configuration_takes_and_told(name: bytes, value: float, held: float) -> None:
    (told,) = _told(mavlink.MAVLink_param_set_message(1, 191, name, value, REAL32))
    assert (told.param_id, told.param_value) == (name.decode(), pytest.approx(held))


def test_each_is_read_by_name_and_by_index_and_can_be_set_to_what_it_is() -> None:
    for listed in _told(mavlink.MAVLink_param_request_list_message(1, 191)):
        name = listed.param_id.encode()
        for question in (
            mavlink.MAVLink_param_request_read_message(1, 0, name, -1),
            mavlink.MAVLink_param_request_read_message(1, 191, b"", listed.param_index),
            mavlink.MAVLink_param_set_message(1, 191, name, listed.param_value, REAL32),
        ):
            (told,) = _told(question)
            assert (told.param_id, told.param_value) == (listed.param_id, listed.param_value)


@pytest.mark.parametrize(
    "question",
    [
        mavlink.MAVLink_param_request_read_message(1, 0, b"MPC_XY_VEL_MAX", -1),
        mavlink.MAVLink_param_request_read_message(1, 0, b"", -1),
        mavlink.MAVLink_param_request_read_message(1, 0, b"\xff\xfe", -1),
        mavlink.MAVLink_param_request_read_message(1, 0, b"", 3),
        mavlink.MAVLink_param_request_read_message(1, 191, b"", 30),
        mavlink.MAVLink_param_set_message(1, 191, b"MPC_XY_VEL_MAX", 3.0, REAL32),
    ],
)
def test_parameters_of_others_are_not_answered_for(question: Message) -> None:
    assert _told(question) == []
