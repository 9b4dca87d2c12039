import struct
from collections.abc import Callable, Iterable
from math import inf, isfinite, nan

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from link.mavlink.codec import MavlinkCodec
from link.mavlink.contents import field_offsets, with_checksum
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.commands.incoming import HANDLED
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.runtime.node import AutopilotNode
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import OFFBOARD, START_NS, STILL_AIR, Pilot, arm, px4, setpoint

HEARD = sorted(HANDLED | {mavlink.MAVLINK_MSG_ID_TIMESYNC, mavlink.MAVLINK_MSG_ID_PING})
ABSURD = [struct.pack("<f", number) for number in (nan, inf, -inf, 3.4e38, -1e-40, 0.0)] + [b"\xff" * 4]


def numbers(messages: Iterable[Message]) -> Iterable[float]:
    for message in messages:
        if message.get_type() == "PARAM_VALUE" and message.param_type != mavlink.MAV_PARAM_TYPE_REAL32:
            continue  # PX4's integers travel as the bits of a float, -1 as those of no number
        for value in message.to_dict().values():
            yield from value if isinstance(value, list) else (value,) if isinstance(value, float) else ()


@st.composite
def heard_frames(draw: st.DrawFn) -> bytes:
    """A valid frame of a message that is handled, its fields absurd and its target often right."""
    message_id = draw(st.sampled_from(HEARD))
    offsets = field_offsets(message_id)
    size = mavlink.mavlink_map[message_id].unpacker.size
    payload = bytearray(draw(st.binary(min_size=size, max_size=size)))
    for start in draw(st.sets(st.integers(0, max(size - 4, 0) // 4))):
        payload[4 * start : 4 * start + 4] = draw(st.sampled_from(ABSURD))
    for name in ("target_system", "target_component"):
        if name in offsets and draw(st.booleans()):
            payload[offsets[name]] = 1
    head = bytes((0xFD, size, 0, 0, 0, 255, 190)) + message_id.to_bytes(3, "little")
    return with_checksum(head + bytes(payload[:size]), message_id)


@pytest.mark.slow
@pytest.mark.parametrize("make", [px4, ardupilot])
@given(packets=st.lists(heard_frames() | st.binary(max_size=80), max_size=25), armed=st.booleans())
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_whatever_is_received_it_goes_on_and_sends_only_finite_numbers(
    make: Callable[[], AutopilotConfig], packets: list[bytes], *, armed: bool
) -> None:
    node, listener = AutopilotNode(make(), START_NS), MavlinkCodec(1, 191)
    orders = MavlinkCodec(1, 191).encode(arm(force=True)) if armed else b""
    for packet in [orders, *packets, b"", b"", b""]:
        data = b"".join(node.receive(packet, node.state.t_ns) + node.step(None, STILL_AIR))
        assert all(isfinite(number) for number in numbers(listener.decode(data)))
    assert np.isfinite(node.state.position_enu_m).all()


@pytest.mark.slow
def test_a_setpoint_that_cannot_be_flown_leaves_the_flight_undisturbed() -> None:
    garbage = (
        setpoint((nan, 0.0, -5.0)),
        setpoint((inf, 0.0, -5.0)),
        setpoint((50.0, 0.0, -5.0), frame=mavlink.MAV_FRAME_GLOBAL),
        setpoint((50.0, 0.0, -5.0), mask=0b1001_1111_1001),
        setpoint((50.0, 0.0, -5.0), system=2),
        setpoint((50.0, 0.0, -5.0), yaw=nan),
    )
    pilot, undisturbed = Pilot(), Pilot()
    pilot.take_off(5.0)
    undisturbed.take_off(5.0)
    for _ in range(100):
        pilot.step(setpoint((1.0, 2.0, -5.0)), *garbage)
        undisturbed.step(setpoint((1.0, 2.0, -5.0)))
    assert np.array_equal(pilot.position, undisturbed.position)


@pytest.mark.slow
def test_garbage_does_not_keep_offboard_alive() -> None:
    pilot = Pilot()
    pilot.take_off(5.0)
    pilot.run(1.2, lambda _t: setpoint((nan, nan, nan)))
    assert pilot.custom_mode() != OFFBOARD


@pytest.mark.slow
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
