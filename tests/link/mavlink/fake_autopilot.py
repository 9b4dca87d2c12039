"""A small autopilot for the tests of the session: streams, answers and clocks, made of the codec alone."""

from dataclasses import dataclass, field
from typing import TypeVar

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import Event
from link.mavlink.parameters import parameter_on_wire
from link.mavlink.session import MavlinkSession
from link.memory_link import MemoryLink

EventT = TypeVar("EventT")

MS = 1_000_000
S = 1_000_000_000
START_NS = 1_795_000_000 * S  # local time at which the tests begin
UTC_AHEAD_NS = 37 * S + 123_456_789  # what the companion's clock is behind UTC
BOOTED_NS = 20 * S  # time since boot at the beginning
U32 = 0xFFFF_FFFF  # a boot time in milliseconds begins anew after it

INT32 = mavlink.MAV_PARAM_TYPE_INT32
REAL32 = mavlink.MAV_PARAM_TYPE_REAL32


@dataclass
class FakeAutopilot:
    """System 1; `results` are the answers by command, all given at once; an empty tuple is silence."""

    firmware: int = mavlink.MAV_AUTOPILOT_PX4
    drift: float = 0.0
    results: dict[int, tuple[int, ...]] = field(default_factory=dict)
    parameters: dict[str, tuple[float, int]] = field(default_factory=dict)
    mute: bool = False
    left_out: frozenset[int] = frozenset()
    utc_known: bool = True

    def __post_init__(self) -> None:
        self.codec = MavlinkCodec(1, 1)
        self.output: list[bytes] = []
        self.received: list[Message] = []
        self.intervals_ns: dict[int, int] = {}
        self.last_sent_ns: dict[int, int] = {}
        self.boot_at_ns = START_NS - round(BOOTED_NS / (1.0 + self.drift))

    def boot_ns(self, t_ns: int) -> int:
        return round((t_ns - self.boot_at_ns) * (1.0 + self.drift))

    def restart(self, t_ns: int) -> None:
        self.boot_at_ns = t_ns
        self.intervals_ns.clear()

    def send(self, message: Message) -> None:
        if not self.mute and message.get_msgId() not in self.left_out:
            self.output.append(self.codec.encode(message))

    def take_output(self) -> list[bytes]:
        output, self.output = self.output, []
        return output

    def tick(self, t_ns: int) -> None:
        periods_ns = {mavlink.MAVLINK_MSG_ID_HEARTBEAT: S, mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: S, **self.intervals_ns}
        for message_id, period_ns in periods_ns.items():
            if t_ns - self.last_sent_ns.get(message_id, -(2**62)) >= period_ns:
                self.last_sent_ns[message_id] = t_ns
                self.send(self.message(message_id, t_ns))

    def message(self, message_id: int, t_ns: int) -> Message:
        boot_ms = self.boot_ns(t_ns) // MS
        if message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT:
            return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, self.firmware, 0, 0, 3, 3)
        if message_id == mavlink.MAVLINK_MSG_ID_SYSTEM_TIME:
            # Whole milliseconds since boot, and the UTC at exactly that time, as clocks with no error would say.
            at_ns = self.boot_at_ns + round(boot_ms * MS / (1.0 + self.drift))
            unix_us = (at_ns + UTC_AHEAD_NS) // 1000 if self.utc_known else 0
            return mavlink.MAVLink_system_time_message(unix_us, boot_ms & U32)
        if message_id == mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION:
            return mavlink.MAVLink_attitude_quaternion_message(boot_ms & U32, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        return mavlink.MAVLink_local_position_ned_message(boot_ms & U32, 1.0, 2.0, -3.0, 0.1, 0.2, -0.3)

    def receive(self, data: bytes, t_ns: int) -> None:
        for message in self.codec.decode(data):
            self.received.append(message)
            kind = message.get_type()
            if kind == "TIMESYNC" and message.tc1 == 0:
                self.send(mavlink.MAVLink_timesync_message(tc1=self.boot_ns(t_ns), ts1=message.ts1))
            elif kind == "COMMAND_LONG":
                self.obey(message)
            elif kind == "PARAM_REQUEST_READ":
                self.tell_parameter(message.param_id)

    def obey(self, message: Message) -> None:
        results = self.results.get(message.command, (mavlink.MAV_RESULT_ACCEPTED,))
        is_granted = message.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL and mavlink.MAV_RESULT_ACCEPTED in results
        if is_granted and message.param1 != mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED:  # it tells of no setpoint
            self.intervals_ns[int(message.param1)] = round(message.param2 * 1000)
        for result in results:
            self.acknowledge(message.command, result)

    def acknowledge(self, command: int, result: int) -> None:
        self.send(mavlink.MAVLink_command_ack_message(command, result, 0, 0, 1, 191))

    def tell_parameter(self, name: str) -> None:
        if name in self.parameters:
            value, kind = self.parameters[name]
            on_wire = parameter_on_wire(value, kind, self.firmware)
            self.send(mavlink.MAVLink_param_value_message(name.encode(), on_wire, kind, 1, 0))

    def of_type(self, kind: str) -> list[Message]:
        return [message for message in self.received if message.get_type() == kind]


@dataclass
class Pair:
    """A session and an autopilot with a link each way, ticked every 5 ms; `t_ns` is the local time."""

    session: MavlinkSession
    autopilot: FakeAutopilot
    up: MemoryLink = field(default_factory=lambda: MemoryLink(seed=1, delay_s=0.001))
    down: MemoryLink = field(default_factory=lambda: MemoryLink(seed=2, delay_s=0.001))
    t_ns: int = START_NS

    def run(self, duration_s: float) -> list[Event]:
        events: list[Event] = []
        end_ns = self.t_ns + round(duration_s * S)
        while self.t_ns < end_ns:
            self.t_ns += 5 * MS
            for data in self.up.take(self.t_ns):
                self.autopilot.receive(data, self.t_ns)
            self.autopilot.tick(self.t_ns)
            for data in self.autopilot.take_output():
                self.down.put(data, self.t_ns)
            for data in self.down.take(self.t_ns):
                events += self.session.receive(data, self.t_ns)
            events += self.session.poll(self.t_ns)
            for data in self.session.take_output():
                self.up.put(data, self.t_ns)
        return events


def of_kind(events: list[Event], kind: type[EventT]) -> list[EventT]:
    return [event for event in events if isinstance(event, kind)]
