"""Whether a landing on this vehicle can be done at all: the speed, the way and the battery against the limits; pure.

What cannot be done is not begun. It is told with its numbers, once, and again only when it is another thing.
"""

import math

from companion.config.autopilot import Guide
from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.integrity.contradictions import contradicts_itself, tell_rejected
from companion.integrity.heights import road_above_ground_m, road_distance_m
from companion.integrity.sightings import has_nothing_but_unplaced_sightings
from companion.integrity.stamps import (
    are_fixes_rare,
    are_stamps_late,
    have_stamps_stepped,
    is_stamped_ahead,
    tell_rare,
    tell_stamped_ahead,
    tell_stamped_late,
)
from companion.landing.decisions.conditions import (
    AUTOPILOT_SILENT,
    Condition,
    first_cause,
    is_fix_old,
    is_pad_doubted,
    is_vehicle_taken,
    tell_taken,
)
from companion.landing.state.memory import Held
from companion.landing.steering.following_height import chase_floor_m, climb_m, vague_height_m
from companion.situation.phases import Phase
from companion.situation.situation import Situation, driving_hold_s
from companion.vehicle.pad_reach import is_too_small, pad_width_min_m
from link.records import replace

_MORE_SHARE = 0.15  # of the vehicle's speed
_RECEIVER_TOLD_S = 3.0  # it says so once a second
_TOLD_M = 0.1  # what heights are told to
_SEEN_HEIGHT = "mend the board's size, the camera's calibration or silent_vehicle.pad_height_m"  # by which it is told
_ROUNDING = 1e-6
_BEFORE_AN_ARMING = frozenset({Phase.IDLE, Phase.SECURED, Phase.PILOT})
_BEFORE_A_FLIGHT = frozenset({Phase.IDLE, Phase.SECURED, Phase.PILOT, Phase.HOLD, Phase.WAITING})
_BEFORE_A_CHASE = _BEFORE_A_FLIGHT | {Phase.ABORT}
_WAITS = frozenset({Phase.WAITING})
_BEFORE_A_RETRY = frozenset({Phase.WAITING, Phase.HOLD, Phase.ABORT})
_BEFORE_ANY_CHASE = _BEFORE_A_CHASE | {Phase.FOLLOW, Phase.RETURN}
"""A sortie comes home on a low battery as well: it has nowhere else to land."""


def is_drone_taken(s: Situation, _: CompanionConfig) -> bool:
    """Return whether another companion is to fly this drone."""
    return s.rival is not None and s.rival.is_this_drone


def catching_up_m_s(vehicle_m_s: float, c: CompanionConfig) -> float:
    """Return the least speed of a drone that catches up with a vehicle, m/s: with less no landing is begun."""
    passes_m_s = c.chase.passing_distance_m / c.chase.catch_up_s  # by so much more a vehicle is caught that has passed
    return vehicle_m_s + min(_MORE_SHARE * vehicle_m_s, passes_m_s)


def _vehicle_speed_m_s(s: Situation) -> float:
    return 0.0 if s.pad is None else s.pad.ground_speed_m_s


def _is_too_fast(s: Situation, c: CompanionConfig) -> bool:
    if s.limits is None or is_fix_old(s, c):
        return False
    return catching_up_m_s(_vehicle_speed_m_s(s), c) > s.limits.speed_max_m_s


def _too_fast(s: Situation, c: CompanionConfig) -> Cause:
    speed_m_s = _vehicle_speed_m_s(s)
    allowed_m_s = c.limits.speed_max_m_s if s.limits is None else s.limits.speed_max_m_s
    name = " or ".join(s.speed_limited_by) if allowed_m_s < c.limits.speed_max_m_s else "limits.speed_max_m_s"
    return Cause(Reason.VEHICLE_TOO_FAST, (speed_m_s, catching_up_m_s(speed_m_s, c), allowed_m_s, name))


def _way_m(s: Situation, c: CompanionConfig) -> float:
    return _vehicle_speed_m_s(s) * c.limits.landing_time_s


def _is_too_far(s: Situation, c: CompanionConfig) -> bool:
    return not is_fix_old(s, c) and _way_m(s, c) > c.limits.range_max_m


def _too_far(s: Situation, c: CompanionConfig) -> Cause:
    values = (_vehicle_speed_m_s(s), _way_m(s, c), c.limits.landing_time_s, c.limits.range_max_m)
    return Cause(Reason.VEHICLE_TOO_FAR, values)


def _is_empty(s: Situation, c: CompanionConfig) -> bool:
    share = s.autopilot.battery_share
    return share is not None and share < c.limits.battery_min_share


def _empty(s: Situation, c: CompanionConfig) -> Cause:
    share = s.autopilot.battery_share or 0.0
    return Cause(Reason.BATTERY_LOW, (100.0 * share, 100.0 * c.limits.battery_min_share))


EMPTY = Condition(
    reason=Reason.BATTERY_LOW,
    phases=_BEFORE_A_CHASE | {Phase.ON_DECK},
    is_true=_is_empty,
    hold_s=driving_hold_s,
    cause=_empty,
)
"""A drone begins no flight and no approach on a battery at its reserve."""


def _is_too_narrow(s: Situation, c: CompanionConfig) -> bool:
    return s.pad is not None and is_too_small(s.pad, c)


def _too_narrow(s: Situation, c: CompanionConfig) -> Cause:
    width_m = 0.0 if s.pad is None else 2.0 * s.pad.half_width_m
    return Cause(Reason.PAD_TOO_SMALL, (width_m, pad_width_min_m(c), c.touchdown.foot_radius_m))


def _lacks_geoid(s: Situation, _: CompanionConfig) -> bool:
    return s.autopilot.frame is not None and not s.autopilot.receiver.knows_geoid


def _is_elsewhere(s: Situation, c: CompanionConfig) -> bool:
    return not is_fix_old(s, c) and s.vehicle.is_road_elsewhere


def _elsewhere(s: Situation, c: CompanionConfig) -> Cause:
    above_m, is_silent = road_above_ground_m(s), c.silent_vehicle is not None
    if above_m is None:  # an outage has taken the ground's height
        mend = _SEEN_HEIGHT if is_silent else "mend its altitude"
        told = f"was said to be far above or below the ground: land, {mend}, start again"
    else:
        mend = _SEEN_HEIGHT if is_silent else "let drone and vehicle tell altitudes of one kind"
        where = f"{abs(above_m):.1f} m {'above' if above_m > 0.0 else 'below'} the ground {road_distance_m(s):.0f} m"
        told = f"is said to be {where} from it: {mend}"
    return Cause(Reason.ROAD_ELSEWHERE, (told,))


def _hover_height_m(s: Situation, c: CompanionConfig) -> float:
    """Return how high above the pad the drone hovers, or will once it has climbed to wait."""
    if s.approach is None or s.drone is None:
        return 0.0
    return s.approach.height_m + climb_m(float(s.drone.position_enu_m[2]), s, c)


def _is_high(s: Situation, c: CompanionConfig) -> bool:
    if s.approach is None or is_fix_old(s, c) or s.approach.distance_m > c.integrity.ground_within_m:
        return False
    unsure_m = 0.0 if s.pad is None else vague_height_m(s.pad, c)
    return _hover_height_m(s, c) + unsure_m < chase_floor_m(c)


def _high(s: Situation, c: CompanionConfig) -> Cause:
    more_m = math.ceil((chase_floor_m(c) - _hover_height_m(s, c)) / _TOLD_M - _ROUNDING) * _TOLD_M
    told_m = math.ceil(chase_floor_m(c) / _TOLD_M - _ROUNDING) * _TOLD_M
    # A drone that hovers higher than the setting has it climb is not raised by it.
    is_set = s.drone is None or climb_m(float(s.drone.position_enu_m[2]) - _TOLD_M, s, c) > 0.0
    told = (
        f"raise takeoff.waiting_height_m by {more_m:.1f} m or hover higher"
        if is_set
        else f"hover {more_m:.1f} m higher"
    )
    return Cause(Reason.ROOF_TOO_HIGH, (told_m - more_m, told_m, told))


OBSTACLES = (
    Condition(reason=Reason.DRONE_TAKEN, phases=_BEFORE_ANY_CHASE, is_true=is_drone_taken),
    Condition(reason=Reason.SYSTEM_ID_SHARED, phases=_BEFORE_AN_ARMING, is_true=lambda s, _: s.autopilot.is_id_shared),
    Condition(reason=Reason.VEHICLE_TAKEN, phases=_BEFORE_ANY_CHASE, is_true=is_vehicle_taken, cause=tell_taken),
    Condition(
        reason=Reason.STAMPS_AHEAD,
        phases=_BEFORE_ANY_CHASE,
        is_true=is_stamped_ahead,
        hold_s=lambda _, c: c.integrity.fix_ahead_hold_s,
        cause=tell_stamped_ahead,
    ),
    Condition(
        reason=Reason.STAMPS_LATE,
        phases=_BEFORE_A_CHASE,
        is_true=are_stamps_late,
        hold_s=driving_hold_s,
        cause=tell_stamped_late,
    ),
    Condition(
        reason=Reason.FIXES_RARE,
        phases=_BEFORE_A_CHASE,
        is_true=are_fixes_rare,
        hold_s=driving_hold_s,
        cause=tell_rare,
    ),
    Condition(reason=Reason.STAMPS_STEPPED, phases=_BEFORE_A_RETRY, is_true=have_stamps_stepped),
    Condition(
        reason=Reason.VEHICLE_TOO_FAST,
        phases=_BEFORE_ANY_CHASE,
        is_true=_is_too_fast,
        hold_s=driving_hold_s,
        cause=_too_fast,
    ),
    Condition(
        reason=Reason.VEHICLE_TOO_FAR,
        phases=_BEFORE_ANY_CHASE,
        is_true=_is_too_far,
        hold_s=driving_hold_s,
        cause=_too_far,
    ),
    Condition(
        reason=Reason.HEIGHTS_APART,
        phases=_BEFORE_ANY_CHASE,
        is_true=_lacks_geoid,
        hold_s=lambda _, __: _RECEIVER_TOLD_S,
    ),
    Condition(reason=Reason.AUTOPILOT_WARNS, phases=_BEFORE_A_CHASE, is_true=lambda s, _: s.autopilot.warns),
    Condition(
        reason=Reason.MEASUREMENTS_REJECTED,
        phases=_BEFORE_ANY_CHASE,
        is_true=contradicts_itself,
        cause=tell_rejected(Reason.MEASUREMENTS_REJECTED),
    ),
    *(replace(silence, phases=_WAITS) for silence in AUTOPILOT_SILENT),
    Condition(reason=Reason.SIGHTINGS_UNPLACED, phases=_WAITS, is_true=has_nothing_but_unplaced_sightings),
    EMPTY,
    Condition(reason=Reason.PAD_CHANGED, phases=_BEFORE_ANY_CHASE, is_true=is_pad_doubted),
    Condition(reason=Reason.PAD_TOO_SMALL, phases=_BEFORE_ANY_CHASE, is_true=_is_too_narrow, cause=_too_narrow),
    Condition(
        reason=Reason.ROAD_ELSEWHERE,
        phases=_BEFORE_ANY_CHASE,
        is_true=_is_elsewhere,
        hold_s=driving_hold_s,
        cause=_elsewhere,
    ),
    Condition(
        reason=Reason.ROOF_TOO_HIGH,
        phases=_BEFORE_A_FLIGHT,
        is_true=_is_high,
        hold_s=driving_hold_s,
        cause=_high,
    ),
)


def obstacle(held: Held, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return what makes a landing impossible now, with its numbers; None without one."""
    if config.autopilot.guide is Guide.PRECLAND:
        return Cause(Reason.GUIDES_ONLY)
    return first_cause(OBSTACLES, held, s, config)
