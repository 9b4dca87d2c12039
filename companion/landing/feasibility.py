"""Whether a landing on this vehicle can be done at all: the speed, the way and the battery against the limits; pure.

What cannot be done is not begun. It is told with its numbers, once, and again only when it is another thing.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.integrity.contradictions import CONTRADICTING, contradicts_itself
from companion.integrity.ground import road_above_ground_m, road_distance_m
from companion.landing.condition import Held, Test, holds
from companion.landing.conditions import is_stamped_ahead
from companion.landing.silence import fix_too_old
from companion.landing.targets import chase_floor_m
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation, approach
from companion.vehicle.pad_reach import is_too_small

SPEED_SHARE_MIN = 1.15
"""Of the vehicle's speed: with less there is nothing to catch up with, and no landing is begun."""

HEIGHTS_APART = (
    "heights cannot be compared: the vehicle's are above the ellipsoid, and the autopilot tells its own above the sea "
    "only (no alt_ellipsoid in GPS_RAW_INT): set geoid_height_m"
)
"""Of an autopilot whose receiver does not know the geoid: a drone that is off by it flies into the vehicle."""

_RECEIVER_TOLD_S = 3.0  # it says so once a second
_ROUNDING = 1e-6
_BEFORE_A_FLIGHT = frozenset({Phase.IDLE, Phase.SECURED, Phase.PILOT, Phase.HOLD, Phase.WAITING})
_BEFORE_A_CHASE = _BEFORE_A_FLIGHT | {Phase.ABORT}


@dataclass(frozen=True, slots=True)
class Obstacle:
    """What makes a landing impossible, and how it is told."""

    test: Test
    told: Callable[[Situation, CompanionConfig], str]


def _vehicle_speed_m_s(s: Situation) -> float:
    return 0.0 if s.pad is None else math.hypot(*s.pad.velocity_enu_m_s[0, :2].tolist())


def _is_too_fast(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    if s.limits is None or fix_too_old(s, None, c):
        return False
    return SPEED_SHARE_MIN * _vehicle_speed_m_s(s) > s.limits.speed_max_m_s


def _too_fast(s: Situation, c: CompanionConfig) -> str:
    speed_m_s = _vehicle_speed_m_s(s)
    allowed_m_s = c.limits.speed_max_m_s if s.limits is None else s.limits.speed_max_m_s
    name = " or ".join(s.speed_limited_by) if allowed_m_s < c.limits.speed_max_m_s else "limits.speed_max_m_s"
    needs = f"vehicle at {speed_m_s:.1f} m/s needs {SPEED_SHARE_MIN * speed_m_s:.1f} m/s"
    return f"{needs}, the limit is {allowed_m_s:.1f}: raise {name} or drive slower"


def _way_m(s: Situation, c: CompanionConfig) -> float:
    return _vehicle_speed_m_s(s) * c.limits.landing_time_s


def _is_too_far(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return not fix_too_old(s, None, c) and _way_m(s, c) > c.limits.range_max_m


def _too_far(s: Situation, c: CompanionConfig) -> str:
    way = f"vehicle at {_vehicle_speed_m_s(s):.1f} m/s goes {_way_m(s, c):.0f} m in {c.limits.landing_time_s:g} s"
    return f"{way}, limits.range_max_m is {c.limits.range_max_m:g}: raise it or drive slower"


def _contradicting(s: Situation, _: CompanionConfig) -> str:
    share = f"{100.0 * s.rejected_share:.0f} % of the last 10 s' measurements"
    return f"{CONTRADICTING}: {share} were rejected: see the axes of its velocity, its stamps, its receiver"


def _is_empty(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    share = s.autopilot.battery_share
    return share is not None and share < c.limits.battery_min_share


def _empty(s: Situation, c: CompanionConfig) -> str:
    share, least = s.autopilot.battery_share or 0.0, c.limits.battery_min_share
    return f"battery at {100.0 * share:.0f} %, limits.battery_min_share is {100.0 * least:.0f} %: charge it"


def _is_too_narrow(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.pad is not None and is_too_small(s.pad, c)


def _too_narrow(s: Situation, c: CompanionConfig) -> str:
    width_m = 0.0 if s.pad is None else 2.0 * s.pad.half_width_m
    return f"pad is {width_m:.2f} m wide, descent.pad_width_min_m is {c.descent.pad_width_min_m:.2f}: use a larger pad"


def _lacks_geoid(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    return s.autopilot.frame is not None and not s.autopilot.geoid_known


def _stamped_ahead(s: Situation, _: CompanionConfig) -> str:
    ahead_s = -(s.fix_age_on_arrival_s or 0.0)
    return f"vehicle's fixes come {ahead_s:.2f} s before their stamps: set its clock by GNSS or NTP, or the autopilot's"


def _is_warned(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    return s.autopilot.warns


def _warned(_: Situation, __: CompanionConfig) -> str:
    return "the autopilot reports a failsafe (battery, radio, ground station): end its cause, see its own messages"


def _is_elsewhere(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return not fix_too_old(s, None, c) and s.is_road_elsewhere


def _elsewhere(s: Situation, _: CompanionConfig) -> str:
    above_m = road_above_ground_m(s)
    if above_m is None:  # an outage has taken the ground's height
        return "the vehicle's road was said to be far above or below the ground: land, mend its altitude, start again"
    side = "above" if above_m > 0.0 else "below"
    where = f"{abs(above_m):.1f} m {side} the ground {road_distance_m(s):.0f} m from it"
    return f"the vehicle's road is said to be {where}: let drone and vehicle tell altitudes of one kind"


def _hover_height_m(s: Situation, a: Approach, c: CompanionConfig) -> float:
    """Return how high above the pad the drone hovers, or will after its take-off."""
    stands = not s.autopilot.armed or s.autopilot.landed is not False
    return a.height_m + (c.takeoff.waiting_height_m if stands else 0.0)


def _is_high(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    if a is None or fix_too_old(s, None, c) or a.distance_m > c.chase.ground_within_m:
        return False
    return _hover_height_m(s, a, c) < chase_floor_m(c)


def _high(s: Situation, c: CompanionConfig) -> str:
    relative = approach(s)
    height_m = 0.0 if relative is None else _hover_height_m(s, relative, c)
    more_m = math.ceil(10.0 * (chase_floor_m(c) - height_m) - _ROUNDING) / 10.0
    needed = f"waiting {height_m:.1f} m above the pad, {chase_floor_m(c):.1f} m are needed"
    return f"{needed}: raise takeoff.waiting_height_m by {more_m:.1f} m or hover higher"


# An estimate that has just begun jumps: what is said of the vehicle must hold for a while.
OBSTACLES = (
    Obstacle(
        Test("vehicle's stamps are ahead", _BEFORE_A_CHASE, is_stamped_ahead, lambda c: c.abort.fix_ahead_hold_s),
        _stamped_ahead,
    ),
    Obstacle(Test("vehicle too fast", _BEFORE_A_CHASE, _is_too_fast, lambda c: c.chase.driving_hold_s), _too_fast),
    Obstacle(Test("vehicle drives too far", _BEFORE_A_CHASE, _is_too_far, lambda c: c.chase.driving_hold_s), _too_far),
    Obstacle(
        Test("geoid unknown", _BEFORE_A_CHASE, _lacks_geoid, lambda _: _RECEIVER_TOLD_S), lambda *_: HEIGHTS_APART
    ),
    Obstacle(Test("autopilot reports a failsafe", _BEFORE_A_CHASE, _is_warned, lambda _: 0.0), _warned),
    Obstacle(Test("vehicle data rejected", _BEFORE_A_CHASE, contradicts_itself, lambda _: 0.0), _contradicting),
    Obstacle(Test("battery too low", _BEFORE_A_CHASE, _is_empty, lambda c: c.chase.driving_hold_s), _empty),
    Obstacle(Test("pad too small", _BEFORE_A_CHASE, _is_too_narrow, lambda _: 0.0), _too_narrow),
    Obstacle(
        Test("vehicle's height implausible", _BEFORE_A_CHASE, _is_elsewhere, lambda c: c.chase.driving_hold_s),
        _elsewhere,
    ),
    Obstacle(Test("roof too high", _BEFORE_A_FLIGHT, _is_high, lambda c: c.chase.driving_hold_s), _high),
)

OBSTACLE_TESTS = tuple(obstacle.test for obstacle in OBSTACLES)


def obstacle(held: Held, s: Situation, config: CompanionConfig) -> tuple[str, str] | None:
    """Return the name of what makes a landing impossible now, and the sentence with its numbers; None without one."""
    for one in OBSTACLES:
        if holds(one.test, held, s.t_ns, config):
            return one.test.reason, one.told(s, config)
    return None
