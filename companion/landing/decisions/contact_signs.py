"""The signs of a contact in a step's facts, which `contact` weighs; pure."""

import math

from msgspec import Struct

from companion.config.touchdown import TouchdownConfig
from companion.situation.own_drone import lowest_foot
from companion.situation.situation import Approach, Situation

_JOLT_S = 0.06  # three reports at 50 Hz


class Signs(Struct, frozen=True, kw_only=True):
    """What is known of a contact; None where it is not.

    Attributes:
        height_m: of the feet above the pad, by the estimates of drone and vehicle.
        distance_m: horizontal, from the pad's centre.
        climb_m_s: of the lowest foot, upwards against the pad.
        acceleration_up_m_s2: of the drone.
        setpoint_below_m: how far the setpoint has sunk below the lowest foot, beyond how it flew before.
        range_height_m: of the feet above what the range finder sees.
        range_carried_m: the last such height that it saw, less what the drone has sunk since.
        landed: the autopilot's own word.
        pad_half_width_m: from the pad's centre to its nearest edge.
        passed_m: least horizontal distance from the pad's centre within the time that a jolt is seen for.
        road_below_m: the road beside the vehicle, below the pad.
        sink_left_m_s: by how much its autopilot lets the drone sink faster than it does.
    """

    height_m: float | None
    distance_m: float | None
    climb_m_s: float | None
    acceleration_up_m_s2: float | None
    setpoint_below_m: float | None
    range_height_m: float | None
    landed: bool | None
    range_carried_m: float | None = None
    passed_m: float | None = None
    pad_half_width_m: float = math.inf
    road_below_m: float | None = None
    sink_left_m_s: float = math.inf


def signs_of(s: Situation, touchdown: TouchdownConfig) -> Signs:
    """Return the signs in a step's facts."""
    relative = s.approach
    drone, reference = s.drone, s.following.reference
    foot_below_m, foot_sinks_m_s = lowest_foot(drone, touchdown)
    above = None if drone is None or reference is None else drone.position_enu_m[2] - reference.position_enu_m[2]
    return Signs(
        height_m=None if relative is None else relative.height_m,
        distance_m=relative.distance_m
        if relative is not None and s.pad is not None and s.pad.unplaced is None
        else None,
        climb_m_s=None if relative is None else relative.climb_m_s - foot_sinks_m_s,
        acceleration_up_m_s2=None if drone is None else drone.acceleration_up_m_s2,
        setpoint_below_m=None if above is None else float(above) - foot_below_m - s.following.rides_m,
        range_height_m=s.below.range_height_m,
        landed=s.autopilot.landed,
        range_carried_m=s.below.range_carried_m,
        pad_half_width_m=math.inf if s.pad is None else s.pad.half_width_m,
        road_below_m=None if s.pad is None or s.pad.mounting.is_afloat else s.pad.height_m,
        passed_m=None if relative is None or drone is None else _passed_m(relative, _JOLT_S + drone.age_s),
        sink_left_m_s=math.inf
        if drone is None or s.limits is None
        else s.limits.descent_max_m_s + drone.velocity_enu_m_s[2],
    )


def signs_text(signs: Signs) -> str:
    """Return the signs for a log."""
    parts = [
        _part(signs.height_m, "m over the pad"),
        _part(signs.setpoint_below_m, "m above the setpoint"),
        _part(signs.climb_m_s, "m/s up"),
        _part(signs.acceleration_up_m_s2, "m/s^2 up"),
        _part(signs.range_height_m, "m by range finder"),
        {None: "", True: "autopilot landed", False: "autopilot not landed"}[signs.landed],
    ]
    return ", ".join(part for part in parts if part)


def _part(value: float | None, unit: str) -> str:
    return "" if value is None else f"{round(value, 2) + 0.0:.2f} {unit}"


def _passed_m(relative: Approach, within_s: float) -> float:
    """Return the least horizontal distance of a drone that has moved against the pad as it does now."""
    (x, y, _), (vx, vy, _) = relative.position_enu_m, relative.velocity_enu_m_s
    speed_squared = vx * vx + vy * vy
    nearest_s = (x * vx + y * vy) / speed_squared if speed_squared > 0.0 else 0.0
    ago_s = min(max(nearest_s, 0.0), max(within_s, 0.0))
    return math.hypot(x - vx * ago_s, y - vy * ago_s)
