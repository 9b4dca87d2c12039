"""The local frames of autopilots: how each lays latitude, longitude and altitude out as metres about its origin.

Latitude and longitude in radians, altitude in metres above the ellipsoid, places in metres, ENU. A tangent plane is
exact in three dimensions. Autopilots lay the ground out flat instead, on a sphere, and their height is a difference of
altitudes: 1 km off the origin PX4's place is up to 3 m beside the tangent plane's and 8 cm above it.

- PX4: azimuthal equidistant on a sphere of 6371 km. Source: PX4, MapProjection in src/lib/geo; Snyder, Map Projections:
  A Working Manual, USGS Professional Paper 1395, 1987, section 25.
- ArduPilot: degrees times one length on a sphere of 6378.1 km, those of longitude shortened by the cosine of the mean
  of both latitudes, of 0.01 at least. Source: ArduPilot, Location in libraries/AP_Common.
"""

from dataclasses import dataclass
from enum import Enum
from math import atan2, cos, hypot, sin
from typing import assert_never

from link.frames.geodesy import Datum, curvature_radii_m, enu_from_geodetic, geodetic_from_enu
from link.frames.rotations import wrap_angle
from link.messages import Vector3

_PX4_RADIUS_M = 6371000.0
_ARDUPILOT_RADIUS_M = 6378100.0
_ARDUPILOT_COSINE_MIN = 0.01


class Projection(Enum):
    """How a local frame is laid out."""

    TANGENT_PLANE = "tangent plane"
    PX4 = "px4"
    ARDUPILOT = "ardupilot"


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalFrame:
    """A local frame: where its origin is, and how it is laid out about it."""

    origin: Datum
    projection: Projection


def local_from_geodetic(frame: LocalFrame, latitude_rad: float, longitude_rad: float, altitude_m: float) -> Vector3:
    """Return where a geodetic point is in `frame`, m, ENU."""
    origin = frame.origin
    up_m = altitude_m - origin.altitude_m
    match frame.projection:
        case Projection.TANGENT_PLANE:
            return enu_from_geodetic(origin, latitude_rad, longitude_rad, altitude_m)
        case Projection.PX4:
            return (*_on_sphere(origin, latitude_rad, longitude_rad), up_m)
        case Projection.ARDUPILOT:
            north_rad = latitude_rad - origin.latitude_rad
            east_rad = wrap_angle(longitude_rad - origin.longitude_rad) * _shortening(origin, north_rad)
            return (_ARDUPILOT_RADIUS_M * east_rad, _ARDUPILOT_RADIUS_M * north_rad, up_m)
        case _:
            assert_never(frame.projection)


def geodetic_from_local(frame: LocalFrame, position_enu_m: Vector3) -> Vector3:
    """Return latitude (rad), longitude (rad) and altitude (m) of a place in `frame`."""
    origin, (east_m, north_m, up_m) = frame.origin, position_enu_m
    altitude_m = origin.altitude_m + up_m
    match frame.projection:
        case Projection.TANGENT_PLANE:
            return geodetic_from_enu(origin, position_enu_m)
        case Projection.PX4:
            return (*_from_sphere(origin, east_m / _PX4_RADIUS_M, north_m / _PX4_RADIUS_M), altitude_m)
        case Projection.ARDUPILOT:
            north_rad = north_m / _ARDUPILOT_RADIUS_M
            east_rad = east_m / _ARDUPILOT_RADIUS_M / _shortening(origin, north_rad)
            return (origin.latitude_rad + north_rad, wrap_angle(origin.longitude_rad + east_rad), altitude_m)
        case _:
            assert_never(frame.projection)


def scale_of(frame: LocalFrame) -> Vector3:
    """Return how many metres of `frame` a true metre is at its origin, towards east, north and up.

    So much faster does a place move in the frame than the velocity that a receiver measures. Some kilometres away the
    numbers are the same to 1e-6, and the frame's north is true north to some 1e-4 rad a kilometre.
    """
    meridian_m, prime_vertical_m = curvature_radii_m(frame.origin)
    match frame.projection:
        case Projection.TANGENT_PLANE:
            return (1.0, 1.0, 1.0)
        case Projection.PX4:
            return (_PX4_RADIUS_M / prime_vertical_m, _PX4_RADIUS_M / meridian_m, 1.0)
        case Projection.ARDUPILOT:
            return (_ARDUPILOT_RADIUS_M / prime_vertical_m, _ARDUPILOT_RADIUS_M / meridian_m, 1.0)
        case _:
            assert_never(frame.projection)


def _shortening(origin: Datum, north_rad: float) -> float:
    return max(cos(origin.latitude_rad + 0.5 * north_rad), _ARDUPILOT_COSINE_MIN)


def _on_sphere(origin: Datum, latitude_rad: float, longitude_rad: float) -> tuple[float, float]:
    """Return east and north, m: as far away and in the same direction as along the great circle."""
    sin_origin, cos_origin = sin(origin.latitude_rad), cos(origin.latitude_rad)
    east_rad = longitude_rad - origin.longitude_rad
    outward = cos(latitude_rad) * cos(east_rad)
    east = cos(latitude_rad) * sin(east_rad)
    north = cos_origin * sin(latitude_rad) - sin_origin * outward
    up = sin_origin * sin(latitude_rad) + cos_origin * outward
    away = hypot(east, north)
    length_m = _PX4_RADIUS_M * (atan2(away, up) / away if away > 0.0 else 1.0)
    return (length_m * east, length_m * north)


def _from_sphere(origin: Datum, east_rad: float, north_rad: float) -> tuple[float, float]:
    """Return latitude and longitude of what lies so far away along the great circle."""
    sin_origin, cos_origin = sin(origin.latitude_rad), cos(origin.latitude_rad)
    angle_rad = hypot(east_rad, north_rad)
    share = sin(angle_rad) / angle_rad if angle_rad > 0.0 else 1.0
    east, north, up = east_rad * share, north_rad * share, cos(angle_rad)
    outward = cos_origin * up - sin_origin * north
    latitude_rad = atan2(sin_origin * up + cos_origin * north, hypot(outward, east))
    return (latitude_rad, wrap_angle(origin.longitude_rad + atan2(east, outward)))
