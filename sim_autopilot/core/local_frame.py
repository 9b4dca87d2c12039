"""The autopilot's local frame: between W, which is a tangent plane, and the frame as the firmware lays it out.

Both name the same point on the globe; away from the origin their metres differ (`link.local_frame`).
"""

from dataclasses import dataclass

from link.geodesy import Datum, enu_from_geodetic, geodetic_from_enu
from link.local_frame import LocalFrame, geodetic_from_local, local_from_geodetic
from link.messages import Vector3

_REACH_M = 1e5
"""No drone gets so far from its origin; a place beyond would be on the other side of the globe."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin:
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
    east_m, north_m, up_m = (max(-_REACH_M, min(_REACH_M, part_m)) for part_m in position_enu_m)
    return enu_from_geodetic(origin.world, *geodetic_from_local(origin.frame, (east_m, north_m, up_m)))
