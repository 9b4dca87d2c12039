"""How a drone that leans into a curve, or against a gust, comes to touch the pad level; pure.

In a curve the drone leans as the deck does not: 18 degrees on a circle of 20 m at 8 m/s. So in its last moments it
turns less than the pad does, and takes the speed against it that it gains so.
"""

import math

from companion.config.companion import CompanionConfig
from companion.config.landing import TouchdownConfig
from companion.core.data import FlightLimits
from companion.landing.memory import StepMemory
from companion.landing.step_data import StepInputs
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation
from companion.vehicle.pad_reach import over_pad_radius_m
from link.records import replace

_SEEN_OFF_MAX_M = 1.0  # what a range finder sees farther off is not the pad: a roof is 1.5 m above the road


def limits_now(memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig) -> FlightLimits:
    """Return the limits of this step: just above the pad the drone turns less than the deck, to touch down level.

    A drone that leans touches with its lowest foot, so it begins that much higher, and it begins earlier by as much as
    nearly every setpoint is late at most; one that breaks off climbs before it leans.
    """
    limits, relative, drone = inputs.limits, situation.approach, situation.drone
    if memory.progress.phase not in (Phase.DESCEND, Phase.ABORT) or relative is None or drone is None:
        return limits
    touchdown = config.touchdown
    escape_m = 0.0 if memory.progress.phase is Phase.DESCEND else config.descent.commit_height_m
    late_m = max(-relative.climb_m_s, 0.0) * touchdown.level_late_stds * inputs.link_delay_std_s
    if lowest_foot_m(situation, relative, config) > touchdown.level_height_m + late_m + escape_m:
        return limits
    turns_m_s2 = 0.0 if situation.pad is None else math.hypot(*situation.pad.acceleration_enu_m_s2[0, :2].tolist())
    kept_m_s2 = min(_kept_m_s2(turns_m_s2, touchdown), limits.acceleration_max_m_s2)
    return replace(limits, acceleration_max_m_s2=kept_m_s2)


def lowest_foot_m(situation: Situation, relative: Approach, config: CompanionConfig) -> float:
    """Return how high the lowest foot of a leaning drone is above the pad, by a range finder that has just seen it."""
    lean = 0.0 if situation.drone is None else situation.drone.lean
    seen_m, height_m = situation.below.range_carried_m, relative.height_m
    is_over = relative.distance_m < over_pad_radius_m(relative.pad_half_width_m, config)
    if situation.below.range_height_m is not None and seen_m is not None and is_over:
        height_m = seen_m if abs(seen_m - height_m) < _SEEN_OFF_MAX_M else height_m
    return height_m - config.touchdown.foot_radius_m * lean


def _kept_m_s2(turns_m_s2: float, config: TouchdownConfig) -> float:
    """Return what a level drone keeps of the pad's acceleration."""
    kept_m_s2 = max(config.level_share * turns_m_s2, config.level_acceleration_min_m_s2)
    return min(kept_m_s2, config.level_acceleration_max_m_s2)
