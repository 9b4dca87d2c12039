"""Whether the vehicle's road and pad can be as high as they are said to be; pure.

Heights of drone and vehicle come from two receivers. One that tells heights above mean sea level instead of the
ellipsoid, or goes by another geoid, puts the pad up to 100 m too high or too low, and a drone that believes in a pad
that is too low flies into the vehicle. What the drone knows by itself is where it stood, or what a range finder sees.
"""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import Array
from companion.situation.phases import FLYING_PHASES, Phase
from companion.situation.situation import Situation

VEHICLE_M = 3.0  # so near the pad what the drone stands on may be the vehicle
_STDS = 2.0
_LEAN_MAX = 0.4  # sine; a drone that leans more turns too fast for the attitude to be that of the reading
_COARSE_OFF_M = 0.7  # twice what over poor receivers the estimates of both heights have been seen to differ by
_BEFORE_IT_IS_FOLLOWED = frozenset({Phase.TAKEOFF, Phase.WAITING})


def update_ground(ground: Array | None, phase: Phase, s: Situation) -> Array | None:
    """Return (3,) a place of the ground in W, None while none is known.

    A drone that was not heard of in flight knows none any more: its local frame may have moved meanwhile.

    Args:
        ground: so far; in flight it stays, for what is below may be a roof.
        phase: of the landing.
        s: the facts.
    """
    relative = s.approach
    if phase in FLYING_PHASES:
        return None if s.drone is None else ground
    if s.drone is None:
        return ground
    if relative is not None and relative.distance_m < VEHICLE_M:
        return ground
    stands = not s.autopilot.armed or s.autopilot.landed is True
    above_m = 0.0 if stands else s.below.range_height_m
    if above_m is None:
        return ground
    return np.asarray(s.drone.position_enu_m - np.array([0.0, 0.0, s.feet_offset_m + above_m]))


def road_above_ground_m(s: Situation) -> float | None:
    """Return how far the vehicle's road is said to be above the ground that the drone knows."""
    if s.below.ground_enu_m is None or s.pad is None:
        return None
    return float(s.pad.position_enu_m[0, 2] - s.pad.height_m - s.below.ground_enu_m[2])


def road_distance_m(s: Situation) -> float:
    """Return how far from that ground the vehicle is."""
    if s.below.ground_enu_m is None or s.pad is None:
        return math.inf
    return math.hypot(*(s.pad.position_enu_m[0, :2] - s.below.ground_enu_m[:2]).tolist())


def is_road_elsewhere(was: bool | None, phase: Phase, s: Situation, c: CompanionConfig) -> bool | None:
    """Return whether the vehicle is said to be higher or lower than any hill puts it, None before that can be judged.

    A vehicle that is followed since it was not has told the altitude of the right kind: it may climb where it likes.
    One that is said to be far below the ground is doubted all the same, for a drone would fly into that.

    Args:
        was: so far; in flight that outlasts a vehicle's departure, for far away nothing tells.
        phase: of the landing.
        s: the facts.
        c: all numbers.
    """
    above_m = road_above_ground_m(s)
    if was is False and phase in FLYING_PHASES - _BEFORE_IT_IS_FOLLOWED and (above_m is None or above_m > 0.0):
        return False
    is_off = _is_off_the_ground(s, c)
    if was and not is_off and phase in FLYING_PHASES and road_distance_m(s) > c.chase.passing_distance_m:
        return True
    return is_off


def _is_off_the_ground(s: Situation, c: CompanionConfig) -> bool | None:
    above_m, distance_m = road_above_ground_m(s), road_distance_m(s)
    if s.pad is None or s.pad.mounting.is_afloat or above_m is None or distance_m > c.integrity.ground_within_m:
        return None
    unsure_m = _STDS * float(s.pad.position_std_m[0, 2]) if s.pad.is_coarse else 0.0
    return abs(above_m) > max(c.integrity.ground_step_max_m, unsure_m) + c.integrity.ground_slope_max * distance_m


def is_seen_too_near(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the range finder sees something nearer than the pad and all that is about it may be.

    Over the pad, that is the pad, whose height is wrong then; before, the vehicle's side or whatever stands there.
    """
    a, seen_m = s.approach, s.below.range_height_m
    if s.pad is None or a is None or s.drone is None or seen_m is None or s.drone.lean > _LEAN_MAX:
        return False
    about_m = c.touchdown.range_finder.off_max_m
    if s.pad.is_coarse:
        about_m = max(about_m, _COARSE_OFF_M, _STDS * float(s.pad.position_std_m[0, 2]))
    nearer_m = a.height_m - s.pad.frame_offset.higher_m - seen_m
    return nearer_m > about_m + c.integrity.ground_slope_max * a.distance_m
