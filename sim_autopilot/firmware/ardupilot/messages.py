"""Messages of ArduPilot's own, and those that only it sends: what its ground stations show of board and estimator.

The board is that of its simulation; the estimator has converged once positions are known.
"""

from math import atan2, degrees, hypot, pi

from link.frames.rotations import frd_from_flu, ned_from_enu, yaw_ned_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.places import geodetic, local_from_world
from sim_autopilot.interfaces import AutopilotConfig, has_passed
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.setpoints.guided_setpoint import Task
from sim_autopilot.telemetry.motion import attitude, wire_place
from sim_autopilot.telemetry.sensors import scaled_imu, scaled_pressure, truth
from sim_autopilot.telemetry.status import boot_ms

_BOARD_MV = 5000
_FREE_BYTES = 131_072
_ATTITUDE_ONLY = mavlink.EKF_ATTITUDE | mavlink.EKF_VELOCITY_VERT | mavlink.EKF_CONST_POS_MODE
_ALL_WELL = (
    mavlink.EKF_ATTITUDE
    | mavlink.EKF_VELOCITY_HORIZ
    | mavlink.EKF_VELOCITY_VERT
    | mavlink.EKF_POS_HORIZ_REL
    | mavlink.EKF_POS_HORIZ_ABS
    | mavlink.EKF_POS_VERT_ABS
    | mavlink.EKF_PRED_POS_HORIZ_REL
    | mavlink.EKF_PRED_POS_HORIZ_ABS
)


def power_status(_memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return POWER_STATUS of the simulated board."""
    return mavlink.MAVLink_power_status_message(_BOARD_MV, 0, 0)


def meminfo(_memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return MEMINFO of the simulated board."""
    return mavlink.MAVLink_meminfo_message(0, 0xFFFF, _FREE_BYTES)


def hwstatus(_memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return HWSTATUS of the simulated board."""
    return mavlink.MAVLink_hwstatus_message(_BOARD_MV, 0)


def ahrs(_memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return AHRS: no drift, no error."""
    return mavlink.MAVLink_ahrs_message(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def ahrs2(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return AHRS2, the second estimate, which agrees with the first."""
    angles = attitude(memory, config)
    place = geodetic(memory.places.chart, memory.now.position_enu_m)
    latitude, longitude, _ = wire_place(place)
    return mavlink.MAVLink_ahrs2_message(angles.roll, angles.pitch, angles.yaw, place[2], latitude, longitude)


def simstate(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SIMSTATE, by which the simulation tells the truth."""
    angles, now = attitude(memory, config), truth(memory)
    latitude, longitude, _ = wire_place(geodetic(memory.places.chart, now.position_enu_m))
    force, rates = frd_from_flu(now.specific_force_flu_m_s2), frd_from_flu(now.angular_velocity_flu_rad_s)
    return mavlink.MAVLink_simstate_message(angles.roll, angles.pitch, angles.yaw, *force, *rates, latitude, longitude)


def ekf_status_report(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return EKF_STATUS_REPORT."""
    flags = _ALL_WELL if has_passed(config, memory, config.firmware.condition.readiness.arming_s) else _ATTITUDE_ONLY
    return mavlink.MAVLink_ekf_status_report_message(flags, 0.02, 0.02, 0.02, 0.02, 0.0)


def wind(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return WIND: where it comes from in degrees from North, and how fast."""
    east, north, up = memory.world.wind_enu_m_s
    from_deg = degrees(yaw_ned_from_enu(atan2(-north, -east))) % 360.0
    return mavlink.MAVLink_wind_message(from_deg, hypot(east, north), -up)


def scaled_imu3(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SCALED_IMU3, of a compass of its own; the third gyro and accelerometer are not there."""
    own = scaled_imu(memory, config)
    return mavlink.MAVLink_scaled_imu3_message(own.time_boot_ms, 0, 0, 0, 0, 0, 0, own.xmag, own.ymag, own.zmag)


def scaled_pressure2(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SCALED_PRESSURE2 of the second barometer, which measures what the first does."""
    own = scaled_pressure(memory, config)
    return mavlink.MAVLink_scaled_pressure2_message(own.time_boot_ms, own.press_abs, 0.0, own.temperature)


def fence_status(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return FENCE_STATUS."""
    outside = memory.safety.watch.outside
    kind = mavlink.FENCE_BREACH_BOUNDARY if outside else mavlink.FENCE_BREACH_NONE
    return mavlink.MAVLink_fence_status_message(int(outside), int(outside), kind, boot_ms(memory) if outside else 0)


def scaled_imu2(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SCALED_IMU2 of the second sensor, which measures what the first does."""
    one = scaled_imu(memory, config)
    return mavlink.MAVLink_scaled_imu2_message(*(getattr(one, name) for name in one.fieldnames[:10]))


def nav_controller_output(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return NAV_CONTROLLER_OUTPUT: how far what is followed is, and where."""
    angles, following, now = attitude(memory, config), memory.course.following, memory.now
    place = None if following is None else following.position_enu_m
    east, north, up = (0.0, 0.0, 0.0) if place is None else (place - now.position_enu_m).tolist()
    bearing_deg = round(degrees(yaw_ned_from_enu(atan2(north, east))) % 360.0) if (east, north) != (0.0, 0.0) else 0
    bearing_deg = (bearing_deg + 180) % 360 - 180
    roll_deg, pitch_deg = degrees(angles.roll), degrees(angles.pitch)
    distance_m = min(65535, round(hypot(east, north)))
    return mavlink.MAVLink_nav_controller_output_message(
        roll_deg, pitch_deg, bearing_deg, bearing_deg, distance_m, up, 0.0, 0.0
    )


def position_target(memory: AutopilotMemory, _config: AutopilotConfig) -> Message | None:
    """Return POSITION_TARGET_LOCAL_NED: GUIDED's setpoint, carried on since it came; None in any other mode.

    Source: GCS_MAVLINK_Copter::send_position_target_local_ned. It tells no heading.
    """
    guided = memory.course.guided
    if memory.modes.mode is not Mode.OFFBOARD or guided.attitude is not None:
        return None
    wish = guided.wish
    has_place = wish.task not in (Task.VELOCITY, Task.ACCELERATION)
    place = local_from_world(memory.places.origin, wish.position) if has_place else (0.0, 0.0, 0.0)
    return mavlink.MAVLink_position_target_local_ned_message(
        boot_ms(memory),
        mavlink.MAV_FRAME_LOCAL_NED,
        _TARGET_MASKS[wish.task],
        *ned_from_enu(place),
        *ned_from_enu(wish.velocity),
        *ned_from_enu(wish.acceleration),
        0.0,
        0.0,
    )


def position_target_global(memory: AutopilotMemory, _config: AutopilotConfig) -> Message | None:
    """Return POSITION_TARGET_GLOBAL_INT: the place that is followed, None while there is none."""
    following = memory.course.following
    if following is None or following.position_enu_m is None:
        return None
    x, y, z = following.position_enu_m.tolist()
    place = geodetic(memory.places.chart, (x, y, z))
    latitude, longitude, _ = wire_place(place)
    yaw = 0.0 if following.yaw_rad is None else yaw_ned_from_enu(following.yaw_rad)
    return mavlink.MAVLink_position_target_global_int_message(
        boot_ms(memory),
        mavlink.MAV_FRAME_GLOBAL,
        _PLACE_ONLY,
        latitude,
        longitude,
        place[2],
        *(0.0,) * 6,
        max(-pi, min(pi, yaw)),
        0.0,
    )


_TARGET_MASKS = {
    Task.POSITION: 0b1101_1111_1000,
    Task.TAKEOFF: 0b1101_1111_1000,
    Task.FOLLOW: 0b1100_0000_0000,
    Task.VELOCITY: 0b1100_0000_0111,
    Task.ACCELERATION: 0b1100_0011_1111,
}
_PLACE_ONLY = 0b1101_1111_1000
"""The mask that leaves everything out but the place."""
