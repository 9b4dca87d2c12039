"""Bounds that are widened just enough for a state that already breaks them to come back as fast as it can.

The widened speed bound is the speed that is left when acceleration is turned around with nearly all of the jerk and
then held at nearly all of the acceleration limit; the widened acceleration bound falls with the jerk; the lowered
floor is the height reached by pulling up likewise, at no more than the climb limit. All functions are compiled.
"""

import numpy as np
from numba import njit

from companion.data import Array

AUTHORITY = 0.98
"""Share of the limits that the way back uses, so that the solver has room to follow it."""


@njit(cache=True)
def velocity_left(velocity: float, acceleration: float, braking: float, jerk: float, t_s: float) -> float:
    """Return the velocity at `t_s` when the acceleration goes to `-braking` at `jerk` and stays there."""
    turning = min(t_s, max((acceleration + braking) / jerk, 0.0))
    turned = velocity + (acceleration - 0.5 * jerk * turning) * turning
    return turned + min(-braking, acceleration) * (t_s - turning)


@njit(cache=True)
def velocity_ceiling(
    bound_m_s: Array, velocity_m_s: float, acceleration_m_s2: float, braking_m_s2: float, jerk_m_s3: float, t_s: Array
) -> Array:
    """Return the upper bound (n,) at `t_s`, at least `bound_m_s` (n,), that a state can keep."""
    braking, jerk = AUTHORITY * braking_m_s2, AUTHORITY * jerk_m_s3
    ceiling = np.empty_like(bound_m_s)
    for i in range(len(t_s)):
        left = velocity_left(velocity_m_s, acceleration_m_s2, braking, jerk, t_s[i])
        ceiling[i] = max(bound_m_s[i], left)
    return ceiling


@njit(cache=True)
def acceleration_ceiling(bound_m_s2: Array, acceleration_m_s2: float, jerk_m_s3: float, t_s: Array) -> Array:
    """Return the upper bound (n,) at `t_s`, at least `bound_m_s2` (n,), that a state can keep."""
    ceiling = np.empty_like(bound_m_s2)
    for i in range(len(t_s)):
        ceiling[i] = max(bound_m_s2[i], acceleration_m_s2 - AUTHORITY * jerk_m_s3 * t_s[i])
    return ceiling


@njit(cache=True)
def reachable_floor(
    floor_m: Array, x: Array, pull_m_s2: float, climb_m_s: float, jerk_m_s3: float, t_s: Array
) -> Array:
    """Return the floor (n,) at `t_s`, at most `floor_m` (n,), that the state `x` (3,) can keep above."""
    pull, jerk = AUTHORITY * pull_m_s2, AUTHORITY * jerk_m_s3
    climb = max(AUTHORITY * climb_m_s, x[1])
    height, before, then = x[0], x[1], 0.0
    floor = np.empty_like(floor_m)
    for i in range(len(t_s)):
        velocity = min(-velocity_left(-x[1], -x[2], pull, jerk, t_s[i]), climb)
        height += 0.5 * (velocity + before) * (t_s[i] - then)
        before, then = velocity, t_s[i]
        floor[i] = min(floor_m[i], height)
    return floor
