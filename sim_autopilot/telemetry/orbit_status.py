"""ORBIT_EXECUTION_STATUS: the circle that PX4 flies. Source: FlightTaskOrbit::sendTelemetry."""

from math import copysign, degrees

from link.frames.geodesy import geodetic_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory


def orbit_execution_status(memory: AutopilotMemory, config: AutopilotConfig) -> Message | None:
    """Return the centre, the radius (negative against the clock) and the present altitude of the orbit.

    None while none is flown: disarmed, or in another mode.
    """
    orbit = memory.course.flight.orbit
    if orbit is None or memory.modes.mode is not Mode.ORBIT or memory.armed_ns is None:
        return None
    east_m, north_m, _ = orbit.centre_enu_m
    latitude, longitude, altitude_m = geodetic_from_enu(config.datum, (east_m, north_m, orbit.height_m))
    return mavlink.MAVLink_orbit_execution_status_message(
        memory.now.boot_ns // 1000,
        copysign(orbit.radius_m, orbit.speed_m_s),
        mavlink.MAV_FRAME_GLOBAL,
        round(degrees(latitude) * 1e7),
        round(degrees(longitude) * 1e7),
        altitude_m,
    )
