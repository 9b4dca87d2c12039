"""COMMAND_LONG and COMMAND_INT: how they are answered, and what those do that every firmware has.

Source: MAVLink command protocol, https://mavlink.io/en/services/command.html; results as PX4 was seen to give them.
"""

from collections.abc import Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.mode_request import loiter, mode_command, try_mode
from sim_autopilot.commands.place_commands import set_home
from sim_autopilot.commands.requests import (
    ACCEPTED,
    DENIED,
    UNSUPPORTED,
    Answer,
    Request,
    acknowledgement,
    request_from_message,
)
from sim_autopilot.commands.stream_commands import get_interval, request_message, request_version, set_interval
from sim_autopilot.core.links import Later
from sim_autopilot.core.modes import Mode
from sim_autopilot.interfaces import AutopilotConfig, Handler
from sim_autopilot.memory import AutopilotMemory, with_later
from sim_autopilot.missions.step import set_current
from sim_autopilot.safety.arming import arm, arming_obstacle, disarm
from sim_autopilot.telemetry.events import tell

_FORCE = 21196
_SECOND_ANSWER_NS = 20_000_000
"""A command is obeyed at the beginning of its step: one step later than its own acknowledgement, 10 ms."""
_NOTHING, _REBOOT, _TO_BOOTLOADER = 0, 1, 3
_REBOOTS_ARMED = 20190226
_REBOOT_AFTER_NS = 300_000_000
"""From the acknowledgement until it stops."""

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def obey(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after a command for this autopilot, and the messages that answer it."""
    request = request_from_message(message)
    handler = config.firmware.commands.handlers.get(request.command)
    if handler is None:
        return memory, (acknowledgement(request, UNSUPPORTED),)
    return answer_command(handler(memory, request, config), request, config)


def answer_command(answer: Answer, request: Request, config: AutopilotConfig) -> Result:
    """Return the memory after a command that a handler has obeyed, and its acknowledgement with what else is sent.

    What is said about it is for everybody: it waits for the end of the step, when texts go to all links.
    """
    severity = config.firmware.texts.severity
    told = () if answer.result is None else (acknowledgement(request, answer.result),)
    if not answer.text:
        return answer.memory, (*told, *answer.messages)
    telling = tell(answer.memory, answer.text, severity, config)
    said = (Later(boot_ns=answer.memory.now.boot_ns, message=message) for message in telling.messages)
    return with_later(telling.memory, *said), (*told, *answer.messages)


def _arm_disarm(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    neither = config.firmware.texts.neither_arms_nor_disarms
    unclear = neither is None and request.parameters[0] not in {0.0, 1.0}
    wanted, forced = None if unclear else request.number(1), request.number(2) == _FORCE
    if wanted == 1:
        obstacle = None if forced or memory.armed_ns is not None else arming_obstacle(memory, config)
        if obstacle is not None:
            refused = config.firmware.commands.results.arm_refused
            return Answer(memory=memory, result=refused, text=obstacle)
        return Answer(memory=arm(memory), result=ACCEPTED)
    if wanted != 0:
        if neither is None:
            return Answer(memory=memory, result=UNSUPPORTED)
        return Answer(memory=memory, result=None, text=neither.format(request.parameters[0]))
    if memory.armed_ns is not None and not memory.course.landing.landed and not forced:
        refused = config.firmware.commands.results.disarm_in_the_air
        return Answer(memory=memory, result=refused, text=config.firmware.texts.disarm_refused)
    return Answer(memory=disarm(memory), result=ACCEPTED)


def _set_mode(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    wanted, modes = (request.number(2), request.number(3)), config.firmware.modes
    mode = next((mode for mode, code in modes.codes.items() if code.request == wanted[: len(code.request)]), None)
    base = (request.number(1) or 0) & 0xFF
    if not base & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
        if modes.of_flags is None:
            return Answer(memory=memory, result=DENIED)
        mode = modes.of_flags(base)
    if mode is None:
        said = config.firmware.texts.no_such_mode.format(wanted[0])
        return Answer(memory=memory, result=config.firmware.commands.results.no_such_mode, text=said or None)
    memory, result = try_mode(memory, mode, config)
    if not modes.answered_twice:
        return Answer(memory=memory, result=result)
    second = Later(boot_ns=memory.now.boot_ns + _SECOND_ANSWER_NS, message=acknowledgement(request, result))
    return Answer(memory=with_later(memory, second), result=ACCEPTED)


def _start_mission(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    if not memory.mission.items and config.firmware.missions.arms_to_start:
        return Answer(memory=memory, result=DENIED, text=config.firmware.texts.no_mission)
    refused = config.firmware.commands.results.mode_refused
    first = request.number(1)
    if first is not None and first > 0:
        sent = set_current(memory, first)
        if sent is None:
            return Answer(memory=memory, result=DENIED)
        memory = sent
    started, result = try_mode(memory, Mode.MISSION, config)
    if result != ACCEPTED or started.armed_ns is not None or not config.firmware.missions.arms_to_start:
        return Answer(memory=started, result=result)
    if arming_obstacle(started, config) is not None:
        return Answer(memory=memory, result=refused)
    return Answer(memory=arm(started), result=ACCEPTED)


def _terminate(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Stop the motors wherever the drone is; a real PX4 lets nobody arm after that, here a new flight is possible."""
    if request.number(1) != 1:
        return Answer(memory=memory, result=config.firmware.commands.results.reboot_refused)
    return Answer(memory=disarm(memory), result=ACCEPTED)


def _tell_home(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    number = float(mavlink.MAVLINK_MSG_ID_HOME_POSITION)
    return request_message(memory, replace(request, parameters=(number,)), config)


def _reboot(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Boot again, where the firmware can; what stands in for an autopilot ends when its process is told to."""
    wanted, rules = request.number(1), config.firmware.commands
    if wanted == _NOTHING:
        return Answer(memory=memory, result=ACCEPTED)
    if not rules.reboots or (memory.armed_ns is not None and request.number(6) != _REBOOTS_ARMED):
        return Answer(memory=memory, result=rules.results.reboot_refused)
    if wanted not in {_REBOOT, _TO_BOOTLOADER}:
        return Answer(memory=memory, result=UNSUPPORTED)
    boot = replace(memory.boot, again_ns=memory.now.boot_ns + _REBOOT_AFTER_NS)
    return Answer(memory=replace(memory, boot=boot), result=ACCEPTED)


HANDLERS: Mapping[int, Handler] = MappingProxyType(
    {
        mavlink.MAV_CMD_COMPONENT_ARM_DISARM: _arm_disarm,
        mavlink.MAV_CMD_DO_SET_MODE: _set_mode,
        mavlink.MAV_CMD_NAV_LAND: mode_command(Mode.LAND),
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: mode_command(Mode.RTL),
        mavlink.MAV_CMD_NAV_LOITER_UNLIM: loiter,
        mavlink.MAV_CMD_DO_SET_HOME: set_home,
        mavlink.MAV_CMD_GET_HOME_POSITION: _tell_home,
        mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: _reboot,
        mavlink.MAV_CMD_DO_FLIGHTTERMINATION: _terminate,
        mavlink.MAV_CMD_MISSION_START: _start_mission,
        mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: set_interval,
        mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: get_interval,
        mavlink.MAV_CMD_REQUEST_MESSAGE: request_message,
        mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: request_version,
    }
)
"""Of every firmware, to which each adds its own."""
