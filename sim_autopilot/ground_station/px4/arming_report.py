"""PX4's report on health and arming, as MAV_CMD_RUN_PREARM_CHECKS asks for it: two events with a bit for each mode.

Source: MAVLink events interface, and PX4's HealthAndArmingChecks, whose layout of the arguments it is.
"""

import struct
from collections.abc import Iterable

from link.mavlink.dialect import Message
from link.records import replace
from sim_autopilot.commands.requests import ACCEPTED, Answer, Request
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.status_texts import EventCode
from sim_autopilot.flight.manual import MANUAL_MODES, sticks_in_effect
from sim_autopilot.ground_station.px4.health_bits import (
    ARMING_SUMMARY,
    COMPONENTS,
    HEALTH_SUMMARY,
    MODE_STATES,
    PROTOCOL,
)
from sim_autopilot.interfaces import AutopilotConfig, has_passed
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.safety.arming import arming_obstacle
from sim_autopilot.telemetry.events import tell

_CHUNK = 0
_BATTERY = 11
_ESTIMATES = (17, 24)


def report_arming(memory: AutopilotMemory, _request: Request, config: AutopilotConfig) -> Answer:
    """Tell in which modes it arms and flies, and which of its parts are well."""
    can_arm = _bits(mode for mode in MODE_STATES if _arms(memory, mode, config))
    can_run = _bits(mode for mode in MODE_STATES if _runs(memory, mode, config))
    present = sum(1 << number for number in COMPONENTS if number)
    wrong = _errors(memory, config)
    summary = struct.pack("<BIIII", _CHUNK, wrong, 0, can_arm, can_run)
    health = struct.pack("<BIII", _CHUNK, present, wrong, 0)
    messages: list[Message] = []
    for name, arguments in ((ARMING_SUMMARY, summary), (HEALTH_SUMMARY, health)):
        code = EventCode(name=name, levels=PROTOCOL, arguments=arguments, said="")
        telling = tell(memory, "", config.firmware.texts.severity, config, code)
        memory = telling.memory
        messages += telling.messages
    return Answer(memory=memory, result=ACCEPTED, messages=tuple(messages))


def _bits(modes: Iterable[Mode]) -> int:
    return sum(1 << MODE_STATES[mode][0] for mode in modes)


def _arms(memory: AutopilotMemory, mode: Mode, config: AutopilotConfig) -> bool:
    there = replace(memory, modes=replace(memory.modes, mode=mode, intended=mode))
    return arming_obstacle(there, config) is None


def _runs(memory: AutopilotMemory, mode: Mode, config: AutopilotConfig) -> bool:
    if mode in MANUAL_MODES:
        return sticks_in_effect(memory.heard.sticks, memory.now.boot_ns, memory.tuning.settings.sticks) is not None
    if mode is Mode.OFFBOARD:
        return config.firmware.setpoints.may_begin(memory)
    flies = mode is not Mode.MISSION or bool(memory.mission.items)
    return flies and has_passed(config, memory, config.firmware.condition.readiness.position_s)


def _errors(memory: AutopilotMemory, config: AutopilotConfig) -> int:
    lost = () if has_passed(config, memory, config.firmware.condition.readiness.position_s) else _ESTIMATES
    empty = (_BATTERY,) if memory.safety.failures.battery else ()
    return sum(1 << number for number in (*lost, *empty))
