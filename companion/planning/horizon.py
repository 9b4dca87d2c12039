"""One plan's problem in turned axes: the state and the references relative to the target's position now.

Axis 0 is the major horizontal axis, where most of the motion is needed, axis 1 the minor one, axis 2 is up. The
acceleration norm is split at the angle at which the sum of the times that the two horizontal axes need to the target
is least.
"""

import math
from dataclasses import dataclass

import numpy as np

from companion.data import Array, FlightLimits
from companion.planning.condensed import AxisModel
from companion.planning.config import MpcConfig
from companion.planning.guidance import PlanRequest
from companion.planning.intercept import approach
from companion.planning.resample import make_resampler


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Horizon:
    """What the programmes of the three axes are made from.

    Attributes:
        origin_enu_m: (3,) the target's position now.
        turn: (3, 3) from W to the turned axes.
        state: (3, 3) position, velocity, acceleration (rows) per axis (columns).
        reference: (3, 3, n) position, velocity, acceleration; axis; node.
        jerk_m_s3: (3, m) the target's mean jerk in each block.
        target_velocity_m_s: (3, n + 1) the target's own velocity, now and at the nodes.
        target_acceleration_m_s2: (3, m + 1) the target's own acceleration, now and at the ends of the blocks.
        floor_m: (n,) relative to the origin.
        split_rad: the angle at which the acceleration norm is split.
        minor_push_m_s2: what the minor axis accelerates with beside the target's own acceleration.
    """

    origin_enu_m: Array
    turn: Array
    state: Array
    reference: Array
    jerk_m_s3: Array
    target_velocity_m_s: Array
    target_acceleration_m_s2: Array
    floor_m: Array
    split_rad: float
    minor_push_m_s2: float


def make_horizon(request: PlanRequest, model: AxisModel, nodes_s: Array, config: MpcConfig) -> Horizon:
    """Return the problem of `request`; `nodes_s` (n + 1,) are 0 and the nodes of `model`."""
    resampler = make_resampler(tuple(request.target.offset_s.tolist()), tuple(nodes_s.tolist()))
    position, velocity, acceleration = resampler.apply(request.target)
    origin, state = position[0], request.state
    turn = turn_to_major(state.position_enu_m - origin, state.velocity_enu_m_s - velocity[0], config.axes_time_s)
    x = np.array((state.position_enu_m - origin, state.velocity_enu_m_s, state.acceleration_enu_m_s2)) @ turn.T
    target = turn @ np.array((position - origin, velocity, acceleration)).transpose(0, 2, 1)
    limits = limit_array(request.limits)
    fraction, time_min_s = config.intercept_fraction, config.intercept_time_min_s
    split, push, reference = approach(x[:2], nodes_s, target, limits, fraction, time_min_s)
    ends = target[2][:, model.end_node]
    return Horizon(
        origin_enu_m=origin,
        turn=turn,
        state=x,
        reference=reference,
        jerk_m_s3=(ends[:, 1:] - ends[:, :-1]) / model.move_s,
        target_velocity_m_s=target[1],
        target_acceleration_m_s2=ends,
        floor_m=(resampler.linear @ request.floor_enu_m)[1:] - origin[2],
        split_rad=split,
        minor_push_m_s2=float(push[1]),
    )


def limit_array(limits: FlightLimits) -> Array:
    """Return speed, climb, descent, horizontal and vertical acceleration limits (5,)."""
    return np.array(
        (
            limits.speed_max_m_s,
            limits.climb_max_m_s,
            limits.descent_max_m_s,
            limits.acceleration_max_m_s2,
            limits.vertical_acceleration_max_m_s2,
        )
    )


def turn_to_major(error_m: Array, rate_m_s: Array, time_s: float) -> Array:
    """Return the rotation (3, 3) about up that lays axis 0 along the greatest horizontal need of motion.

    The need is the principal direction of `e e' + time^2 w w'`, e relative position and w relative velocity.
    """
    ex, ey = float(error_m[0]), float(error_m[1])
    wx, wy = time_s * float(rate_m_s[0]), time_s * float(rate_m_s[1])
    angle = 0.5 * math.atan2(2.0 * (ex * ey + wx * wy), ex * ex - ey * ey + wx * wx - wy * wy)
    c, s = math.cos(angle), math.sin(angle)
    return np.array(((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)))
