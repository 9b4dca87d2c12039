"""The companion's dialogue with the autopilot: requests streams, origin and parameters, and reads messages."""

from collections.abc import Mapping

from companion.autopilots.choice import driver_for
from companion.autopilots.driver import AutopilotCommand, AutopilotView, Driver, gives_up_after_s, streams_hz
from companion.autopilots.geoid import Geoid
from companion.autopilots.heartbeat import with_acknowledgement
from companion.autopilots.late_reports import LateReports
from companion.autopilots.limits import LimitQuestions
from companion.autopilots.pilot_switch import PilotSwitch
from companion.autopilots.response import Cascade, Shaping
from companion.autopilots.sent_setpoints import SentSetpoints
from companion.autopilots.state import AutopilotState, has_frame_moved, shift_reports, update_state
from companion.config.autopilot import AutopilotConfig
from companion.core.data import FlightLimits, Setpoint
from link.mavlink.clock_map import ClockMap, utc_set_by_ns
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import (
    AutopilotRestarted,
    CommandAcknowledged,
    CommandTimedOut,
    Event,
    LinkFound,
    LinkLost,
    LinkRegained,
    MessageReceived,
    ParameterMissing,
)
from link.mavlink.session import MavlinkSession
from link.records import replace

_ASK = mavlink.MAV_CMD_REQUEST_MESSAGE
_ASK_ORIGIN_NS = 1_000_000_000
_ASK_KNOWN_ORIGIN_NS = 5_000_000_000
_CLOCK_SET_NS = 20_000_000  # SYSTEM_TIME comes in whole milliseconds: no fit is refined by so much at once
_BY_ITSELF = AutopilotConfig()
_LimitsAsked = tuple[FlightLimits, Driver, Mapping[str, float]]


class AutopilotLink:
    """The MAVLink session of a companion, without I/O.

    Args:
        session: to the autopilot.
        config: of the autopilot and its link.
        motion_rate_hz: of the drone's position and attitude.
    """

    def __init__(
        self, session: MavlinkSession, config: AutopilotConfig = _BY_ITSELF, motion_rate_hz: float = 50.0
    ) -> None:
        self.session = session
        self._config = config
        self._motion_rate_hz = motion_rate_hz
        self.state = AutopilotState(geoid=Geoid(height_m=config.geoid_height_m))
        self.driver: Driver | None = None
        self.setpoints = SentSetpoints(session)
        self._acknowledgements: list[tuple[int, int]] = []
        self._unanswered: dict[int, int] = {}
        self._origin_asked_ns: int | None = None
        self._limits: tuple[_LimitsAsked, FlightLimits] | None = None
        self._heard_ns: int | None = None
        self._polled_ns: int | None = None
        self._questions = LimitQuestions()
        self._late = LateReports()
        self.pilot_switch = PilotSwitch(config.pilot_switch)
        self._clock = ClockMap()
        self.utc_set_ns = 0
        """By how much UTC was set in all."""

    def receive(self, data: bytes, local_ns: int, *, is_datagram: bool = False) -> None:
        """Take bytes of the transport: whole frames if `is_datagram`, else a piece of a stream.

        Raises:
            UserError: the autopilot is of a kind that cannot be flown.
        """
        self._take(self.session.receive(data, local_ns, is_datagram=is_datagram), local_ns)

    def poll(self, local_ns: int) -> None:
        """Do what is due by now."""
        self._take(self.session.poll(local_ns), local_ns)
        if self._is_out_of_touch(local_ns):
            self._set_link(up=False)  # until a heartbeat says what the autopilot does now
        self._polled_ns = local_ns
        is_id_shared = self.session.is_id_shared(local_ns)
        if is_id_shared is not self.state.view.is_id_shared:
            self.state = replace(self.state, view=replace(self.state.view, is_id_shared=is_id_shared))
        self._ask_for_origin(local_ns)
        if self.driver is not None:
            for name in self._questions.due(self.driver, local_ns):
                self.session.read_parameter(name, local_ns)

    def take_acknowledgements(self) -> tuple[tuple[int, int], ...]:
        """Return (command, MAV_RESULT) received since the last call."""
        taken, self._acknowledgements = tuple(self._acknowledgements), []
        return taken

    def take_texts(self) -> tuple[str, ...]:
        """Return the autopilot's texts since the last call."""
        texts, self.state = self.state.texts, replace(self.state, texts=())
        return texts

    def limits(self, wanted: FlightLimits) -> FlightLimits:
        """Return `wanted` cut to the autopilot's own limits, as far as they are known."""
        if self.driver is None:
            return wanted
        asked = (wanted, self.driver, self.state.parameters)
        if self._limits is None or any(now is not then for now, then in zip(asked, self._limits[0], strict=True)):
            self._limits = (asked, self.driver.limits(wanted, self.state.parameters))
        return self._limits[1]

    @property
    def cascade(self) -> Cascade | None:
        """How the autopilot follows setpoints, by its parameters as far as they are known; None before it is found."""
        return None if self.driver is None else self.driver.cascade(self.state.parameters)

    @property
    def shaping(self) -> Shaping | None:
        """How the autopilot carries setpoints on; None before it is found, and of one that does not."""
        return None if self.driver is None else self.driver.shaping(self.state.parameters)

    def send_setpoint(self, setpoint: Setpoint, local_ns: int) -> None:
        """Send a setpoint for the flight, once an autopilot is found."""
        if self.driver is not None:
            self.setpoints.send(setpoint, self.driver, local_ns)

    def ask_often(self, *, is_steered: bool) -> None:
        """Ask for the time as often as setpoints are sent, where nothing else tells from instant to instant of them."""
        self.session.clock_sync.asks_often = is_steered and self.setpoints.answers.sent_ns is None

    def send_commands(self, commands: tuple[AutopilotCommand, ...], local_ns: int) -> None:
        """Send commands; their acknowledgements come back by `take_acknowledgements`.

        One that would have to wait for the answer to an earlier one of its kind is left out: sent later, it could
        meet another situation, as a disarm that is meant for the pad and arrives after a bounce.
        """
        for command in commands:
            if command.command not in self._unanswered:
                ticket = self.session.command(command.command, command.parameters, local_ns, command.retries)
                self._unanswered[command.command] = ticket

    def _take(self, events: list[Event], local_ns: int) -> None:
        self._follow_clock(local_ns)
        for event in events:
            match event:
                case MessageReceived() if self.driver is not None:
                    self._heard_ns = local_ns
                    self._hear(event.message, self.driver, local_ns)
                case LinkFound():
                    self._find(event, local_ns)
                case LinkLost() | LinkRegained():
                    self._follow_link(is_regained=isinstance(event, LinkRegained))
                case AutopilotRestarted():
                    self._start_over()
                case CommandAcknowledged():
                    if event.result != mavlink.MAV_RESULT_IN_PROGRESS:
                        self._take_answer(event.command, event.ticket)
                    self._acknowledgements.append((event.command, event.result))
                    self.state = replace(self.state, view=with_acknowledgement(self.state.view, event))
                case CommandTimedOut():
                    self._take_answer(event.command, event.ticket)
                case ParameterMissing():
                    self._questions.unanswered(event.name, local_ns)

    def _find(self, found: LinkFound, local_ns: int) -> None:
        """Take the first autopilot, or another kind of it in its place."""
        before, self.driver = self.driver, driver_for(found.autopilot, found.vehicle_type, self._config.kind)
        if before is not None and before is not self.driver:
            self.state = replace(self.state, parameters={})
            self._start_over()
        self._ask_for_streams(self.driver, local_ns)

    def _hear(self, message: Message, driver: Driver, local_ns: int) -> None:
        if self._late.is_late(message, local_ns):
            return
        if message.get_type() == "PARAM_VALUE":
            parameters = self._questions.hear(message, driver, self.state.parameters, local_ns)
            self.state = replace(self.state, parameters=parameters)
        elif message.get_type() == "RC_CHANNELS":
            self.pilot_switch.hear(message, local_ns)
        elif message.get_type() == "POSITION_TARGET_LOCAL_NED":
            self.setpoints.hear(message, driver, local_ns)
        before = self.state
        self.state = update_state(before, message, self.session.clock, driver)
        if has_frame_moved(before, self.state):
            self._origin_asked_ns = None  # it has probably moved, too

    def _start_over(self) -> None:
        """Forget what the autopilot told before its restart; its parameters count until it tells them anew."""
        moves = self.state.view.frame_moves
        moves = replace(moves, origin_count=moves.origin_count + 1)
        view = AutopilotView(
            link_up=True, armed=False, in_control=False, failsafe=False, restarted=True, frame_moves=moves
        )
        geoid = Geoid(height_m=self._config.geoid_height_m)
        self.state = AutopilotState(view=view, parameters=self.state.parameters, geoid=geoid)
        self._origin_asked_ns = None
        self._questions.ask_all()
        self.pilot_switch.forget()
        self.setpoints.start_over()

    def _take_answer(self, command: int, ticket: int | None) -> None:
        if self._unanswered.get(command) == ticket:
            self._unanswered.pop(command, None)

    def _follow_link(self, *, is_regained: bool) -> None:
        self._set_link(up=is_regained)
        if is_regained:
            self._questions.ask_all()

    def _set_link(self, *, up: bool) -> None:
        self.state = replace(self.state, view=replace(self.state.view, link_up=up))

    @property
    def timeout_s(self) -> float:
        """For how long the autopilot goes on without a setpoint."""
        if self.driver is None:
            return 0.0
        return self.state.parameters.get(self.driver.timeout_parameter, self.driver.timeout_default_s)

    def _is_out_of_touch(self, local_ns: int) -> bool:
        """Return whether the autopilot may have given up on setpoints, since it is silent or since we stood still."""
        if self.driver is None or self._heard_ns is None or self._polled_ns is None:
            return False
        return (local_ns - min(self._heard_ns, self._polled_ns)) * 1e-9 > gives_up_after_s(self.driver, self.timeout_s)

    def _ask_for_streams(self, driver: Driver, local_ns: int) -> None:
        wanted_hz = streams_hz(driver, self._motion_rate_hz, stops_unused=self._config.stops_unused_streams)
        for message_id, rate_hz in (wanted_hz | self.pilot_switch.streams_hz).items():
            self.session.request_interval(message_id, rate_hz, local_ns)

    def _follow_clock(self, local_ns: int) -> None:
        """Put off the times of what has been reported, once UTC was set: what comes next has the new time."""
        set_by_ns = utc_set_by_ns(self._clock, self.session.clock, local_ns)
        if abs(set_by_ns) > _CLOCK_SET_NS:
            self.state = shift_reports(self.state, set_by_ns)
            self.utc_set_ns += set_by_ns
        self._clock = self.session.clock

    def _ask_for_origin(self, local_ns: int) -> None:
        """Ask until it is known, and from time to time after, since it can be moved; one question at a time."""
        if self.driver is None or not self.session.link_up or _ASK in self._unanswered:
            return
        is_known = self.state.view.frame is not None and self.state.origin_doubted_msl is None
        period_ns = _ASK_KNOWN_ORIGIN_NS if is_known else _ASK_ORIGIN_NS
        if self._origin_asked_ns is None or local_ns - self._origin_asked_ns >= period_ns:
            self._origin_asked_ns = local_ns
            self._unanswered[_ASK] = self.session.request_message(mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN, local_ns)
