"""Whether the deck that the drone stands on is quiet enough to leave it; pure.

The drone's own inertial unit tells the deck best: standing, it leans and moves as the deck does.
"""

import math

from companion.config.sortie import LaunchConfig
from companion.situation.situation import Situation


def is_deck_quiet(s: Situation, config: LaunchConfig) -> bool:
    """Return whether the deck is level, neither rises nor sinks, and the vehicle drives evenly."""
    if s.drone is None or s.pad is None:
        return False
    climb_m_s = abs(float(s.drone.velocity_enu_m_s[2] - _road_climb_m_s(s)))
    changes_m_s2 = math.hypot(*s.pad.acceleration_enu_m_s2[0, :2].tolist())
    is_level = s.drone.lean <= math.sin(config.quiet_tilt_max_rad)
    return is_level and climb_m_s <= config.quiet_climb_max_m_s and changes_m_s2 <= config.quiet_acceleration_max_m_s2


def _road_climb_m_s(s: Situation) -> float:
    """Return how fast the road rises by its grade, which is no heave."""
    return 0.0 if s.pad is None else float(s.pad.velocity_enu_m_s[0, 2])


def stands_on_deck(s: Situation, distance_max_m: float, height_max_m: float) -> bool:
    """Return whether the drone is on the vehicle, as far as both places are known."""
    a = s.approach
    return a is not None and a.distance_m < distance_max_m and abs(a.height_m) < height_max_m
