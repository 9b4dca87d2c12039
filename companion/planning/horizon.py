"""One plan's problem in turned axes: the state and the target relative to the target's position now. All compiled.

Axis 0 is the major horizontal axis, where most of the motion is needed, axis 1 the minor one, axis 2 is up.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel


@compiled_kernel
def major_direction(x: Array, target_v: Array, time_s: float) -> tuple[float, float]:
    """Return the unit vector along which most motion is needed: the principal direction of the distance and the rate.

    Args:
        x: (3, 3) position relative to the target, velocity, acceleration.
        target_v: (3,) the target's velocity.
        time_s: the time in which a relative velocity counts like the distance it covers.
    """
    rate_x, rate_y = time_s * (x[1, 0] - target_v[0]), time_s * (x[1, 1] - target_v[1])
    xx, yy = x[0, 0] * x[0, 0] + rate_x * rate_x, x[0, 1] * x[0, 1] + rate_y * rate_y
    xy = x[0, 0] * x[0, 1] + rate_x * rate_y
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    return math.cos(angle), math.sin(angle)


@compiled_kernel
def turned_horizon(
    state: tuple[Array, Array, Array],
    path: Array,
    axes_time_s: float,
) -> tuple[tuple[float, float], Array, Array]:
    """Return a plan's problem in turned axes, relative to the target now.

    Args:
        state: (3,) each: position, velocity, acceleration in W.
        path: (3, n, 3) of the target in W, from now on.
        axes_time_s: `time_s` of `major_direction`.

    Returns:
        the direction of the major axis in W; the state (3, 3), the axes in its columns; and the target (3, 3, n):
        position, velocity, acceleration; axis; node.
    """
    x = np.empty((3, 3))
    for axis in range(3):
        x[0, axis] = state[0][axis] - path[0, 0, axis]
        x[1, axis], x[2, axis] = state[1][axis], state[2][axis]
    c, s = major_direction(x, path[1, 0], axes_time_s)
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
