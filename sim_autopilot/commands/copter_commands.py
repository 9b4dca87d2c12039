"""Commands that ArduCopter alone obeys, or in its own way: to turn the nose, to pause, and to switch the fence.

Source: ArduCopter's documentation of MAV_CMD_CONDITION_YAW, MAV_CMD_DO_PAUSE_CONTINUE and MAV_CMD_DO_FENCE_ENABLE.
"""

from dataclasses import replace
from math import pi, radians

from sim_autopilot.commands.incoming_parameters import with_value
from sim_autopilot.flight.modes import Mode
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.requests import ACCEPTED, Answer, Request
from sim_autopilot.setpoints.guided import with_heading, with_wish
from sim_autopilot.setpoints.guided_setpoint import STOP

_FULL_TURN_DEG = 360.0
_HEIGHT, _CIRCLE, _AREAS = 1, 2, 4
_MOTORS, _OUTPUTS = range(1, 5), range(5, 17)
_OFF, _ON, _LOWEST_OFF = 0, 1, 2


def turn(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Turn the nose to a heading, or by an angle; another mode than GUIDED accepts it and flies on."""
    angle_deg, _, direction, relative = request.parameters[:4]
    if not 0.0 <= angle_deg <= _FULL_TURN_DEG or relative not in {0.0, 1.0}:
        return Answer(memory=memory, result=config.firmware.results.mode_refused)
    if memory.modes.mode is not Mode.OFFBOARD or memory.armed_ns is None:
        return Answer(memory=memory, result=ACCEPTED)
    clockwise_rad = radians(angle_deg) * (-1.0 if direction < 0.0 else 1.0)
    heading_rad = memory.now.yaw_rad - clockwise_rad if relative else pi / 2.0 - radians(angle_deg)
    return Answer(memory=replace(memory, guided=with_heading(memory.guided, heading_rad)), result=ACCEPTED)


def set_servo(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Take an order for an output that no motor is at; nothing is moved by those here."""
    output = request.number(1)
    if output is not None and output in _MOTORS:
        refused = config.firmware.results.mode_refused
        return Answer(memory=memory, result=refused, text=f"ServoRelayEvent: Channel {output} is already in use")
    free = output is not None and output in _OUTPUTS
    return Answer(memory=memory, result=ACCEPTED if free else config.firmware.results.mode_refused)


def pause_or_resume(memory: AutopilotMemory, *, pauses: bool, refused: int) -> Answer:
    """Stop in GUIDED, or go on with what AUTO does or with nothing in GUIDED; other modes have nothing to pause.

    A pause of AUTO, which the real one has, is refused here.
    """
    mode = memory.modes.mode
    if mode is Mode.OFFBOARD and pauses:
        return Answer(memory=replace(memory, guided=with_wish(memory.guided, STOP, memory.now)), result=ACCEPTED)
    if mode in {Mode.OFFBOARD, Mode.MISSION} and not pauses:
        return Answer(memory=memory, result=ACCEPTED)
    return Answer(memory=memory, result=refused, text="Failed to pause" if pauses else "Failed to resume")


def switch_fence(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Switch the fence on or off, as FENCE_ENABLE does; without a fence it cannot be switched on."""
    wanted = request.number(1)
    if wanted == _LOWEST_OFF:
        return Answer(memory=memory, result=ACCEPTED)  # there is no lowest fence
    kinds = int(memory.values["FENCE_TYPE"])
    present = kinds & (_HEIGHT | _CIRCLE) or (kinds & _AREAS and memory.services.fence)
    if wanted not in {_OFF, _ON} or (wanted == _ON and not present):
        return Answer(memory=memory, result=config.firmware.results.mode_refused)
    return Answer(memory=with_value(memory, "FENCE_ENABLE", float(wanted), config), result=ACCEPTED)
