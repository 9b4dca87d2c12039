import struct
from collections.abc import Iterable
from math import inf, isfinite, nan

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.node import AutopilotNode
from tests.sim_autopilot.pilot import OFFBOARD, START_NS, STILL_AIR, Pilot, px4, setpoint

HEARD = sorted(
    {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT,
        mavlink.MAVLINK_MSG_ID_COMMAND_LONG,
        mavlink.MAVLINK_MSG_ID_COMMAND_INT,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
        mavlink.MAVLINK_MSG_ID_TIMESYNC,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ,
        mavlink.MAVLINK_MSG_ID_PARAM_SET,
        mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN,
    }
)


def framed(message_id: int, payload: bytes) -> bytes:
    """A frame with a right checksum and any payload."""
    kind = mavlink.mavlink_map[message_id]
    head = bytes((len(payload), 0, 0, 0, 1, 191)) + message_id.to_bytes(3, "little")
    crc = mavlink.x25crc(head + payload)
    crc.accumulate(bytes((kind.crc_extra,)))
    return b"\xfd" + head + payload + struct.pack("<H", crc.crc)


def numbers(messages: Iterable[Message]) -> Iterable[float]:
    for message in messages:
        for value in message.to_dict().values():
            yield from value if isinstance(value, list) else (value,) if isinstance(value, float) else ()


@st.composite
def heard_frames(draw: st.DrawFn) -> bytes:
    message_id = draw(st.sampled_from(HEARD))
    size = mavlink.mavlink_map[message_id].unpacker.size
    payload = bytearray(draw(st.binary(min_size=size, max_size=size)))
    return framed(message_id, bytes(payload))


@given(st.lists(heard_frames() | st.binary(max_size=80), max_size=25))
@pytest.mark.slow
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_whatever_is_received_it_goes_on_and_sends_only_finite_numbers(packets: list[bytes]) -> None:
    node, listener = AutopilotNode(px4(), START_NS), MavlinkCodec(1, 191)
    for packet in [*packets, b"", b"", b""]:
        data = node.receive(packet, node.state.t_ns) + node.step(None, STILL_AIR)
        assert all(isfinite(number) for number in numbers(listener.decode(data)))
    assert np.isfinite(node.state.position_enu_m).all()


@pytest.mark.parametrize(
    "garbage",
    [
        setpoint((nan, 0.0, -5.0)),
        setpoint((inf, 0.0, -5.0)),
        setpoint((50.0, 0.0, -5.0), frame=mavlink.MAV_FRAME_GLOBAL),
        setpoint((50.0, 0.0, -5.0), mask=0b1001_1111_1001),
        setpoint((50.0, 0.0, -5.0), system=2),
        setpoint((50.0, 0.0, -5.0), yaw=nan),
    ],
)
def test_a_setpoint_that_cannot_be_flown_leaves_the_flight_undisturbed(garbage: Message) -> None:
    pilot, undisturbed = Pilot(), Pilot()
    pilot.take_off(5.0)
    undisturbed.take_off(5.0)
    for _ in range(100):
        pilot.step(setpoint((1.0, 2.0, -5.0)), garbage)
        undisturbed.step(setpoint((1.0, 2.0, -5.0)))
    assert np.array_equal(pilot.position, undisturbed.position)


def test_garbage_does_not_keep_offboard_alive() -> None:
    pilot = Pilot()
    pilot.take_off(5.0)
    pilot.run(1.2, lambda _t: setpoint((nan, nan, nan)))
    assert pilot.custom_mode() != OFFBOARD


def test_every_message_sent_twice_changes_nothing_but_the_answers() -> None:
    once, twice = Pilot(), Pilot()
    for pilot, copies in ((once, 1), (twice, 2)):
        for tick in range(400):
            messages = [setpoint((0.0, 0.0, -3.0))]
            if tick == 50:
                messages += [mavlink.MAVLink_command_long_message(1, 1, 176, 0, 1.0, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0)]
                messages += [mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)]
            pilot.step(*[message for message in messages for _ in range(copies)])
    assert once.position[2] > 0.5
    assert np.array_equal(once.position, twice.position)
