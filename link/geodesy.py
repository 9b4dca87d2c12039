"""Geodetic coordinates and the local ENU frame about a datum, on the WGS 84 ellipsoid.

Latitude and longitude in radians, altitude in metres above the ellipsoid. Exact (through ECEF), no flat earth.
Source: pymap3d, whose import is put off until the first conversion.
"""

from dataclasses import dataclass
from math import isfinite, pi

from link.messages import Vector3


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


def enu_from_geodetic(datum: Datum, latitude_rad: float, longitude_rad: float, altitude_m: float) -> Vector3:
    """Return the position in metres, ENU about `datum`, of a geodetic point."""
    from pymap3d import geodetic2enu  # noqa: PLC0415 (0.1 s, not wanted by --help)

    east, north, up = geodetic2enu(
        latitude_rad,
        longitude_rad,
        altitude_m,
        datum.latitude_rad,
        datum.longitude_rad,
        datum.altitude_m,
        deg=False,
    )
    return (float(east), float(north), float(up))


def geodetic_from_enu(datum: Datum, position_enu_m: Vector3) -> Vector3:
    """Return latitude (rad), longitude (rad) and altitude (m) of a point given in ENU about `datum`."""
    from pymap3d import enu2geodetic  # noqa: PLC0415 (as above)

    latitude, longitude, altitude = enu2geodetic(
        *position_enu_m, datum.latitude_rad, datum.longitude_rad, datum.altitude_m, deg=False
    )
    return (float(latitude), float(longitude), float(altitude))
