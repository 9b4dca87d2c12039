"""The one entry to the services: what each message asks of them, and what they send by themselves."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from link.ftp.state import FtpRules
from link.ftp.store import Shown
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.commands.addressees import is_for_us, is_ours
from sim_autopilot.commands.commands import answer_command
from sim_autopilot.commands.requests import Answer, Request, acknowledgement, request_from_message
from sim_autopilot.core.parameters import Parameter, Values
from sim_autopilot.core.streams import Stream
from sim_autopilot.ground_station.files_and_logs import (
    LOG_IDS,
    log_flight,
    send_burst,
    send_log,
    take_ftp,
    take_log_request,
)
from sim_autopilot.ground_station.log_streaming import stream_log, take_logging_ack
from sim_autopilot.ground_station.logs.flight_log import LogRules
from sim_autopilot.ground_station.memory import EMPTY, StationMemory, keep_stored
from sim_autopilot.ground_station.missions.plans import pass_transfer, take_plan
from sim_autopilot.ground_station.missions.rules import TransferRules
from sim_autopilot.ground_station.missions.transfer import MESSAGE_IDS
from sim_autopilot.interfaces import AutopilotConfig, Builder, Result
from sim_autopilot.memory import AutopilotMemory

_COMMANDS = frozenset({mavlink.MAVLINK_MSG_ID_COMMAND_LONG, mavlink.MAVLINK_MSG_ID_COMMAND_INT})

MessageHandler = Callable[[AutopilotMemory, Message, AutopilotConfig], Result]
CommandHandler = Callable[[AutopilotMemory, Request, AutopilotConfig], Answer | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundStation:
    """The services of one firmware.

    Attributes:
        files: that it shows over MAVLink FTP, by its parameters and their values.
        ftp: rules of the FTP server.
        logs: of flights.
        plans: of the mission protocol.
        messages: what else is handled, by message id.
        commands: by MAV_CMD; a handler may leave one to the flight, by None.
        fixed_answers: the MAV_RESULT of commands that change nothing here, None for no answer, by MAV_CMD.
        streams: messages that it can send besides the flight's.
        builders: of the messages in `streams`.
    """

    files: Callable[[tuple[Parameter, ...], Values], Shown]
    ftp: FtpRules
    logs: LogRules
    plans: TransferRules
    messages: Mapping[int, MessageHandler] = field(default_factory=dict)
    commands: Mapping[int, CommandHandler]
    fixed_answers: Mapping[int, int | None]
    streams: Mapping[int, Stream] = field(default_factory=dict)
    builders: Mapping[int, Builder] = field(default_factory=dict)

    def begin(self) -> object:
        """Return the services' memory at boot."""
        return EMPTY

    def keep(self, station: object) -> object:
        """Return what of it outlives a reboot."""
        return keep_stored(station) if isinstance(station, StationMemory) else station

    def handle(self, memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> "Result | None":
        """Return the memory after a message, and what answers it; None for one that is the flight's."""
        message_id = message.get_msgId()
        if message_id in _COMMANDS:
            return self._obey(memory, message, config)
        handler = self.messages.get(message_id)
        if handler is not None:
            return handler(memory, message, config)
        service = _SERVICES.get(message_id)
        if service is None:
            return None
        return service(self, memory, message, config) if is_ours(message, config) else (memory, ())

    def advance(self, memory: AutopilotMemory, config: AutopilotConfig) -> Result:
        """Return the memory a step on, and what a transfer and a burst send to their clients."""
        memory, asked = pass_transfer(memory, self.plans)
        memory, sent = send_burst(log_flight(memory, config, self.logs), self.ftp)
        return memory, asked + sent

    def report(self, memory: AutopilotMemory, config: AutopilotConfig) -> Result:
        """Return the memory a step on, and what of logs goes on the link at hand."""
        memory, log = send_log(memory, self.logs)
        memory, live = stream_log(memory, config, self.logs)
        return memory, log + live

    def _obey(self, memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> "Result | None":
        handler, is_fixed = self.commands.get(message.command), message.command in self.fixed_answers
        if (handler is None and not is_fixed) or not is_for_us(message, config):
            return None
        request = request_from_message(message)
        if handler is None:
            result = self.fixed_answers[message.command]
            return memory, () if result is None else (acknowledgement(request, result),)
        answer = handler(memory, request, config)
        return None if answer is None else answer_command(answer, request, config)


_Service = Callable[[GroundStation, AutopilotMemory, Message, AutopilotConfig], Result]


def _plan(station: GroundStation, memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    return take_plan(memory, message, config, station.plans)


def _log(station: GroundStation, memory: AutopilotMemory, message: Message, _config: AutopilotConfig) -> Result:
    return take_log_request(memory, message, station.logs)


def _file(station: GroundStation, memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    own = station.files(config.firmware.parameters.table, memory.tuning.values)
    return take_ftp(memory, message, own, station.ftp, station.logs)


def _logging_ack(_: GroundStation, memory: AutopilotMemory, message: Message, _config: AutopilotConfig) -> Result:
    return take_logging_ack(memory, message)


_SERVICES: Mapping[int, _Service] = MappingProxyType(
    dict.fromkeys(MESSAGE_IDS, _plan)
    | dict.fromkeys(LOG_IDS, _log)
    | {
        mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: _file,
        mavlink.MAVLINK_MSG_ID_LOGGING_ACK: _logging_ack,
    }
)
HANDLED = frozenset(_SERVICES)
"""The ids of the messages that every firmware's services handle."""
