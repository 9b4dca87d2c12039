"""Flying round a place: the point that PX4's orbit mode moves along its circle.

State: the angle about the centre in W (from East, counter-clockwise) and the present distance, which goes to the
radius that was asked for. Source: MAV_CMD_DO_ORBIT, https://mavlink.io/en/messages/common.html#MAV_CMD_DO_ORBIT.
"""

from dataclasses import dataclass
from enum import Enum
from math import atan2, copysign, cos, hypot, isfinite, pi, sin, sqrt

import numpy as np

from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.flight.travel import Pace
from sim_autopilot.plant.snapshot import Snapshot

_RADIUS_M, _SPEED_M_S = 10.0, 3.0
"""Of a command that does not say."""
_RADIUS_MIN_M, _RADIUS_MAX_M = 1.0, 1000.0
_SPEED_MAX_M_S = 10.0
_ACROSS_M_S2 = 2.0
"""PX4 flies its circles with less than this towards the centre."""


class Facing(Enum):
    """Where the nose points: ORBIT_YAW_BEHAVIOUR."""

    CENTRE = 0
    AS_BEFORE = 1
    FREE = 2
    ALONG = 3

    @classmethod
    def of(cls, number: int | None) -> "Facing":
        """Return the behaviour of a number on the wire, towards the centre for one that is none."""
        return cls(number) if number in {one.value for one in cls} else cls.CENTRE


@dataclass(frozen=True, slots=True, kw_only=True)
class Orbit:
    """A circle in W under way; a positive `speed_m_s` is clockwise seen from above."""

    centre_enu_m: Vector3
    radius_m: float
    speed_m_s: float
    facing: Facing
    angle_rad: float
    distance_m: float
    height_m: float
    yaw_rad: float


def begin_orbit(centre_enu_m: Vector3, radius_m: float, speed_m_s: float, facing: Facing, now: Snapshot) -> Orbit:
    """Return the circle that begins where the drone is; what is not finite has PX4's default."""
    radius_m = radius_m if isfinite(radius_m) and radius_m != 0.0 else _RADIUS_M
    speed_m_s = speed_m_s if isfinite(speed_m_s) else _SPEED_M_S
    size_m = min(_RADIUS_MAX_M, max(_RADIUS_MIN_M, abs(radius_m)))
    most_m_s = min(_SPEED_MAX_M_S, abs(speed_m_s), sqrt(_ACROSS_M_S2 * size_m))
    east, north = now.position_enu_m[0] - centre_enu_m[0], now.position_enu_m[1] - centre_enu_m[1]
    return Orbit(
        centre_enu_m=centre_enu_m,
        radius_m=size_m,
        speed_m_s=copysign(most_m_s, radius_m * copysign(1.0, speed_m_s)),
        facing=facing,
        angle_rad=atan2(north, east),
        distance_m=hypot(east, north),
        height_m=now.position_enu_m[2],
        yaw_rad=now.yaw_rad,
    )


def carry_round(orbit: Orbit, pace: Pace, elapsed_s: float) -> tuple[Orbit, Reference]:
    """Return the circle `elapsed_s` later, and what to follow there."""
    outward_m_s = _towards(orbit.radius_m - orbit.distance_m, pace.speed_m_s)
    up_m_s = _towards(
        orbit.centre_enu_m[2] - orbit.height_m,
        pace.climb_m_s if orbit.centre_enu_m[2] > orbit.height_m else pace.descent_m_s,
    )
    near = abs(orbit.radius_m - orbit.distance_m) < 1.0
    turn_rad_s = -orbit.speed_m_s / orbit.radius_m if near else 0.0
    orbit = replace(
        orbit,
        angle_rad=orbit.angle_rad + turn_rad_s * elapsed_s,
        distance_m=orbit.distance_m + outward_m_s * elapsed_s,
        height_m=orbit.height_m + up_m_s * elapsed_s,
    )
    c, s, r = cos(orbit.angle_rad), sin(orbit.angle_rad), orbit.distance_m
    x, y, _ = orbit.centre_enu_m
    along_m_s = turn_rad_s * r
    reference = Reference(
        position_enu_m=np.array((x + r * c, y + r * s, orbit.height_m)),
        velocity_enu_m_s=np.array((outward_m_s * c - along_m_s * s, outward_m_s * s + along_m_s * c, up_m_s)),
        acceleration_enu_m_s2=np.array((-along_m_s * turn_rad_s * c, -along_m_s * turn_rad_s * s, 0.0)),
        yaw_rad=_heading(orbit),
    )
    return orbit, reference


def _towards(distance: float, most_per_s: float) -> float:
    return max(-most_per_s, min(most_per_s, distance))


def _heading(orbit: Orbit) -> float:
    match orbit.facing:
        case Facing.CENTRE:
            return orbit.angle_rad + pi
        case Facing.ALONG:
            return orbit.angle_rad - copysign(pi / 2.0, orbit.speed_m_s)
        case Facing.AS_BEFORE | Facing.FREE:
            return orbit.yaw_rad
