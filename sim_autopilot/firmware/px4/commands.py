"""The commands that PX4 obeys in its own way: take-off by a mode, hold elsewhere, an orbit, failures."""

from collections.abc import Mapping
from math import isfinite, nan, pi
from types import MappingProxyType

from link.mavlink.dialect import mavlink
from link.messages import Vector3
from link.records import replace
from sim_autopilot.commands.commands import HANDLERS
from sim_autopilot.commands.mode_request import try_mode
from sim_autopilot.commands.place_commands import go_there
from sim_autopilot.commands.requests import ACCEPTED, DENIED, UNSUPPORTED, Answer, Request
from sim_autopilot.commands.stream_commands import request_flight, request_protocol
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.flight import climb_to
from sim_autopilot.flight.orbit import Facing, begin_orbit
from sim_autopilot.flight.repositioning import place_asked, reposition, with_speed
from sim_autopilot.interfaces import AutopilotConfig, Handler
from sim_autopilot.memory import AutopilotMemory, with_flight
from sim_autopilot.safety.failures import inject, is_refused


def _take_off(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Take off by a mode of its own, to the parameter's height or to an altitude."""
    memory, result = try_mode(memory, Mode.TAKEOFF, config)
    above_sea_m, up_m = request.parameters[6], memory.now.position_enu_m[2]
    if result != ACCEPTED or not isfinite(above_sea_m):
        return Answer(memory=memory, result=result)
    height_m = above_sea_m - config.datum.altitude_m
    memory = with_flight(memory, climb_to(memory.course.flight, height_m, memory.now))
    return Answer(memory=memory, result=result, text=None if height_m > up_m else config.firmware.texts.high_enough)


def _hold_there(memory: AutopilotMemory, place: Vector3, request: Request) -> AutopilotMemory:
    speed_m_s, yaw_ned_rad = request.parameters[0], request.parameters[3]
    yaw_rad = pi / 2.0 - yaw_ned_rad if isfinite(yaw_ned_rad) else None
    return reposition(memory, place, yaw_rad, speed_m_s)


def _change_speed(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Fly on at another speed."""
    speed_m_s = request.parameters[1]
    right = speed_m_s > 0.0 and isfinite(speed_m_s)
    return Answer(memory=with_speed(memory, speed_m_s) if right else memory, result=ACCEPTED)


def _change_altitude(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Hold at another altitude."""
    memory, result = try_mode(memory, Mode.HOLD, config)
    place = place_asked(memory, config.datum, request.number(2) or 0, (nan, nan, request.parameters[0]))
    if result == ACCEPTED and place is not None and memory.armed_ns is not None:
        memory = reposition(memory, place, memory.now.yaw_rad, 0.0)
    return Answer(memory=memory, result=result)


def _circle(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Circle about a place until another mode is asked for."""
    place = place_asked(memory, config.datum, request.frame, request.place)
    if place is None:
        return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
    memory, result = try_mode(memory, Mode.ORBIT, config)
    facing = Facing.of(request.number(3))
    radius_m, speed_m_s = request.parameters[0], request.parameters[1]
    orbit = begin_orbit(place, radius_m, speed_m_s, facing, memory.now)
    return Answer(memory=with_flight(memory, replace(memory.course.flight, orbit=orbit)), result=result)


def _inject_failure(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    if not memory.tuning.settings.simulation.takes_failures:
        return Answer(memory=memory, result=UNSUPPORTED)
    unit, kind, instance = request.number(1), request.number(2), request.number(3)
    unit, kind = unit or 0, -1 if kind is None else kind
    failures = inject(memory.safety.failures, unit, kind, instance or 0)
    if failures is None:
        return Answer(memory=memory, result=UNSUPPORTED if is_refused(unit, kind) else None)
    return Answer(memory=replace(memory, safety=replace(memory.safety, failures=failures)), result=ACCEPTED)


def _pause_or_continue(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    wanted = {0: Mode.HOLD, 1: Mode.MISSION}.get(request.number(1) or 0)
    if wanted is None:
        return Answer(memory=memory, result=DENIED)
    memory, result = try_mode(memory, wanted, config)
    return Answer(memory=memory, result=result)


COMMANDS: Mapping[int, Handler] = MappingProxyType(
    {
        **HANDLERS,
        mavlink.MAV_CMD_NAV_TAKEOFF: _take_off,
        mavlink.MAV_CMD_INJECT_FAILURE: _inject_failure,
        mavlink.MAV_CMD_DO_REPOSITION: go_there(Mode.HOLD, _hold_there),
        mavlink.MAV_CMD_DO_CHANGE_SPEED: _change_speed,
        mavlink.MAV_CMD_DO_CHANGE_ALTITUDE: _change_altitude,
        mavlink.MAV_CMD_DO_ORBIT: _circle,
        mavlink.MAV_CMD_DO_PAUSE_CONTINUE: _pause_or_continue,
        mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION: request_protocol,
        mavlink.MAV_CMD_REQUEST_FLIGHT_INFORMATION: request_flight,
    }
)
