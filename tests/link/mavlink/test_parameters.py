import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.events import ParameterMissing, ParameterRead
from link.mavlink.parameters import parameter_on_wire, parameter_value
from link.mavlink.session import MavlinkSession
from tests.link.mavlink.fake_autopilot import INT32, REAL32, START_NS, FakeAutopilot, Pair, of_kind

PX4, ARDUPILOT = mavlink.MAV_AUTOPILOT_PX4, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
RANGES = {
    mavlink.MAV_PARAM_TYPE_UINT8: (0, 255),
    mavlink.MAV_PARAM_TYPE_INT8: (-128, 127),
    mavlink.MAV_PARAM_TYPE_UINT16: (0, 65535),
    mavlink.MAV_PARAM_TYPE_INT16: (-32768, 32767),
}


def over_the_wire(value: float, kind: int, autopilot: int) -> int | float | None:
    message = mavlink.MAVLink_param_value_message(b"P", parameter_on_wire(value, kind, autopilot), kind, 1, 0)
    (received,) = MavlinkCodec(1, 191).decode(MavlinkCodec(1, 1).encode(message))
    return parameter_value(received, autopilot)


@pytest.mark.slow
@given(st.sampled_from(sorted(RANGES)), st.sampled_from([PX4, ARDUPILOT]), st.data())
def test_small_integers_survive_both_encodings(kind: int, autopilot: int, data: st.DataObject) -> None:
    value = data.draw(st.integers(*RANGES[kind]))
    assert over_the_wire(value, kind, autopilot) == value


@given(st.integers(-(2**24), 2**24), st.sampled_from([PX4, ARDUPILOT]))
def test_integers_that_a_float_holds_survive_both_encodings(value: int, autopilot: int) -> None:
    assert over_the_wire(value, INT32, autopilot) == value


@given(st.integers(-(2**31), 2**31 - 1))
def test_the_bytes_of_any_integer_are_read_as_sent(value: int) -> None:
    kind_and_rest = struct.pack("<HH16sB", 1, 0, b"P", INT32)
    frame = bytearray(MavlinkCodec(1, 1).encode(mavlink.MAVLink_param_value_message(b"P", 0.0, INT32, 1, 0)))
    payload = struct.pack("<i", value) + kind_and_rest
    frame[10:-2] = payload
    crc = mavlink.x25crc(frame[1:-2] + bytes([mavlink.MAVLink_param_value_message.crc_extra])).crc
    (message,) = MavlinkCodec(1, 191).decode(bytes(frame[:-2]) + struct.pack("<H", crc))
    assert parameter_value(message, PX4) == value


def test_the_two_encodings_differ_as_the_protocol_says() -> None:
    assert parameter_on_wire(1, INT32, PX4) == pytest.approx(1.401298464324817e-45)  # float32 of the bits 0x00000001
    assert parameter_on_wire(1, INT32, ARDUPILOT) == 1.0


def test_a_value_that_does_not_fit_its_type_is_an_error() -> None:
    with pytest.raises(ValueError, match="300 does not fit"):
        parameter_on_wire(300, mavlink.MAV_PARAM_TYPE_UINT8, PX4)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_value_that_is_no_number_is_unknown(value: float) -> None:
    assert over_the_wire(value, REAL32, ARDUPILOT) is None


@pytest.mark.parametrize("firmware", [PX4, ARDUPILOT])
def test_a_parameter_is_read_by_its_name(firmware: int) -> None:
    autopilot = FakeAutopilot(firmware=firmware, parameters={"COUNT": (1500, INT32), "SPEED": (12.5, REAL32)})
    run = Pair(session=MavlinkSession(1), autopilot=autopilot)
    run.run(1.5)
    for name in ("COUNT", "SPEED"):
        run.session.read_parameter(name, run.t_ns)
    read = of_kind(run.run(1.0), ParameterRead)
    assert {(one.name, one.value) for one in read} == {("COUNT", 1500), ("SPEED", 12.5)}
    assert {type(one.value) for one in read} == {int, float}


def test_an_unknown_parameter_is_asked_for_six_times_and_told_missing() -> None:
    run = Pair(session=MavlinkSession(1), autopilot=FakeAutopilot())
    run.run(1.5)
    run.session.read_parameter("NO_SUCH", run.t_ns)
    assert [one.name for one in of_kind(run.run(5.0), ParameterMissing)] == ["NO_SUCH"]
    assert len(run.autopilot.of_type("PARAM_REQUEST_READ")) == 6


def test_a_parameter_that_nobody_asked_for_is_only_a_message() -> None:
    run = Pair(session=MavlinkSession(1), autopilot=FakeAutopilot(parameters={"SPEED": (12.5, REAL32)}))
    run.run(1.5)
    run.autopilot.tell_parameter("SPEED")
    assert of_kind(run.run(0.5), ParameterRead) == []


@pytest.mark.parametrize("name", ["", "A" * 17, "GRÖSSE"])
def test_a_name_that_no_parameter_can_have_is_an_error_of_the_caller(name: str) -> None:
    with pytest.raises(ValueError, match="1 to 16 ASCII"):
        MavlinkSession(1).read_parameter(name, START_NS)
