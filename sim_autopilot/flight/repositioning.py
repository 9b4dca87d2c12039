"""Going somewhere by command: DO_REPOSITION and DO_CHANGE_SPEED."""

from math import hypot, isfinite, radians

from link.frames.geodesy import Datum, enu_from_geodetic
from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.places import ABOVE_HOME, REACH_M
from sim_autopilot.flight.flight import go_to
from sim_autopilot.flight.travel import Goal
from sim_autopilot.memory import AutopilotMemory, with_flight


def place_asked(memory: AutopilotMemory, datum: Datum, frame: int, place: tuple[float, float, float]) -> Vector3 | None:
    """Return a place of latitude, longitude (degrees) and altitude in W; what is not finite is where the drone is.

    None is a place beyond reach or on no globe.
    """
    latitude_deg, longitude_deg, altitude_m = place
    x, y, z = memory.now.position_enu_m
    if isfinite(latitude_deg) and isfinite(longitude_deg):
        try:
            x, y, high = enu_from_geodetic(datum, radians(latitude_deg), radians(longitude_deg), datum.altitude_m)
        except ValueError:
            return None
        if hypot(x, y, high) > REACH_M:
            return None
    if isfinite(altitude_m):
        z = altitude_m + (memory.places.home_enu_m[2] if frame in ABOVE_HOME else -datum.altitude_m)
    return x, y, z


def reposition(memory: AutopilotMemory, place: Vector3, yaw_rad: float | None, speed_m_s: float) -> AutopilotMemory:
    """Return the memory of a drone in hold that goes to `place` in W; a speed that is not positive is the usual one."""
    if not speed_m_s > 0.0:
        asked_m_s = memory.course.flight.speed_m_s
        speed_m_s = memory.tuning.settings.travel.cruise_m_s if asked_m_s is None else asked_m_s
    goal = Goal(position_enu_m=place, speed_m_s=speed_m_s, yaw_rad=yaw_rad)
    return with_flight(memory, go_to(memory.course.flight, goal, memory.now))


def with_speed(memory: AutopilotMemory, speed_m_s: float) -> AutopilotMemory:
    """Return the memory of a drone that goes on to where it is going, and with its mission, at `speed_m_s`."""
    flight, mission = memory.course.flight, memory.mission
    goal = None if flight.goal is None else replace(flight.goal, speed_m_s=speed_m_s)
    memory = with_flight(memory, replace(flight, goal=goal, speed_m_s=speed_m_s))
    return replace(memory, mission=replace(mission, progress=replace(mission.progress, speed_m_s=speed_m_s)))
