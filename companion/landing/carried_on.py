"""Bounds on setpoints for an autopilot that continues the last one if the companion dies; pure numerics.

ArduCopter moves the last setpoint on by its velocity v and acceleration a for `GUID_TIMEOUT`, T, and then stops it; its
path brakes with A, which it reaches from a at the jerk J. With w = v + a T, and b the part of a along it, that takes it

    d(v, a) = |v T + a T^2 / 2| + |w| b / J + z^2 / 2A + z A / 2J,        z = |w| + b^2 / 2J

away. Out of a chase with 4 m/s^2 and T = 3 s a drone was carried 65 m so. What is asked for is bounded in two steps:
the plan's rates, by what is accepted for a steady flight, and the acceleration of each setpoint, by what that leaves.
What is left out is asked for otherwise, so that the drone's path is the same. The path makes up for an error of its
velocity at the rate k = J / A: a setpoint of v + a / k without its acceleration carries it a third as far. And it makes
up for an error e of its position with a velocity s(e), the square-root law of A / 2 and k / 2: a setpoint that is
s^-1(v) lower sinks it as fast, and stays where it is. Source: ArduPilot's ModeGuided::posvelaccel_control_run,
shape_pos_vel_accel_xy.
"""

import math
from collections.abc import Callable

import numpy as np
from msgspec import Struct

from companion.autopilots.response import Shaping
from companion.config.companion import CompanionConfig
from companion.core.data import FlightLimits
from companion.landing.decisions.feasibility import catching_up_m_s
from companion.landing.sortie.aims import station_speed_m_s
from companion.landing.state.memory import StepMemory
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from link.records import replace

FARTHEST_M = 25.0
"""Accepted: so far a drone whose companion has died flies on, or as far as a vehicle needs that is faster."""
LOWEST_M = 0.8
"""Accepted: so far above the pad it then ends, unless it was nearer or was about to touch."""

_SWING = 1.08  # of what its path is carried by a real ArduCopter flew: 25.8 to 27.0 m of 25
# Of the vehicle's speed, up to which setpoints accelerate: of ArduCopter's default parameters 25 m leave that at 5 m/s.
_ACCELERATED_SHARE = 1.07
_HALVINGS = 12  # of a share: to 0.02 %

Plane = tuple[float, float]


class Carried(Struct, frozen=True, kw_only=True):
    """How far a setpoint may be carried on.

    Attributes:
        speed_m_s: horizontally no farther than from a steady flight at this.
        climb_m_s: to no more than this upwards.
        lowest_enu_m: height in W of the drone above which it is to end; None where the plan sees to that.
    """

    speed_m_s: float
    climb_m_s: float
    lowest_enu_m: float | None


def carried_m(velocity: Plane, acceleration: Plane, shaping: Shaping) -> float:
    """Return how far a drone flies that is carried on from this horizontal motion, at most."""
    (u, v), (a, b), t = velocity, acceleration, shaping.carried_s
    last = (u + a * t, v + b * t)
    last_m_s = math.hypot(*last)
    ahead_m_s2 = max(a * last[0] + b * last[1], 0.0) / last_m_s if last_m_s > 0.0 else 0.0
    most, jerk = shaping.acceleration_m_s2, shaping.jerk_m_s3
    top_m_s = last_m_s + 0.5 * ahead_m_s2**2 / jerk
    braking_m = last_m_s * ahead_m_s2 / jerk + 0.5 * top_m_s * (top_m_s / most + most / jerk)
    return math.hypot((u + 0.5 * a * t) * t, (v + 0.5 * b * t) * t) + braking_m


def speed_carried_m_s(shaping: Shaping) -> float:
    """Return the speed of a steady flight from which a drone is carried on as far as is accepted."""
    a, late_s = shaping.acceleration_m_s2, shaping.carried_s + 0.5 * shaping.acceleration_m_s2 / shaping.jerk_m_s3
    return a * (math.hypot(late_s, math.sqrt(2.0 * FARTHEST_M / _SWING / a)) - late_s)


def limit_rates(
    limits: FlightLimits, memory: StepMemory, situation: Situation, shaping: Shaping | None, config: CompanionConfig
) -> FlightLimits:
    """Return the limits of a plan, and for an autopilot that carries setpoints on the rates at which it may.

    It has to be somewhat faster than the vehicle, or it never catches up. A descent sinks as fast as it touches down,
    or faster as long as it can stop in time.
    """
    if shaping is None:
        return limits
    speed_m_s = max(speed_carried_m_s(shaping), catching_up_m_s(_followed_m_s(memory, situation), config))
    limits = replace(limits, speed_max_m_s=min(limits.speed_max_m_s, speed_m_s))
    pad, drone, lowest_m = situation.pad, memory.model.reference, _lowest_enu_m(memory, situation, config)
    if lowest_m is None or pad is None or drone is None:
        return limits
    room_m = max(float(drone.position_enu_m[2]) - lowest_m, 0.0)
    sink_m_s = max(_rate_of(room_m, shaping), config.descent.sink.contact_rate_m_s)
    sink_m_s += max(-float(pad.velocity_enu_m_s[0, 2]), 0.0)
    return replace(limits, descent_max_m_s=min(limits.descent_max_m_s, sink_m_s))


def bound_carried(
    reference: ReferenceState,
    memory: StepMemory,
    situation: Situation,
    shaping: Shaping | None,
    config: CompanionConfig,
) -> ReferenceState:
    """Return what to ask for, so that it may be carried on, of an autopilot that is to follow `reference`.

    A drone that is committed is on the pad before a setpoint could carry it anywhere.
    """
    if shaping is None or _is_committed(memory, situation, config):
        return reference
    limits = config.limits.flight_limits() if situation.limits is None else situation.limits
    carried = Carried(
        speed_m_s=max(speed_carried_m_s(shaping), _ACCELERATED_SHARE * _followed_m_s(memory, situation)),
        climb_m_s=limits.climb_max_m_s,
        lowest_enu_m=_lowest_enu_m(memory, situation, config),
    )
    return bound_reference(reference, carried, shaping)


def bound_reference(reference: ReferenceState, carried: Carried, shaping: Shaping) -> ReferenceState:
    """Return what to ask for in place of `reference`; the autopilot's path is the same."""
    (u, v, up), (a, b, c) = reference.velocity_enu_m_s.tolist(), reference.acceleration_enu_m_s2.tolist()
    east_m, north_m, height_m = reference.position_enu_m.tolist()
    velocity, acceleration = bound_motion((u, v), (a, b), carried.speed_m_s, shaping)
    up, c = bound_climb(up, c, carried.climb_m_s, shaping)
    if carried.lowest_enu_m is not None:
        lower_m, up, c = bound_sink(up, c, height_m - carried.lowest_enu_m, shaping)
        height_m -= lower_m
    return ReferenceState(
        position_enu_m=np.array([east_m, north_m, height_m]),
        velocity_enu_m_s=np.array([*velocity, up]),
        acceleration_enu_m_s2=np.array([*acceleration, c]),
    )


def bound_motion(velocity: Plane, acceleration: Plane, speed_m_s: float, shaping: Shaping) -> tuple[Plane, Plane]:
    """Return velocity and acceleration that accelerate a path alike and carry it no farther than a steady `speed_m_s`.

    As much of the acceleration as may be is asked for as such. What a velocity beyond `speed_m_s` would be needed for
    is not asked for; one that is faster already is not accelerated.
    """
    (u, v), (a, b) = velocity, acceleration
    speed_m_s = max(speed_m_s, math.hypot(u, v))
    slope_s, farthest_m = (
        shaping.acceleration_m_s2 / shaping.jerk_m_s3,
        carried_m((speed_m_s, 0.0), (0.0, 0.0), shaping),
    )

    def shared(share: float) -> tuple[Plane, Plane]:
        lead_s = (1.0 - share) * slope_s
        return (u + a * lead_s, v + b * lead_s), (a * share, b * share)

    if carried_m(velocity, acceleration, shaping) <= farthest_m:
        return velocity, acceleration
    led, none = shared(0.0)
    fast_m_s = math.hypot(*led)
    if fast_m_s > speed_m_s:
        return (led[0] * speed_m_s / fast_m_s, led[1] * speed_m_s / fast_m_s), none
    return shared(_largest_share(lambda share: carried_m(*shared(share), shaping) <= farthest_m))


def bound_climb(
    climb_m_s: float, acceleration_m_s2: float, fastest_m_s: float, shaping: Shaping
) -> tuple[float, float]:
    """Return rate and acceleration upwards that lift a path alike, but carry it on to `fastest_m_s` at most."""
    t, lead_s = shaping.carried_s, shaping.vertical_acceleration_m_s2 / shaping.vertical_jerk_m_s3
    if acceleration_m_s2 <= 0.0 or climb_m_s + acceleration_m_s2 * t <= fastest_m_s or t <= lead_s:
        return climb_m_s, acceleration_m_s2
    led_m_s = climb_m_s + acceleration_m_s2 * lead_s
    share = min(max((fastest_m_s - led_m_s) / (acceleration_m_s2 * (t - lead_s)), 0.0), 1.0)
    return climb_m_s + (1.0 - share) * acceleration_m_s2 * lead_s, share * acceleration_m_s2


def bound_sink(
    climb_m_s: float, acceleration_m_s2: float, room_m: float, shaping: Shaping
) -> tuple[float, float, float]:
    """Return how much lower, and with which rate and acceleration upwards, a path sinks alike and is carried less low.

    Args:
        climb_m_s: of the path, upwards.
        acceleration_m_s2: of the path, upwards.
        room_m: by which it may end lower at most; if that cannot be, it ends as high as it can.
        shaping: of the path.
    """
    t, most = shaping.carried_s, shaping.vertical_acceleration_m_s2
    last_m_s = climb_m_s + acceleration_m_s2 * t
    sinks_m = -(climb_m_s + 0.5 * acceleration_m_s2 * t) * t + 0.5 * min(last_m_s, 0.0) ** 2 / most
    wanted_m_s = -(climb_m_s + acceleration_m_s2 * most / shaping.vertical_jerk_m_s3)
    if sinks_m <= room_m or wanted_m_s <= 0.0:
        return 0.0, climb_m_s, acceleration_m_s2

    def ends_m(share: float) -> float:
        rate_m_s = share * wanted_m_s
        return _error_of(wanted_m_s - rate_m_s, shaping) + rate_m_s * (t + 0.5 * rate_m_s / most)

    share = max(2.0 * wanted_m_s - t * most, 0.0) / (3.0 * wanted_m_s)  # it ends highest
    if ends_m(share) <= room_m:
        share = _largest_share(lambda share: ends_m(share) <= room_m, share)
    return _error_of((1.0 - share) * wanted_m_s, shaping), -share * wanted_m_s, 0.0


def _largest_share(fits: Callable[[float], bool], least: float = 0.0) -> float:
    """Return the largest share up to 1 that fits; `least` does, and all up to the largest."""
    most = 1.0
    for _ in range(_HALVINGS):
        share = 0.5 * (least + most)
        least, most = (share, most) if fits(share) else (least, share)
    return least


def _vertical_law(shaping: Shaping) -> tuple[float, float]:
    """Return slope (1/s) and acceleration of the law by which a vertical error of the position is made up for."""
    most = shaping.vertical_acceleration_m_s2
    return 0.5 * shaping.vertical_jerk_m_s3 / most, 0.5 * most


def _error_of(rate_m_s: float, shaping: Shaping) -> float:
    slope, limit = _vertical_law(shaping)
    return rate_m_s / slope if rate_m_s <= limit / slope else 0.5 * rate_m_s**2 / limit + 0.5 * limit / slope**2


def _rate_of(error_m: float, shaping: Shaping) -> float:
    slope, limit = _vertical_law(shaping)
    linear_m = limit / slope**2
    return slope * error_m if error_m <= linear_m else math.sqrt(2.0 * limit * (error_m - 0.5 * linear_m))


def _followed_m_s(memory: StepMemory, situation: Situation) -> float:
    """Return how fast the vehicle is, or the station that is kept beside it: outside in a bend that is faster."""
    vehicle_m_s = 0.0 if situation.pad is None else situation.pad.ground_speed_m_s
    follows = memory.progress.phase is Phase.FOLLOW
    return max(vehicle_m_s, station_speed_m_s(memory.sortie, situation)) if follows else vehicle_m_s


def _is_committed(memory: StepMemory, situation: Situation, config: CompanionConfig) -> bool:
    relative, phase = situation.approach, memory.progress.phase
    is_low = relative is not None and relative.height_m < config.descent.commit_height_m
    return phase is Phase.TOUCHDOWN or (phase is Phase.DESCEND and is_low)


def _lowest_enu_m(memory: StepMemory, situation: Situation, config: CompanionConfig) -> float | None:
    """Return where a descent that is not committed yet has to end; other phases have a floor in their plan."""
    pad = situation.pad
    if memory.progress.phase is not Phase.DESCEND or pad is None or _is_committed(memory, situation, config):
        return None
    return float(pad.position_enu_m[0, 2]) + situation.feet_offset_m + LOWEST_M
