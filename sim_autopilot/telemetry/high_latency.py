"""HIGH_LATENCY2: the flight in one message, for a satellite link."""

from math import atan2, degrees, hypot

from link.frames.rotations import yaw_ned_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.places import geodetic
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.safety.failsafes_step import charge_of
from sim_autopilot.telemetry.motion import vfr_hud, wire_place
from sim_autopilot.telemetry.status import boot_ms, heartbeat

_WIRE_BYTE = 256


def high_latency2(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return HIGH_LATENCY2."""
    now, beat, hud = memory.now, heartbeat(memory, config), vfr_hud(memory, config)
    latitude, longitude, altitude_mm = wire_place(geodetic(memory.places.chart, now.position_enu_m))
    place = None if memory.course.following is None else memory.course.following.position_enu_m
    east_m, north_m, up_m = (0.0, 0.0, 0.0) if place is None else (place - now.position_enu_m).tolist()
    wind_east, wind_north, _ = memory.world.wind_enu_m_s
    altitude_m = altitude_mm / 1000.0
    return mavlink.MAVLink_high_latency2_message(
        boot_ms(memory),
        beat.type,
        beat.autopilot,
        beat.custom_mode & 0xFFFF,
        latitude,
        longitude,
        _within(altitude_m, -32768, 32767),
        _within(altitude_m + up_m, -32768, 32767),
        _half_degrees(now.yaw_rad),
        _half_degrees(atan2(north_m, east_m)) if (east_m, north_m) != (0.0, 0.0) else 0,
        _within(hypot(east_m, north_m) / 10.0, 0, 65535),
        hud.throttle,
        _within(5.0 * hud.airspeed, 0, 255),
        0,
        _within(5.0 * hud.groundspeed, 0, 255),
        _within(5.0 * hypot(wind_east, wind_north), 0, 255),
        _half_degrees(atan2(-wind_north, -wind_east)) if (wind_east, wind_north) != (0.0, 0.0) else 0,
        0,
        0,
        0,
        _within(10.0 * hud.climb, -128, 127),
        round(100.0 * charge_of(memory, config)),
        memory.mission.progress.index,
        0,
        beat.base_mode - _WIRE_BYTE if beat.base_mode >= _WIRE_BYTE // 2 else beat.base_mode,
        0,
        0,
    )


def _within(value: float, lowest: int, highest: int) -> int:
    return max(lowest, min(highest, round(value)))


def _half_degrees(yaw_rad: float) -> int:
    return round(degrees(yaw_ned_from_enu(yaw_rad)) % 360.0 / 2.0) % 180
