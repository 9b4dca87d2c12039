"""Where a station is over the horizon, the way to it round the vehicle, and the way home; pure numerics.

A station is an offset (ahead, left, up) from the pad's centre, turned by the angle at which ahead is. Ways to it are
laid in the frame that moves and turns with the vehicle: straight where that is clear of the vehicle's cylinder, about
it at one's own distance otherwise, over it only at a height that is clear of its roof. On a way of the length d the
speed against the vehicle is at most sqrt(2 a d), and about the vehicle sqrt(a r): either takes no more than the
acceleration a, so that the rest is left for what the vehicle does.

On the way home to a vehicle that drives on evenly, with the way u to it, a unit vector, and the vehicle's velocity v, a
drone that closes at s flies v + s u, which is as fast as its limit c allows: s = -v u + sqrt((v u)^2 + c^2 - v^2). The
way against the vehicle then stays straight, so that it leads to where the vehicle will be.
"""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from companion.vehicle.pad import PadPath
from link.frames.rotations import wrap_angle
from link.messages import StationFrame, Vector3

_SLOW_M_S = 1.0  # slower than this a course is known to no better than 0.1 rad from velocities of 0.1 m/s
_OVER_SHARE = 0.5  # of the radius: farther out the nearest way out of the vehicle is to the side
_ROUNDING_M = 1e-6
_ARRIVED_M = 0.3  # nearer than this a station is aimed at as it is: the planner makes up for the rest


class KeepOut(Struct, frozen=True, kw_only=True):
    """The vehicle as an upright cylinder about the pad's centre: its radius, and heights above the pad.

    Attributes:
        radius_m: inside of which the drone is above `over_m`.
        over_m: clear of the roof.
        lowest_m: clear of the road beside the vehicle.
    """

    radius_m: float
    over_m: float
    lowest_m: float


def is_inside(offset_m: Vector3, keep_out: KeepOut) -> bool:
    """Return whether an offset is where no station may be: in the vehicle, or too low beside it."""
    ahead_m, left_m, up_m = offset_m
    beside = math.hypot(ahead_m, left_m) >= keep_out.radius_m
    return up_m < (keep_out.lowest_m if beside else keep_out.over_m)


def keep_outside(offset_m: Array, keep_out: KeepOut) -> Array:
    """Return the place (3,) nearest to an offset beside the vehicle, or above one over it, where a station may be."""
    ahead_m, left_m, up_m = offset_m.tolist()
    distance_m = math.hypot(ahead_m, left_m)
    if distance_m < _OVER_SHARE * keep_out.radius_m or up_m >= keep_out.over_m:
        beside = distance_m >= keep_out.radius_m
        return np.array([ahead_m, left_m, max(up_m, keep_out.lowest_m if beside else keep_out.over_m)])
    out = max(keep_out.radius_m / distance_m, 1.0)
    return np.array([out * ahead_m, out * left_m, max(up_m, keep_out.lowest_m)])


def course_rad(pad: PadPath, before_rad: float) -> float:
    """Return the vehicle's course from East counter-clockwise; of one that hardly moves the one before."""
    east_m_s, north_m_s = pad.velocity_enu_m_s[0, :2].tolist()
    return math.atan2(north_m_s, east_m_s) if math.hypot(east_m_s, north_m_s) > _SLOW_M_S else before_rad


def ahead_rad(frame: StationFrame, pad: PadPath, before_rad: float) -> float:
    """Return where ahead is in W now, from East counter-clockwise; where it cannot be told, where it was before."""
    match frame:
        case StationFrame.NORTH:
            return 0.5 * math.pi
        case StationFrame.VEHICLE if pad.yaw_rad is not None:
            return pad.yaw_rad
        case StationFrame.VEHICLE | StationFrame.COURSE:
            return course_rad(pad, before_rad)


def turn_rates_rad_s(frame: StationFrame, pad: PadPath) -> Array:
    """Return how fast ahead turns (n,) over the horizon: as the vehicle's heading does, or its course.

    A course's rate is made of an acceleration, which on an even straight errs by 1 m/s^2: of a slow vehicle, whose
    course it turns fast, that says nothing. The heading's rate is what the curvature makes of the speed.
    """
    velocity, acceleration = pad.velocity_enu_m_s, pad.acceleration_enu_m_s2
    if frame is StationFrame.NORTH:
        return np.zeros(len(pad.offset_s))
    if pad.yaw_rate_rad_s is not None:
        return pad.yaw_rate_rad_s
    across = velocity[:, 0] * acceleration[:, 1] - velocity[:, 1] * acceleration[:, 0]
    rates = across / np.maximum(np.sum(velocity[:, :2] ** 2, axis=1), _SLOW_M_S**2)
    return np.asarray(rates)


def turned(offset_m: Array, angle_rad: float) -> Array:
    """Return an offset (3,) turned about the vertical."""
    x, y, z = offset_m.tolist()
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([c * x - s * y, s * x + c * y, z])


def way_to(start_m: Array, wanted_m: Array, keep_out: KeepOut, offset_s: Array, rates: tuple[float, float]) -> Array:
    """Return offsets (n, 3) from the pad's centre on the way to a station, at `offset_s` after now.

    Args:
        start_m: (3,) where the drone is, in the frame that turns with the vehicle.
        wanted_m: (3,) the station.
        keep_out: the vehicle.
        offset_s: (n,) rising from 0.
        rates: the acceleration that the way may take, and the largest speed on it.
    """
    if float(np.linalg.norm(wanted_m - start_m)) < _ARRIVED_M:
        return np.tile(wanted_m, (len(offset_s), 1))
    way, here = np.empty((len(offset_s), 3)), start_m
    way[0] = start_m
    for k in range(1, len(offset_s)):
        here = _next_place(here, wanted_m, keep_out, float(offset_s[k] - offset_s[k - 1]), rates)
        way[k] = here
    return way


def _next_place(here: Array, wanted_m: Array, keep_out: KeepOut, dt_s: float, rates: tuple[float, float]) -> Array:
    acceleration_m_s2, speed_max_m_s = rates
    if is_clear(here, wanted_m, keep_out):
        return _towards(here, wanted_m, dt_s, rates)
    radius_m, aim_radius_m = math.hypot(*here[:2].tolist()), math.hypot(*wanted_m[:2].tolist())
    if radius_m < keep_out.radius_m - _ROUNDING_M:
        if here[2] < keep_out.over_m and radius_m < _OVER_SHARE * keep_out.radius_m:  # too low over it: up first
            return _towards(here, np.array([*here[:2], keep_out.over_m]), dt_s, rates)
        if here[2] < keep_out.over_m:  # pushed too near its side
            out = here[:2] * (keep_out.radius_m / radius_m)
            return _towards(here, np.array([*out, here[2]]), dt_s, rates)
        out = wanted_m[:2] * (keep_out.radius_m / max(aim_radius_m, keep_out.radius_m))
        return _towards(here, np.array([*out, max(float(wanted_m[2]), keep_out.over_m)]), dt_s, rates)
    if aim_radius_m < keep_out.radius_m:  # a station over the roof: up on the way to the vehicle's side, then over it
        side = here[:2] * (keep_out.radius_m / radius_m)
        return _towards(here, np.array([*side, max(float(wanted_m[2]), keep_out.over_m)]), dt_s, rates)
    speed_m_s = min(math.sqrt(acceleration_m_s2 * radius_m), speed_max_m_s)
    angle_rad = math.atan2(here[1], here[0])
    turn_rad = wrap_angle(math.atan2(wanted_m[1], wanted_m[0]) - angle_rad)
    step_m = speed_m_s * dt_s
    angle_rad += min(max(turn_rad, -step_m / radius_m), step_m / radius_m)
    radius_m += min(max(aim_radius_m - radius_m, -step_m), step_m)
    height_m = float(here[2]) + min(max(float(wanted_m[2] - here[2]), -step_m), step_m)
    return np.array([radius_m * math.cos(angle_rad), radius_m * math.sin(angle_rad), height_m])


def _towards(here: Array, there: Array, dt_s: float, rates: tuple[float, float]) -> Array:
    left_m = float(np.linalg.norm(there - here))
    step_m = min(math.sqrt(2.0 * rates[0] * left_m), rates[1]) * dt_s
    return there if step_m >= left_m else np.asarray(here + (there - here) * (step_m / left_m))


def is_clear(start_m: Array, end_m: Array, keep_out: KeepOut) -> bool:
    """Return whether the straight way between two offsets is clear of the vehicle.

    So is the way out of its cylinder for a drone that was pushed too near its side: at no place nearer than now.
    """
    if min(float(start_m[2]), float(end_m[2])) >= keep_out.over_m:
        return True
    way = end_m[:2] - start_m[:2]
    length2 = float(way @ way)
    share = 0.0 if length2 == 0.0 else min(max(-float(start_m[:2] @ way) / length2, 0.0), 1.0)
    nearest_m, radius_m = math.hypot(*(start_m[:2] + share * way).tolist()), math.hypot(*start_m[:2].tolist())
    is_pushed = start_m[2] < keep_out.over_m and radius_m > _OVER_SHARE * keep_out.radius_m
    least_m = min(keep_out.radius_m, radius_m) if is_pushed else keep_out.radius_m
    return nearest_m >= least_m - _ROUNDING_M


_CLOSING_MIN_M_S = 0.5  # slower than this it comes nowhere: a gust takes more


def closing_speed_m_s(way_m: Array, velocity_enu_m_s: Array, speed_max_m_s: float) -> float:
    """Return how fast the drone can close in along `way_m` (2,) on a vehicle with this velocity (2,); 0 for no way."""
    distance_m = math.hypot(*way_m.tolist())
    if distance_m == 0.0:
        return 0.0
    along_m_s = float(way_m @ velocity_enu_m_s) / distance_m
    rest_m2_s2 = along_m_s**2 + speed_max_m_s**2 - float(velocity_enu_m_s @ velocity_enu_m_s)
    return max(math.sqrt(rest_m2_s2) - along_m_s, 0.0) if rest_m2_s2 > 0.0 else 0.0


def intercept_s(way_m: Array, velocity_enu_m_s: Array, speed_max_m_s: float, acceleration_m_s2: float) -> float | None:
    """Return how long the way to the vehicle takes, gaining speed and losing it included; None if it outruns the drone.

    Args:
        way_m: (2,) from the drone to the vehicle.
        velocity_enu_m_s: (2,) of the vehicle.
        speed_max_m_s: of the drone over ground.
        acceleration_m_s2: with which it gains and loses speed.
    """
    distance_m = math.hypot(*way_m.tolist())
    fastest_m_s = closing_speed_m_s(way_m, velocity_enu_m_s, speed_max_m_s)
    speed_m_s = min(fastest_m_s, math.sqrt(acceleration_m_s2 * distance_m))
    if distance_m == 0.0:
        return 0.0
    if fastest_m_s < _CLOSING_MIN_M_S:
        return None
    return distance_m / speed_m_s + speed_m_s / acceleration_m_s2
