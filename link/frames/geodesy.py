"""Places on the Earth and in local ENU frames about an origin: the tangent plane, and how each autopilot lays them out.

Latitude and longitude in radians, altitude in metres above the WGS 84 ellipsoid, places in metres. A tangent plane is
exact in three dimensions (through ECEF). Autopilots lay the ground out flat instead, on a sphere, and their height is a
difference of altitudes: 1 km off the origin PX4's place is up to 3 m beside the tangent plane's and 8 cm above it.

- WGS 84, NIMA TR8350.2; the way back is Bowring, Transformation from spatial to geographical coordinates, 1976. Plain
  floats: pymap3d, the authority in the tests, takes 9 to 50 times as long for a single point, and is 4 nm off.
- PX4: azimuthal equidistant on a sphere of 6371 km. Source: PX4, MapProjection in src/lib/geo; Snyder, Map Projections:
  A Working Manual, USGS Professional Paper 1395, 1987, section 25.
- ArduPilot: degrees times one length on a sphere of 6378.1 km, those of longitude shortened by the cosine of the mean
  of both latitudes, of 0.01 at least. Source: ArduPilot, Location in libraries/AP_Common.
"""

from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from math import atan2, cos, hypot, isfinite, pi, sin, sqrt
from typing import NamedTuple, assert_never

from link.frames.rotations import wrap_angle
from link.messages import Vector3

_SEMI_MAJOR_M = 6378137.0
_FLATTENING = 1.0 / 298.257223563
_SEMI_MINOR_M = _SEMI_MAJOR_M * (1.0 - _FLATTENING)
_ECCENTRICITY2 = _FLATTENING * (2.0 - _FLATTENING)
_SECOND_ECCENTRICITY2 = _ECCENTRICITY2 / (1.0 - _ECCENTRICITY2)
_ROUNDS = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Datum:
    """The origin of a local ENU frame."""

    latitude_rad: float
    longitude_rad: float
    altitude_m: float

    def __post_init__(self) -> None:
        """Reject what is no place on earth.

        Raises:
            ValueError: If a coordinate is not finite or the latitude or longitude is out of range.
        """
        if not abs(self.latitude_rad) <= 0.5 * pi:
            raise ValueError(f"latitude_rad must lie within +-pi/2, got {self.latitude_rad}")
        if not abs(self.longitude_rad) <= pi:
            raise ValueError(f"longitude_rad must lie within +-pi, got {self.longitude_rad}")
        if not isfinite(self.altitude_m):
            raise ValueError(f"altitude_m must be finite, got {self.altitude_m}")


class _Frame(NamedTuple):
    """A datum's place in ECEF, m, and the sines and cosines of its latitude and longitude."""

    x_m: float
    y_m: float
    z_m: float
    sin_latitude: float
    cos_latitude: float
    sin_longitude: float
    cos_longitude: float


@lru_cache(maxsize=64)
def _frame(datum: Datum) -> _Frame:
    latitude_rad, longitude_rad = datum.latitude_rad, datum.longitude_rad
    return _Frame(
        *_ecef(latitude_rad, longitude_rad, datum.altitude_m),
        sin(latitude_rad),
        cos(latitude_rad),
        sin(longitude_rad),
        cos(longitude_rad),
    )


def _ecef(latitude_rad: float, longitude_rad: float, altitude_m: float) -> Vector3:
    sin_latitude, cos_latitude = sin(latitude_rad), cos(latitude_rad)
    normal_m = _SEMI_MAJOR_M / sqrt(1.0 - _ECCENTRICITY2 * sin_latitude * sin_latitude)
    from_axis_m = (normal_m + altitude_m) * cos_latitude
    z_m = (normal_m * (1.0 - _ECCENTRICITY2) + altitude_m) * sin_latitude
    return (from_axis_m * cos(longitude_rad), from_axis_m * sin(longitude_rad), z_m)


def curvature_radii_m(datum: Datum) -> tuple[float, float]:
    """Return the radii of the meridian and of the prime vertical at `datum`, at its altitude."""
    root = sqrt(1.0 - _ECCENTRICITY2 * sin(datum.latitude_rad) ** 2)
    meridian_m, prime_vertical_m = _SEMI_MAJOR_M * (1.0 - _ECCENTRICITY2) / root**3, _SEMI_MAJOR_M / root
    return (meridian_m + datum.altitude_m, prime_vertical_m + datum.altitude_m)


def enu_from_geodetic(datum: Datum, latitude_rad: float, longitude_rad: float, altitude_m: float) -> Vector3:
    """Return the position in metres, ENU about `datum`, of a geodetic point."""
    frame = _frame(datum)
    x_m, y_m, z_m = _ecef(latitude_rad, longitude_rad, altitude_m)
    x_m, y_m, z_m = x_m - frame.x_m, y_m - frame.y_m, z_m - frame.z_m
    outward_m = frame.cos_longitude * x_m + frame.sin_longitude * y_m
    return (
        frame.cos_longitude * y_m - frame.sin_longitude * x_m,
        frame.cos_latitude * z_m - frame.sin_latitude * outward_m,
        frame.cos_latitude * outward_m + frame.sin_latitude * z_m,
    )


def geodetic_from_enu(datum: Datum, position_enu_m: Vector3) -> Vector3:
    """Return latitude (rad), longitude (rad) and altitude (m) of a point given in ENU about `datum`."""
    frame, (east_m, north_m, up_m) = _frame(datum), position_enu_m
    outward_m = frame.cos_latitude * up_m - frame.sin_latitude * north_m
    x_m = frame.x_m + frame.cos_longitude * outward_m - frame.sin_longitude * east_m
    y_m = frame.y_m + frame.sin_longitude * outward_m + frame.cos_longitude * east_m
    z_m = frame.z_m + frame.cos_latitude * north_m + frame.sin_latitude * up_m
    return _geodetic(x_m, y_m, z_m)


def _geodetic(x_m: float, y_m: float, z_m: float) -> Vector3:
    """Bowring's iteration over the reduced latitude, which has converged to rounding after two rounds."""
    from_axis_m = hypot(x_m, y_m)
    reduced_rad = atan2(z_m, from_axis_m * (1.0 - _FLATTENING))
    latitude_rad = reduced_rad
    for _ in range(_ROUNDS):
        latitude_rad = atan2(
            z_m + _SECOND_ECCENTRICITY2 * _SEMI_MINOR_M * sin(reduced_rad) ** 3,
            from_axis_m - _ECCENTRICITY2 * _SEMI_MAJOR_M * cos(reduced_rad) ** 3,
        )
        reduced_rad = atan2((1.0 - _FLATTENING) * sin(latitude_rad), cos(latitude_rad))
    sin_latitude, cos_latitude = sin(latitude_rad), cos(latitude_rad)
    # the same at the poles and at the equator
    to_surface_m = _SEMI_MAJOR_M * sqrt(1.0 - _ECCENTRICITY2 * sin_latitude * sin_latitude)
    return (latitude_rad, atan2(y_m, x_m), from_axis_m * cos_latitude + z_m * sin_latitude - to_surface_m)


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


def is_metric(frame: LocalFrame) -> bool:
    """Return whether a metre of `frame` is one on the ground; ArduPilot's east is longer within 0.57 degrees of a pole.

    There places move in the frame as no velocity tells, the drone's own among them.
    """
    return frame.projection is not Projection.ARDUPILOT or cos(frame.origin.latitude_rad) >= _ARDUPILOT_COSINE_MIN


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
