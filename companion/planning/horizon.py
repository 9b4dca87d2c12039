"""One plan's problem in turned axes: the state and the target relative to the target's position now. All compiled.

Axis 0 is the major horizontal axis, where most of the motion is needed, axis 1 the minor one, axis 2 is up.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel
from companion.planning.intercept import TINY

EXCESS_WEIGHT = 1e3
"""Metres that each m/s or m/s^2 over a limit counts for when the axes are turned: more than any distance."""


@compiled_kernel
def needs(x: Array, target_v: Array, speed_max_m_s: float, acceleration_max_m_s2: float, time_s: float) -> Array:
    """Return four horizontal needs of motion as lengths (4, 2).

    They are the relative position, the relative velocity times `time_s`, and the velocity and the acceleration as far
    as they break their limits, weighed such that they come first.

    Args:
        x: (3, 3) position relative to the target, velocity, acceleration.
        target_v: (3,) the target's velocity.
        speed_max_m_s: of the drone.
        acceleration_max_m_s2: of the drone.
        time_s: the time in which a relative velocity counts like the distance it covers.
    """
    speed, push = math.hypot(x[1, 0], x[1, 1]), math.hypot(x[2, 0], x[2, 1])
    fast = EXCESS_WEIGHT * max(1.0 - speed_max_m_s / max(speed, TINY), 0.0)
    hard = EXCESS_WEIGHT * max(1.0 - acceleration_max_m_s2 / max(push, TINY), 0.0)
    lengths = np.empty((4, 2))
    for axis in range(2):
        lengths[0, axis] = x[0, axis]
        lengths[1, axis] = time_s * (x[1, axis] - target_v[axis])
        lengths[2, axis] = fast * x[1, axis]
        lengths[3, axis] = hard * x[2, axis]
    return lengths


@compiled_kernel
def major_direction(lengths: Array) -> tuple[float, float]:
    """Return the unit vector along the principal direction of `lengths` (k, 2)."""
    xx, xy, yy = 0.0, 0.0, 0.0
    for row in range(len(lengths)):
        xx += lengths[row, 0] * lengths[row, 0]
        xy += lengths[row, 0] * lengths[row, 1]
        yy += lengths[row, 1] * lengths[row, 1]
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    return math.cos(angle), math.sin(angle)


@compiled_kernel
def turned_horizon(
    state: tuple[Array, Array, Array],
    path: Array,
    speed_max_m_s: float,
    acceleration_max_m_s2: float,
    axes_time_s: float,
) -> tuple[tuple[float, float], Array, Array]:
    """Return a plan's problem in turned axes, relative to the target now.

    Args:
        state: (3,) each: position, velocity, acceleration in W.
        path: (3, n, 3) of the target in W, from now on.
        speed_max_m_s: of the drone.
        acceleration_max_m_s2: of the drone.
        axes_time_s: see `needs`.

    Returns:
        the direction of the major axis in W; the state (3, 3), the axes in its columns; and the target (3, 3, n):
        position, velocity, acceleration; axis; node.
    """
    x = np.empty((3, 3))
    for axis in range(3):
        x[0, axis] = state[0][axis] - path[0, 0, axis]
        x[1, axis], x[2, axis] = state[1][axis], state[2][axis]
    c, s = major_direction(needs(x, path[1, 0], speed_max_m_s, acceleration_max_m_s2, axes_time_s))
    turned_x, target = np.empty((3, 3)), np.empty((3, 3, path.shape[1]))
    for rate in range(3):
        turned_x[rate, 0] = c * x[rate, 0] + s * x[rate, 1]
        turned_x[rate, 1] = c * x[rate, 1] - s * x[rate, 0]
        turned_x[rate, 2] = x[rate, 2]
        is_place = 1.0 if rate == 0 else 0.0
        for node in range(path.shape[1]):
            east = path[rate, node, 0] - is_place * path[0, 0, 0]
            north = path[rate, node, 1] - is_place * path[0, 0, 1]
            target[rate, 0, node] = c * east + s * north
            target[rate, 1, node] = c * north - s * east
            target[rate, 2, node] = path[rate, node, 2] - is_place * path[0, 0, 2]
    return (c, s), turned_x, target
