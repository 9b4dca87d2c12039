"""The companion's side of MAVLink as a machine without I/O: bytes and time in, events and bytes out.

The owner calls `receive` with what came, `poll` at least every 20 ms or so, and sends what `take_output` gives. Local
time must not run backwards; it may be off from UTC by any amount.
"""

from collections.abc import Sequence

from link.mavlink.clock_map import ClockMap
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import AutopilotRestarted, CommandTimedOut, Event, MessageReceived
from link.mavlink.own_heartbeat import OwnHeartbeat
from link.mavlink.parameters import parameter_question
from link.mavlink.peer import Address, Peer, RestartWatch
from link.mavlink.requests import (
    PATIENT,
    CommandParams,
    CommandSender,
    ParameterReader,
    Retries,
    command_message,
    command_params,
)
from link.mavlink.signing import Signing
from link.mavlink.statistics import SessionStatistics
from link.mavlink.streams import StreamRequests
from link.mavlink.timesync import ClockSync, boot_time_ns

_COMPONENT_ID = mavlink.MAV_COMP_ID_ONBOARD_COMPUTER
_INTERVAL = Retries(attempts=3)  # of one message's interval, before the next one has its turn


class MavlinkSession:
    """One conversation with one autopilot.

    Args:
        system_id: our own, the vehicle's; we are its component 191, an onboard computer.
        target_system_id: of the autopilot; None takes the first that is heard.
        signing: signs what is sent and refuses what is not signed rightly; None for a link without a key.
        records_input: keep the frames received for `take_input`.
        first_number: of the sequence sent; another one of our address that begins elsewhere is told from an echo.
        takes_own_utc: UTC is what the local clock shows, not what the autopilot tells.
    """

    def __init__(
        self,
        system_id: int,
        target_system_id: int | None = None,
        signing: Signing | None = None,
        *,
        records_input: bool = False,
        first_number: int = 0,
        takes_own_utc: bool = False,
    ) -> None:
        self._signing = signing
        self._codec = MavlinkCodec(
            system_id, _COMPONENT_ID, records_input=records_input, signing=signing, first_number=first_number
        )
        self._peer = Peer(Address(system_id, _COMPONENT_ID), target_system_id)
        self._restarts = RestartWatch()
        self.clock_sync = ClockSync(takes_own_utc=takes_own_utc)
        self._commands = CommandSender(self._send_command)
        self._streams = StreamRequests(self._command_stream)
        self._parameters = ParameterReader(self._send_parameter_request)
        self.heartbeat = OwnHeartbeat()
        self._filtered = 0
        self._output: list[bytes] = []

    @property
    def clock(self) -> ClockMap:
        """What is known now of local, boot and UTC time."""
        return self.clock_sync.clock

    @property
    def link_up(self) -> bool:
        """Whether the autopilot was found and is heard."""
        return self._peer.is_up

    @property
    def target_system_id(self) -> int | None:
        """The autopilot's system id, None while it is unknown."""
        return self._peer.target_system_id

    @property
    def other_system_ids(self) -> frozenset[int]:
        """Systems of autopilots that were heard and are not the target."""
        return frozenset(self._peer.others)

    def is_id_shared(self, t_ns: int) -> bool:
        """Whether two autopilots answer as the target, at local time `t_ns`."""
        return self.clock_sync.shared_id.is_shared(t_ns)

    @property
    def autopilot(self) -> int | None:
        """MAV_AUTOPILOT of its heartbeat, None before the first one."""
        return self._peer.autopilot

    @property
    def vehicle_type(self) -> int | None:
        """MAV_TYPE of its heartbeat, None before the first one."""
        return self._peer.vehicle_type

    @property
    def statistics(self) -> SessionStatistics:
        """The counters as they stand."""
        return SessionStatistics(
            codec=self._codec.statistics,
            filtered_messages=self._filtered,
            commands_retried=self._commands.retried,
            commands_timed_out=self._commands.timed_out,
            round_trips=self.clock_sync.round_trips,
        )

    def receive(self, data: bytes, t_ns: int, *, is_datagram: bool = False) -> list[Event]:
        """Takes what came from the transport; no bytes whatever make it raise.

        Args:
            data: bytes as they came.
            t_ns: local time now.
            is_datagram: they are whole frames, not a piece of a stream.
        """
        decoded = self._codec.decode(data, t_ns=t_ns, is_datagram=is_datagram)
        return [event for message in decoded for event in self._take(message, t_ns)]

    def poll(self, t_ns: int) -> list[Event]:
        """Does what is due at local time `t_ns`: heartbeat, questions, sending again, looking for silence."""
        if self._signing is not None:
            self._signing.advance(t_ns)
        events: list[Event] = [*self._peer.poll(t_ns)]
        for _, message in self._codec.flush(t_ns):
            events += self._take(message, t_ns)
        self._output += self.heartbeat.poll(t_ns, self._codec.encode)
        if self._peer.is_up and (question := self.clock_sync.poll(t_ns)) is not None:
            self.send(question)
        events += self._without_streams(self._commands.poll(t_ns))
        self._streams.poll(t_ns)
        events += self._parameters.poll(t_ns)
        return events

    def send(self, message: Message) -> None:
        """Sends a message once, with its target fields filled in where it has any.

        Raises:
            ValueError: A field does not fit its type.
        """
        self._output.append(self._codec.encode(message))

    def command(self, command_id: int, params: Sequence[float], t_ns: int, retries: Retries = PATIENT) -> int:
        """Sends a command to the autopilot, and again until it is acknowledged.

        A further command with the same id waits until this one is answered or has timed out.

        Args:
            command_id: MAV_CMD.
            params: up to seven, the rest is 0; NaN is MAVLink's "not given".
            t_ns: local time now.
            retries: how often it is sent at most, and when again.

        Returns:
            The ticket that its events carry.

        Raises:
            ValueError: There are too many parameters, or one is infinite.
        """
        return self._commands.submit(command_id, command_params(params), t_ns, retries)

    def request_interval(self, message_id: int, rate_hz: float, t_ns: int) -> None:
        """Asks for a message at a rate until it is granted, and again after a restart or when it stays away.

        Raises:
            ValueError: The rate is negative or not finite; 0 is for never.
        """
        self._streams.request(message_id, rate_hz, t_ns)

    def request_message(self, message_id: int, t_ns: int) -> int:
        """Asks for a message once, at local time `t_ns`, and gives the ticket of the command."""
        return self.command(mavlink.MAV_CMD_REQUEST_MESSAGE, (float(message_id),), t_ns)

    def read_parameter(self, name: str, t_ns: int) -> None:
        """Asks for a parameter, at local time `t_ns`; ParameterRead or ParameterMissing follows.

        Raises:
            ValueError: No parameter can have this name.
        """
        self._parameters.read(name, t_ns)

    def take_output(self) -> list[bytes]:
        """Gives what is to be sent, one frame each, once."""
        output, self._output = self._output, []
        return output

    def take_input(self) -> list[bytes]:
        """Gives the frames received since the last call, all senders', for a recording; see `records_input`."""
        return self._codec.take_input()

    def take_requests(self) -> list[Message]:
        """Gives what was asked of us as a component since the last call, and heartbeats of another with our address."""
        return [message for message in self._peer.take_requests() if not self.heartbeat.is_echo(message)]

    def _take(self, message: Message, t_ns: int) -> list[Event]:
        if is_accepted := self._peer.accepts(message):
            self.clock_sync.shared_id.hear(message, t_ns)
        boot_ns = boot_time_ns(message, self.clock.local_to_boot_ns(t_ns))
        if not is_accepted or (boot_ns and self._restarts.doubts(boot_ns, t_ns, self.clock)):
            self._filtered += 1
            return []
        events = self._peer.heard(message, t_ns)
        if boot_ns and (restart := self._restarts.see(boot_ns, t_ns)) is not None:
            events += [restart, *self._start_over(restart)]
        if boot_ns and self._restarts.is_behind:
            self._filtered += 1
            return events
        return [*events, MessageReceived(message, t_ns), *self._handle(message, t_ns)]

    def _handle(self, message: Message, t_ns: int) -> list[Event]:
        message_id = message.get_msgId()
        self._streams.seen(message_id, t_ns)
        if (answer := self.clock_sync.hear(message, t_ns)) is not None:
            self.send(answer)
        elif message_id == mavlink.MAVLINK_MSG_ID_COMMAND_ACK:
            event = self._commands.acknowledged(message, t_ns)
            self._streams.acknowledged(event)
            return [event]
        elif message_id == mavlink.MAVLINK_MSG_ID_PARAM_VALUE and self._peer.autopilot is not None:
            return [*self._parameters.received(message, self._peer.autopilot, t_ns)]
        return []

    def _start_over(self, restart: AutopilotRestarted) -> list[Event]:
        self.clock_sync.start_over()
        events = self._without_streams(self._commands.drop_all(restart.t_ns))
        self._streams.start_over(restart.t_ns)
        self._parameters.start_over(restart.t_ns)
        return events

    def _without_streams(self, timed_out: list[CommandTimedOut]) -> list[Event]:
        """The commands that their owner hears of; streams see to their own."""
        return [event for event in timed_out if not self._streams.timed_out(event)]

    def _command_stream(self, command: int, params: CommandParams, t_ns: int) -> int:
        return self._commands.submit(command, params, t_ns, _INTERVAL)

    def _send_command(self, command: int, params: CommandParams, confirmation: int) -> None:
        target = self._peer.target_system_id
        if target is not None:
            self.send(command_message(target, command, params, confirmation))

    def _send_parameter_request(self, name: str) -> None:
        if (target := self._peer.target_system_id) is not None:
            self.send(parameter_question(target, name))
