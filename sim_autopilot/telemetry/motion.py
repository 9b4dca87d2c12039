"""Messages about where the drone is and how it moves, in MAVLink's frames and units."""

from math import atan2, degrees, hypot, pi

from link.frames.geodesy import geodetic_from_enu, local_from_geodetic
from link.frames.rotations import (
    frd_from_flu,
    ned_from_enu,
    quaternion_ned_frd_from_enu_flu,
    roll_pitch_yaw_of,
    yaw_ned_from_enu,
)
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.core.places import geodetic, local_from_world
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.telemetry.status import boot_ms

_NONE = (0.0, 0.0, 0.0)
_IGNORE = (0b0000_0000_0000_0111, 0b0000_0000_0011_1000, 0b0000_0001_1100_0000)
_IGNORE_YAW = 0b0000_0100_0000_0000
_IGNORE_YAW_RATE = 0b0000_1000_0000_0000
_POSITION_VARIANCE_M2 = 1e-4
_VELOCITY_VARIANCE_M2_S2 = 1e-4
_ANGLE_VARIANCE_RAD2 = 1e-6
_RECEIVER_ACCURACY = (900, 1780, 400, 572958)
"""Horizontal and vertical, mm, of speed, mm/s, and of course, 1e-5 deg: as PX4's simulated receiver says."""
# A fixed carrier phase errs by a quarter of its wavelength of 0.19 m at most; one that floats, by decimetres.
_FIXES_BY_ACCURACY_M = ((0.048, mavlink.GPS_FIX_TYPE_RTK_FIXED), (0.5, mavlink.GPS_FIX_TYPE_RTK_FLOAT))
_DIAGONAL = (0, 6, 11, 15, 18, 20)  # of a 6x6 matrix's upper triangle, row by row


def _diagonal(first: float, last: float) -> tuple[float, ...]:
    values = dict.fromkeys(_DIAGONAL[:3], first) | dict.fromkeys(_DIAGONAL[3:], last)
    return tuple(values.get(i, 0.0) for i in range(21))


_POSE_COVARIANCE = _diagonal(_POSITION_VARIANCE_M2, _ANGLE_VARIANCE_RAD2)
_TWIST_COVARIANCE = _diagonal(_VELOCITY_VARIANCE_M2_S2, _ANGLE_VARIANCE_RAD2)


def _local_ned(memory: AutopilotMemory, position_enu_m: Vector3) -> Vector3:
    return ned_from_enu(local_from_world(memory.places.origin, position_enu_m))


def _own_ned(memory: AutopilotMemory) -> Vector3:
    """Return where the drone is, by the chart, which costs less."""
    place = geodetic(memory.places.chart, memory.now.position_enu_m)
    return ned_from_enu(local_from_geodetic(memory.places.origin.frame, *place))


def local_position_ned(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return LOCAL_POSITION_NED about the autopilot's origin."""
    now = memory.now
    return mavlink.MAVLink_local_position_ned_message(
        boot_ms(memory), *_own_ned(memory), *ned_from_enu(now.velocity_enu_m_s)
    )


def attitude(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return ATTITUDE."""
    now = memory.now
    roll, pitch, yaw = roll_pitch_yaw_of(quaternion_ned_frd_from_enu_flu(now.orientation_wxyz))
    rates = frd_from_flu(now.angular_velocity_flu_rad_s)
    return mavlink.MAVLink_attitude_message(boot_ms(memory), roll, pitch, yaw, *rates)


def attitude_quaternion(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return ATTITUDE_QUATERNION."""
    now = memory.now
    q = quaternion_ned_frd_from_enu_flu(now.orientation_wxyz)
    rates = frd_from_flu(now.angular_velocity_flu_rad_s)
    return mavlink.MAVLink_attitude_quaternion_message(boot_ms(memory), *q, *rates)


def odometry(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return ODOMETRY, with the velocity in NED as PX4 has it."""
    now = memory.now
    return mavlink.MAVLink_odometry_message(
        now.boot_ns // 1000,
        mavlink.MAV_FRAME_LOCAL_NED,
        mavlink.MAV_FRAME_LOCAL_NED,
        *_own_ned(memory),
        quaternion_ned_frd_from_enu_flu(now.orientation_wxyz),
        *ned_from_enu(now.velocity_enu_m_s),
        *frd_from_flu(now.angular_velocity_flu_rad_s),
        _POSE_COVARIANCE,
        _TWIST_COVARIANCE,
        memory.places.origin.resets % 256,
        mavlink.MAV_ESTIMATOR_TYPE_AUTOPILOT,
        100,
    )


def position_target(memory: AutopilotMemory, _config: AutopilotConfig) -> Message | None:
    """Return POSITION_TARGET_LOCAL_NED: the setpoint that is followed, None while nothing is.

    PX4's own tells the place of the setpoint, and of its controller the velocity and acceleration that it asks for.
    """
    following = memory.course.following
    if following is None:
        return None
    given = (following.position_enu_m, following.velocity_enu_m_s, following.acceleration_enu_m_s2)
    mask = sum(ignore for ignore, group in zip(_IGNORE, given, strict=True) if group is None)
    mask |= 0 if following.yaw_rad is not None else _IGNORE_YAW
    mask |= 0 if following.yaw_rate_rad_s is not None else _IGNORE_YAW_RATE
    position, velocity, acceleration = (_NONE if group is None else group.tolist() for group in given)
    return mavlink.MAVLink_position_target_local_ned_message(
        boot_ms(memory),
        mavlink.MAV_FRAME_LOCAL_NED,
        mask,
        *(_NONE if given[0] is None else _local_ned(memory, position)),
        *ned_from_enu(velocity),
        *ned_from_enu(acceleration),
        yaw_ned_from_enu(following.yaw_rad or 0.0),
        -(following.yaw_rate_rad_s or 0.0),
    )


def vfr_hud(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return VFR_HUD; without an airspeed sensor its airspeed is the ground speed."""
    now = memory.now
    most = memory.tuning.plant_config.airframe.thrust_to_weight or 2.0
    throttle = round(min(100.0, 100.0 * now.thrust_share / most))
    altitude_m = geodetic(memory.places.chart, now.position_enu_m)[2]
    heading = round(degrees(_heading_rad(now))) % 360
    speed = now.speed_m_s
    return mavlink.MAVLink_vfr_hud_message(speed, speed, heading, throttle, altitude_m, now.velocity_enu_m_s[2])


def global_position_int(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return GLOBAL_POSITION_INT."""
    now = memory.now
    latitude, longitude, altitude = wire_place(geodetic(memory.places.chart, now.position_enu_m))
    above_home_mm = round(1000.0 * (now.position_enu_m[2] - memory.places.home_enu_m[2]))
    velocity = (_int16(100.0 * v) for v in ned_from_enu(now.velocity_enu_m_s))
    heading = round(100.0 * degrees(_heading_rad(now))) % 36000
    return mavlink.MAVLink_global_position_int_message(
        boot_ms(memory), latitude, longitude, altitude, above_home_mm, *velocity, heading
    )


def gps_raw_int(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return GPS_RAW_INT: no fix before the receiver has one."""
    now = memory.now
    has_fix = config.instant or now.boot_ns * 1e-9 >= config.firmware.condition.readiness.fix_s
    fix, accuracy = _receiver(config) if has_fix else (mavlink.GPS_FIX_TYPE_NO_FIX, _RECEIVER_ACCURACY)
    place = wire_place(geodetic(memory.places.chart, now.position_enu_m))
    north, east, _ = ned_from_enu(now.velocity_enu_m_s)
    speed = min(65534, round(100.0 * hypot(north, east)))
    course = round(100.0 * degrees(yaw_ned_from_enu(_course_rad(now)))) % 36000
    return mavlink.MAVLink_gps_raw_int_message(
        now.boot_ns // 1000, fix, *place, 70, 110, speed, course, 10, place[2], *accuracy
    )


def _receiver(config: AutopilotConfig) -> tuple[int, tuple[int, int, int, int]]:
    """Return GPS_FIX_TYPE and what the receiver states of its accuracy."""
    accuracy_m = config.own_state.receiver_accuracy_m
    if accuracy_m is None:
        return config.firmware.condition.fix_type, _RECEIVER_ACCURACY
    fix = next((fix for most_m, fix in _FIXES_BY_ACCURACY_M if accuracy_m <= most_m), mavlink.GPS_FIX_TYPE_3D_FIX)
    horizontal_mm = round(1000.0 * accuracy_m)
    return fix, (horizontal_mm, 2 * horizontal_mm, *_RECEIVER_ACCURACY[2:])


def gps_global_origin(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return GPS_GLOBAL_ORIGIN, about which LOCAL_POSITION_NED is."""
    now = memory.now
    datum = memory.places.origin.frame.origin
    place = wire_place((datum.latitude_rad, datum.longitude_rad, datum.altitude_m))
    return mavlink.MAVLink_gps_global_origin_message(*place, now.boot_ns // 1000)


def home_position(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return HOME_POSITION: where it was armed."""
    now = memory.now
    place = wire_place(geodetic_from_enu(config.datum, memory.places.home_enu_m))
    local = _local_ned(memory, memory.places.home_enu_m)
    return mavlink.MAVLink_home_position_message(
        *place, *local, (1.0, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, now.boot_ns // 1000
    )


def wire_place(place: Vector3) -> tuple[int, int, int]:
    """Return latitude, longitude (rad) and altitude (m) as the integers of the wire."""
    latitude, longitude, altitude_m = place
    return round(degrees(latitude) * 1e7), round(degrees(longitude) * 1e7), round(altitude_m * 1000.0)


def _heading_rad(now: Snapshot) -> float:
    return yaw_ned_from_enu(now.yaw_rad) % (2.0 * pi)


def _course_rad(now: Snapshot) -> float:
    east, north, _ = now.velocity_enu_m_s
    return now.yaw_rad if east == north == 0.0 else atan2(north, east)


def _int16(value: float) -> int:
    return max(-32767, min(32767, round(value)))
