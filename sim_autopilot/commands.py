"""COMMAND_LONG and COMMAND_INT: what each does, and how it is answered.

Source: MAVLink command protocol, https://mavlink.io/en/services/command.html; results as PX4 was seen to give them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import isfinite
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.arming import arm, arming_obstacle, disarm, may_fly_setpoints
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, Later
from sim_autopilot.mode_change import change_mode
from sim_autopilot.modes import ASK_FOR, Mode
from sim_autopilot.streams import Stream, with_interval
from sim_autopilot.telemetry import build_message

ACCEPTED = int(mavlink.MAV_RESULT_ACCEPTED)
UNSUPPORTED = int(mavlink.MAV_RESULT_UNSUPPORTED)
_FORCE = 21196
_SECOND_ANSWER_NS = 20_000_000
"""A command is obeyed at the beginning of its step: one step later than its own acknowledgement, 10 ms."""
_DEFAULT_RATE = 0
_STOP = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """A command, who sent it, and its seven parameters; one that is not finite counts as not given."""

    command: int
    parameters: tuple[float, ...]
    system: int
    component: int

    def number(self, position: int) -> int | None:
        """Return parameter `position` (1 to 7) as a whole number, None where it is not finite."""
        value = self.parameters[position - 1]
        return round(value) if isfinite(value) else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a command leads to: the result, and what is sent besides the acknowledgement."""

    memory: AutopilotMemory
    result: int
    messages: tuple[Message, ...] = ()
    text: str | None = None


Handler = Callable[[AutopilotMemory, Request, AutopilotConfig], Answer]


def request_from_message(message: Message) -> Request:
    """Return what a COMMAND_LONG or COMMAND_INT asks."""
    last = (message.x, message.y, message.z) if message.get_type() == "COMMAND_INT" else _long_tail(message)
    return Request(
        command=message.command,
        parameters=(message.param1, message.param2, message.param3, message.param4, *last),
        system=message.get_srcSystem(),
        component=message.get_srcComponent(),
    )


def is_for_us(message: Message, config: AutopilotConfig) -> bool:
    """Return whether a command concerns this autopilot; others are not answered at all."""
    if message.target_system != config.system_id:
        return False
    ours = (mavlink.MAV_COMP_ID_AUTOPILOT1, mavlink.MAV_COMP_ID_ALL)
    return config.firmware.answers_other_components or message.target_component in ours


def obey(
    memory: AutopilotMemory, request: Request, config: AutopilotConfig
) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Return the memory after a command, and the messages that answer it."""
    handler = _HANDLERS.get(request.command)
    if handler is None:
        return memory, (_acknowledgement(request, UNSUPPORTED),)
    answer = handler(memory, request, config)
    texts = (_status_text(answer.text),) if answer.text and memory.ground_station else ()
    return answer.memory, (_acknowledgement(request, answer.result), *answer.messages, *texts)


def _acknowledgement(request: Request, result: int) -> Message:
    return mavlink.MAVLink_command_ack_message(
        request.command, result, 0, 0, target_system=request.system, target_component=request.component
    )


def _status_text(text: str) -> Message:
    return mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_WARNING, text.encode()[:50])


def _long_tail(message: Message) -> tuple[float, float, float]:
    return (message.param5, message.param6, message.param7)


def _arm_disarm(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    wanted, forced = request.number(1), request.number(2) == _FORCE
    if wanted == 1:
        obstacle = None if forced or memory.armed_ns is not None else arming_obstacle(memory, config)
        if obstacle is not None:
            refused = config.firmware.results.arm_refused
            return Answer(memory=memory, result=refused, text=f"Arming refused: {obstacle}")
        return Answer(memory=arm(memory), result=ACCEPTED)
    if wanted != 0:
        return Answer(memory=memory, result=UNSUPPORTED)
    if memory.armed_ns is not None and not memory.landing.landed and not forced:
        refused = config.firmware.results.disarm_in_the_air
        return Answer(memory=memory, result=refused, text="Disarming refused: not landed")
    return Answer(memory=disarm(memory), result=ACCEPTED)


def _set_mode(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    wanted = (request.number(2), request.number(3))
    mode = next((mode for mode, code in config.firmware.modes.items() if code.request == wanted), None)
    if mode is None:
        return Answer(memory=memory, result=ACCEPTED)
    memory, result = _try_mode(memory, mode, config)
    if not config.firmware.mode_answered_twice:
        return Answer(memory=memory, result=result)
    second = Later(boot_ns=memory.now.boot_ns + _SECOND_ANSWER_NS, message=_acknowledgement(request, result))
    return Answer(memory=replace(memory, later=(*memory.later, second)), result=ACCEPTED)


def _try_mode(memory: AutopilotMemory, mode: Mode, config: AutopilotConfig) -> tuple[AutopilotMemory, int]:
    if mode is Mode.OFFBOARD and not may_fly_setpoints(memory, config):
        return memory, config.firmware.results.mode_refused
    return change_mode(memory, ASK_FOR[mode]), ACCEPTED


def _mode_command(mode: Mode) -> Handler:
    def handle(memory: AutopilotMemory, _request: Request, config: AutopilotConfig) -> Answer:
        memory, result = _try_mode(memory, mode, config)
        return Answer(memory=memory, result=result)

    return handle


def _take_off(memory: AutopilotMemory, _request: Request, config: AutopilotConfig) -> Answer:
    if memory.armed_ns is None:
        return Answer(memory=memory, result=ACCEPTED)
    memory, result = _try_mode(memory, Mode.TAKEOFF, config)
    return Answer(memory=memory, result=result)


def _set_interval(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    stream, interval_us = _stream(request.number(1), config), request.number(2)
    if stream is None or interval_us is None or interval_us < _STOP:
        return Answer(memory=memory, result=config.firmware.results.no_such_stream)
    boot_ns = memory.now.boot_ns
    streams = with_interval(memory.streams, stream.message_id, _interval_ns(stream, interval_us, config), boot_ns)
    return Answer(memory=replace(memory, streams=streams), result=ACCEPTED)


def _interval_ns(stream: Stream, interval_us: int, config: AutopilotConfig) -> int | None:
    if interval_us == _STOP or (interval_us == _DEFAULT_RATE and stream.rate_hz <= 0.0):
        return None
    if interval_us == _DEFAULT_RATE:
        return round(1e9 / stream.rate_hz)
    return max(interval_us * 1000, round(1e9 / config.firmware.stream_rate_max_hz))


def _get_interval(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    stream = _stream(request.number(1), config)
    if stream is None:
        return Answer(memory=memory, result=config.firmware.results.no_such_stream)
    interval_ns = memory.streams.interval_ns.get(stream.message_id)
    interval_us = _STOP if interval_ns is None else min(interval_ns // 1000, 2**31 - 1)
    message = mavlink.MAVLink_message_interval_message(stream.message_id, interval_us)
    return Answer(memory=memory, result=ACCEPTED, messages=(message,))


def _request_message(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    stream = _stream(request.number(1), config)
    if stream is None:
        return Answer(memory=memory, result=config.firmware.results.no_such_message)
    message = build_message(stream, memory, config)
    return Answer(memory=memory, result=ACCEPTED, messages=() if message is None else (message,))


def _request_version(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    version = replace(request, parameters=(float(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),))
    return _request_message(memory, version, config)


def _stream(message_id: int | None, config: AutopilotConfig) -> Stream | None:
    return None if message_id is None else config.firmware.streams.get(message_id)


_HANDLERS: Mapping[int, Handler] = MappingProxyType(
    {
        mavlink.MAV_CMD_COMPONENT_ARM_DISARM: _arm_disarm,
        mavlink.MAV_CMD_DO_SET_MODE: _set_mode,
        mavlink.MAV_CMD_NAV_TAKEOFF: _take_off,
        mavlink.MAV_CMD_NAV_LAND: _mode_command(Mode.LAND),
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: _mode_command(Mode.RTL),
        mavlink.MAV_CMD_NAV_LOITER_UNLIM: _mode_command(Mode.HOLD),
        mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: _set_interval,
        mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: _get_interval,
        mavlink.MAV_CMD_REQUEST_MESSAGE: _request_message,
        mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: _request_version,
    }
)
