"""Messages that ArduPilot sends besides its stream groups, when somebody asks: truth, a summary, gimbals, motors.

Fields and scales: MAVLink common and ArduPilot dialects; what is not there is told as in ArduPilot's simulation.
"""

from math import atan2, degrees, hypot, nan, pi

from link.frames.rotations import frd_from_flu, ned_from_enu, quaternion_ned_frd_from_enu_flu, yaw_ned_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.safety.failsafes_step import charge_of
from sim_autopilot.telemetry.ardupilot import simstate
from sim_autopilot.telemetry.chart import geodetic
from sim_autopilot.telemetry.motion import vfr_hud, wire_place
from sim_autopilot.telemetry.status import boot_ms, extended_sys_state, heartbeat

_NONE = (0, 0, 0, 0)
_WIRE_BYTE = 256
_ALL_WELL = (
    mavlink.ESTIMATOR_ATTITUDE
    | mavlink.ESTIMATOR_VELOCITY_HORIZ
    | mavlink.ESTIMATOR_VELOCITY_VERT
    | mavlink.ESTIMATOR_POS_HORIZ_ABS
    | mavlink.ESTIMATOR_POS_VERT_ABS
)


def sim_state(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SIM_STATE, by which the simulation tells the truth."""
    short, now = simstate(memory, config), memory.now
    q = quaternion_ned_frd_from_enu_flu(now.orientation_wxyz)
    place = geodetic(memory.chart, now.position_enu_m)
    motion = (short.xacc, short.yacc, short.zacc, short.xgyro, short.ygyro, short.zgyro)
    latitude, longitude, _ = wire_place(place)
    velocity = ned_from_enu(now.velocity_enu_m_s)
    return mavlink.MAVLink_sim_state_message(
        *q,
        *(short.roll, short.pitch, short.yaw, *motion, degrees(place[0]), degrees(place[1]), place[2], 0.0, 0.0),
        *velocity,
        latitude,
        longitude,
    )


def high_latency2(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return HIGH_LATENCY2: the flight in one message, for a satellite link."""
    now, beat, hud = memory.now, heartbeat(memory, config), vfr_hud(memory, config)
    latitude, longitude, altitude_mm = wire_place(geodetic(memory.chart, now.position_enu_m))
    place = None if memory.following is None else memory.following.position_enu_m
    east_m, north_m, up_m = (0.0, 0.0, 0.0) if place is None else (place - now.position_enu_m).tolist()
    wind_east, wind_north, _ = memory.wind_enu_m_s
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
        memory.services.mission.index,
        0,
        beat.base_mode - _WIRE_BYTE if beat.base_mode >= _WIRE_BYTE // 2 else beat.base_mode,
        0,
        0,
    )


def terrain_report(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return TERRAIN_REPORT: where it is, and that it knows of no terrain there."""
    latitude, longitude, _ = wire_place(geodetic(memory.chart, memory.now.position_enu_m))
    return mavlink.MAVLink_terrain_report_message(latitude, longitude, 0, 0.0, 0.0, 0, 0)


def state_for_gimbal(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return AUTOPILOT_STATE_FOR_GIMBAL_DEVICE, for everybody."""
    now = memory.now
    _, _, rate_rad_s = frd_from_flu(now.angular_velocity_flu_rad_s)
    return mavlink.MAVLink_autopilot_state_for_gimbal_device_message(
        0,
        0,
        now.boot_ns // 1000,
        quaternion_ned_frd_from_enu_flu(now.orientation_wxyz),
        0,
        *ned_from_enu(now.velocity_enu_m_s),
        0,
        nan if memory.following is None else -(memory.following.yaw_rate_rad_s or 0.0),
        _ALL_WELL,
        extended_sys_state(memory, config).landed_state,
        rate_rad_s,
    )


def relay_status(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return RELAY_STATUS: there is none."""
    return mavlink.MAVLink_relay_status_message(boot_ms(memory), 0, 0)


def esc_telemetry(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return ESC_TELEMETRY_1_TO_4: the battery's voltage and the rotors' speed."""
    empty_v, full_v = memory.settings.battery_v
    voltage_cv = round(100.0 * (empty_v + charge_of(memory, config) * (full_v - empty_v)))
    speeds = memory.plant.state.rotor_speed_rad_s.tolist()
    rpm = tuple(_within(speed * 30.0 / pi, 0, 65535) for speed in speeds)
    return mavlink.MAVLink_esc_telemetry_1_to_4_message(bytes(_NONE), (voltage_cv,) * 4, _NONE, _NONE, rpm, _NONE)


def _within(value: float, lowest: int, highest: int) -> int:
    return max(lowest, min(highest, round(value)))


def _half_degrees(yaw_rad: float) -> int:
    return round(degrees(yaw_ned_from_enu(yaw_rad)) % 360.0 / 2.0) % 180
