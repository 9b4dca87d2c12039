"""Asking for a mode, as operators do: refused where the firmware refuses, and remembered for when the motors stop."""

from link.records import replace
from sim_autopilot.commands.requests import ACCEPTED, Answer, Request
from sim_autopilot.core.modes import ASK_FOR, Mode
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.interfaces import AutopilotConfig, Handler
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.missions.step import begin_mission


def try_mode(memory: AutopilotMemory, mode: Mode, config: AutopilotConfig) -> tuple[AutopilotMemory, int]:
    """Return the memory in `mode`, or as it was, and the MAV_RESULT."""
    firmware = config.firmware
    stale = mode is Mode.OFFBOARD and memory.armed_ns is not None and not firmware.setpoints.may_begin(memory)
    if stale or mode not in firmware.modes.codes:
        return memory, firmware.commands.results.mode_refused
    if mode is Mode.MISSION:
        if not memory.mission.items and memory.armed_ns is not None:
            return memory, firmware.commands.results.mode_refused
        memory = begin_mission(memory, config)
    memory = change_mode(memory, ASK_FOR[mode])
    if firmware.modes.leaves_landing and mode not in firmware.modes.unarmable:
        memory = replace(memory, modes=replace(memory.modes, resting=mode))
    return memory, ACCEPTED


def mode_command(mode: Mode) -> Handler:
    """Return the handler of a command that asks for `mode`."""

    def handle(memory: AutopilotMemory, _request: Request, config: AutopilotConfig) -> Answer:
        memory, result = try_mode(memory, mode, config)
        said = config.firmware.texts.obeyed.get(mode) if result == ACCEPTED else None
        return Answer(memory=memory, result=result, text=said)

    return handle


def loiter(memory: AutopilotMemory, _request: Request, config: AutopilotConfig) -> Answer:
    """Ask for the mode that NAV_LOITER_UNLIM means."""
    memory, result = try_mode(memory, config.firmware.modes.loiter, config)
    return Answer(memory=memory, result=result)
