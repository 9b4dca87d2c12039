"""The commands that say where: take-off, reposition, orbit, altitude, speed and home."""

from dataclasses import replace
from math import isfinite, nan, pi

from sim_autopilot.commands.mode_request import try_mode
from sim_autopilot.flight.flight import climb_to
from sim_autopilot.flight.modes import Mode
from sim_autopilot.flight.orbit import Facing, begin_orbit
from sim_autopilot.flight.repositioning import place_asked, reposition, with_speed
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.requests import ACCEPTED, DENIED, Answer, Request
from sim_autopilot.setpoints.guided import with_destination, with_guided_speed, with_takeoff
from sim_autopilot.telemetry.motion import home_position

_CHANGE_MODE = 1
_CURRENT = 1


def take_off(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Take off: by a mode of its own, to the parameter's height or to an altitude, or in GUIDED to one above home."""
    if config.firmware.guided:
        return _take_off_guided(memory, request, config)
    memory, result = try_mode(memory, Mode.TAKEOFF, config)
    above_sea_m, up_m = request.parameters[6], memory.now.position_enu_m[2]
    if result != ACCEPTED or not isfinite(above_sea_m):
        return Answer(memory=memory, result=result)
    height_m = above_sea_m - config.datum.altitude_m
    memory = replace(memory, flight=climb_to(memory.flight, height_m, memory.now))
    return Answer(memory=memory, result=result, text=None if height_m > up_m else config.firmware.texts.high_enough)


def _take_off_guided(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    above_home_m, now = request.parameters[6], memory.now
    height_m = memory.home_enu_m[2] + above_home_m
    on_ground = memory.armed_ns is not None and memory.landing.landed
    rises = isfinite(above_home_m) and height_m > now.position_enu_m[2]
    if memory.modes.mode is not Mode.OFFBOARD or not on_ground or not rises:
        return Answer(memory=memory, result=config.firmware.results.mode_refused)
    guided = with_takeoff(memory.guided, height_m, now)
    return Answer(memory=replace(memory, guided=guided), result=ACCEPTED)


def go_there(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Fly to a place and stay there."""
    mode = config.firmware.reposition_mode
    place = place_asked(memory, config.datum, request.frame, request.place)
    if place is None:
        return Answer(memory=memory, result=config.firmware.results.mode_refused)
    if memory.modes.mode is not mode:
        if not (request.number(2) or 0) & _CHANGE_MODE:
            return Answer(memory=memory, result=DENIED)
        memory, result = try_mode(memory, mode, config)
        if result != ACCEPTED:
            return Answer(memory=memory, result=result)
    if memory.armed_ns is None:
        return Answer(memory=memory, result=ACCEPTED)
    if config.firmware.guided:
        return Answer(
            memory=replace(memory, guided=with_destination(memory.guided, place, memory.now)), result=ACCEPTED
        )
    speed_m_s, yaw_ned_rad = request.parameters[0], request.parameters[3]
    yaw_rad = pi / 2.0 - yaw_ned_rad if isfinite(yaw_ned_rad) else None
    return Answer(memory=reposition(memory, place, yaw_rad, speed_m_s), result=ACCEPTED)


def change_altitude(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Hold at another altitude."""
    memory, result = try_mode(memory, Mode.HOLD, config)
    place = place_asked(memory, config.datum, request.number(2) or 0, (nan, nan, request.parameters[0]))
    if result == ACCEPTED and place is not None and memory.armed_ns is not None:
        memory = reposition(memory, place, memory.now.yaw_rad, 0.0)
    return Answer(memory=memory, result=result)


def circle(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Circle about a place until another mode is asked for."""
    place = place_asked(memory, config.datum, request.frame, request.place)
    if place is None:
        return Answer(memory=memory, result=config.firmware.results.mode_refused)
    memory, result = try_mode(memory, Mode.ORBIT, config)
    facing = Facing.of(request.number(3))
    radius_m, speed_m_s = request.parameters[0], request.parameters[1]
    orbit = begin_orbit(place, radius_m, speed_m_s, facing, memory.now)
    return Answer(memory=replace(memory, flight=replace(memory.flight, orbit=orbit)), result=result)


def change_speed(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Fly on at another speed."""
    speed_m_s = request.parameters[1]
    rules = config.firmware
    right = speed_m_s > 0.0 and isfinite(speed_m_s)
    if not rules.guided:
        return Answer(memory=with_speed(memory, speed_m_s) if right else memory, result=ACCEPTED)
    if not right or memory.modes.mode not in {Mode.OFFBOARD, Mode.MISSION}:
        return Answer(memory=memory, result=rules.results.mode_refused)
    memory = with_speed(memory, speed_m_s)
    return Answer(memory=replace(memory, guided=with_guided_speed(memory.guided, speed_m_s)), result=ACCEPTED)


def set_home(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Put home here, or where the command says."""
    place = memory.now.position_enu_m
    if request.number(1) != _CURRENT:
        if not all(map(isfinite, request.place)):
            return Answer(memory=memory, result=DENIED)
        asked = place_asked(memory, config.datum, request.frame, request.place)
        if asked is None:
            return Answer(memory=memory, result=config.firmware.results.mode_refused)
        place = asked
    memory = replace(memory, home_enu_m=place)
    return Answer(memory=memory, result=ACCEPTED, messages=(home_position(memory, config),))
