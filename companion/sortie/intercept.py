"""How fast and how soon a drone comes to a vehicle that drives on evenly; pure numerics.

With the way u to it, a unit vector, and the vehicle's velocity v, a drone that closes at s flies v + s u, which is as
fast as its limit c allows: s = -v u + sqrt((v u)^2 + c^2 - v^2). The way against the vehicle then stays straight, so
that it leads to where the vehicle will be.
"""

import math

from companion.core.data import Array

_CLOSING_MIN_M_S = 0.5  # slower than this it comes nowhere: a gust takes more


def closing_speed_m_s(way_m: Array, velocity_enu_m_s: Array, speed_max_m_s: float) -> float:
    """Return how fast the drone can close in along `way_m` (2,) on a vehicle with this velocity (2,); 0 for no way."""
    distance_m = math.hypot(*way_m.tolist())
    if distance_m == 0.0:
        return 0.0
    along_m_s = float(way_m @ velocity_enu_m_s) / distance_m
    rest_m2_s2 = along_m_s**2 + speed_max_m_s**2 - float(velocity_enu_m_s @ velocity_enu_m_s)
    return max(math.sqrt(rest_m2_s2) - along_m_s, 0.0) if rest_m2_s2 > 0.0 else 0.0


def intercept_s(way_m: Array, velocity_enu_m_s: Array, speed_max_m_s: float, acceleration_m_s2: float) -> float | None:
    """Return how long the way to the vehicle takes, gaining speed and losing it included; None if it outruns the drone.

    Args:
        way_m: (2,) from the drone to the vehicle.
        velocity_enu_m_s: (2,) of the vehicle.
        speed_max_m_s: of the drone over ground.
        acceleration_m_s2: with which it gains and loses speed.
    """
    distance_m = math.hypot(*way_m.tolist())
    fastest_m_s = closing_speed_m_s(way_m, velocity_enu_m_s, speed_max_m_s)
    speed_m_s = min(fastest_m_s, math.sqrt(acceleration_m_s2 * distance_m))
    if distance_m == 0.0:
        return 0.0
    if fastest_m_s < _CLOSING_MIN_M_S:
        return None
    return distance_m / speed_m_s + speed_m_s / acceleration_m_s2
