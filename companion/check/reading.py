"""Listening to an autopilot: what a check wants to know, asked for and gathered; no I/O."""

import statistics
from collections import Counter, deque

from companion.autopilots.geoid import geoid_height_m
from companion.autopilots.sensor_reports import battery_share, distance_below_m, is_of_first_battery, looks_down
from companion.check.assessment import MOTION
from companion.check.firmwares import FIRMWARES
from companion.check.observation import AutopilotFacts
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import (
    CommandAcknowledged,
    CommandTimedOut,
    Event,
    LinkFound,
    MessageReceived,
    ParameterMissing,
    ParameterRead,
)
from link.mavlink.session import MavlinkSession

_RATE_HZ = 50.0
_SETTLE_NS = 1_000_000_000  # for the rates to become what was asked for
_READY_BIT = mavlink.MAV_SYS_STATUS_PREARM_CHECK
_STREAMS = {
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: _RATE_HZ,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: _RATE_HZ,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 2.0,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 2.0,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 1.0,
    mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 2.0,
}
_ONCE = (mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION, mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN)
_ASK_AGAIN_NS = 1_000_000_000
_KEPT = 500


class Reader:
    """Asks an autopilot for what a check needs, and remembers the answers.

    Args:
        session: to the autopilot.
    """

    def __init__(self, session: MavlinkSession) -> None:
        self.session = session
        self.parameter_types: dict[str, int] = {}
        self._parameters: dict[str, float] = {}
        self._outstanding: set[str] = set()
        self._newest: dict[str, Message] = {}
        self._counts: Counter[str] = Counter()
        self._latencies_s: deque[float] = deque(maxlen=_KEPT)
        self._found_ns: int | None = None
        self._counted_from_ns = 0
        self._asked_ns = 0
        self._unanswered: dict[int, int] = {}  # message ids that were asked for, by their tickets
        self._t_ns = 0

    @property
    def parameters_done(self) -> bool:
        """Whether every parameter was answered or given up."""
        return self._found_ns is not None and not self._outstanding

    @property
    def listened_s(self) -> float:
        """For how long messages have been counted."""
        return 0.0 if self._found_ns is None else max(0.0, (self._t_ns - self._counted_from_ns) * 1e-9)

    def count_anew(self, t_ns: int) -> None:
        """Forget rates and latencies at local time `t_ns`; those of an autopilot just found need time to settle."""
        self._counts.clear()
        self._latencies_s.clear()
        self._counted_from_ns = max(t_ns, self._counted_from_ns)

    def receive(self, data: bytes, t_ns: int, *, is_datagram: bool = False) -> None:
        """Take bytes of the transport at local time `t_ns`: whole frames if `is_datagram`."""
        self._take(self.session.receive(data, t_ns, is_datagram=is_datagram))

    def poll(self, t_ns: int) -> None:
        """Do what is due at local time `t_ns`."""
        self._t_ns = t_ns
        self._take(self.session.poll(t_ns))
        if self._found_ns is not None and t_ns - self._asked_ns >= _ASK_AGAIN_NS:
            self._asked_ns = t_ns
            for message_id in _ONCE:
                if _name(message_id) not in self._newest and message_id not in self._unanswered.values():
                    self._unanswered[self.session.request_message(message_id, t_ns)] = message_id

    def read_again(self, name: str, t_ns: int) -> None:
        """Ask for a parameter's present value."""
        self._outstanding.add(name)
        self.session.read_parameter(name, t_ns)

    def value(self, name: str) -> float | None:
        """Return a parameter as it was last read, None when it is still asked for or unknown."""
        return None if name in self._outstanding else self._parameters.get(name)

    def facts(self) -> AutopilotFacts:
        """Return what is known now.

        Raises:
            ValueError: no autopilot was heard.
        """
        autopilot, vehicle_type = self.session.autopilot, self.session.vehicle_type
        if autopilot is None or vehicle_type is None:
            raise ValueError("no autopilot was heard")
        clock = self.session.clock
        std_ns = clock.local_to_boot_std_ns(self._t_ns)
        return AutopilotFacts(
            autopilot_id=autopilot,
            vehicle_type=vehicle_type,
            version=self._version(),
            can_arm=self._can_arm(),
            is_id_shared=self.session.is_id_shared(self._t_ns),
            has_origin="GPS_GLOBAL_ORIGIN" in self._newest,
            geoid_height_m=self._geoid_height_m(),
            has_position="LOCAL_POSITION_NED" in self._newest,
            round_trips=self.session.statistics.round_trips,
            utc_known=clock.is_utc_known,
            utc_ahead_s=self._utc_ahead_s(),
            clock_std_s=None if std_ns is None else std_ns * 1e-9,
            rates_hz={name: self._counts[name] / self.listened_s for name in MOTION} if self.listened_s else {},
            latency_s=statistics.median(self._latencies_s) if self._latencies_s else None,
            has_range_finder="DISTANCE_SENSOR" in self._newest,
            range_at_rest_m=self._range_at_rest_m(),
            battery_share=self._battery_share(),
            parameters=dict(self._parameters),
        )

    def _utc_ahead_s(self) -> float | None:
        clock = self.session.clock
        is_known = clock.is_utc_known and clock.local_to_boot is not None
        return (clock.local_to_utc_ns(self._t_ns) - self._t_ns) * 1e-9 if is_known else None

    def _take(self, events: list[Event]) -> None:
        for event in events:
            match event:
                case MessageReceived():
                    self._hear(event.message, event.t_ns)
                case LinkFound():
                    self._ask(event)
                case CommandAcknowledged(result=mavlink.MAV_RESULT_IN_PROGRESS):
                    pass
                case CommandAcknowledged(ticket=ticket) | CommandTimedOut(ticket=ticket) if ticket is not None:
                    self._unanswered.pop(ticket, None)
                case ParameterRead():
                    self._parameters[event.name] = float(event.value)
                    self._outstanding.discard(event.name)
                case ParameterMissing():
                    self._outstanding.discard(event.name)
                case _:
                    pass

    def _ask(self, found: LinkFound) -> None:
        self._found_ns, self._counted_from_ns = found.t_ns, found.t_ns + _SETTLE_NS
        for message_id, rate_hz in _STREAMS.items():
            self.session.request_interval(message_id, rate_hz, found.t_ns)
        firmware = FIRMWARES.get(found.autopilot)
        for name in () if firmware is None else firmware.parameters:
            self.read_again(name, found.t_ns)

    def _hear(self, message: Message, t_ns: int) -> None:
        name = message.get_type()
        if name == "BATTERY_STATUS" and not is_of_first_battery(message):
            return
        if name == "DISTANCE_SENSOR" and not looks_down(message):
            return
        self._newest[name] = message
        if name == "PARAM_VALUE":
            self.parameter_types[message.param_id] = message.param_type
        if self._found_ns is None or t_ns < self._counted_from_ns:
            return
        self._counts[name] += 1
        boot_ns = self.session.clock.local_to_boot_ns(t_ns)
        if name == "LOCAL_POSITION_NED" and boot_ns is not None:
            self._latencies_s.append((boot_ns - message.time_boot_ms * 1_000_000) * 1e-9)

    def _version(self) -> tuple[int, int, int] | None:
        message = self._newest.get("AUTOPILOT_VERSION")
        if message is None:
            return None
        packed = message.flight_sw_version
        return packed >> 24 & 0xFF, packed >> 16 & 0xFF, packed >> 8 & 0xFF

    def _can_arm(self) -> bool | None:
        message = self._newest.get("SYS_STATUS")
        return None if message is None else bool(message.onboard_control_sensors_health & _READY_BIT)

    def _geoid_height_m(self) -> float | None:
        message = self._newest.get("GPS_RAW_INT")
        return None if message is None else geoid_height_m(None, message)

    def _range_at_rest_m(self) -> float | None:
        seen, beat = self._newest.get("DISTANCE_SENSOR"), self._newest.get("HEARTBEAT")
        if seen is None or beat is None or beat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED:
            return None
        return distance_below_m(seen)

    def _battery_share(self) -> float | None:
        message = self._newest.get("BATTERY_STATUS")
        return None if message is None else battery_share(message)


def _name(message_id: int) -> str:
    return str(mavlink.mavlink_map[message_id].msgname)
