"""A vehicle's gps_msgs/msg/GPSFix as our own: place and velocity in one message, as some drivers and gpsd tell it.

Angles are degrees, the course from north clockwise, deviations 95 %. Its altitude is above the ellipsoid or above the
sea, by driver. Source: gps_msgs of swri-robotics/gps_umd, GPSFix.msg and GPSStatus.msg.
"""

from functools import cache
from math import cos, isfinite, radians, sin
from typing import Any

from rosbags.typesys import get_types_from_msg

from link.messages import Fix, FixVelocity
from link.payloads import cdr
from link.payloads.checks import PayloadError, checked_covariance
from link.payloads.ros_fields import matrix3, stamp_ns

GPS_FIX = "gps_msgs/msg/GPSFix"
_STATUS = "gps_msgs/msg/GPSStatus"
_NO_FIX = -1
_UNKNOWN = 0  # of position_covariance_type
_STDS = 1.96  # in 95 % of a normal distribution
_MOVES_M_S = 0.1  # the course of a slower receiver means nothing, and neither does its absence

_STATUS_TEXT = (
    "std_msgs/Header header\nuint16 satellites_used\nint32[] satellite_used_prn\nuint16 satellites_visible\n"
    "int32[] satellite_visible_prn\nint32[] satellite_visible_z\nint32[] satellite_visible_azimuth\n"
    "int32[] satellite_visible_snr\nint16 status\nuint16 motion_source\nuint16 orientation_source\n"
    "uint16 position_source\n"
)
_NUMBERS = (
    *("latitude", "longitude", "altitude", "track", "speed", "climb", "pitch", "roll", "dip", "time"),
    *("gdop", "pdop", "hdop", "vdop", "tdop", "err", "err_horz", "err_vert", "err_track", "err_speed", "err_climb"),
    *("err_time", "err_pitch", "err_roll", "err_dip"),
)
_FIX_TEXT = (
    "std_msgs/Header header\ngps_msgs/GPSStatus status\n"
    + "".join(f"float64 {name}\n" for name in _NUMBERS)
    + "float64[9] position_covariance\nuint8 position_covariance_type\n"
)


@cache
def register() -> None:
    """Add the types to the store."""
    cdr.typestore().register(get_types_from_msg(_STATUS_TEXT, _STATUS) | get_types_from_msg(_FIX_TEXT, GPS_FIX))


def fix_of_gps(payload: bytes, geoid_height_m: float) -> Fix:
    """Return where the antenna is.

    Args:
        payload: a GPSFix in CDR.
        geoid_height_m: added to its altitude: of the sea above the ellipsoid, 0 for altitudes above the ellipsoid.

    Raises:
        PayloadError: It is none, or has no fix.
    """
    message = _read(payload)
    values = message.latitude, message.longitude, message.altitude
    if not all(map(isfinite, values)):
        raise PayloadError("the place is not finite")
    known = message.position_covariance_type != _UNKNOWN
    return Fix(
        t_ns=stamp_ns(message.header),
        latitude_rad=radians(message.latitude),
        longitude_rad=radians(message.longitude),
        altitude_m=message.altitude + geoid_height_m,
        covariance_enu_m2=checked_covariance("covariance", matrix3(message.position_covariance)) if known else None,
    )


def velocity_of_gps(payload: bytes) -> FixVelocity:
    """Return the velocity in ENU of a GPSFix.

    Raises:
        PayloadError: It is none, has no fix, or no velocity.
    """
    message = _read(payload)
    moves = abs(message.speed) >= _MOVES_M_S
    if not isfinite(message.speed) or (moves and not isfinite(message.track)):
        raise PayloadError("it has no velocity")
    course_rad = radians(message.track) if moves else 0.0
    along_std_m_s, up_std_m_s = message.err_speed / _STDS, message.err_climb / _STDS
    along, up = along_std_m_s * along_std_m_s, up_std_m_s * up_std_m_s  # a power of a huge one would raise an error
    known = isfinite(along) and isfinite(up) and min(along, up) > 0.0
    return FixVelocity(
        t_ns=stamp_ns(message.header),
        velocity_enu_m_s=(
            message.speed * sin(course_rad),
            message.speed * cos(course_rad),
            message.climb if isfinite(message.climb) else 0.0,
        ),
        velocity_covariance_enu_m2_s2=(along, 0.0, 0.0, 0.0, along, 0.0, 0.0, 0.0, up) if known else None,
        is_vertical_measured=isfinite(message.climb),
    )


def _read(payload: bytes) -> Any:
    register()
    message = cdr.decode_ros(GPS_FIX, payload)
    if message.status.status <= _NO_FIX:
        raise PayloadError("the receiver has no fix")
    return message
