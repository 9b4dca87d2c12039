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
from companion.planning.intercept import TINY, approach
from companion.planning.resample import make_resampler

EXCESS_WEIGHT = 1e3
"""Metres that each m/s or m/s^2 over a limit counts for when the axes are turned: more than any distance."""


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
    x = np.array((state.position_enu_m - origin, state.velocity_enu_m_s, state.acceleration_enu_m_s2))
    turn = turn_to_major(needs(x, velocity[0], request.limits, config.axes_time_s))
    x = x @ turn.T
    target = turn @ np.array((position - origin, velocity, acceleration)).transpose(0, 2, 1)
    limits = limit_array(request.limits)
    fraction, time_min_s = config.intercept_fraction, config.intercept_time_min_s
    floor = resampler.linear @ request.floor_enu_m - origin[2]
    split, push, reference = approach(x[:2], nodes_s, target, floor, limits, fraction, time_min_s)
    ends = target[2][:, model.end_node]
    return Horizon(
        origin_enu_m=origin,
        turn=turn,
        state=x,
        reference=reference,
        jerk_m_s3=(ends[:, 1:] - ends[:, :-1]) / model.move_s,
        target_velocity_m_s=target[1],
        target_acceleration_m_s2=ends,
        floor_m=floor[1:],
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


def needs(x: Array, target_v: Array, limits: FlightLimits, time_s: float) -> Array:
    """Return four horizontal needs of motion as lengths (4, 2).

    They are the relative position, the relative velocity times `time_s`, and the velocity and the acceleration as far
    as they break their limits, weighed such that they come first.

    Args:
        x: (3, 3) position relative to the target, velocity, acceleration.
        target_v: (3,) the target's velocity.
        limits: of the drone.
        time_s: the time in which a relative velocity counts like the distance it covers.
    """
    speed, push = math.hypot(x[1, 0], x[1, 1]), math.hypot(x[2, 0], x[2, 1])
    fast = EXCESS_WEIGHT * max(1.0 - limits.speed_max_m_s / max(speed, TINY), 0.0)
    hard = EXCESS_WEIGHT * max(1.0 - limits.acceleration_max_m_s2 / max(push, TINY), 0.0)
    return np.array((x[0, :2], time_s * (x[1, :2] - target_v[:2]), fast * x[1, :2], hard * x[2, :2]))


def turn_to_major(lengths: Array) -> Array:
    """Return the rotation (3, 3) about up that lays axis 0 along the principal direction of `lengths` (k, 2)."""
    (xx, xy), (_, yy) = (lengths.T @ lengths).tolist()
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    c, s = math.cos(angle), math.sin(angle)
    return np.array(((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)))
