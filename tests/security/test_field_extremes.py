"""Each field of what the companion hears at its extremes, one at a time: nothing raises, and only numbers are sent."""

import math
import struct
from collections.abc import Iterator, Sequence

import pytest

from companion.situation.phases import Phase
from link.mavlink.codec import MavlinkCodec
from link.mavlink.contents import Field, field_offsets, fields_in_order, with_checksum
from link.mavlink.dialect import mavlink
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.flight import FaultFlight
from scenarios.faults.fuzz_companion import count_not_finite

HEARD = (
    "LOCAL_POSITION_NED",
    "ATTITUDE_QUATERNION",
    "EXTENDED_SYS_STATE",
    "GPS_GLOBAL_ORIGIN",
    "GPS_RAW_INT",
    "DISTANCE_SENSOR",
    "BATTERY_STATUS",
    "STATUSTEXT",
    "EVENT",
    "SYSTEM_TIME",
    "TIMESYNC",
    "COMMAND_ACK",
    "PARAM_VALUE",
    "RC_CHANNELS",
    "POSITION_TARGET_LOCAL_NED",
    "PARAM_SET",
    "COMMAND_INT",
    "COMMAND_LONG",
    "CURRENT_MODE",
    "HEARTBEAT",
)
"""What the companion reads of an autopilot or a ground station; what ends its part comes last."""
REALS = (math.nan, math.inf, -math.inf, 3.4e38, -3.4e38, 1e6, 1e-45, 0.0, -1.0)
FORMATS = {"float": "f", "int8_t": "b", "int16_t": "h", "int32_t": "i", "int64_t": "q"}
FORMATS |= {"char": "B", "uint8_t": "B", "uint16_t": "H", "uint32_t": "I", "uint64_t": "Q"}
DOUBLES = (math.nan, -math.inf, 1.7e308, 1e150, -1e3, 5e-324, 0.0)
HEADER_BYTES = mavlink.HEADER_LEN_V2
HEAD_BYTES = 4  # of CDR
FRAMES_A_STEP = SAMPLES_A_STEP = 4


class Watched(FaultFlight):
    """A landing whose companion's numbers are counted that are none; it keeps what was heard last of each kind."""

    def __init__(self) -> None:
        super().__init__(load_scenario("straight_5+sensors=nominal"), 1)
        self.not_finite = self.frames = 0
        self.number = 0
        self.payloads: dict[str, bytes] = {}
        self._from, self._to = MavlinkCodec(255, 190), MavlinkCodec(255, 190)
        node, receive = self.companion, self.companion.receive_sample

        def keep(key: str, payload: bytes) -> None:
            self.payloads[key] = payload
            receive(key, payload)

        node.receive_sample = keep  # type: ignore[method-assign]

    def _hear(self, data: bytes) -> None:
        for message in self._from.decode(data):
            frame = message.get_msgbuf()
            self.payloads[message.get_type()] = bytes(frame[HEADER_BYTES : HEADER_BYTES + frame[1]])
            self.number = message.get_seq()
        super()._hear(data)

    def _send(self, frames: Sequence[bytes], t_ns: int) -> None:
        self.not_finite += count_not_finite(self._to.decode(b"".join(frames)))
        self.frames += len(frames)
        super()._send(frames, t_ns)


def values(field: Field) -> Iterator[bytes]:
    """Yield the extremes of a field, in all places of an array."""
    form = FORMATS[field.kind]
    bits = 8 * struct.calcsize(form)
    lowest, highest = (-1 << bits - 1, (1 << bits - 1) - 1) if form.islower() else (0, (1 << bits) - 1)
    for value in REALS if form == "f" else (lowest, highest, 1):
        yield struct.pack("<" + form, value) * (field.length or 1)


def extreme_frames(flight: Watched, name: str) -> Iterator[bytes]:
    """Yield the message as it was heard last, with one field at an extreme."""
    kind = next(number for number, message in mavlink.mavlink_map.items() if message.msgname == name)
    offsets = field_offsets(kind)
    whole = bytearray(flight.payloads.get(name, b"").ljust(mavlink.mavlink_map[kind].unpacker.size, b"\0"))
    for target, of_companion in (("target_system", 1), ("target_component", 191)):
        if target in offsets:
            whole[offsets[target]] = of_companion
    for field in fields_in_order(kind):
        for told in values(field) if not field.name.startswith("target") else ():
            payload = bytearray(whole)
            payload[offsets[field.name] : offsets[field.name] + len(told)] = told
            head = bytes((mavlink.PROTOCOL_MARKER_V2, len(payload), 0, 0, (flight.number + 1) % 256, 1, 1))
            yield with_checksum(head + kind.to_bytes(3, "little") + payload, kind)


@pytest.fixture
def flight() -> Watched:
    """One that has just begun to descend."""
    flown = Watched()
    flown.fly_to(Phase.DESCEND)
    return flown


@pytest.mark.slow
def test_no_field_of_a_message_makes_the_companion_stop_or_send_what_is_no_number(flight: Watched) -> None:
    before, heard = flight.frames, 0
    for name in HEARD:
        for frame in extreme_frames(flight, name):
            flight.companion.receive_mavlink(frame, flight.local_ns, is_datagram=True)
            heard += 1
            if heard % FRAMES_A_STEP == 0:
                flight.step()
    flight.fly(1.0)
    assert heard > 700
    assert flight.not_finite == 0
    assert flight.frames > before
    own = flight.companion.autopilot.state.own
    assert own is not None
    assert all(map(math.isfinite, (*own.position_enu_m, *own.velocity_enu_m_s, *own.orientation_wxyz)))


@pytest.mark.slow
def test_no_number_of_a_sample_makes_the_companion_stop_or_send_what_is_no_number(flight: Watched) -> None:
    samples = {key: payload for key, payload in flight.payloads.items() if "/" in key}
    given = 0
    for key, payload in samples.items():
        for place in range(HEAD_BYTES, len(payload) - 7, 8):
            for value in DOUBLES:
                told = payload[:place] + struct.pack("<d", value) + payload[place + 8 :]
                flight.companion.receive_sample(key, told)
                given += 1
                if given % SAMPLES_A_STEP == 0:
                    flight.step()
    flight.fly(1.0)
    assert len(samples) == 4
    assert flight.not_finite == 0
    assert flight.phase is not Phase.PILOT
