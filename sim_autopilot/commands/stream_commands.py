"""The commands about messages: at which rate they stream, and to send one now."""

from link.mavlink.dialect import mavlink
from link.records import replace
from sim_autopilot.commands.requests import ACCEPTED, Answer, Request
from sim_autopilot.core.streams import Stream, with_interval
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory, with_link
from sim_autopilot.telemetry.builders import build_message, stream_of
from sim_autopilot.telemetry.versions import PROTOCOL_VERSION

_DEFAULT_RATE = 0
_STOP = -1


def set_interval(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Set the rate of a stream of the link at hand."""
    if request.number(1) in config.firmware.streams.silent:
        return Answer(memory=memory, result=ACCEPTED)
    stream, interval_us = _stream(request.number(1), config), request.number(2)
    if stream is None or stream.fixed or interval_us is None or interval_us < _STOP:
        return Answer(memory=memory, result=config.firmware.commands.results.no_such_stream)
    link, interval_ns = memory.links.here, _interval_ns(stream, interval_us, config)
    streams = with_interval(link.streams, stream.message_id, interval_ns, memory.now.boot_ns)
    return Answer(memory=with_link(memory, replace(link, streams=streams)), result=ACCEPTED)


def _interval_ns(stream: Stream, interval_us: int, config: AutopilotConfig) -> int | None:
    if interval_us == _STOP or (interval_us == _DEFAULT_RATE and stream.rate_hz <= 0.0):
        return None
    if interval_us == _DEFAULT_RATE:
        return round(1e9 / stream.rate_hz)
    return max(interval_us * 1000, round(1e9 / config.firmware.streams.rate_max_hz))


def get_interval(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Tell the rate of a stream."""
    stream = _stream(request.number(1), config)
    if stream is None:
        return Answer(memory=memory, result=config.firmware.commands.results.no_such_stream)
    interval_ns = memory.links.here.streams.interval_ns.get(stream.message_id)
    interval_us = _STOP if interval_ns is None else min(interval_ns // 1000, 2**31 - 1)
    message = mavlink.MAVLink_message_interval_message(stream.message_id, interval_us)
    return Answer(memory=memory, result=ACCEPTED, messages=(message,))


def request_message(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Send a message now."""
    rules = config.firmware.streams
    if rules.answers_silent and request.number(1) in rules.silent:
        return Answer(memory=memory, result=ACCEPTED)
    stream = _stream(request.number(1), config)
    if stream is None:
        return Answer(memory=memory, result=config.firmware.commands.results.no_such_message)
    message = build_message(stream, memory, config)
    return Answer(memory=memory, result=ACCEPTED, messages=() if message is None else (message,))


def request_version(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Send AUTOPILOT_VERSION now."""
    version = replace(request, parameters=(float(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),))
    return request_message(memory, version, config)


def request_protocol(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Send PROTOCOL_VERSION now."""
    version = replace(request, parameters=(float(PROTOCOL_VERSION),))
    return request_message(memory, version, config)


def request_flight(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Send FLIGHT_INFORMATION now."""
    flight = replace(request, parameters=(float(mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION),))
    return request_message(memory, flight, config)


def _stream(message_id: int | None, config: AutopilotConfig) -> Stream | None:
    return None if message_id is None else stream_of(message_id, config)
