"""COMMAND_LONG and COMMAND_INT: what each does, and how it is answered.

Source: MAVLink command protocol, https://mavlink.io/en/services/command.html; results as PX4 was seen to give them.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.commands.calibration import calibrate
from sim_autopilot.commands.copter_commands import pause_or_resume, set_servo, switch_fence, turn
from sim_autopilot.commands.copter_services import format_storage, reset_parameters, spin_motor
from sim_autopilot.commands.gripper_command import grip
from sim_autopilot.commands.mode_request import loiter, mode_command, try_mode
from sim_autopilot.commands.place_commands import (
    change_altitude,
    change_speed,
    circle,
    go_there,
    set_home,
    take_off,
)
from sim_autopilot.commands.reboot import reboot
from sim_autopilot.commands.stream_commands import (
    get_interval,
    request_flight,
    request_message,
    request_protocol,
    request_version,
    set_interval,
)
from sim_autopilot.flight.modes import Mode
from sim_autopilot.log_stream_step import start_log_stream, stop_log_stream
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, Later
from sim_autopilot.missions.step import mission_current, mission_items, set_current
from sim_autopilot.requests import ACCEPTED, DENIED, UNSUPPORTED, Answer, Handler, Request, acknowledgement
from sim_autopilot.safety.arming import arm, arming_obstacle, disarm
from sim_autopilot.safety.failures import injected, is_refused
from sim_autopilot.telemetry.arming_report import report_arming
from sim_autopilot.telemetry.events import tell

_FORCE = 21196
_SECOND_ANSWER_NS = 20_000_000
"""A command is obeyed at the beginning of its step: one step later than its own acknowledgement, 10 ms."""


def obey(
    memory: AutopilotMemory, request: Request, config: AutopilotConfig
) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Return the memory after a command, and the messages that answer it."""
    firmware = config.firmware
    handler = None if request.command in firmware.plain_answers else _HANDLERS.get(request.command)
    if handler is None:
        result = firmware.plain_answers.get(request.command, UNSUPPORTED)
        return memory, () if result is None else (acknowledgement(request, result),)
    answer = handler(memory, request, config)
    severity = config.firmware.texts.severity
    telling = tell(answer.memory, answer.text, severity, config) if answer.text else None
    told = () if answer.result is None else (acknowledgement(request, answer.result),)
    if telling is None:
        return answer.memory, (*told, *answer.messages)
    return telling.memory, (*told, *answer.messages, *telling.messages)


def _arm_disarm(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    exact = config.firmware.guided and request.parameters[0] not in {0.0, 1.0}
    wanted, forced = None if exact else request.number(1), request.number(2) == _FORCE
    if wanted == 1:
        obstacle = None if forced or memory.armed_ns is not None else arming_obstacle(memory, config)
        if obstacle is not None:
            refused = config.firmware.results.arm_refused
            return Answer(memory=memory, result=refused, text=obstacle)
        return Answer(memory=arm(memory), result=ACCEPTED)
    if wanted != 0:
        if config.firmware.guided:
            return Answer(memory=memory, result=UNSUPPORTED)
        return Answer(memory=memory, result=None, text=f"Unsupported ARM_DISARM param: {request.parameters[0]:.3f}\t")
    if memory.armed_ns is not None and not memory.landing.landed and not forced:
        refused = config.firmware.results.disarm_in_the_air
        return Answer(memory=memory, result=refused, text=config.firmware.texts.disarm_refused)
    return Answer(memory=disarm(memory), result=ACCEPTED)


def _set_mode(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    wanted = (request.number(2), request.number(3))
    modes = config.firmware.modes
    mode = next((mode for mode, code in modes.items() if code.request == wanted[: len(code.request)]), None)
    base = (request.number(1) or 0) & 0xFF
    if not base & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
        if config.firmware.guided:
            return Answer(memory=memory, result=DENIED)
        mode = _mode_of_flags(base)
    if mode is None:
        said = config.firmware.texts.no_such_mode.format(wanted[0])
        return Answer(memory=memory, result=config.firmware.results.no_such_mode, text=said or None)
    memory, result = try_mode(memory, mode, config)
    if not config.firmware.mode_answered_twice:
        return Answer(memory=memory, result=result)
    second = Later(boot_ns=memory.now.boot_ns + _SECOND_ANSWER_NS, message=acknowledgement(request, result))
    return Answer(memory=replace(memory, later=(*memory.later, second)), result=ACCEPTED)


def _mode_of_flags(base: int) -> Mode | None:
    """Return the mode that the MAV_MODE_FLAGs of a client without custom modes ask PX4 for."""
    if base & mavlink.MAV_MODE_FLAG_AUTO_ENABLED:
        return Mode.MISSION
    if not base & mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED:
        return None
    if base & mavlink.MAV_MODE_FLAG_GUIDED_ENABLED:
        return Mode.POSITION
    return Mode.STABILIZED if base & mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED else Mode.MANUAL


def _inject_failure(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    if not memory.settings.takes_failures:
        return Answer(memory=memory, result=UNSUPPORTED)
    unit, kind, instance = request.number(1), request.number(2), request.number(3)
    services = memory.services
    unit, kind = unit or 0, -1 if kind is None else kind
    failures = injected(services.failures, unit, kind, instance or 0)
    if failures is None:
        return Answer(memory=memory, result=UNSUPPORTED if is_refused(unit, kind) else None)
    return Answer(memory=replace(memory, services=replace(services, failures=failures)), result=ACCEPTED)


def _start_mission(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    if not mission_items(memory) and config.firmware.missions.arms_to_start:
        return Answer(memory=memory, result=DENIED, text=config.firmware.texts.no_mission)
    refused = config.firmware.results.mode_refused
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


def _set_mission_current(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    index = request.number(1)
    sent = None if index is None else set_current(memory, index)
    if sent is None:
        return Answer(memory=memory, result=DENIED)
    return Answer(memory=sent, result=ACCEPTED, messages=(mission_current(sent, config),))


def _pause_or_continue(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    wanted = {0: Mode.HOLD, 1: Mode.MISSION}.get(request.number(1) or 0)
    if wanted is not None and config.firmware.guided:
        return pause_or_resume(memory, pauses=wanted is Mode.HOLD, refused=config.firmware.results.mode_refused)
    if wanted is None:
        return Answer(memory=memory, result=DENIED)
    memory, result = try_mode(memory, wanted, config)
    return Answer(memory=memory, result=result)


def _terminate(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Stop the motors wherever the drone is; a real PX4 lets nobody arm after that, here a new flight is possible."""
    if request.number(1) != 1:
        return Answer(memory=memory, result=config.firmware.results.reboot_refused)
    return Answer(memory=disarm(memory), result=ACCEPTED)


def _tell_home(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    number = float(mavlink.MAVLINK_MSG_ID_HOME_POSITION)
    return request_message(memory, replace(request, parameters=(number,)), config)


_HANDLERS: Mapping[int, Handler] = MappingProxyType(
    {
        mavlink.MAV_CMD_COMPONENT_ARM_DISARM: _arm_disarm,
        mavlink.MAV_CMD_DO_SET_MODE: _set_mode,
        mavlink.MAV_CMD_NAV_TAKEOFF: take_off,
        mavlink.MAV_CMD_NAV_LAND: mode_command(Mode.LAND),
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: mode_command(Mode.RTL),
        mavlink.MAV_CMD_NAV_LOITER_UNLIM: loiter,
        mavlink.MAV_CMD_INJECT_FAILURE: _inject_failure,
        mavlink.MAV_CMD_DO_REPOSITION: go_there,
        mavlink.MAV_CMD_DO_CHANGE_SPEED: change_speed,
        mavlink.MAV_CMD_DO_CHANGE_ALTITUDE: change_altitude,
        mavlink.MAV_CMD_DO_ORBIT: circle,
        mavlink.MAV_CMD_DO_SET_HOME: set_home,
        mavlink.MAV_CMD_GET_HOME_POSITION: _tell_home,
        mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: reboot,
        mavlink.MAV_CMD_DO_FLIGHTTERMINATION: _terminate,
        mavlink.MAV_CMD_RUN_PREARM_CHECKS: report_arming,
        mavlink.MAV_CMD_MISSION_START: _start_mission,
        mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: _set_mission_current,
        mavlink.MAV_CMD_DO_PAUSE_CONTINUE: _pause_or_continue,
        mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: set_interval,
        mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: get_interval,
        mavlink.MAV_CMD_REQUEST_MESSAGE: request_message,
        mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: request_version,
        mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION: request_protocol,
        mavlink.MAV_CMD_REQUEST_FLIGHT_INFORMATION: request_flight,
        mavlink.MAV_CMD_LOGGING_START: start_log_stream,
        mavlink.MAV_CMD_LOGGING_STOP: stop_log_stream,
        mavlink.MAV_CMD_DO_GRIPPER: grip,
        mavlink.MAV_CMD_PREFLIGHT_CALIBRATION: calibrate,
        mavlink.MAV_CMD_CONDITION_YAW: turn,
        mavlink.MAV_CMD_DO_FENCE_ENABLE: switch_fence,
        mavlink.MAV_CMD_DO_SET_SERVO: set_servo,
        mavlink.MAV_CMD_DO_REPEAT_SERVO: set_servo,
        mavlink.MAV_CMD_DO_MOTOR_TEST: spin_motor,
        mavlink.MAV_CMD_PREFLIGHT_STORAGE: reset_parameters,
        mavlink.MAV_CMD_STORAGE_FORMAT: format_storage,
    }
)
