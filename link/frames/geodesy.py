"""Geodetic coordinates and the local ENU frame about a datum, on the WGS 84 ellipsoid.

Latitude and longitude in radians, altitude in metres above the ellipsoid. Exact (through ECEF), no flat earth.
Source: WGS 84, NIMA TR8350.2; the way back is Bowring, Transformation from spatial to geographical coordinates, 1976.
Plain floats: pymap3d, the authority in the tests, takes 9 to 50 times as long for a single point, and is 4 nm off.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import atan2, cos, hypot, isfinite, pi, sin, sqrt
from typing import NamedTuple

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
