"""The commands that ArduCopter obeys in its own way: take-off and places in GUIDED, the nose, a pause, the fence.

Source: ArduCopter's documentation of MAV_CMD_NAV_TAKEOFF, MAV_CMD_CONDITION_YAW, MAV_CMD_DO_PAUSE_CONTINUE and
MAV_CMD_DO_FENCE_ENABLE.
"""

from collections.abc import Mapping
from math import isfinite, pi, radians
from types import MappingProxyType

from link.mavlink.dialect import mavlink
from link.messages import Vector3
from sim_autopilot.commands.commands import HANDLERS
from sim_autopilot.commands.incoming_parameters import with_value
from sim_autopilot.commands.place_commands import go_there
from sim_autopilot.commands.requests import ACCEPTED, DENIED, Answer, Request
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.repositioning import with_speed
from sim_autopilot.interfaces import AutopilotConfig, Handler
from sim_autopilot.memory import AutopilotMemory, with_guided
from sim_autopilot.missions.step import mission_current, set_current
from sim_autopilot.setpoints.guided import (
    with_destination,
    with_guided_speed,
    with_heading,
    with_takeoff,
    with_wish,
)
from sim_autopilot.setpoints.guided_setpoint import STOP

_FULL_TURN_DEG = 360.0
_HEIGHT, _CIRCLE, _AREAS = 1, 2, 4
_OFF, _ON, _LOWEST_OFF = 0, 1, 2
_PAUSES, _GOES_ON = 0, 1


def _take_off(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Take off in GUIDED to a height above home."""
    above_home_m, now = request.parameters[6], memory.now
    height_m = memory.places.home_enu_m[2] + above_home_m
    on_ground = memory.armed_ns is not None and memory.course.landing.landed
    rises = isfinite(above_home_m) and height_m > now.position_enu_m[2]
    if memory.modes.mode is not Mode.OFFBOARD or not on_ground or not rises:
        return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
    guided = with_takeoff(memory.course.guided, height_m, now)
    return Answer(memory=with_guided(memory, guided), result=ACCEPTED)


def _fly_there(memory: AutopilotMemory, place: Vector3, _request: Request) -> AutopilotMemory:
    return with_guided(memory, with_destination(memory.course.guided, place, memory.now))


def _change_speed(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Fly on at another speed."""
    speed_m_s = request.parameters[1]
    right = speed_m_s > 0.0 and isfinite(speed_m_s)
    if not right or memory.modes.mode not in {Mode.OFFBOARD, Mode.MISSION}:
        return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
    memory = with_speed(memory, speed_m_s)
    return Answer(memory=with_guided(memory, with_guided_speed(memory.course.guided, speed_m_s)), result=ACCEPTED)


def _turn(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Turn the nose to a heading, or by an angle; another mode than GUIDED accepts it and flies on."""
    angle_deg, _, direction, relative = request.parameters[:4]
    if not 0.0 <= angle_deg <= _FULL_TURN_DEG or relative not in {0.0, 1.0}:
        return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
    if memory.modes.mode is not Mode.OFFBOARD or memory.armed_ns is None:
        return Answer(memory=memory, result=ACCEPTED)
    clockwise_rad = radians(angle_deg) * (-1.0 if direction < 0.0 else 1.0)
    heading_rad = memory.now.yaw_rad - clockwise_rad if relative else pi / 2.0 - radians(angle_deg)
    return Answer(memory=with_guided(memory, with_heading(memory.course.guided, heading_rad)), result=ACCEPTED)


def _pause_or_resume(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Stop in GUIDED, or go on with what AUTO does or with nothing in GUIDED; other modes have nothing to pause.

    A pause of AUTO, which the real one has, is refused here.
    """
    mode, wanted = memory.modes.mode, request.number(1) or 0
    if wanted not in {_PAUSES, _GOES_ON}:
        return Answer(memory=memory, result=DENIED)
    if mode is Mode.OFFBOARD and wanted == _PAUSES:
        return Answer(memory=with_guided(memory, with_wish(memory.course.guided, STOP, memory.now)), result=ACCEPTED)
    if mode in {Mode.OFFBOARD, Mode.MISSION} and wanted == _GOES_ON:
        return Answer(memory=memory, result=ACCEPTED)
    text = "Failed to pause" if wanted == _PAUSES else "Failed to resume"
    return Answer(memory=memory, result=config.firmware.commands.results.mode_refused, text=text)


def _switch_fence(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Switch the fence on or off, as FENCE_ENABLE does; without a fence it cannot be switched on."""
    wanted = request.number(1)
    if wanted == _LOWEST_OFF:
        return Answer(memory=memory, result=ACCEPTED)  # there is no lowest fence
    kinds = int(memory.tuning.values["FENCE_TYPE"])
    present = kinds & (_HEIGHT | _CIRCLE) or (kinds & _AREAS and memory.mission.fence)
    if wanted not in {_OFF, _ON} or (wanted == _ON and not present):
        return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
    return Answer(memory=with_value(memory, "FENCE_ENABLE", float(wanted), config), result=ACCEPTED)


def _set_mission_current(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    index = request.number(1)
    sent = None if index is None else set_current(memory, index)
    if sent is None:
        return Answer(memory=memory, result=DENIED)
    return Answer(memory=sent, result=ACCEPTED, messages=(mission_current(sent, config),))


COMMANDS: Mapping[int, Handler] = MappingProxyType(
    {
        **HANDLERS,
        mavlink.MAV_CMD_NAV_TAKEOFF: _take_off,
        mavlink.MAV_CMD_DO_REPOSITION: go_there(Mode.OFFBOARD, _fly_there),
        mavlink.MAV_CMD_DO_CHANGE_SPEED: _change_speed,
        mavlink.MAV_CMD_DO_PAUSE_CONTINUE: _pause_or_resume,
        mavlink.MAV_CMD_CONDITION_YAW: _turn,
        mavlink.MAV_CMD_DO_FENCE_ENABLE: _switch_fence,
        mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: _set_mission_current,
    }
)
