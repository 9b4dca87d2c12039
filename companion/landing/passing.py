"""When a vehicle that drives past is to be chased; pure."""

import math

from companion.config.companion import CompanionConfig
from companion.landing.conditions import is_too_low
from companion.landing.silence import fix_too_old
from companion.situation.phases import Event
from companion.situation.situation import Situation, stands


def vehicle_passes(s: Situation, config: CompanionConfig) -> tuple[Event, str] | None:
    """Return the event that starts the chase.

    A moving vehicle is chased from the moment at which a drone that accelerates evenly to the vehicle's speed
    v meets it: v / (2 a) before it passes. One that is past is let go when it is farther away than the passing
    distance and would not be caught up with soon.
    """
    if s.drone is None or s.pad is None or fix_too_old(s, None, config) or is_too_low(s, config):
        return None
    velocity = s.pad.velocity_enu_m_s[0, :2]
    ahead = s.drone.position_enu_m[:2] - s.pad.position_enu_m[0, :2]
    speed_m_s = math.hypot(*velocity.tolist())
    if stands(s, config.chase):
        return None
    to_go_m = float(ahead @ velocity) / speed_m_s
    beside_m = abs(float(ahead[0] * velocity[1] - ahead[1] * velocity[0])) / speed_m_s
    lead_m = speed_m_s**2 / (2.0 * config.chase.start_acceleration_m_s2)
    speed_max_m_s = config.limits.speed_max_m_s if s.limits is None else s.limits.speed_max_m_s
    faster_m_s = min(speed_max_m_s - speed_m_s, config.chase.catch_up_speed_m_s)
    past_m = max(config.chase.passing_distance_m, config.chase.catch_up_s * faster_m_s)
    if beside_m > config.chase.passing_distance_m or not -past_m < to_go_m < lead_m:
        return None
    return Event.VEHICLE_PASSES, f"vehicle passes at {speed_m_s:.1f} m/s"
