"""How long the way home takes, when it has to begin, and why none can be flown; pure."""

import math

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason, same_or_new
from companion.integrity.frames import tell_unheard
from companion.landing.decisions.conditions import is_fix_old
from companion.landing.sortie.over_vehicle import SPEED_SHARE, WAY_SHARE
from companion.situation.phases import OUT_PHASES, Phase
from companion.situation.situation import Situation
from companion.sortie.memory import SortieMemory, left_s
from companion.sortie.station import intercept_s


def home_s(s: Situation, config: CompanionConfig) -> float:
    """Return how long the way home and the landing take; infinite for a vehicle that outruns the drone."""
    if s.approach is None or s.pad is None or s.limits is None:
        return config.limits.landing_time_s
    way = s.pad.position_enu_m[0, :2] - s.drone.position_enu_m[:2] if s.drone is not None else None
    if way is None or s.approach.distance_m < config.chase.passing_distance_m:
        return config.limits.landing_time_s
    limits, velocity = s.limits, s.pad.velocity_enu_m_s[0, :2]
    flight_s = intercept_s(way, velocity, SPEED_SHARE * limits.speed_max_m_s, WAY_SHARE * limits.acceleration_max_m_s2)
    return math.inf if flight_s is None else flight_s + config.limits.landing_time_s


def out_of_reach(s: Situation, config: CompanionConfig) -> Cause | None:
    """Return why no way home is begun to where the vehicle is; None where one can be."""
    if s.approach is None or s.pad is None or s.limits is None:
        return Cause(Reason.NO_OWN_POSITION)
    if s.approach.distance_m > config.limits.range_max_m:
        return Cause(Reason.VEHICLE_OUT_OF_RANGE, (s.approach.distance_m, config.limits.range_max_m))
    if math.isfinite(home_s(s, config)):
        return None
    speed_m_s = s.pad.ground_speed_m_s
    return Cause(Reason.VEHICLE_DRIVES_OFF, (speed_m_s, SPEED_SHARE * s.limits.speed_max_m_s))


def way_home_due(sortie: SortieMemory, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return that the battery above its reserve lasts just for the way home; None while it lasts longer."""
    if is_fix_old(s, config):
        return None
    lasts_s = left_s(sortie.battery, config.limits.battery_min_share, s.monotonic_ns)
    needed_s = home_s(s, config)
    return Cause(Reason.HOME_NOW, (lasts_s, needed_s)) if lasts_s <= needed_s < math.inf else None


def warn_of_way_home(sortie: SortieMemory, phase: Phase, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return what the pilot is told of the way home, with the numbers that it was first told with.

    Where a return would be refused it is not advised: the reason is told instead.
    """
    if phase not in OUT_PHASES:
        return None
    lasts_s = left_s(sortie.battery, config.limits.battery_min_share, s.monotonic_ns)
    needed_s = home_s(s, config)
    spare_s = lasts_s - needed_s if math.isfinite(lasts_s) else math.inf
    if spare_s > config.sortie.warn_before_s or not math.isfinite(needed_s):  # no way home leads to who is faster
        return None
    refused = tell_unheard(s, config) if is_fix_old(s, config) else out_of_reach(s, config)
    return same_or_new(sortie.warning, refused or Cause(Reason.HOME_SOON, (max(spare_s, 0.0),)))
