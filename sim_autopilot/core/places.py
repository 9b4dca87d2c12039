"""Where things are: the autopilot's local frame in W, home, and geodetic coordinates at little cost.

The local frame is laid out as the firmware does it; W is a tangent plane. Both name the same point on the globe, and
away from the origin their metres differ (`link.local_frame`). A chart is an exact point and its slopes, renewed every
few metres. Longitudes are kept in (-pi, pi], and their differences go the short way: a flight may cross the
antimeridian.
"""

from math import dist

from msgspec import Struct

from link.frames.geodesy import (
    Datum,
    LocalFrame,
    enu_from_geodetic,
    geodetic_from_enu,
    geodetic_from_local,
    local_from_geodetic,
)
from link.frames.rotations import wrap_angle
from link.mavlink.dialect import mavlink
from link.messages import Vector3

_CHART_REACH_M = 20.0
"""Within it the linear map is off by less than 20^2 / (2 * 6.4e6) m = 0.03 mm."""
_STEP_M = 10.0


class Chart(Struct, frozen=True, kw_only=True):
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
    if dist(chart.base_enu_m, position_enu_m) < _CHART_REACH_M:
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


REACH_M = 1e5
"""No drone gets so far from its origin; a place beyond would be on the other side of the globe."""
ABOVE_SEA = frozenset({mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT})
"""MAV_FRAME of places on the globe, by what their altitude is above."""
ABOVE_HOME = frozenset({mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT})
ABOVE_TERRAIN = frozenset({mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT})
"""The ground is flat: as high as home."""


class Origin(Struct, frozen=True, kw_only=True):
    """The autopilot's local frame, where its origin is in W, which is about `world`, and how often it was moved."""

    world: Datum
    frame: LocalFrame
    position_enu_m: Vector3 = (0.0, 0.0, 0.0)
    resets: int = 0


def local_from_world(origin: Origin, position_enu_m: Vector3) -> Vector3:
    """Return a place in W in the local frame, m, ENU."""
    return local_from_geodetic(origin.frame, *geodetic_from_enu(origin.world, position_enu_m))


def world_from_local(origin: Origin, position_enu_m: Vector3) -> Vector3:
    """Return a place in the local frame in W, m, ENU; each part of what is beyond reach is cut to it."""
    east_m, north_m, up_m = (max(-REACH_M, min(REACH_M, part_m)) for part_m in position_enu_m)
    return enu_from_geodetic(origin.world, *geodetic_from_local(origin.frame, (east_m, north_m, up_m)))


class Places(Struct, frozen=True, kw_only=True):
    """The local frame with its origin, where it was armed, and a chart for geodetic coordinates."""

    origin: Origin
    home_enu_m: Vector3
    chart: Chart
