"""Log streaming in the autopilot's step: the commands that begin and end it, acknowledgements, and what is sent."""

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.requests import ACCEPTED, UNSUPPORTED, Answer, Request, acknowledgement
from sim_autopilot.ground_station.files_and_logs import log_row
from sim_autopilot.ground_station.logs.flight_log import LogRules
from sim_autopilot.ground_station.logs.log_stream import (
    LogStream,
    begun_stream,
    stream_on,
    wants_row,
    with_acknowledged,
    with_row,
)
from sim_autopilot.ground_station.memory import station_of, with_station
from sim_autopilot.interfaces import AutopilotConfig, Handler
from sim_autopilot.memory import AutopilotMemory

_REJECTED = int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
_IN_PROGRESS = int(mavlink.MAV_RESULT_IN_PROGRESS)
_ULOG = 0

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def start_log_stream(rules: LogRules) -> Handler:
    """Return the handler of LOGGING_START: it streams a log to whoever asks, made as `rules` say."""

    def start(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
        stream = station_of(memory).log_stream
        if stream is not None:  # while its head is on the way PX4's logger answers nobody
            return Answer(memory=memory, result=None if stream.head else _REJECTED)
        if request.number(1) != _ULOG:
            return Answer(memory=memory, result=UNSUPPORTED)
        head = rules.head(log_row(memory, config))
        begun = begun_stream(head, memory.links.at_hand, (request.system, request.component))
        return Answer(memory=_with_stream(memory, begun), result=ACCEPTED)

    return start


def stop_log_stream(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """End the stream, if there is one."""
    stream = station_of(memory).log_stream
    if stream is None:
        return Answer(memory=memory, result=ACCEPTED)
    if stream.head:
        return Answer(memory=memory, result=None)
    told = (acknowledgement(request, _IN_PROGRESS), acknowledgement(request, ACCEPTED))
    return Answer(memory=_with_stream(memory, None), result=None, messages=told)


def take_logging_ack(memory: AutopilotMemory, message: Message) -> Result:
    """Return the memory after a client's LOGGING_ACK."""
    stream = station_of(memory).log_stream
    if stream is None:
        return memory, ()
    return _with_stream(memory, with_acknowledged(stream, message.sequence)), ()


def stream_log(memory: AutopilotMemory, config: AutopilotConfig, rules: LogRules) -> Result:
    """Return the memory one step on, and what of a stream goes on the link at hand now."""
    stream = station_of(memory).log_stream
    if stream is None or stream.link != memory.links.at_hand:
        return memory, ()
    boot_ns = memory.now.boot_ns
    if wants_row(stream, boot_ns):
        stream = with_row(stream, rules.row(log_row(memory, config)), boot_ns)
    rest, messages = stream_on(stream, boot_ns)
    return _with_stream(memory, rest), messages


def _with_stream(memory: AutopilotMemory, stream: LogStream | None) -> AutopilotMemory:
    return with_station(memory, replace(station_of(memory), log_stream=stream))
