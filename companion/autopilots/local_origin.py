"""The origin of the autopilot's local frame above the ellipsoid, from messages that have it above mean sea level."""

from math import radians

from link.frames.geodesy import Datum
from link.mavlink.dialect import Message, mavlink
from link.records import replace

_MOVED_RAD = 1e-8  # 6 cm; the field's resolution is 1e-7 degrees, 1 cm
_MOVED_M = 0.05
_GEOID_MAX_M = 120.0  # it lies between -107 and 86 m (EGM96)
_GEOID_STEP_M = 1.0  # a smaller change of the geoid's height along a flight is left alone
_LATITUDE_MAX_1E7 = 90 * 10**7
_LONGITUDE_MAX_1E7 = 180 * 10**7


def origin_above_sea(message: Message) -> Datum | None:
    """Return the origin, its altitude above mean sea level, of a GPS_GLOBAL_ORIGIN; None of one off the earth."""
    if abs(message.latitude) > _LATITUDE_MAX_1E7 or abs(message.longitude) > _LONGITUDE_MAX_1E7:
        return None
    return Datum(
        latitude_rad=radians(message.latitude * 1e-7),
        longitude_rad=radians(message.longitude * 1e-7),
        altitude_m=message.altitude * 1e-3,
    )


def geoid_height_m(known_m: float | None, message: Message) -> float | None:
    """Return the height of mean sea level above the ellipsoid, which the vehicle's fixes refer to.

    Args:
        known_m: so far; None before the first that was told, which is taken whatever it is.
        message: GPS_RAW_INT, which says 0 where the receiver does not know its height above the ellipsoid.
    """
    if message.fix_type < mavlink.GPS_FIX_TYPE_3D_FIX or message.alt_ellipsoid == 0:
        return known_m
    told_m: float = (message.alt_ellipsoid - message.alt) * 1e-3
    if abs(told_m) > _GEOID_MAX_M or (known_m is not None and abs(told_m - known_m) < _GEOID_STEP_M):
        return known_m
    return told_m


def above_ellipsoid(above_sea: Datum, geoid_m: float | None) -> Datum:
    """Return the origin above the ellipsoid; where nobody knows the geoid, its place is right and its height is not."""
    return replace(above_sea, altitude_m=above_sea.altitude_m + (geoid_m or 0.0))


def is_same(origin: Datum, other: Datum) -> bool:
    """Return whether two origins are one, as exactly as they are sent."""
    return (
        abs(origin.latitude_rad - other.latitude_rad) < _MOVED_RAD
        and abs(origin.longitude_rad - other.longitude_rad) < _MOVED_RAD
        and abs(origin.altitude_m - other.altitude_m) < _MOVED_M
    )
