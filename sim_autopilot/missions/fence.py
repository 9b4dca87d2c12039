"""The geofence: inclusion and exclusion polygons and circles, and the cylinder about home that parameters set.

Source: MAVLink mission protocol, fence items; PX4 GF_MAX_HOR_DIST and GF_MAX_VER_DIST.
"""

from dataclasses import dataclass
from math import hypot

from link.frames.geodesy import Datum
from link.mavlink.dialect import mavlink
from link.messages import Vector3
from sim_autopilot.missions.items import Item, place_of

_POLYGONS = {
    int(mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION): True,
    int(mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION): False,
}
_CIRCLES = {
    int(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION): True,
    int(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION): False,
}

Point = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A polygon of `corners`, or the circle of `radius_m` about the first; in W, east and north in metres."""

    corners: tuple[Point, ...]
    radius_m: float | None
    inclusion: bool


Fence = tuple[Area, ...]


def fence_of(items: tuple[Item, ...], datum: Datum) -> Fence:
    """Return the areas of uploaded fence items; polygons with fewer than three corners enclose nothing."""
    areas: list[Area] = []
    index = 0
    while index < len(items):
        item = items[index]
        if item.command in _POLYGONS:
            count = max(1, round(item.number(1, 1.0)))
            corners = tuple(_point(vertex, datum) for vertex in items[index : index + count])
            areas.append(Area(corners=corners, radius_m=None, inclusion=_POLYGONS[item.command]))
            index += count
            continue
        if item.command in _CIRCLES:
            centre, radius_m = _point(item, datum), item.number(1)
            areas.append(Area(corners=(centre,), radius_m=radius_m, inclusion=_CIRCLES[item.command]))
        index += 1
    return tuple(areas)


def is_allowed(fence: Fence, position_enu_m: Vector3) -> bool:
    """Return whether a drone may be there: in one of the inclusions, where there are any, and in no exclusion."""
    point = position_enu_m[:2]
    inside = [(area.inclusion, _holds(area, point)) for area in fence]
    inclusions = [holds for inclusion, holds in inside if inclusion]
    return (not inclusions or any(inclusions)) and not any(holds for inclusion, holds in inside if not inclusion)


def is_near_home(position_enu_m: Vector3, home_enu_m: Vector3, reach_m: float, height_m: float) -> bool:
    """Return whether a drone is within the cylinder about home; a bound of 0 is none."""
    x, y, z = (p - h for p, h in zip(position_enu_m, home_enu_m, strict=True))
    return (reach_m <= 0.0 or hypot(x, y) <= reach_m) and (height_m <= 0.0 or z <= height_m)


def _point(item: Item, datum: Datum) -> Point:
    x, y, _ = place_of(item, datum, (0.0, 0.0, 0.0))
    return x, y


def _holds(area: Area, point: Point) -> bool:
    x, y = point
    if area.radius_m is not None:
        return hypot(x - area.corners[0][0], y - area.corners[0][1]) <= area.radius_m
    crossings = 0
    for (ax, ay), (bx, by) in zip(area.corners, (*area.corners[1:], area.corners[0]), strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            crossings += 1
    return crossings % 2 == 1
