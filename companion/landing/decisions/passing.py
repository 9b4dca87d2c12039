"""Which vehicle is chased as it passes the drone that waits, and why another one is not; pure."""

import math

from msgspec import Struct

from companion.autopilots.response import DRAG_PER_S
from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.conditions import is_fix_old
from companion.landing.state.memory import Held
from companion.landing.steering.following_height import chase_floor_m
from companion.situation.phases import Event
from companion.situation.situation import Drone, Situation, vehicle_stands
from companion.vehicle.pad import PadPath

_LEFT_MIN_M_S2 = 1.0  # of the tilt limit beside drag: a drone that has less meets nothing


class _Passage(Struct, frozen=True, kw_only=True):
    """How a vehicle passes the drone, on the course that it drives now, and from where to where it is chased."""

    speed_m_s: float
    to_go_m: float  # until it is abreast of the drone; negative once it is past
    beside_m: float  # its course is off the drone
    lead_m: float  # as near as this before it passes, the chase begins
    past_m: float  # farther past than this it is let go


def is_too_low(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone hovers so low that a chase would run into the vehicle's side."""
    return s.approach is None or s.approach.height_m < chase_floor_m(c)


def distance_m(drone: Drone, pad: PadPath) -> float:
    """Return how far apart drone and pad are, horizontally, m."""
    return math.hypot(*(drone.position_enu_m[:2] - pad.position_enu_m[0, :2]).tolist())


def vehicle_passes(s: Situation, config: CompanionConfig) -> tuple[Event, Cause] | None:
    """Return the event that starts the chase.

    A moving vehicle is chased from the moment at which a drone that accelerates to its speed meets it. One that is past
    is let go when it is farther away than the passing distance and would not be caught up with soon.
    """
    if s.drone is None or s.pad is None or is_fix_old(s, config) or is_too_low(s, config):
        return None
    if vehicle_stands(s, config.chase):
        return None
    way = _passage(s, s.drone, s.pad, config)
    if way.beside_m > config.chase.passing_distance_m or not -way.past_m < way.to_go_m < way.lead_m:
        return None
    return Event.VEHICLE_PASSES, Cause(Reason.VEHICLE_PASSES, (way.speed_m_s,))


def why_not_chased(held: Held, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return why a drone that waits does not chase the vehicle that it knows, None where that one is to come yet."""
    if s.drone is None or s.pad is None:
        return None
    if is_fix_old(s, config):
        return Cause(Reason.VEHICLE_DATA_OLD)
    nearest_m = config.chase.passing_distance_m
    if Reason.VEHICLE_STANDS in held or vehicle_stands(s, config.chase):
        away_m = distance_m(s.drone, s.pad)
        if away_m >= nearest_m:
            return Cause(Reason.VEHICLE_STANDS_FAR, (away_m, nearest_m))
        stood_s = (s.monotonic_ns - held.get(Reason.VEHICLE_STANDS, s.monotonic_ns)) * 1e-9
        return Cause(Reason.VEHICLE_MAY_DEPART, (max(config.chase.parked_wait_s - stood_s, 0.0),))
    way = _passage(s, s.drone, s.pad, config)
    if way.to_go_m <= -way.past_m:
        return Cause(Reason.VEHICLE_IS_PAST, (-way.to_go_m,))
    is_near = way.to_go_m < way.lead_m  # before that its course can still be another one
    return Cause(Reason.VEHICLE_PASSES_FAR, (way.beside_m, nearest_m)) if is_near and way.beside_m > nearest_m else None


def _passage(s: Situation, drone: Drone, pad: PadPath, config: CompanionConfig) -> _Passage:
    velocity = pad.velocity_enu_m_s[0, :2]
    ahead = drone.position_enu_m[:2] - pad.position_enu_m[0, :2]
    speed_m_s = math.hypot(*velocity.tolist())
    speed_max_m_s = config.limits.speed_max_m_s if s.limits is None else s.limits.speed_max_m_s
    faster_m_s = min(speed_max_m_s - speed_m_s, config.chase.catch_up_speed_m_s)
    return _Passage(
        speed_m_s=speed_m_s,
        to_go_m=float(ahead @ velocity) / speed_m_s,
        beside_m=abs(float(ahead[0] * velocity[1] - ahead[1] * velocity[0])) / speed_m_s,
        lead_m=_lead_m(speed_m_s, s, config),
        past_m=max(config.chase.passing_distance_m, config.chase.catch_up_s * faster_m_s),
    )


def _lead_m(speed_m_s: float, s: Situation, config: CompanionConfig) -> float:
    """Return how far before it passes a vehicle is that a drone meets which accelerates from rest to its speed v.

    It takes v / a + a / j for that, and is half of the way behind. Acceleration and jerk are the same share of what
    there is, a tilt limit less the drag at v included: a drone that is early waits for the vehicle, one that is late
    has nothing left to catch up with.
    """
    limits = config.limits.flight_limits() if s.limits is None else s.limits
    share = config.chase.start_fraction
    left_m_s2 = limits.tilt_acceleration_m_s2 - DRAG_PER_S * speed_m_s
    acceleration_m_s2 = share * max(min(limits.acceleration_max_m_s2, left_m_s2), _LEFT_MIN_M_S2)
    return 0.5 * speed_m_s * (speed_m_s / acceleration_m_s2 + acceleration_m_s2 / (share * limits.jerk_max_m_s3))
