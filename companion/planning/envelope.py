"""Bounds that are widened just enough for a state that already breaks them to come back as fast as it can.

The widened speed bound is the speed that is left when acceleration is turned around with nearly all of the jerk and
then held at nearly all of the acceleration limit; the widened acceleration bound falls with the jerk; the lowered
floor is the height reached by pulling up likewise, at no more than the climb limit.
"""

import numpy as np

from companion.data import Array

AUTHORITY = 0.98
"""Share of the limits that the way back uses, so that the solver has room to follow it."""


def velocity_ceiling(
    bound_m_s: Array, velocity_m_s: float, acceleration_m_s2: float, braking_m_s2: float, jerk_m_s3: float, t_s: Array
) -> Array:
    """Return the upper bound (n,) at `t_s`, at least `bound_m_s` (n,), that a state can keep."""
    jerk = AUTHORITY * jerk_m_s3
    rising = max(acceleration_m_s2, 0.0)
    if velocity_m_s + rising * rising / (2.0 * jerk) <= float(bound_m_s.min()):
        return bound_m_s
    left = velocity_left(velocity_m_s, acceleration_m_s2, AUTHORITY * braking_m_s2, jerk, t_s)
    return np.maximum(bound_m_s, left)


def acceleration_ceiling(bound_m_s2: Array, acceleration_m_s2: float, jerk_m_s3: float, t_s: Array) -> Array:
    """Return the upper bound (n,) at `t_s`, at least `bound_m_s2` (n,), that a state can keep."""
    if acceleration_m_s2 <= float(bound_m_s2.min()):
        return bound_m_s2
    return np.maximum(bound_m_s2, acceleration_m_s2 - AUTHORITY * jerk_m_s3 * t_s)


def reachable_floor(
    floor_m: Array, x: Array, pull_m_s2: float, climb_m_s: float, jerk_m_s3: float, t_s: Array
) -> Array:
    """Return the floor (n,) at `t_s`, at most `floor_m` (n,), that the state `x` (3,) can keep above."""
    sinking = -velocity_left(-float(x[1]), -float(x[2]), AUTHORITY * pull_m_s2, AUTHORITY * jerk_m_s3, t_s)
    velocity = np.minimum(sinking, max(AUTHORITY * climb_m_s, float(x[1])))
    before = np.concatenate((x[1:2], velocity[:-1]))
    path = x[0] + np.cumsum(0.5 * (velocity + before) * np.diff(t_s, prepend=0.0))
    return np.minimum(floor_m, path)


def velocity_left(
    velocity_m_s: float, acceleration_m_s2: float, braking_m_s2: float, jerk_m_s3: float, t_s: Array
) -> Array:
    """Return the velocity (n,) at `t_s` when the acceleration goes to `-braking_m_s2` at `jerk_m_s3` and stays there."""
    turning = max((acceleration_m_s2 + braking_m_s2) / jerk_m_s3, 0.0)
    while_turning = np.minimum(t_s, turning)
    lowest = min(-braking_m_s2, acceleration_m_s2)
    turned = velocity_m_s + (acceleration_m_s2 - 0.5 * jerk_m_s3 * while_turning) * while_turning
    return turned + lowest * (t_s - while_turning)
