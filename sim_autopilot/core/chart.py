"""Geodetic coordinates of a moving drone at little cost: an exact point and its slopes, renewed every few metres.

Longitudes are kept in (-pi, pi], and their differences go the short way: a flight may cross the antimeridian.
"""

from dataclasses import dataclass
from math import dist

from link.frames import wrap_angle
from link.geodesy import Datum, geodetic_from_enu
from link.messages import Vector3

_REACH_M = 20.0
"""Within it the linear map is off by less than 20^2 / (2 * 6.4e6) m = 0.03 mm."""
_STEP_M = 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Chart:
    """A linear map from ENU about `datum` to latitude (rad), longitude (rad), altitude (m), around `base_enu_m`."""

    datum: Datum
    base_enu_m: Vector3
    base: Vector3
    per_east: Vector3
    per_north: Vector3
    per_up: Vector3


def chart_at(datum: Datum, position_enu_m: Vector3) -> Chart:
    """Return the map around `position_enu_m`."""
    x, y, z = position_enu_m
    base = geodetic_from_enu(datum, position_enu_m)
    return Chart(
        datum=datum,
        base_enu_m=position_enu_m,
        base=base,
        per_east=_slope(base, geodetic_from_enu(datum, (x + _STEP_M, y, z))),
        per_north=_slope(base, geodetic_from_enu(datum, (x, y + _STEP_M, z))),
        per_up=_slope(base, geodetic_from_enu(datum, (x, y, z + _STEP_M))),
    )


def near(chart: Chart, position_enu_m: Vector3) -> Chart:
    """Return `chart`, or a new one where it does not reach."""
    if dist(chart.base_enu_m, position_enu_m) < _REACH_M:
        return chart
    return chart_at(chart.datum, position_enu_m)


def geodetic(chart: Chart, position_enu_m: Vector3) -> Vector3:
    """Return latitude (rad), longitude (rad) and altitude (m) of a point near the chart's base."""
    x, y, z = (p - b for p, b in zip(position_enu_m, chart.base_enu_m, strict=True))
    latitude, longitude, altitude = (
        b + e * x + n * y + u * z
        for b, e, n, u in zip(chart.base, chart.per_east, chart.per_north, chart.per_up, strict=True)
    )
    return (latitude, wrap_angle(longitude), altitude)


def _slope(base: Vector3, moved: Vector3) -> Vector3:
    latitude, longitude, altitude = (m - o for m, o in zip(moved, base, strict=True))
    return (latitude / _STEP_M, wrap_angle(longitude) / _STEP_M, altitude / _STEP_M)
