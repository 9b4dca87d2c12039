"""The commands that say where, of every firmware: a place to fly to, and home."""

from collections.abc import Callable
from math import isfinite

from link.mavlink.dialect import mavlink
from link.messages import Vector3
from link.records import replace
from sim_autopilot.commands.mode_request import try_mode
from sim_autopilot.commands.requests import ACCEPTED, DENIED, Answer, Request
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.repositioning import place_asked
from sim_autopilot.interfaces import AutopilotConfig, Handler
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.motion import home_position

_CURRENT = 1


def go_there(mode: Mode, fly_to: Callable[[AutopilotMemory, Vector3, Request], AutopilotMemory]) -> Handler:
    """Return the handler of DO_REPOSITION: fly to a place in `mode`, by `fly_to`, and stay there."""

    def handle(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
        place = place_asked(memory, config.datum, request.frame, request.place)
        if place is None:
            return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
        if memory.modes.mode is not mode:
            if not (request.number(2) or 0) & mavlink.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE:
                return Answer(memory=memory, result=DENIED)
            memory, result = try_mode(memory, mode, config)
            if result != ACCEPTED:
                return Answer(memory=memory, result=result)
        return Answer(memory=memory if memory.armed_ns is None else fly_to(memory, place, request), result=ACCEPTED)

    return handle


def set_home(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Put home here, or where the command says."""
    place = memory.now.position_enu_m
    if request.number(1) != _CURRENT:
        if not all(map(isfinite, request.place)):
            return Answer(memory=memory, result=DENIED)
        asked = place_asked(memory, config.datum, request.frame, request.place)
        if asked is None:
            return Answer(memory=memory, result=config.firmware.commands.results.mode_refused)
        place = asked
    memory = replace(memory, places=replace(memory.places, home_enu_m=place))
    return Answer(memory=memory, result=ACCEPTED, messages=(home_position(memory, config),))
