"""Log streaming in the autopilot's step: the commands that begin and end it, acknowledgements, and what is sent."""

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.files.log_stream import LogStream, begun_stream, streamed, wants_row, with_acknowledged, with_row
from sim_autopilot.files_step import log_row
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.requests import ACCEPTED, UNSUPPORTED, Answer, Request, acknowledgement, is_ours

_REJECTED = int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
_IN_PROGRESS = int(mavlink.MAV_RESULT_IN_PROGRESS)
_ULOG = 0

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def start_log_stream(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Begin to stream a log to whoever asks; while its head is on the way PX4's logger answers nobody."""
    stream = memory.services.log_stream
    if stream is not None:
        return Answer(memory=memory, result=None if stream.head else _REJECTED)
    if request.number(1) != _ULOG:
        return Answer(memory=memory, result=UNSUPPORTED)
    head = config.firmware.logs.head(log_row(memory, config))
    begun = begun_stream(head, memory.link, (request.system, request.component))
    return Answer(memory=_with_stream(memory, begun), result=ACCEPTED)


def stop_log_stream(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """End the stream, if there is one."""
    stream = memory.services.log_stream
    if stream is None:
        return Answer(memory=memory, result=ACCEPTED)
    if stream.head:
        return Answer(memory=memory, result=None)
    told = (acknowledgement(request, _IN_PROGRESS), acknowledgement(request, ACCEPTED))
    return Answer(memory=_with_stream(memory, None), result=None, messages=told)


def take_logging_ack(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after a client's LOGGING_ACK."""
    stream = memory.services.log_stream
    if stream is None or not is_ours(message, config):
        return memory, ()
    return _with_stream(memory, with_acknowledged(stream, message.sequence)), ()


def stream_log(memory: AutopilotMemory, config: AutopilotConfig) -> Result:
    """Return the memory one step on, and what of a stream goes on the link at hand now."""
    stream = memory.services.log_stream
    if stream is None or stream.link != memory.link:
        return memory, ()
    boot_ns = memory.now.boot_ns
    if wants_row(stream, boot_ns):
        stream = with_row(stream, config.firmware.logs.row(log_row(memory, config)), boot_ns)
    rest, messages = streamed(stream, boot_ns)
    return _with_stream(memory, rest), messages


def _with_stream(memory: AutopilotMemory, stream: LogStream | None) -> AutopilotMemory:
    return replace(memory, services=replace(memory.services, log_stream=stream))
